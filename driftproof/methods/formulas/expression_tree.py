"""Users' expressions as trees: a tokenizer and a recursive-descent parser, which evaluate nothing.

sum      = product (("+" | "-") product)*
product  = factor (("*" | "/") factor)*
factor   = ("-" | "+") factor | power
power    = atom [("**" | "^") (exponent | "(" exponent ["/" exponent] ")")]
exponent = ["-"] (integer | decimal)
atom     = number | name | name "(" sum ("," sum)* ")" | "(" sum ")"

The entries of a tableau, of a system and of a family are such expressions; questions extend the grammar. In a rate a
product may stand without its sign, as in -2y and y(1 - y), unless it follows a quotient or a power, as in 1/2y.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, NamedTuple, TypeAlias

from driftproof.methods.numbers.rationals import parse_rational
from driftproof.support.plain_text import shortened

# Chosen far above published tableaux: the limits keep the time and the stack that reading takes small.
LONGEST_EXPRESSION = 2000
# Exact forms that driftproof has written may be longer than what users type.
LONGEST_FORM = 100_000
DEEPEST_NESTING = 40
LARGEST_POWER = 64
LARGEST_POWER_OF_FORM = 9999
# Characters of the reason in an error message, which may contain a formula.
_LONGEST_REASON = 500
NUMBER, NAME, SIGN, END = "number", "name", "sign", "end"

_TOKEN = re.compile(
    r"(?P<name>[A-Za-z_][A-Za-z_0-9]*(?:\.[A-Za-z_0-9]+)*)"
    r"|(?P<number>(?:\d[\d_]*(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<sign>\*\*|[-+*/^()=:,])",
    re.ASCII,
)


class ExpressionError(ValueError):
    """An error in an expression: its `text`, the 1-based `column` in it, and the `reason`, on one line."""

    def __init__(self, text: str, column: int, reason: str) -> None:
        """Make the message "TEXT, column N: REASON"."""
        self.text, self.column = text, column
        self.reason = shortened(" ".join(reason.split()), _LONGEST_REASON)
        super().__init__(f"{shortened(' '.join(text.split()))!r}, column {column}: {self.reason}")


class Token(NamedTuple):
    """A token: its kind, its text, and the 1-based column at which it begins."""

    kind: str
    text: str
    column: int

    @property
    def end(self) -> int:
        """The column after the last character."""
        return self.column + len(self.text)

    @property
    def shown(self) -> str:
        """The token as an error message names it."""
        return "the end" if self.kind == END else repr(shortened(self.text))


@dataclass(frozen=True)
class NumberNode:
    """A rational number."""

    column: int
    value: Fraction


@dataclass(frozen=True)
class NameNode:
    """A name: a root, a parameter, a published value, or in an exact form a variable."""

    column: int
    name: str


@dataclass(frozen=True)
class CallNode:
    """A call of a function with one or more arguments."""

    column: int
    function: str
    arguments: tuple[Any, ...]


@dataclass(frozen=True)
class ChainNode:
    """The chain first (sign node)*, evaluated from the left, with signs + and - or * and /, each with its column."""

    column: int
    first: Any
    rest: tuple[tuple[Token, Any], ...]


@dataclass(frozen=True)
class NegatedNode:
    """The negative of a node."""

    column: int
    node: Any


@dataclass(frozen=True)
class PowerNode:
    """The power base**exponent, whose exponent is a rational number."""

    column: int
    base: Any
    exponent: Fraction


# The parts of a chain, a call, ... are such nodes, or nodes of a grammar that extends this one.
ExpressionNode: TypeAlias = NumberNode | NameNode | CallNode | ChainNode | NegatedNode | PowerNode


class ExpressionParser:
    """A recursive-descent parser: each method reads the rule of its name and returns a node, or raises `refusal`."""

    what: ClassVar[str] = "an expression"
    example: ClassVar[str] = "write a number such as 1/4"
    refusal: ClassVar[type[ExpressionError]] = ExpressionError
    typographic = str.maketrans("−·×’′‘“”", "-**'''" + '""')  # signs of printed texts, for which others are typed
    numbers: Collection[str] = ()  # their names in a rate, where a bracket after one is a factor

    def __init__(self, text: str, longest: int = LONGEST_EXPRESSION, largest_power: int = LARGEST_POWER) -> None:
        """Cut the text into tokens. Raises `refusal` for a character that no token has, and for too long a text."""
        self.text, self.largest_power = text, largest_power
        if len(text) > longest:
            reason = f"{self.what} has at most {longest} characters, not {len(text)}"
            raise self.refusal(text, longest + 1, reason)
        self.tokens = self._cut_into_tokens()
        self.at = self.depth = 0

    @staticmethod
    def token() -> re.Pattern[str]:
        """The pattern of a token, a group for each kind."""
        return _TOKEN

    def _cut_into_tokens(self) -> list[Token]:
        """The tokens of the text, then an empty one of kind END."""
        text, at, pattern = self.text.translate(self.typographic), 0, self.token()
        found: list[Token] = []
        while at < len(text):
            if text[at].isspace():
                at += 1
                continue
            match = pattern.match(text, at)
            if match is None:
                instead = "; write sqrt(2) for a root" * (text[at] == "√")
                raise self.refusal(self.text, at + 1, f"{text[at]!r} is not allowed in {self.what}{instead}")
            kind = str(match.lastgroup)
            found.append(Token(kind, match[kind], match.start(kind) + 1))
            at = match.end()
        return [*found, Token(END, "", len(text) + 1)]

    def tree(self) -> Any:
        """The tree of the whole text."""
        if self.next.kind == END:
            raise self.error(self.next, f"the {self.what.partition(' ')[2]} is empty; {self.example}")
        node = self.sum()
        if self.next.kind != END:
            reason = f"unexpected {self.next.shown}; expected an operator + - * / or the end"
            unit = self.next.kind == NAME and self.tokens[self.at - 1].kind == NUMBER
            reason += "; a decimal has a point" * (self.next.text == ",") + "; numbers have no units" * unit
            raise self.error(self.next, reason)
        return node

    @property
    def next(self) -> Token:
        """The next token, which stays the next one."""
        return self.tokens[self.at]

    def take(self) -> Token:
        """Consume the next token and return it; the token END is never consumed."""
        token = self.next
        self.at += token.kind != END
        return token

    def accept(self, *texts: str) -> Token | None:
        """Consume the next token and return it if it is one of these signs or words; otherwise return None."""
        return self.take() if self.next.text in texts else None

    def expect(self, text: str, what: str) -> Token:
        """Consume the sign `text` and return it. Raises `refusal` with the reason `what` if another token is next."""
        if self.next.text != text:
            raise self.error(self.next, f"{what}; found {self.next.shown}")
        return self.take()

    def sum(self) -> Any:
        """Read products that are added and subtracted."""
        return self._chain(self._product, "+", "-")

    def _product(self) -> Any:
        return self._chain(self._factor, "*", "/")

    def _chain(self, read: Callable[[], Any], *signs: str) -> Any:
        """Read operands by `read`, with one of the signs between two of them."""
        column, first = self.next.column, read()
        rest = list[tuple[Token, Any]]()
        while (sign := self.accept(*signs)) or ("*" in signs and self.continues()):
            *before, last = (token.text for token in self.tokens[max(self.at - 3, 0) : self.at])
            raised = self.next.text != "(" and last != ")" and not {"^", "**"}.isdisjoint(before)
            if not sign and (raised or "/" in [divided.text for divided, _ in rest]):
                raise self.error(self.next, f"after / or ^ write a product with its sign: {last}*{self.next.text}")
            rest.append((sign or Token(SIGN, "*", self.next.column), read()))
        return ChainNode(column, first, tuple(rest)) if rest else first

    def continues(self) -> bool:
        """Whether a factor of a rate stands where a sign should."""
        begins = self.next.kind == NAME and self.tokens[self.at + 1].text == "("
        return bool(self.numbers) and (begins or self.next.text in ("(", *self.numbers))

    def _factor(self) -> Any:
        sign = self.accept("+", "-")
        if sign is None:
            return self._power()
        node = self.nested(self._factor)
        return NegatedNode(sign.column, node) if sign.text == "-" else node

    def _power(self) -> Any:
        column, base = self.next.column, self._atom()
        if not self.accept("**", "^"):
            return base
        if not self.accept("("):
            return PowerNode(column, base, self._exponent())
        exponent = self._exponent()
        if self.accept("/"):
            divisor = self._exponent()
            if divisor < 1:
                raise self.error(self.next, "an exponent is an integer or a fraction of two integers")
            exponent /= divisor
        self.expect(")", "the bracket of the exponent is not closed")
        return PowerNode(column, base, exponent)

    def _exponent(self) -> Fraction:
        """Read an integer, or a decimal such as 0.5; neither number nor denominator may exceed `largest_power`."""
        negative, token = self.accept("-"), self.take()
        try:
            number = parse_rational(token.text)  # raises ValueError for 1e999999999, too
        except ValueError:
            number = None
        if number is None or number > self.largest_power or number.denominator > self.largest_power:
            reason = f"an exponent is an integer from -{self.largest_power} to {self.largest_power}, or a decimal"
            raise self.error(token, reason + "; write exp(t) for e^t" * (self.tokens[self.at - 3].text == "e"))
        return -number if negative else number

    def _atom(self) -> Any:
        token = self.take()
        if token.kind == NUMBER:
            return NumberNode(token.column, self.rational(token.text, token))
        if token.text == "(":
            node = self.nested(self.sum)
            self.expect(")", "a bracket is not closed")
            return node
        if token.kind != NAME:
            raise self.error(token, f"expected a number, a name or a bracket, found {token.shown}")
        return self._call(token) if token.text not in self.numbers and self.accept("(") else self.named(token)

    def named(self, name: Token) -> Any:
        """Return the node of a name that is not called; a grammar that extends this one may read on."""
        return NameNode(name.column, name.text)

    def _call(self, name: Token) -> CallNode:
        """Read the arguments of a function, from after the opening bracket."""
        arguments = [self.nested(self.sum)]
        while self.accept(","):
            arguments.append(self.nested(self.sum))
        self.expect(")", f"the bracket of {name.text} is not closed")
        return CallNode(name.column, name.text, tuple(arguments))

    def rational(self, text: str, token: Token) -> Fraction:
        """The number that the text of a token spells."""
        try:
            return parse_rational(text)
        except ValueError as error:
            raise self.error(token, str(error)) from None

    def nested(self, read: Callable[[], Any]) -> Any:
        """Call `read` one level deeper. Raises `refusal` below DEEPEST_NESTING, which protects Python's own stack."""
        self.depth += 1
        if self.depth > DEEPEST_NESTING:
            raise self.error(self.next, f"it is nested deeper than {DEEPEST_NESTING} levels")
        node = read()
        self.depth -= 1
        return node

    def error(self, token: Token, reason: str) -> ExpressionError:
        """The `refusal` to raise at a token."""
        return self.refusal(self.text, token.column, reason)


class _FormParser(ExpressionParser):
    """A parser of exact forms that driftproof has written; their numbers may be longer than those that users type."""

    def rational(self, text: str, token: Token) -> Fraction:
        return Fraction(text)


def parse_form(form: str) -> ExpressionNode:
    """The tree of an exact form, whose names are variables. Raises ExpressionError for any other or too long a text."""
    node: ExpressionNode = _FormParser(form, LONGEST_FORM, LARGEST_POWER_OF_FORM).tree()
    return node
