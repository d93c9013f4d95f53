"""Exact numbers from users' text such as "1/4 - s3/6": a small recursive-descent parser, in which nothing is evaluated.

sum     = product (("+" | "-") product)*
product = factor (("*" | "/") factor)*
factor  = "-" factor | "+" factor | power
power   = atom ["**" ["-"] integer]
atom    = integer | decimal | name | "(" sum ")"
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction

from methods.number_field import Algebraic, Exact
from methods.rationals import parse_rational

LONGEST_EXPRESSION = 2000
DEEPEST_NESTING = 40
LARGEST_POWER = 64
# A power of a power of a power would ask for gigabytes; no published coefficient comes near.
LARGEST_BITS = 20_000

_TOKEN = re.compile(r"\s*(\d[\d_]*(?:\.\d*)?(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?|[A-Za-z_]\w*|\*\*|[-+*/()])")


def parse_exact(text: str, roots: Mapping[str, Exact], what: str) -> Exact:
    """The number that `text` spells, `roots` being the names that may occur in it. Raises ValueError, in one line.

    The line begins with `what`. All operations are exact: "0.1" is 1/10, and "(1 + s3)/2" an element of s3's field.
    """
    if len(text) > LONGEST_EXPRESSION:
        raise ValueError(f"{what}: the expression has {len(text)} characters; at most {LONGEST_EXPRESSION} are read")
    return _Parser(_tokens(text.replace("\N{MINUS SIGN}", "-"), what), roots, what).whole()


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

    def __init__(self, tokens: list[str], roots: Mapping[str, Exact], what: str) -> None:
        self.tokens, self.roots, self.what = tokens, roots, what
        self.at = self.depth = 0

    def whole(self) -> Exact:
        """The value of all tokens."""
        value = self.sum()
        if self.at < len(self.tokens):
            raise self.error(f"{_shown(self.tokens[self.at])} has no place")
        return value

    def sum(self) -> Exact:
        """Products added and subtracted, from the left."""
        value = self.product()
        while (sign := self.peek()) in ("+", "-"):
            self.at += 1
            term = self.product()
            value = self.small(value + term if sign == "+" else value - term)
        return value

    def product(self) -> Exact:
        """Factors multiplied and divided, from the left."""
        value = self.factor()
        while (sign := self.peek()) in ("*", "/"):
            self.at += 1
            factor = self.factor()
            if sign == "/" and not factor:
                raise self.error("it divides by zero")
            value = self.small(value * factor if sign == "*" else value / factor)
        return value

    def factor(self) -> Exact:
        """A power with signs before it."""
        sign = self.peek()
        if sign not in ("+", "-"):
            return self.power()
        self.at += 1
        value = self.nested(self.factor)
        return -value if sign == "-" else value

    def power(self) -> Exact:
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
        value: Exact = Fraction(1)
        for _ in range(int(exponent)):
            value = self.small(value * base)
        return 1 / value if negative else value

    def atom(self) -> Exact:
        """A number, a name or a sum in parentheses."""
        token = self.take()
        if token == "(":
            value = self.nested(self.sum)
            if self.take() != ")":
                raise self.error("a parenthesis is not closed")
            return value
        if token[0].isdecimal() or token[0] == ".":
            return parse_rational(token, self.what)
        if token in self.roots:
            return self.roots[token]
        if token[0].isalpha() or token[0] == "_":
            known = f"declared in [roots]: {', '.join(self.roots)}" if self.roots else "nothing is declared in [roots]"
            raise self.error(f"{_shown(token)} is an unknown root; {known}")
        raise self.error(f"{_shown(token)} has no place")

    def nested(self, read: Callable[[], Exact]) -> Exact:
        """One level deeper. Refuses depths at which Python's own stack would be at stake."""
        self.depth += 1
        if self.depth > DEEPEST_NESTING:
            raise self.error(f"it is nested deeper than {DEEPEST_NESTING} levels")
        value = read()
        self.depth -= 1
        return value

    def small(self, value: Exact) -> Exact:
        """The value, unless its numbers have grown beyond all reason."""
        for part in value.coefficients if isinstance(value, Algebraic) else (value,):
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
