"""The witness for stiff errors: the orders in print (hairer-wanner-1996, IV.15), and stages solved by elimination."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import pytest

from driftproof.numeric.steps.tableaux import solved
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.linear.stability_function import prothero_robinson, scalar_tableau
from tests.looping import some
from tests.methods.tables.entries import entry
from tests.witnesses.stiff_error import stiff_error

# Local error C h^k (h lambda)^-m, R(oo), order on stiff problems.
REDUCED = {
    "backward_euler": (2, 1, Fraction(1, 2), 0, 1), "implicit_midpoint": (2, 0, Fraction(1, 4), -1, 2),
    "trapezoid": (3, 1, Fraction(1, 6), -1, 2), "gauss2": (3, 0, Fraction(1, 36), 1, 2),
    "gauss3": (4, 0, Fraction(1, 480), -1, 4), "radau_ia3": (3, 0, Fraction(1, 60), 0, 3),
    "radau_iia2": (3, 1, Fraction(1, 9), 0, 2), "radau_iia3": (4, 1, Fraction(1, 80), 0, 3),
    "lobatto_iiic3": (3, 1, Fraction(1, 12), 0, 2),
}  # fmt: skip


@pytest.mark.parametrize("key", REDUCED)
def test_order_on_stiff_problems_is_that_of_the_first_term_of_the_error(key: str) -> None:
    error = stiff_error(entry(key))
    assert (error.power, error.decay, error.coefficient, error.at_infinity, error.order) == REDUCED[key]


def test_order_is_reduced_for_collocation_of_two_stages_and_more() -> None:
    for key in ("gauss2", "gauss3", "radau_ia3", "radau_iia3", "lobatto_iiic3"):
        assert stiff_error(entry(key)).order < entry(key).claimed_order


def test_order_on_stiff_problems_is_refused_where_errors_grow() -> None:
    with pytest.raises(ValueError, match="unstable"):
        stiff_error(entry("rk4"))


def defect(method: Any, power: int, z: Fraction) -> Fraction:
    """phi(1) - y1 of one step h = 1 from 0 on y' = z (y - phi) + phi', phi = t^power: stages by elimination."""
    data = scalar_tableau(method)
    a, b, c = (
        [[Fraction(str(x)) for x in row] for row in data.a],
        *([Fraction(str(x)) for x in v] for v in (data.b, data.c)),
    )
    right = [power * x ** (power - 1) - z * x**power for x in c]
    slopes = solved([[(i == j) - z * x for j, x in enumerate(row)] for i, row in enumerate(a)], right)
    return 1 - sum((w * x for w, x in zip(b, slopes, strict=True)), Fraction(0))


# Both sides are quotients of polynomials of degree stages + 1 at most: equal at 2 stages + 4 points, they are equal.
@pytest.mark.parametrize("key", ["backward_euler", "trapezoid", "radau_iia2", "lobatto_iiic3"])
def test_error_of_a_step_is_exactly_the_function_of_prothero_and_robinson(key: str) -> None:
    method = entry(key)
    for power in range(1, 6):
        function = prothero_robinson(method, power)
        for z in some((Fraction(-i - 1, 3) for i in range(2 * method.stages + 4)), 6):
            assert Fraction(str(exact(function(scalar(z))))) * math.factorial(power) == defect(method, power, z)
