"""AStability.v: the A-stability of the implicit methods, stated of their tables or of the polynomial of their nodes."""

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
    theorems = (Theorem(f"a_stable_{key}", statement, "by_sign.").text() for key, statement in statements())
    return file_text("A-stability of the implicit methods.", IMPORTS, theorems)


def statements() -> Iterator[tuple[str, str]]:
    """Key and statement of every A-stable method; a table is the one whose order OrdersOfTables.v states."""
    for key, method in METHODS.items():
        if isinstance(method, RungeKutta | Collocation) and not method.explicit and Facts(method).a_stable:
            collocation = isinstance(method, Collocation)
            yield key, f"collocation_is_a_stable {_nodes(method)}" if collocation else f"a_stable {key}"


def _nodes(method: Collocation) -> str:
    """The polynomial of the nodes with integer coefficients, constant term first."""
    common = lcm(*(x.denominator for x in method.node_polynomial))
    return coq_list(str(int(x * common)) for x in method.node_polynomial)
