"""How numbers, lists and theorems are written in Coq, and how theorems are read back out of a file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

RING, VM, SIGN, INTERVAL, SCRIPT = "ring", "vm", "sign", "interval", "script"
# The tactic that ends a proof by itself, once words are unfolded -> the way in which it is right; others are scripts.
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
    """A statement and its proof, as Coq reads them; the name holds the claims that it is a certificate for."""

    name: str
    statement: str
    proof: str

    @property
    def claims(self) -> tuple[str, ...]:
        """The claims of the ledger that the name lists; none if it names something else."""
        parts = self.name.split("_")
        return tuple(parts) if all(_CLAIM.fullmatch(part) for part in parts) else ()

    @property
    def technique(self) -> str:
        """The way in which the proof is right."""
        sentence = re.fullmatch(r"(?:(?:unfold|cbv)\b[^.]*\.\s)*(\w+)[^.]*\.", self.proof)
        return TECHNIQUES.get(sentence[1], SCRIPT) if sentence else SCRIPT

    def text(self) -> str:
        """The theorem as it stands in a file."""
        return f"Theorem {self.name} : {self.statement}.\nProof. {self.proof} Qed.\n"


def theorems(text: str) -> Iterator[Theorem]:
    """The theorems of a file, in order."""
    return (Theorem(**found.groupdict()) for found in _THEOREM.finditer(text))


def rational(x: Fraction) -> str:
    """A rational number in Q_scope: 3, -1#2."""
    return str(x).replace("/", "#") if x >= 0 else f"(-{rational(-x)})"


def argument(x: Fraction) -> str:
    """The same where an argument of a function stands."""
    return f"({rational(x)})" if "#" in rational(x) and x >= 0 else rational(x)


def coq_list(items: Iterable[str]) -> str:
    """[a; b; c]."""
    return f"[{'; '.join(items)}]"


def file_text(purpose: str, imports: str, body: Iterable[str]) -> str:
    """A file that says what it is for and that nobody wrote it by hand."""
    return "\n".join(
        [f"(** {purpose} Written by `make kernel`: change the emitter, not this. *)", "", imports, "", *body]
    )
