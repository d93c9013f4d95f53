"""The command line: parse the arguments, run one command, print its answer or a complaint of one line.

Only the module of that command is imported; --help and --version import no parser at all.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from io import TextIOWrapper

from driftproof import __version__
from driftproof.commands.listing import ALIASES, COMMANDS, command_named

# Exit statuses in addition to those of `commands.arguments`: an answer that could not be written counts as no answer;
# the other two are a shell's for Ctrl-C (128 + SIGINT) and for a pipe whose reader has gone (128 + SIGPIPE).
LOST, INTERRUPTED, CUT_SHORT = 3, 130, 141

HELP = """\
usage: driftproof [-h] [--version] COMMAND ...

Exact facts and certified numbers about numerical integrators, and float runs held to them.

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
    """Run the command line and return its status: 0 answered, 1 the answer is no, 2 bad input, 3 no answer.

    Status 3 also means that the answer could not be written.
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
    except KeyboardInterrupt as reason:  # may be raised during an import, too
        return _complain(prog, "; ".join(["interrupted", *map(str, reason.args)]), INTERRUPTED)


def _answer(prog: str, name: str, words: list[str]) -> int:
    """Parse the arguments of one command, print its answer or a complaint of one line, and return the exit status."""
    from driftproof.commands.arguments import BAD_INPUT, NO_ANSWER, Help, Refuted
    from driftproof.support.plain_text import printable
    from driftproof.support.progress import working

    try:
        command = command_named(name)
        options = command.parser(prog).parse_args(words)
        with working(prog, plain=True):
            answer, status = command.answer(options), 0
    except (Help, Refuted) as shown:
        answer, status = str(shown), shown.status if isinstance(shown, Refuted) else 0
    except (OSError, ValueError) as error:
        return _complain(prog, _message_of(error), BAD_INPUT)
    except ArithmeticError as error:
        return _complain(prog, str(error), NO_ANSWER)
    return _print(printable(answer), prog) or status


def _print(text: str, prog: str) -> int:
    """Print the text and return 0, or return the exit status for a text that could not be written."""
    if sys.stdout is None:
        return _complain(prog, "the answer is lost: standard output is closed", LOST)
    try:
        if isinstance(sys.stdout, TextIOWrapper):  # a file is in UTF-8, as it would be read; a terminal in its encoding
            sys.stdout.reconfigure(encoding=None if sys.stdout.isatty() else "utf-8", errors="backslashreplace")
        print(text, flush=True)
    except (OSError, ValueError) as error:
        with suppress(OSError, ValueError):  # or the rest of the buffer would fail again at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # `| head` has read what it wanted
            return CUT_SHORT
        return _complain(prog, f"the answer is lost: standard output: {_message_of(error)}", LOST)
    return 0


def _message_of(error: Exception) -> str:
    """The message of the error; for an OSError the file and the reason, without the error number."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error)


def _complain(name: str, message: str, status: int) -> int:
    from driftproof.support.plain_text import printable

    if sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(printable(f"{name}: {' '.join(message.split())}"), file=sys.stderr, flush=True)
    return status
