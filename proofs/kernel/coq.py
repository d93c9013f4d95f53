"""Write numbers, lists and theorems in the syntax of Coq, and read theorems back from a file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

RING, VM, SIGN, INTERVAL, SCRIPT = "ring", "vm", "sign", "interval", "script"
# Tactic that completes a proof after unfolding -> the technique of the proof; other proofs are scripts.
TECHNIQUES = {
    "by_ring": RING,
    "by_circle": RING,
    "by_vm": VM,
    "by_run": VM,
    "by_order": VM,
    "by_rounded_order": VM,
    "by_bits": VM,
    "by_growth": VM,
    "by_sign": SIGN,
    "by_gappa": INTERVAL,
    "by_interval": INTERVAL,
    "by_angle": INTERVAL,
}
_THEOREM = re.compile(
    r"^Theorem (?P<name>[\w']+) :\s(?P<statement>.*?)\.\nProof\.\s(?P<proof>.*?)\s?Qed\.$", re.M | re.S
)
_CLAIM = re.compile(r"[LT]\d+")


@dataclass(frozen=True)
class Theorem:
    """A theorem in Coq syntax: name, statement and proof; the name lists the claims that it certifies."""

    name: str
    statement: str
    proof: str

    @property
    def claims(self) -> tuple[str, ...]:
        """The ids of claims in the name; empty if the theorem certifies no claim."""
        parts = self.name.split("_")
        return tuple(parts) if all(_CLAIM.fullmatch(part) for part in parts) else ()

    @property
    def technique(self) -> str:
        """The technique of the proof, one of TECHNIQUES or SCRIPT."""
        sentence = re.fullmatch(r"(?:(?:unfold|cbv)\b[^.]*\.\s)*(\w+)[^.]*\.", self.proof)
        return TECHNIQUES.get(sentence[1], SCRIPT) if sentence else SCRIPT

    def text(self) -> str:
        """The theorem as the text of a file."""
        return f"Theorem {self.name} : {self.statement}.\nProof. {self.proof} Qed.\n"


def theorems(text: str) -> Iterator[Theorem]:
    """The theorems of a file, in order."""
    return (Theorem(**found.groupdict()) for found in _THEOREM.finditer(text))


def rational(x: Fraction) -> str:
    """A rational number in Q_scope, such as 3, 1#2 or (-1#2)."""
    return str(x).replace("/", "#") if x >= 0 else f"(-{rational(-x)})"


def argument(x: Fraction) -> str:
    """A rational number as an argument of a function, in brackets if needed."""
    return f"({rational(x)})" if "#" in rational(x) and x >= 0 else rational(x)


def coq_list(items: Iterable[str]) -> str:
    """A Coq list [a; b; c]."""
    return f"[{'; '.join(items)}]"


def file_text(purpose: str, imports: str, body: Iterable[str]) -> str:
    """The text of a generated file, with a comment that states its purpose and its generator."""
    return "\n".join(
        [f"(** {purpose} Written by `make kernel`: change the emitter, not this. *)", "", imports, "", *body]
    )
