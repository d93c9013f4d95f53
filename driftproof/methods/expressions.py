"""Exact numbers from users' text such as "1/4 - s3/6": a small recursive-descent parser, in which nothing is evaluated.

sum     = product (("+" | "-") product)*
product = factor (("*" | "/") factor)*
factor  = "-" factor | "+" factor | power
power   = atom ["**" ["-"] integer]
atom    = integer | decimal | name | ("sqrt" | "cbrt") "(" integer ")" | "(" sum ")"
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, TypeAlias

from driftproof.methods.number_field import Exact, cube_root, square_root
from driftproof.methods.parameters import Function, function
from driftproof.methods.rationals import parse_rational

# A Fraction, an element of a number field, or a function of a parameter: whatever the names stand for.
Value: TypeAlias = Any

LONGEST_EXPRESSION = 2000
DEEPEST_NESTING = 40
LARGEST_POWER = 64
# A power of a power of a power would ask for gigabytes; no published coefficient comes near.
LARGEST_BITS = 20_000
# Of a function of a parameter: numerator and denominator together.
MOST_COEFFICIENTS = 100
# Digits under a root.
LONGEST_RADICAND = 40
RADICALS = {"sqrt": square_root, "cbrt": cube_root}

_TOKEN = re.compile(r"\s*(\d[\d_]*(?:\.\d*)?(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?|[A-Za-z_]\w*|\*\*|[-+*/()])")


def parse_exact(text: str, roots: Mapping[str, Exact], what: str) -> Exact:
    """The number that `text` spells, `roots` being the names that may occur in it. Raises ValueError, in one line.

    The line begins with `what`. All operations are exact: "0.1" is 1/10, and "(1 + s3)/2" an element of s3's field.
    """
    known = f"declared in [roots]: {', '.join(roots)}" if roots else "nothing is declared in [roots]"
    value: Exact = _parsed(text, roots, what, f"is an unknown root; {known}")
    return value


def parse_number(text: str, what: str) -> Exact:
    """The number that `text` spells without names, e.g. "1 - sqrt(2)/2". Raises ValueError, in one line."""
    value: Exact = _parsed(text, {}, what, "is a name; write numbers, sqrt(n) and cbrt(n)")
    return value


def parse_function(text: str, parameter: str, what: str) -> Function:
    """The rational function of the parameter that `text` spells, e.g. "1 - 1/(2*alpha)", its other numbers rational.

    Raises ValueError, in one line.
    """
    value = _parsed(text, {parameter: function((0, 1))}, what, f"is an unknown name; the parameter is {parameter}")
    if not isinstance(value, Function | Fraction):
        raise ValueError(f"{what}: {_shown(text)} is irrational; beside a parameter, numbers are rational")
    return value if isinstance(value, Function) else function((value,))


def _parsed(text: str, names: Mapping[str, Value], what: str, unknown: str) -> Value:
    if len(text) > LONGEST_EXPRESSION:
        raise ValueError(f"{what}: the expression has {len(text)} characters; at most {LONGEST_EXPRESSION} are read")
    return _Parser(_tokens(text.replace("\N{MINUS SIGN}", "-"), what), names, what, unknown).whole()


def _tokens(text: str, what: str) -> list[str]:
    tokens, at, text = [], 0, text.rstrip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise ValueError(f"{what}: {_shown(text)} is no expression: {_shown(text[at:].lstrip()[:1])} has no place")
        tokens.append(match[1])
        at = match.end()
    if not tokens:
        raise ValueError(f"{what}: the expression is empty; write a number such as 1/4")
    return tokens


def _shown(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")


class _Parser:
    """One pass over the tokens; each method reads what its name says and returns its value."""

    def __init__(self, tokens: list[str], names: Mapping[str, Value], what: str, unknown: str) -> None:
        self.tokens, self.names, self.what, self.unknown = tokens, names, what, unknown
        self.at = self.depth = 0

    def whole(self) -> Value:
        """The value of all tokens."""
        try:
            value = self.sum()
        except TypeError:
            raise self.error("numbers of two fields, or irrational ones beside a parameter, do not mix") from None
        if self.at < len(self.tokens):
            raise self.error(f"{_shown(self.tokens[self.at])} has no place")
        return value

    def sum(self) -> Value:
        """Products added and subtracted, from the left."""
        value = self.product()
        while (sign := self.peek()) in ("+", "-"):
            self.at += 1
            term = self.product()
            value = self.small(value + term if sign == "+" else value - term)
        return value

    def product(self) -> Value:
        """Factors multiplied and divided, from the left."""
        value = self.factor()
        while (sign := self.peek()) in ("*", "/"):
            self.at += 1
            factor = self.factor()
            if sign == "/" and not factor:
                raise self.error("it divides by zero")
            value = self.small(value * factor if sign == "*" else value / factor)
        return value

    def factor(self) -> Value:
        """A power with signs before it."""
        sign = self.peek()
        if sign not in ("+", "-"):
            return self.power()
        self.at += 1
        value = self.nested(self.factor)
        return -value if sign == "-" else value

    def power(self) -> Value:
        """An atom, raised to a small integer if one follows."""
        base = self.atom()
        if self.peek() != "**":
            return base
        self.at += 1
        negative = self.peek() == "-"
        self.at += negative
        exponent = self.take()
        if not exponent.isdecimal() or len(exponent) > 4 or int(exponent) > LARGEST_POWER:
            raise self.error(f"the exponent {_shown(exponent)} is no integer from -{LARGEST_POWER} to {LARGEST_POWER}")
        if negative and not base:
            raise self.error("it divides by zero")
        value: Value = Fraction(1)
        for _ in range(int(exponent)):
            value = self.small(value * base)
        return 1 / value if negative else value

    def atom(self) -> Value:
        """A number, a name, a root or a sum in parentheses."""
        token = self.take()
        if token == "(":
            value = self.nested(self.sum)
            if self.take() != ")":
                raise self.error("a parenthesis is not closed")
            return value
        if token[0].isdecimal() or token[0] == ".":
            return parse_rational(token, self.what)
        if token in self.names:
            return self.names[token]
        if token in RADICALS and self.peek() == "(":
            return self.radical(token)
        if token[0].isalpha() or token[0] == "_":
            raise self.error(f"{_shown(token)} {self.unknown}")
        raise self.error(f"{_shown(token)} has no place")

    def radical(self, name: str) -> Value:
        """A root of an integer, from its parenthesis on."""
        inside, closing = (self.take(), self.take(), self.take())[1:]
        if not inside.isdecimal() or len(inside) > LONGEST_RADICAND or closing != ")":
            raise self.error(f"{name} takes one integer, as in {name}(2)")
        try:
            return RADICALS[name](int(inside))
        except ValueError as error:
            raise self.error(str(error)) from None

    def nested(self, read: Callable[[], Value]) -> Value:
        """One level deeper. Refuses depths at which Python's own stack would be at stake."""
        self.depth += 1
        if self.depth > DEEPEST_NESTING:
            raise self.error(f"it is nested deeper than {DEEPEST_NESTING} levels")
        value = read()
        self.depth -= 1
        return value

    def small(self, value: Value) -> Value:
        """The value, unless its numbers have grown beyond all reason."""
        parts = (value,) if isinstance(value, Fraction) else value.coefficients
        if len(parts) > MOST_COEFFICIENTS:
            raise self.error("its degree in the parameter is too large")
        for part in parts:
            if part.numerator.bit_length() + part.denominator.bit_length() > LARGEST_BITS:
                raise self.error("its numbers are too large")
        return value

    def peek(self) -> str:
        """The next token, "" at the end."""
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self) -> str:
        """The next token, which is used up."""
        token = self.peek()
        if not token:
            raise self.error("it ends too early")
        self.at += 1
        return token

    def error(self, reason: str) -> ValueError:
        """The refusal, in one line."""
        return ValueError(f"{self.what}: {_shown(' '.join(self.tokens))} is no expression: {reason}")
