"""Questions as trees: a recursive-descent parser, in which nothing is evaluated.

sum      = product (("+" | "-") product)*
product  = factor (("*" | "/") factor)*
factor   = ("-" | "+") factor | power
power    = atom [("**" | "^") (exponent | "(" exponent ["/" exponent] ")")]
exponent = ["-"] integer
atom     = number | id | function "(" sum ["," sum] ")" | asked | "(" sum ")"
asked    = head part* [":" readout [unit]]
part     = subject | "at" value | name "=" literal | "from" literal "," literal | "sharp"
literal  = ["-" | "+"] number ["/" number]
value    = literal | "(" expression of driftproof.methods.expressions ")"
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from driftproof.methods.rationals import parse_rational
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.syntax import Call, Chain, Negated, Node, Number, Power, Published, Query
from driftproof.texts.questions.tokens import END, LONGEST_QUESTION, NAME, NUMBER, Token, tokens

DEEPEST_NESTING = 40
LARGEST_POWER = 64
# A form is never computed with, only written, and may be longer than a question.
LONGEST_FORM = 100_000
LARGEST_POWER_OF_FORM = 9999
# Words that may stand alone between head and readout.
WORDS = ("sharp",)
SETTINGS = ("h", "t", "N", "steps", "z")


def parse(question: str) -> Node:
    """The tree of the question. Raises QuestionError."""
    return _Parser(question, LONGEST_QUESTION, LARGEST_POWER).whole()


def parse_form(form: str) -> Node:
    """The tree of an exact form, whose names are variables. Raises QuestionError where it is none, or too long."""
    return _Parser(form, LONGEST_FORM, LARGEST_POWER_OF_FORM).whole()


class _Parser:
    """One pass over the tokens; each method reads what its name says."""

    def __init__(self, question: str, longest: int, largest_power: int) -> None:
        self.question, self.largest_power = question, largest_power
        self.tokens = tokens(question, longest)
        self.at = self.depth = 0

    def whole(self) -> Node:
        """The tree of all tokens."""
        if self.next.kind == END:
            raise self.error(self.next, "the question is empty; ask for example: step rk4 h=1/2 : q")
        node = self.sum()
        if self.next.kind != END:
            reason = f"{self.next.shown} has no place here; an operator + - * / or the end may follow"
            raise self.error(self.next, reason)
        return node

    @property
    def next(self) -> Token:
        """The token to be read."""
        return self.tokens[self.at]

    def take(self) -> Token:
        """The next token, used up; the end is never used up."""
        token = self.next
        self.at += token.kind != END
        return token

    def accept(self, *texts: str) -> Token | None:
        """The next token if it is one of these signs or words, used up; else None."""
        return self.take() if self.next.text in texts else None

    def expect(self, text: str, what: str) -> Token:
        """The sign `text`, used up."""
        if self.next.text != text:
            raise self.error(self.next, f"{what}; {self.next.shown} stands there")
        return self.take()

    def sum(self) -> Node:
        """Products added and subtracted."""
        return self.chain(self.product, "+", "-")

    def product(self) -> Node:
        """Factors multiplied and divided."""
        return self.chain(self.factor, "*", "/")

    def chain(self, read: Callable[[], Node], *signs: str) -> Node:
        """What `read` reads, with the signs between."""
        column, first = self.next.column, read()
        rest = []
        while sign := self.accept(*signs):
            rest.append((sign, read()))
        return Chain(column, first, tuple(rest)) if rest else first

    def factor(self) -> Node:
        """A power with signs before it."""
        sign = self.accept("+", "-")
        if sign is None:
            return self.power()
        node = self.nested(self.factor)
        return Negated(sign.column, node) if sign.text == "-" else node

    def power(self) -> Node:
        """An atom, raised to a small power if one follows."""
        column, base = self.next.column, self.atom()
        if not self.accept("**", "^"):
            return base
        if not self.accept("("):
            return Power(column, base, Fraction(self.exponent()))
        numerator = self.exponent()
        denominator = self.exponent() if self.accept("/") else 1
        if denominator < 1:
            raise self.error(self.next, "an exponent is an integer or a fraction of two")
        self.expect(")", "the bracket of the exponent is not closed")
        return Power(column, base, Fraction(numerator, denominator))

    def exponent(self) -> int:
        """A small integer."""
        negative = self.accept("-")
        token = self.take()
        if not token.text.isdigit() or len(token.text) > 4 or int(token.text) > self.largest_power:
            raise self.error(token, f"an exponent is an integer from -{self.largest_power} to {self.largest_power}")
        return -int(token.text) if negative else int(token.text)

    def atom(self) -> Node:
        """A number, an id, a function, what is asked, or a sum in brackets."""
        token = self.take()
        if token.kind == NUMBER:
            return Number(token.column, self.rational(token.text, token))
        if token.text == "(":
            node = self.nested(self.sum)
            self.expect(")", "a bracket is not closed")
            return node
        if token.kind != NAME:
            raise self.error(token, f"{token.shown} stands where a number, a name or a bracket should")
        if self.next.text == "(":
            return self.call(token)
        if self.next.kind == NAME or self.next.text == ":":
            return self.asked(token)
        return Published(token.column, token.text)

    def call(self, name: Token) -> Node:
        """A function from its bracket on."""
        self.take()
        arguments = [self.nested(self.sum)]
        while self.accept(","):
            arguments.append(self.nested(self.sum))
        self.expect(")", f"the bracket of {name.text} is not closed")
        return Call(name.column, name.text, tuple(arguments))

    def asked(self, head: Token) -> Node:
        """What is asked, from after its head on."""
        parts: dict[str, Any] = {"settings": {}, "words": {}}
        while self.next.kind == NAME:
            self.part(self.take(), parts)
        if self.accept(":"):
            parts["readout"] = self.name("the name of a readout, such as q, comes after the colon")
            if self.next.kind == NAME:
                parts["unit"] = self.take()
        return Query(head, **parts)

    def part(self, token: Token, parts: dict[str, Any]) -> None:
        """One part between head and readout."""
        key = {"at": "at", "from": "start"}.get(token.text, "subject")
        if key != "at" and self.next.text == "=":
            self.setting(token, parts["settings"])
        elif token.text in WORDS:
            parts["words"][token.text] = token
        elif key in parts:
            raise self.error(token, f"{token.shown} has no place here; a colon and a readout may follow")
        else:
            parts[key] = token if key == "subject" else self.start() if key == "start" else self.value()

    def setting(self, name: Token, settings: dict[str, Number]) -> None:
        """NAME=LITERAL, from the equals sign on; steps is another word for N."""
        self.take()
        if name.text not in SETTINGS:
            raise self.error(name, f"{name.shown} is no setting; there are {', '.join(SETTINGS)}")
        key = "N" if name.text == "steps" else name.text
        if key in settings:
            raise self.error(name, f"{name.shown} is given twice")
        settings[key] = Number(name.column, self.literal(name.text))

    def start(self) -> tuple[Fraction, Fraction]:
        """A state written as position,velocity."""
        q = self.literal("q")
        self.expect(",", "a start is a position, a comma and a velocity, like 1,0")
        return q, self.literal("v")

    def value(self) -> Token:
        """The text of a parameter's value: a literal, or an expression in brackets, of which only the end is sought."""
        self.accept("=")
        first = self.next
        if first.text != "(":
            self.literal("value")
            last = self.tokens[self.at - 1]
        else:
            open_brackets = 0
            while True:
                last = self.take()
                if last.kind == END:
                    raise self.error(first, "a bracket is not closed")
                open_brackets += (last.text == "(") - (last.text == ")")
                if not open_brackets:
                    break
        return Token(NUMBER, self.question[first.column - 1 : last.end - 1], first.column)

    def literal(self, what: str) -> Fraction:
        """A rational number, for the setting `what`: 10, -1/4 or 0.25."""
        first = self.next
        sign = self.accept("-", "+")
        token = self.take()
        if token.kind != NUMBER:
            raise self.error(token, f"{what}: a number like 1/4 or 0.25 stands here, not {token.shown}")
        text = (sign.text if sign else "") + token.text
        if self.next.text == "/" and self.next.column == token.end and self.tokens[self.at + 1].kind == NUMBER:
            self.take()
            token = self.take()
            text += f"/{token.text}"
        if self.next.kind != END and self.next.column == token.end and self.next.text not in "):,":
            raise self.error(self.next, f"{self.next.shown} has no place in a number; put brackets around the question")
        return self.rational(text, first)

    def rational(self, text: str, token: Token) -> Fraction:
        """The number that the text spells."""
        try:
            return parse_rational(text)
        except ValueError as error:
            raise self.error(token, str(error)) from None

    def name(self, what: str) -> Token:
        """A name, used up."""
        if self.next.kind != NAME:
            raise self.error(self.next, f"{what}; {self.next.shown} stands there")
        return self.take()

    def nested(self, read: Callable[[], Node]) -> Node:
        """One level deeper. Refuses depths at which Python's own stack would be at stake."""
        self.depth += 1
        if self.depth > DEEPEST_NESTING:
            raise self.error(self.next, f"it is nested deeper than {DEEPEST_NESTING} levels")
        node = read()
        self.depth -= 1
        return node

    def error(self, token: Token, reason: str) -> QuestionError:
        """The refusal at a token."""
        return QuestionError(self.question, token.column, reason)
