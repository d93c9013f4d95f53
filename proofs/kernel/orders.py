"""Write OrdersOfTables.v: theorems on the order of every Runge-Kutta table of the catalogue and every embedded one."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import ROUND_DOWN, ROUND_UP, Context, Decimal
from fractions import Fraction
from math import lcm

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.flint_rationals import as_fraction
from driftproof.methods.numbers.number_field import Exact, NumberField
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.facts import Facts
from driftproof.symbolic.linear.printed_digits import RESIDUAL_DIGITS
from driftproof.symbolic.trees.elementary_weights import RingElement
from driftproof.symbolic.trees.order_conditions import order, runge_kutta_conditions
from driftproof.symbolic.trees.rooted_trees import Tree
from proofs.kernel.coq import Theorem, coq_list, file_text, rational
from proofs.kernel.tables import definition

IMPORTS = """\
From Coq Require Import QArith ZArith List.
From driftproof Require Import Methods Trees Orders RoundedOrders.
Import ListNotations.
Open Scope Z_scope."""
# Bits of the enclosure of a generator of a number field: enough to tell every residual of the catalogue from zero.
BITS = 80


def runge_kutta_tables() -> Iterator[RungeKutta]:
    """The Runge-Kutta tables of the catalogue, each followed by its embedded table if it has one."""
    for method in METHODS.values():
        if isinstance(method, RungeKutta):
            yield method
            if method.b_embedded is not None:
                yield method.embedded("_embedded")


def orders() -> str:
    """The text of OrdersOfTables.v."""
    entries = (_rounded_entry(each) if each.decimal else _exact_entry(each) for each in runge_kutta_tables())
    return file_text("The orders of the tables, exact and rounded.", IMPORTS, entries)


def _exact_entry(method: RungeKutta) -> str:
    """The Coq definition of an exact table and the theorem on its order on y' = f(y), of A and b alone."""
    fact = order(method)
    proof = f"by_order ({tree_text(fact.failing_tree)})."
    theorem = Theorem(f"order_of_{method.key}", f"has_order {method.key} {fact.order}", proof)
    return f"{in_integers(method)}\n{theorem.text()}"


def _rounded_entry(method: RungeKutta) -> str:
    """The Coq definition of a table of decimals and the theorem on its order but for rounding, with two bounds."""
    fact = Facts(method).order_but_for_rounding
    if fact is None:
        raise ValueError(f"{method.key} has no order but for rounding")
    conditions = runge_kutta_conditions(method)
    found = [max((abs(x), i) for i, x in conditions.residuals(n)) for n in range(1, fact.order + 2)]
    (*missed, exceeded), (*_, worst) = zip(*found, strict=True)
    bounds = f"{three_digits(max(missed), ROUND_UP)} {three_digits(exceeded, ROUND_DOWN)}"
    proof = f"by_rounded_order ({tree_text(conditions.tree(fact.order + 1, worst))})."
    theorem = Theorem(f"order_of_{method.key}", f"has_rounded_order {method.key} {fact.order} {bounds}", proof)
    return f"{definition(method)}\n{theorem.text()}"


def three_digits(x: RingElement, rounding: str) -> str:
    """A rational number rounded up or down: 2.675e-5 becomes 2.68e-5 or 2.67e-5."""
    exact = as_fraction(x)
    context = Context(RESIDUAL_DIGITS, rounding)
    return f"{context.divide(Decimal(exact.numerator), Decimal(exact.denominator)):e}"


def in_integers(method: RungeKutta) -> str:
    """The Coq definition of the table, in integers of its number field over a common denominator."""
    integers = [_integer_coordinates(x, method.field) for x in (*(x for row in method.a for x in row), *method.b)]
    denominator = lcm(*(x.denominator for coordinates in integers for x in coordinates))
    written = iter(coq_list(str(int(x * denominator)) for x in coordinates) for coordinates in integers)
    rows = [coq_list(next(written) for _ in row) for row in method.a]
    relation, low, high = _root(method.field)
    return (
        f"Definition {method.key} : table := {{|\n"
        f"  written_relation := {coq_list(map(str, relation))}; low := {_in_q(low)}; high := {_in_q(high)};\n"
        f"  denominator := {denominator};\n"
        f"  written_matrix := {coq_list(rows)};\n"
        f"  written_weights := {coq_list(written)} |}}.\n"
    )


def tree_text(tree: Tree) -> str:
    """The tree in Coq syntax: its branches grafted onto a vertex one after the other."""
    text = "vertex"
    for branch in tree:
        left, right = (f"({part})" if " " in part else part for part in (text, tree_text(branch)))
        text = f"graft {left} {right}"
    return text


def _root(field: NumberField | None) -> tuple[list[int], Fraction, Fraction]:
    """The relation r and an enclosure of X = L times the generator of the field: X^n = r_0 + r_1 X + ...

    L is the leading coefficient of the minimal polynomial, so X is an algebraic integer. Without a field, X = 0.
    """
    if field is None:
        return [0], Fraction(0), Fraction(0)
    *rest, leading = field.minimal
    low, high = (leading * field.generator).enclosure(BITS)
    return [-m * leading ** (len(rest) - 1 - i) for i, m in enumerate(rest)], low, high


def _integer_coordinates(x: Exact, field: NumberField | None) -> list[Fraction]:
    """The coefficients of x in the powers of X: see `_root`."""
    if isinstance(x, Fraction):
        return [x]
    assert field is not None
    return [c / Fraction(field.minimal[-1]) ** i for i, c in enumerate(x.coefficients)]


def _in_q(x: Fraction) -> str:
    return f"({rational(x)})%Q"
