"""The sub-commands of the command line, one module each: `add` describes the command, `answer` answers it."""
