"""What a question is made of: the tree that the parser builds. Every node knows its column."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

from driftproof.texts.questions.tokens import Token


@dataclass(frozen=True)
class Number:
    """A rational number written out."""

    column: int
    value: Fraction


@dataclass(frozen=True)
class Published:
    """A published value by its id; in an exact form, a variable."""

    column: int
    name: str


@dataclass(frozen=True)
class Query:
    """HEAD SUBJECT [at VALUE] [NAME=NUMBER ...] [from q,v] [: READOUT [UNIT]]; subject and parts None where absent.

    `at` is the text of the parameter's value, which `driftproof.methods.expressions` reads.
    """

    head: Token
    subject: Token | None = None
    at: Token | None = None
    settings: dict[str, Number] = field(default_factory=dict)
    words: dict[str, Token] = field(default_factory=dict)
    start: tuple[Fraction, Fraction] | None = None
    readout: Token | None = None
    unit: Token | None = None

    @property
    def column(self) -> int:
        """Where it begins."""
        return self.head.column


@dataclass(frozen=True)
class Call:
    """A function of one or two numbers."""

    column: int
    function: str
    arguments: tuple[Node, ...]


@dataclass(frozen=True)
class Chain:
    """first (sign node)*, from the left, the signs being + and -, or * and /; each with its column."""

    column: int
    first: Node
    rest: tuple[tuple[Token, Node], ...]


@dataclass(frozen=True)
class Negated:
    """-node."""

    column: int
    node: Node


@dataclass(frozen=True)
class Power:
    """base**exponent."""

    column: int
    base: Node
    exponent: Fraction


Node: TypeAlias = Number | Published | Query | Call | Chain | Negated | Power
