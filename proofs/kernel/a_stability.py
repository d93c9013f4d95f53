"""Write AStability.v: theorems on which implicit methods are A-stable, from their tables or node polynomials."""

from __future__ import annotations

from collections.abc import Iterator
from math import lcm

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.facts import Facts
from proofs.kernel.coq import Theorem, coq_list, file_text

IMPORTS = """\
From Coq Require Import QArith ZArith List.
From driftproof Require Import Trees Orders OrdersOfTables LeftHalfPlane Contraction.
Import ListNotations.
Open Scope Z_scope."""


def a_stability() -> str:
    """The text of AStability.v."""
    text = (theorem.text() for theorem in verdicts())
    return file_text("Which of the implicit methods are A-stable.", IMPORTS, text)


def verdicts() -> Iterator[Theorem]:
    """One theorem per implicit method of the catalogue; its table is the one defined in OrdersOfTables.v."""
    for key, method in METHODS.items():
        if isinstance(method, RungeKutta | Collocation) and not method.explicit:
            words, proof = ("a_stable", "by_sign.") if Facts(method).a_stable else ("not_a_stable", "by_growth.")
            collocation = isinstance(method, Collocation)
            statement = f"collocation_is_{words} {_nodes(method)}" if collocation else f"{words} {key}"
            yield Theorem(f"{words}_{key}", statement, proof)


def _nodes(method: Collocation) -> str:
    """The polynomial of the nodes as a Coq list of integer coefficients, constant term first."""
    common = lcm(*(x.denominator for x in method.node_polynomial))
    return coq_list(str(int(x * common)) for x in method.node_polynomial)
