"""What the command line takes and how it ends: a parser that complains in one line, numbers read exactly, statuses."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any, NoReturn, TypeAlias

from methods.rationals import parse_rational

REFUTED, BAD_INPUT, NO_ANSWER = 1, 2, 3
MOST_DIGITS = 10_000
MOST_EXAMPLES = 10**6
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


def digits(text: str) -> int:
    """A number of significant digits."""
    if not (text.isascii() and text.isdigit() and len(text) < 9 and 1 <= int(text) <= MOST_DIGITS):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a number of digits from 1 to {MOST_DIGITS}")
    return int(text)


def positive_number(what: str) -> Callable[[str], float]:
    """A reader of finite floats above zero, named `what` in its complaints."""

    def parse(text: str) -> float:
        value = float(rational(what)(text))
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text[:20]!r} is no {what}; write a number above 0")
        return value

    return parse


def number_of_examples(text: str) -> int:
    """How many examples to try."""
    if not (text.isascii() and text.isdigit() and len(text) < 9 and 1 <= int(text) <= MOST_EXAMPLES):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a number of examples from 1 to {MOST_EXAMPLES}")
    return int(text)


def add_method(parser: Parser) -> None:
    """The positional argument METHOD."""
    parser.add_argument("method", help="a key that `driftproof methods` lists, e.g. rk4")


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
