"""The command line: parse, ask, print. One line and a non-zero exit for anything that cannot be answered.

What is not asked for is not imported: neither other commands nor, for --help and --version, the parser of any.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress

from driftproof import __version__
from driftproof.commands.listing import ALIASES, COMMANDS, command_named

# Exit statuses, beside those in `commands.arguments`: no answer, as an answer that did not arrive is none; those of
# a shell for Ctrl-C, and for a reader that has gone (128 + SIGPIPE).
LOST, INTERRUPTED, CUT_SHORT = 3, 130, 141

HELP = """\
usage: driftproof [-h] [--version] COMMAND ...

Exact facts and certified numbers about one-step integrators, and float runs held to them.

commands:
{commands}

options:
  -h, --help      show this help message and exit
  --version       show the version and exit

examples:
  driftproof step rk4 --h 1/2 --state 1,0          337/384 and -23/48, with decimals
  driftproof run forward_euler --h 1/4 --t 10      certified state, errors, energy and phase
  driftproof facts rk4                             every exact fact of a method, or of your own tableau
  driftproof roundoff rk4 --h 1/4                  the rounding bound of a step, derived by running it
  driftproof identify mylib.ode:step               which method your code really is
  driftproof verify mylib.ode:step --method rk4    and whether it is right to roundoff
  driftproof certify mylib.ode:f run.csv           the true error of your run, enclosed
  driftproof scene default                         the lesson's readouts and its table
  driftproof work-precision                        error against evaluations and against run time
  driftproof report -o report.html                 the same as a page, with figures
  driftproof value --only 'rk4.*' --format md      proved values, ready for a text

Numbers are read exactly: 0.1 is 1/10, and 1/4 is a quarter. `driftproof COMMAND --help` teaches each command.
"""


def main(arguments: list[str] | tuple[str, ...] | None = None) -> int:
    """Run the command line; the status is 0 if answered, 1 if the answer is no, 2 for bad input, 3 for no answer.

    An answer that could not be written is none.
    """
    name, *words = (sys.argv[1:] if arguments is None else arguments) or ("",)
    prog = f"driftproof {name}" if name in COMMANDS or name in ALIASES else "driftproof"
    name, *words = (*ALIASES.get(name, (name,)), *words)
    try:
        if name in ("-h", "--help"):
            listed = "\n".join(f"  {command:14}  {what}" for command, (_, what) in COMMANDS.items())
            return _print(HELP.format(commands=listed).removesuffix("\n"), prog)
        if name == "--version":
            return _print(f"driftproof {__version__}", prog)
        return _answer(prog, name, words)
    except KeyboardInterrupt:  # also while something is imported
        return _complain(prog, "interrupted", INTERRUPTED)


def _answer(prog: str, name: str, words: list[str]) -> int:
    """Parse the words of one command, print its answer or one line of complaint."""
    from driftproof.commands.arguments import BAD_INPUT, NO_ANSWER, Help, Refuted
    from driftproof.support.plain_text import printable
    from driftproof.support.progress import working

    try:
        command = command_named(name)
        options = command.parser(prog).parse_args(words)
        with working(prog):
            answer, status = command.answer(options), 0
    except (Help, Refuted) as shown:
        answer, status = str(shown), shown.status if isinstance(shown, Refuted) else 0
    except OSError as error:
        return _complain(prog, _in_words(error), BAD_INPUT)
    except ValueError as error:
        return _complain(prog, str(error), BAD_INPUT)
    except ArithmeticError as error:
        return _complain(prog, str(error), NO_ANSWER)
    return _print(printable(answer), prog) or status


def _print(text: str, prog: str) -> int:
    """0 where the text has arrived; else one line about it."""
    if sys.stdout is None:
        return _complain(prog, "the answer is lost: standard output is closed", LOST)
    try:
        print(text, flush=True)
    except (OSError, ValueError) as error:
        with suppress(OSError, ValueError):  # what is left in the buffer must not fail a second time, at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # `| head` has read what it wanted
            return CUT_SHORT
        return _complain(prog, f"the answer is lost: standard output: {_in_words(error)}", LOST)
    return 0


def _in_words(error: Exception) -> str:
    """As elsewhere: the file, then what is wrong with it, without the number of the error."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error)


def _complain(name: str, message: str, status: int) -> int:
    from driftproof.support.plain_text import printable

    if sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(printable(f"{name}: {' '.join(message.split())}"), file=sys.stderr, flush=True)
    return status
