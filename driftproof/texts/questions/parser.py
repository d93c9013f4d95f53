"""Questions as trees: arithmetic whose atoms may be published values and queries; nothing is evaluated.

The grammar of `driftproof.methods.expression_tree`, in which a name may begin a query:

query   = head part* [":" readout [unit]]
part    = subject | "at" value | name "=" (literal | name | rates) | number "steps" | start | "sharp"
start   = "from" literal ("," literal)*
rates   = "(" sum ("," sum)* ")"
literal = ["-" | "+"] number ["/" number]
value   = literal | "(" expression of driftproof.methods.expressions ")"
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, TypeAlias

from driftproof.methods.expression_tree import (
    END,
    NAME,
    NUMBER,
    ExpressionNode,
    ExpressionParser,
    NameNode,
    NumberNode,
    Token,
)
from driftproof.texts.questions.errors import QuestionError

# Words that may stand alone between head and readout.
WORDS = ("sharp",)
SETTINGS = ("h", "t", "N", "steps", "z", "lambda")
PROBLEM, RATES = ("problem", "rates")
# (17/16)**1000 is a growth that texts have; what is too long to write out is enclosed.
LARGEST_POWER_ASKED = 10**6


@dataclass(frozen=True)
class Query:
    """HEAD SUBJECT [at VALUE] [NAME=NUMBER ...] [from q,v] [: READOUT [UNIT]]; subject and parts None where absent.

    `at` is the text of the parameter's value, which `driftproof.methods.expressions` reads; `rates` are the texts of
    the components of y', which `driftproof.methods.field_text` reads.
    """

    head: Token
    subject: Token | None = None
    at: Token | None = None
    settings: dict[str, NumberNode] = field(default_factory=dict)
    words: dict[str, Token] = field(default_factory=dict)
    start: tuple[Fraction, ...] | None = None
    readout: Token | None = None
    unit: Token | None = None
    problem: Token | None = None
    rates: tuple[Token, ...] = ()


Node: TypeAlias = ExpressionNode | Query


def parse_question(question: str) -> Node:
    """The tree of the question. Raises QuestionError."""
    node: Node = _QuestionParser(question, largest_power=LARGEST_POWER_ASKED).tree()
    return node


class _QuestionParser(ExpressionParser):
    """One pass over the tokens; each method reads what its name says."""

    what = "a question"
    example = "ask for example: step rk4 h=1/2 : q"
    refusal = QuestionError

    def named(self, name: Token) -> Node:
        """A published value by its id, or a query from after its head on."""
        if self.next.kind != NAME and self.next.text != ":":
            return NameNode(name.column, name.text)
        parts: dict[str, Any] = {"settings": {}, "words": {}}
        while self.next.kind == NAME or (self.next.kind == NUMBER and self.tokens[self.at + 1].text == "steps"):
            self.part(self.take(), parts)
        if self.accept(":"):
            parts["readout"] = self.readout()
            if self.next.kind == NAME:
                parts["unit"] = self.take()
        return Query(name, **parts)

    def part(self, token: Token, parts: dict[str, Any]) -> None:
        """One part between head and readout."""
        key = {"at": "at", "from": "start"}.get(token.text, "subject")
        if token.kind == NUMBER:
            self.put(parts["settings"], self.take(), "N", NumberNode(token.column, self.rational(token.text, token)))
        elif token.text == PROBLEM and self.accept("="):
            self.put(parts, token, PROBLEM, self.take())
        elif token.text == RATES and self.accept("="):
            self.put(parts, token, RATES, self.rates())
        elif key != "at" and self.next.text == "=":
            self.setting(token, parts["settings"])
        elif token.text in WORDS:
            parts["words"][token.text] = token
        elif key in parts:
            raise self.error(token, f"{token.shown} has no place here; a colon and a readout may follow")
        else:
            parts[key] = token if key == "subject" else self.start() if key == "start" else self.value()

    def setting(self, name: Token, settings: dict[str, NumberNode]) -> None:
        """NAME=LITERAL, from the equals sign on; steps is another word for N."""
        self.take()
        if name.text not in SETTINGS:
            raise self.error(name, f"{name.shown} is no setting; there are {', '.join((*SETTINGS, PROBLEM, RATES))}")
        key = "N" if name.text == "steps" else name.text
        self.put(settings, name, key, NumberNode(name.column, self.literal(name.text)))

    def put(self, settings: dict[str, Any], name: Token, key: str, given: Any) -> None:
        """A setting, once."""
        if key in settings:
            raise self.error(name, f"{name.shown} is given twice")
        settings[key] = given

    def start(self) -> tuple[Fraction, ...]:
        """A state: of the oscillator position,velocity."""
        found = [self.literal("start")]
        while self.accept(","):
            found.append(self.literal("start"))
        return tuple(found)

    def value(self) -> Token:
        """The text of a parameter's value: a literal, or an expression in brackets, of which only the end is sought."""
        self.accept("=")
        first = self.next
        if first.text != "(":
            self.literal("value")
            last = self.tokens[self.at - 1]
        else:
            *_, last = self.bracketed()
        return self.piece(first.column, last.end)

    def rates(self) -> tuple[Token, ...]:
        """The texts of the components of y', between brackets and parted by commas."""
        if self.next.text != "(":
            raise self.error(self.next, "rates are one or more, parted by commas, in brackets, like (y1, -sin(y0))")
        first, *inside, last = self.bracketed()
        ends, depth = [first.end], 0
        for token in inside:
            depth += (token.text == "(") - (token.text == ")")
            ends += [token.column, token.end] if token.text == "," and not depth else []
        ends.append(last.column)
        return tuple(self.piece(*ends[i : i + 2]) for i in range(0, len(ends), 2))

    def bracketed(self) -> list[Token]:
        """The tokens from the opening bracket that comes next to its closing one, used up."""
        found, open_brackets = [self.take()], 1
        while open_brackets:
            token = self.take()
            if token.kind == END:
                raise self.error(found[0], "a bracket is not closed")
            open_brackets += (token.text == "(") - (token.text == ")")
            found.append(token)
        return found

    def piece(self, start: int, end: int) -> Token:
        """What stands from one column to before another."""
        return Token(NUMBER, self.text[start - 1 : end - 1], start)

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

    def readout(self) -> Token:
        """The name of a readout, used up."""
        if self.next.kind != NAME:
            what = "the name of a readout, such as q, comes after the colon"
            raise self.error(self.next, f"{what}; {self.next.shown} stands there")
        return self.take()
