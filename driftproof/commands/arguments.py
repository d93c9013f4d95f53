"""The parts of commands: options, readers of exact numbers, a parser that complains in one line, exit statuses."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from textwrap import dedent
from typing import Any, NamedTuple, NoReturn, TypeAlias, TypeVar

from driftproof.methods.numbers.rationals import parse_rational, state_of, step_of, steps_of
from driftproof.support.plain_text import did_you_mean, printable

_T = TypeVar("_T")
# A function that adds one option, or several that exclude each other, to a parser.
CommandOption: TypeAlias = "Callable[[argparse._ActionsContainer], object]"

REFUTED, BAD_INPUT, NO_ANSWER = 1, 2, 3
_MOST_DIGITS = 10_000


class Refuted(Exception):
    """Raised if the answer is no: the message is the whole answer as it is printed, `status` the exit status."""

    status = REFUTED


class Undecided(Refuted):
    """Raised if the answer is neither yes nor no; the message says what could not be examined."""

    status = NO_ANSWER


class Unread(Refuted):
    """Raised if some of what is to be examined cannot be read; the message is the answer about the rest, too."""

    status = BAD_INPUT


class Help(Exception):
    """Raised if help is asked for; the message is the help text."""


class Parser(argparse.ArgumentParser):
    """An argument parser that complains in one line, and reads -1/2, -1,0 and -y0 as values, not as options."""

    def __init__(self, prog: str, description: str, epilog: str) -> None:
        """Keep the line breaks of descriptions and examples."""
        keep = argparse.RawDescriptionHelpFormatter
        super().__init__(prog, description=description, epilog=epilog, formatter_class=keep)
        self._negative_number_matcher = re.compile(r"-(?:[\d.(]|\w$|\w+[\d(*/^+[])")

    def error(self, message: str) -> NoReturn:
        """Print one line that names the problem and where to read more, and exit with status 2."""
        known, line = self._option_string_actions, printable(" ".join(message.split()))
        if wrong := re.search(r"unrecognized arguments:.*?(--[\w-]+)", line):
            json = wrong[1] == "--json" and "--format" in known
            line += "; did you mean --format json?" if json else did_you_mean(wrong[1], known)
        self.exit(BAD_INPUT, f"{self.prog}: {line} (`{self.prog} --help` shows how)\n")

    def print_help(self, file: object = None) -> None:
        """Raise Help with the text, which `driftproof.cli` prints like any answer."""
        raise Help(self.format_help().removesuffix("\n"))


class Command(NamedTuple):
    """A command: the function that answers it, whose docstring is its --help, and its options."""

    answer: Callable[[argparse.Namespace], str]
    options: tuple[CommandOption, ...]

    def parser(self, prog: str) -> Parser:
        """The parser of the command; its help has the docstring's first paragraph above the options, the rest below."""
        first, _, rest = (self.answer.__doc__ or "").partition("\n")  # Python 3.13 removes the indent itself
        about, _, examples = f"{first}\n{dedent(rest)}".partition("\n\n")
        parser = Parser(prog, about, examples)
        for add in self.options:
            add(parser)
        return parser


def command(*options: CommandOption) -> Callable[[Callable[[argparse.Namespace], str]], Command]:
    """A decorator that makes a Command of the function that answers it."""
    return lambda answer: Command(answer, options)


def option(names: str, words: str | None = None, **settings: Any) -> CommandOption:
    """An option or a positional argument, with argparse's settings; `choices` may be a function that lists them."""

    def add(parser: argparse._ActionsContainer) -> None:
        choices = settings.get("choices")
        late = {"choices": choices()} if callable(choices) else {}
        parser.add_argument(*names.split(), help=words, **{**settings, **late})

    return add


def one_of(*options: CommandOption, required: bool = False) -> CommandOption:
    """A group of options that exclude each other."""

    def add(parser: argparse._ActionsContainer) -> None:
        group = parser.add_mutually_exclusive_group(required=required)
        for each in options:
            each(group)

    return add


def names_in(module: str, table: str) -> Callable[[], tuple[str, ...]]:
    """A function that lists the names in a table of a module, which is only imported when the parser is made."""
    return lambda: tuple(getattr(import_module(module), table))


def read_by(parse: Callable[..., _T], *more: Any) -> Callable[[str], _T]:
    """`parse` as a type of argparse: the ValueError that it raises becomes the complaint about the option."""

    def read(text: str) -> _T:
        try:
            return parse(text, *more)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return read


# Readers of exact values; the name of a number in complaints is the argument of `exactly`.
exactly = partial(read_by, parse_rational)
nonzero_step = read_by(step_of)
initial_state = read_by(state_of)


def integer_in(least: int, most: int, what: str) -> Callable[[str], int]:
    """A reader of whole numbers from `least` to `most` that count `what`, such as "digits"."""

    def parse(text: str) -> int:
        if not (text.isascii() and text.isdigit() and len(text) < 9 and least <= int(text) <= most):
            raise ValueError(f"{text[:20]!r} is not allowed: the number of {what} must be from {least} to {most}")
        return int(text)

    return read_by(parse)


def positive_number(what: str) -> Callable[[str], float]:
    """A reader of finite floats above zero, named `what` in its complaints."""

    def parse(text: str) -> float:
        try:
            value = float(parse_rational(text, what))
        except OverflowError:
            raise ValueError(f"{text[:20]!r} is too large for the {what}") from None
        if not value > 0:
            raise ValueError(f"{text[:20]!r} is not allowed: the {what} must be a number above 0")
        return value

    return read_by(parse)


def several(read: Callable[[str], Any]) -> Callable[[str], list[Any]]:
    """A reader of a list of values, separated by commas."""
    return lambda text: [read(part.strip()) for part in text.split(",")]


@read_by
def _parameter(text: str) -> tuple[str, str]:
    """A parameter and the text of its value, as in mu=5."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"{text[:20]!r} is not NAME=VALUE, such as mu=5")
    return name.strip(), value.strip()


def format_option(choices: str, words: str | None = "json is for programs") -> CommandOption:
    """The option --format, whose first choice is the default."""
    return option("--format", words, choices=choices.split(), default=choices.split()[0])


# Options that several commands have; each command words their help for itself.
METHOD = option("method", "a method, such as rk4 (`driftproof methods` lists them)")
TEXT_OR_JSON = format_option("text json", "text is for reading, json for programs")
flag = partial(option, action="store_true")
list_option = partial(option, action="extend", default=[])
_methods_listed = lambda text: import_module("driftproof.methods.catalogue").names_listed(text)
methods_option = partial(list_option, "--methods", type=_methods_listed, metavar="M,M")
# Irrational ones are read beside the end that they divide.
_steps_given = lambda text: text.split(",") if {"pi", "sqrt"} & {*re.findall(r"[a-z]+", text)} else steps_of(text)
steps_option = partial(list_option, "--h", type=read_by(_steps_given), metavar="H,H")
OTHER_PARAMETERS = "other values of parameters of your own problem, such as mu=5"
parameters_option = partial(list_option, "--parameters", type=several(_parameter), metavar="NAME=VALUE")
error_option = partial(list_option, "--error", type=several(positive_number("error")), metavar="E,E")
digits_option = partial(option, "--digits", type=integer_in(1, _MOST_DIGITS, "digits"))
places_option = partial(option, "--places", type=integer_in(0, _MOST_DIGITS, "places"))
rounding_option = partial(
    option, "--rounding", choices=names_in("driftproof.texts.questions.decimals", "ROUNDING_POLICIES")
)
output_option = partial(option, "-o --output", type=Path, metavar="FILE")
time_limit_option = partial(option, "--time-limit", type=positive_number("time limit"))


def refuse(options: argparse.Namespace, names: Sequence[str], where: str) -> None:
    """Raise ValueError if one of these options is given, which has no effect `where`, such as "with --solver"."""
    if given := [name for name in names if (value := getattr(options, name)) is not False and value not in (None, [])]:
        raise ValueError(f"--{given[0].replace('_', '-')} has no effect {where}")


def answer_of(name: str, options: argparse.Namespace) -> str:
    """Call the public function `name` of driftproof with the options, and return its answer in their --format."""
    import driftproof

    given = {option: value for option, value in vars(options).items() if option != "format"}
    answer: str = getattr(driftproof, name)(**given).written(options.format)
    return answer
