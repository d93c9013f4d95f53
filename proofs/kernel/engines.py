"""Write Engines.v: the one-step matrices of every rational method from both exact engines, entry by entry."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction as Q
from math import lcm
from typing import Any

import sympy

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation
from driftproof.symbolic.derivation.one_step import entries, numerator_and_denominator
from driftproof.symbolic.derivation.stages import derived_matrix
from driftproof.symbolic.linear.oscillator import oscillator_matrix as flint_matrix
from proofs.kernel.coq import Theorem, coq_list, file_text

IMPORTS = """\
From Coq Require Import ZArith Uint63 List.
Import ListNotations.
Open Scope Z_scope.

(** A quotient of polynomials in h: numerator and denominator, constant term first; the denominator begins above 0, and
    no integer but 1 divides all coefficients. *)
Definition fraction : Type := list Z * list Z.
(** A number by its digits to the base 2^60, the last one first: Coq reads the processor's integers fastest. *)
Definition long (digits : list int) : Z := fold_right (fun digit number => to_Z digit + 2 ^ 60 * number) 0 digits."""

# Numbers of at most SHORT characters are written in place; others as digits of DIGIT hexadecimal characters.
SHORT, DIGIT = 12, 15

Fraction = tuple[list[Q], list[Q]]


def rational_methods() -> list[str]:
    """The keys of the methods with rational coefficients, except collocation methods, which are given by nodes."""
    return [key for key, method in METHODS.items() if not isinstance(method, Collocation) and method.field is None]


def both_matrices(key: str) -> Iterator[tuple[Fraction, Fraction]]:
    """Pairs of SymPy's and FLINT's entries, row by row: numerator and denominator in h, constant term first."""
    derived, _ = derived_matrix(METHODS[key])
    for mine, theirs in zip(entries(derived), (x for row in flint_matrix(METHODS[key]) for x in row), strict=True):
        top, bottom = map(ascending, numerator_and_denominator(mine))
        yield (top, bottom), (_fractions(theirs.num), _fractions(theirs.den))


def ascending(polynomial: sympy.polys.rings.PolyElement) -> list[Q]:
    """The coefficients of a SymPy polynomial, constant term first."""
    found = {power: Q(int(c.numerator), int(c.denominator)) for (power,), c in polynomial.terms()}
    return [found.get(power, Q(0)) for power in range(max(found, default=0) + 1)]


def _fractions(polynomial: Any) -> list[Q]:
    return [Q(int(c.p), int(c.q)) for c in polynomial.coeffs()]


def engines() -> str:
    """The text of Engines.v."""
    pairs = [list(both_matrices(key)) for key in rational_methods()]
    names: dict[str, str] = {}
    written = [[coq_list(_entry(pair[i], names) for pair in row) for row in pairs] for i in (0, 1)]
    numbers = (f"Definition {name} : Z := {number}.\n" for number, name in names.items())
    tables = (
        f"Definition {engine} : list (list fraction) :=\n  {coq_list(rows)}.\n"
        for engine, rows in zip(("sympy", "flint"), written, strict=True)
    )
    claim = Theorem("T01", f"(length sympy = {len(pairs)})%nat /\\ sympy = flint", "split; reflexivity.")
    purpose = "The matrices M(h) of the rational methods, as SymPy derives them and as FLINT does."
    return file_text(purpose, IMPORTS, [*numbers, *tables, claim.text()])


def _entry(fraction: Fraction, names: dict[str, str]) -> str:
    """Numerator and denominator as lists of integers over a common denominator, long integers by name."""
    top, bottom = ([x / fraction[1][0] for x in polynomial] for polynomial in fraction)
    common = lcm(*(x.denominator for x in (*top, *bottom)))
    return "({}, {})".format(*(coq_list(_number(int(x * common), names) for x in part) for part in (top, bottom)))


def _number(x: int, names: dict[str, str]) -> str:
    """A short number in decimal; the name of a long one, whose digits are recorded in `names`."""
    if len(str(x)) <= SHORT:
        return str(x)
    written = f"{abs(x):x}"
    digits = coq_list(f"0x{written[max(end - DIGIT, 0) : end]}" for end in range(len(written), 0, -DIGIT))
    return names.setdefault(f"{'- ' if x < 0 else ''}long {digits}%uint63", f"number_{len(names) + 1}")
