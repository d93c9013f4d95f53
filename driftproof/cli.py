"""The command line: parse, ask, print. One line and a non-zero exit for anything that cannot be answered."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Sequence

from driftproof import __version__
from driftproof.commands import (
    check,
    diff,
    facts,
    identify,
    methods,
    render,
    report,
    roundoff,
    run,
    scene,
    scenes,
    stability,
    step,
    sweep,
    value,
    values,
    verify,
    work_precision,
)
from driftproof.commands.arguments import BAD_INPUT, INTERRUPTED, NO_ANSWER, REFUTED, Parser, Refuted

COMMANDS = (
    methods,
    facts,
    step,
    run,
    roundoff,
    stability,
    identify,
    verify,
    scenes,
    scene,
    sweep,
    report,
    work_precision,
    value,
    values,
    render,
    check,
    diff,
)

EXAMPLES = """\
examples:
  driftproof step rk4 --h 1/2 --state 1,0          337/384 and -23/48, with decimals
  driftproof run forward_euler --h 1/4 --t 10      certified state, errors, energy and phase
  driftproof facts rk4                             every exact fact of a method, or of your own tableau
  driftproof roundoff rk4 --h 1/4                  the rounding bound of a step, derived by running it
  driftproof identify mylib.ode:step               which method your code really is
  driftproof verify mylib.ode:step --method rk4    and whether it is right to roundoff
  driftproof scene default                         the lesson's readouts and its table
  driftproof work-precision                        error against evaluations and against run time
  driftproof report -o report.html                 the same as a page, with figures
  driftproof values --only 'rk4.*' --format md     proved values, ready for a text

Numbers are read exactly: 0.1 is 1/10, and 1/4 is a quarter. `driftproof COMMAND --help` teaches each command.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the status is 0 if answered, 1 if the answer is no, 2 for bad input, 3 for no answer."""
    name = "driftproof"
    try:
        options = _parser().parse_args(arguments)
        name = f"driftproof {options.command}"
        status, text = _answered(options)
        _show(text)
    except OSError as error:
        return _complain(name, _in_words(error), BAD_INPUT)
    except ValueError as error:
        return _complain(name, str(error), BAD_INPUT)
    except ArithmeticError as error:
        return _complain(name, str(error), NO_ANSWER)
    except KeyboardInterrupt:
        return _complain(name, "interrupted", INTERRUPTED)
    return status


def _answered(options: Namespace) -> tuple[int, str]:
    try:
        return 0, options.answer(options)
    except Refuted as answer:
        return REFUTED, str(answer)


def _show(text: str) -> None:
    try:
        print(text, flush=True)
    except BrokenPipeError:
        sys.stderr.close()  # the reader has gone; a second complaint at exit would be noise


def _in_words(error: OSError) -> str:
    """As elsewhere: the file, then what is wrong with it, without the number of the error."""
    return f"{error.filename}: {error.strerror}" if error.filename and error.strerror else str(error)


def _complain(name: str, message: str, status: int) -> int:
    print(f"{name}: {' '.join(message.split())}", file=sys.stderr)
    return status


def _parser() -> Parser:
    parser = Parser(
        prog="driftproof",
        description="Exact facts and certified numbers about one-step integrators, and float runs held to them.",
        epilog=EXAMPLES,
    )
    parser.add_argument("--version", action="version", version=f"driftproof {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    for command in COMMANDS:
        command.add(commands)
    return parser
