"""Boundedness at one step size, exact: against spectral radii of the matrix, and at limits, where it turns."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import acb_mat, arb, ctx, fmpq

from driftproof.methods.catalogue import METHODS
from driftproof.methods.expressions import parse_system
from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError
from driftproof.symbolic.linear.systems import SystemFacts, bounded_at, factor_at, largest_eigenvalue
from driftproof.texts.writing.records import record
from tests.symbolic.linear.linear_examples import at

STIFF = "0 1; -1000000 0"
SPRINGS = "0 0 1 0; 0 0 0 1; -2 1 0 0; 1 -2 0 0"
DAMPED = "0 1; -1 -1/10"
COUPLED = "0 0 1 0; 0 0 0 1; -2 1 -1/10 0; 1 -3 0 -1/5"
STEPS = [Q(1, 1000), Q(1, 7), Q(1, 2), Q(3, 2), Q(9, 5), Q(5, 2), Q(3), Q(40)]


def radius(found: SystemFacts, h: Q) -> tuple[Q, Q]:
    """Ends of an enclosure of the spectral radius of M(h), by the eigenvalues of the matrix in balls."""
    with ctx.workprec(300):
        matrix = acb_mat([[at(entry, arb(fmpq(*h.as_integer_ratio()))) for entry in row] for row in found.matrix])
        sizes = [abs(x) for x in matrix.eig(nonstop=True)]
        largest = sizes[0]
        for size in sizes[1:]:
            largest = largest.max(size)
        return endpoints(largest)


@pytest.mark.parametrize("key", ["forward_euler", "rk4", "sdirk2", "radau_iia2", "velocity_verlet", "ruth3"])
@pytest.mark.parametrize("text", ["0 1; -1 0", SPRINGS, STIFF])
def test_verdict_is_that_of_the_spectral_radius_where_that_is_not_one(key: str, text: str) -> None:
    found = SystemFacts(METHODS[key], parse_system(text))
    decided = 0
    for h in STEPS:
        low, high = radius(found, h)
        if high < 1 or low > 1:
            decided += 1
            assert bounded_at(found, h) is (high < 1)
    assert decided


@pytest.mark.parametrize("key", ["rk4", "backward_euler", "gauss2"])
@pytest.mark.parametrize("text", [DAMPED, COUPLED])
def test_verdict_on_damped_systems_is_that_of_the_spectral_radius(key: str, text: str) -> None:
    found = SystemFacts(METHODS[key], parse_system(text))
    for h in STEPS:
        low, high = radius(found, h)
        assert high < 1 or low > 1
        assert bounded_at(found, h) is (high < 1)


# At the very step where the verdict turns: what holds just below it, at it, and just above.
TURNS = [
    ("forward_euler", "-1", Q(2), (True, True, False)),
    ("forward_euler", "-1 1; 0 -1", Q(2), (True, False, False)),
    ("symplectic_euler", "0 1; -1 0", Q(2), (True, False, False)),
    ("symplectic_euler", STIFF, Q(1, 500), (True, False, False)),
    ("velocity_verlet", "0 1; -4 0", Q(1), (True, False, False)),
    ("rk4", "-1 -1; 1 -1", None, (True, False, False)),
    ("implicit_midpoint", "0 1; -1 0", Q(2), (True, True, True)),
    ("forward_euler", "0 1; -1 0", Q(1, 10**6), (False, False, False)),
    ("forward_euler", "0 0; 0 -1", Q(2), (True, True, False)),
    ("forward_euler", "0 1; 0 0", Q(2), (False, False, False)),
]


@pytest.mark.parametrize(("key", "text", "turn", "verdicts"), TURNS)
def test_verdict_turns_at_the_limit(key: str, text: str, turn: Q | None, verdicts: tuple[bool, bool, bool]) -> None:
    found = SystemFacts(METHODS[key], parse_system(text))
    if turn is None:  # an irrational limit: doubles on either side
        with ctx.workprec(200):
            turn = Q(float(found.step_limit.limit.ball().mid()))  # type: ignore[union-attr]
        near = [bounded_at(found, turn * (1 + Q(k, 2**50))) for k in (-1, 1)]
        assert near == [True, False]
        return
    near_by = Q(1, 10**30)
    assert tuple(bounded_at(found, turn * x) for x in (1 - near_by, Q(1), 1 + near_by)) == verdicts


def test_verdict_agrees_with_the_limit_of_every_method_on_the_oscillator() -> None:
    for method in METHODS.values():
        found = SystemFacts(method, parse_system("0 1; -1 0"))
        data = found.step_limit.limit
        if not hasattr(data, "ball"):
            assert bounded_at(found, Q(10**6))
            continue
        with ctx.workprec(200):
            low, _ = endpoints(data.ball())
        if low > 0:
            assert bounded_at(found, low * Q(99, 100))


def test_factor_is_the_size_of_the_stability_function() -> None:
    euler = SystemFacts(METHODS["forward_euler"], parse_system("-1"))
    assert factor_at(euler, largest_eigenvalue(euler.rows), Q(3, 2)) == Q(1, 2)
    rk4 = SystemFacts(METHODS["rk4"], parse_system("-1000"))
    z = Q(-1000, 300)
    assert factor_at(rk4, largest_eigenvalue(rk4.rows), Q(1, 300)) == abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)
    assert factor_at(rk4, largest_eigenvalue(rk4.rows), Q(1, 301)) != abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)


@pytest.mark.parametrize("key", ["rk4", "symplectic_euler", "radau_iia2", "yoshida4"])
@pytest.mark.parametrize("h", [Q(1, 3), Q(5, 2)])
def test_factor_is_the_spectral_radius_of_one_oscillator(key: str, h: Q) -> None:
    found = SystemFacts(METHODS[key], parse_system("0 1; -4 0"))
    low, high = radius(found, h)
    with ctx.workprec(300):
        assert enclose(factor_at(found, largest_eigenvalue(found.rows), h)).overlaps(
            arb(
                fmpq(*((low + high) / 2).as_integer_ratio()),
                fmpq(*((high - low) / 2 + Q(1, 2**200)).as_integer_ratio()),
            )
        )


def test_largest_eigenvalue_is_the_largest_in_size() -> None:
    assert record(largest_eigenvalue(parse_system("998 1998; -999 -1999")).place)["exact"] == "-1000"
    assert record(largest_eigenvalue(parse_system("0 1; -4 0")).place)["exact"] == "2*I"


def test_what_is_not_decided_is_refused() -> None:
    stuck = SystemFacts(METHODS["symplectic_euler"], parse_system("0 0 1 0; 0 0 0 1; -1 1 0 0; 0 -1 0 0"))
    with pytest.raises(UndecidedLimitError, match="only simple"):
        bounded_at(stuck, Q(1, 2))
