"""What the command line takes and how it ends: a parser that complains in one line, numbers read exactly, statuses."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn, TypeAlias

from driftproof.methods.rationals import parse_rational

REFUTED, BAD_INPUT, NO_ANSWER, INTERRUPTED = 1, 2, 3, 130
MOST_DIGITS = 10_000
# A float run longer than this shows a progress bar.
LONG_RUN = 10**6


class Refuted(Exception):
    """The answer is no: the text is the whole answer, as it is printed, and the exit status is REFUTED."""


class Parser(argparse.ArgumentParser):
    """An argument parser that complains in one line, and takes -1/2 and -1,0 for values rather than options."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """Keep the line breaks of descriptions and examples."""
        kwargs["formatter_class"] = argparse.RawDescriptionHelpFormatter
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = re.compile(r"-[\d.]")

    def error(self, message: str) -> NoReturn:
        """Print one line that names the problem and where to read more, and exit with status 2."""
        self.exit(BAD_INPUT, f"{self.prog}: {' '.join(message.split())} (`{self.prog} --help` shows how)\n")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse, but what a command does not know is its own complaint, whose --help then helps."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}")
        return found, unknown


Commands: TypeAlias = "argparse._SubParsersAction[Parser]"


def rational(what: str) -> Callable[[str], Fraction]:
    """A reader of exact numbers, named `what` in its complaints."""

    def parse(text: str) -> Fraction:
        try:
            return parse_rational(text, what)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return parse


def nonzero_step(text: str) -> Fraction:
    """A step size, exact and not zero."""
    h = rational("h")(text)
    if h == 0:
        raise argparse.ArgumentTypeError("a step of size 0 goes nowhere; give a nonzero h")
    return h


def state(text: str) -> tuple[Fraction, Fraction]:
    """A state written as position,velocity."""
    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a state; write position,velocity like 1,0")
    return rational("q")(parts[0]), rational("v")(parts[1])


def counted(what: str, most: int, least: int = 1) -> Callable[[str], int]:
    """A reader of whole numbers from `least` to `most`, which counts `what`: "digits", say."""

    def parse(text: str) -> int:
        if not (text.isascii() and text.isdigit() and len(text) < 9 and least <= int(text) <= most):
            raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a number of {what} from {least} to {most}")
        return int(text)

    return parse


digits = counted("digits", MOST_DIGITS)


def several(read: Callable[[str], Any]) -> Callable[[str], list[Any]]:
    """A reader of values that commas part; with the action "extend" the option may be repeated, too."""
    return lambda text: [read(part.strip()) for part in text.split(",")]


def positive_number(what: str) -> Callable[[str], float]:
    """A reader of finite floats above zero, named `what` in its complaints."""

    def parse(text: str) -> float:
        try:
            value = float(rational(what)(text))
        except OverflowError:
            raise argparse.ArgumentTypeError(f"{text[:20]!r} is too large a {what}") from None
        if not value > 0:
            raise argparse.ArgumentTypeError(f"{text[:20]!r} is no {what}; write a number above 0")
        return value

    return parse


def add_method(parser: Parser) -> None:
    """The positional argument METHOD."""
    parser.add_argument("method", help="a key that `driftproof methods` lists, e.g. rk4")


def add_methods(parser: Parser, words: str) -> None:
    """--methods, as a list that is empty where none is given."""
    parser.add_argument("--methods", type=several(str), action="extend", default=[], metavar="M,M", help=words)


def add_sizes(parser: Parser, words: str) -> None:
    """--h, once or several times, with one step size or several."""
    parser.add_argument("--h", type=several(nonzero_step), action="extend", default=[], metavar="H,H", help=words)


def add_output(parser: Parser, words: str, metavar: str = "FILE", *, required: bool = False) -> None:
    """-o or --output, what is written."""
    parser.add_argument("-o", "--output", type=Path, metavar=metavar, required=required, help=words)


def add_format(parser: Parser) -> None:
    """--format text or json."""
    parser.add_argument("--format", choices=("text", "json"), default="text", help="json is canonical, text is for you")


def add_question(parser: Parser) -> None:
    """What `step` and `run` share: method, step, start, digits, rounding, format."""
    add_method(parser)
    parser.add_argument("--h", type=nonzero_step, required=True, help="step size, e.g. 1/4 or 0.25")
    parser.add_argument("--state", type=state, default="1,0", help="start as position,velocity (default 1,0)")
    parser.add_argument("--digits", type=digits, default=15, help="significant digits (default 15)")
    parser.add_argument(
        "--rounding", choices=("half-even", "half-away"), default="half-even", help="what a tie becomes"
    )
    add_format(parser)


def progress(steps: int) -> Iterable[int]:
    """range(steps), with a progress bar on a terminal when it will take a while."""
    if steps < LONG_RUN or not sys.stderr.isatty():
        return range(steps)
    from tqdm import trange

    bar: Iterable[int] = trange(steps, unit="step", unit_scale=True, leave=False)
    return bar
