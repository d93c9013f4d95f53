"""AStability.v: |P|^2 <= |Q|^2 on the left half-plane for the stability functions P/Q of the implicit methods."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import lcm

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.polynomials import coefficients
from driftproof.symbolic.facts import Facts
from proofs.kernel.coq import Theorem, coq_list, file_text

IMPORTS = """\
From Coq Require Import ZArith Reals List.
From driftproof Require Import LeftHalfPlane.
Import ListNotations.
Open Scope Z_scope."""

# A-stable, but with a negative coefficient in |Q|^2 - |P|^2: no visible sign shows it.
NO_VISIBLE_SIGN = ("sdirk4", "esdirk43")


def a_stability() -> str:
    """The text of AStability.v."""
    theorems = (
        Theorem(f"a_stable_{key}", f"contractive\n  {p}\n  {q}", "by_sign.").text() for key, p, q in functions()
    )
    return file_text("A-stability of the implicit methods.", IMPORTS, theorems)


def functions() -> Iterator[tuple[str, str, str]]:
    """Key, P and Q of every A-stable method whose P and Q are rational, as lists of integers, constant term first."""
    for key, method in METHODS.items():
        implicit = isinstance(method, RungeKutta | Collocation) and not method.explicit
        if implicit and key not in NO_VISIBLE_SIGN and Facts(method).a_stable:
            fraction = Facts(method).stability_function.f
            p, q = coefficients(fraction.num), coefficients(fraction.den)
            rational = [x for x in (*p, *q) if isinstance(x, Fraction)]
            if len(rational) == len(p) + len(q):
                common = lcm(*(x.denominator for x in rational))
                whole = [str(int(x * common)) for x in rational]
                yield key, coq_list(whole[: len(p)]), coq_list(whole[len(p) :])
