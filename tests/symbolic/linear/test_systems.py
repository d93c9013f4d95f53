"""Methods on linear systems: the matrix by stepping, limits of h and verdicts by spectral radii in balls."""

from __future__ import annotations

from fractions import Fraction as Q
from math import sqrt
from typing import Any

import pytest
from flint import acb_mat, arb, ctx, fmpq

import driftproof
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.expressions import System, parse_system
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Method, Splitting
from driftproof.symbolic.algebra.certified import enclose, endpoints, significant
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, rational_root
from driftproof.symbolic.linear.oscillator import linear_step_matrix
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError
from driftproof.symbolic.linear.stability_limits import ALWAYS, Bound, Limit
from driftproof.symbolic.linear.systems import SystemFacts
from tests.symbolic.linear.linear_examples import (
    CHAIN,
    COUPLED,
    DAMPED,
    MIDPOINT,
    MIDPOINT_NYSTROM,
    NYSTROM_4,
    SPRINGS,
    STUCK,
    TWISTED,
    at,
    facts,
    limit_text,
    record_text,
)
from tests.witnesses.witness_limits import is_where_growth_begins


class Column(tuple[Any, ...]):
    """A vector with what a step needs, over any numbers."""

    def __add__(self, other: Any) -> Column:
        return Column(x + y for x, y in zip(self, other, strict=True))

    def __rmul__(self, factor: Any) -> Column:
        return Column(factor * x for x in self)


class Factor:
    """A coefficient that multiplies numbers and vectors."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def __mul__(self, other: Any) -> Any:
        return Column(self.value * x for x in other) if isinstance(other, Column) else Factor(self.value * other)


def stepped(method: Method, rows: System, h: Q) -> list[list[Any]]:
    """The one-step matrix at a rational h, column by column, by the generic step itself."""
    half = len(rows) // 2
    step = stepper(method, Factor)

    def force(q: Column) -> Column:
        return Column(sum((x * y for x, y in zip(row[:half], q, strict=True)), Q(0)) for row in rows[half:])

    columns = []
    for k in range(2 * half):
        start = Column(Q(int(i == k)) for i in range(2 * half))
        q, v = step(force, Column(start[:half]), Column(start[half:]), h)
        columns.append([*q, *v])
    return [list(row) for row in zip(*columns, strict=True)]


PARTITIONED = ["symplectic_euler", "velocity_verlet", "position_verlet", "ruth3", "forest_ruth", "pefrl", "nystrom4"]


@pytest.mark.parametrize("key", PARTITIONED)
@pytest.mark.parametrize("text", ["0 1; -3 0", "0 1; 2 0", CHAIN, STUCK, "0 0 1 0; 0 0 0 1; 0 1 0 0; 0 0 0 0"])
def test_matrix_of_a_partitioned_method_is_that_of_its_step(key: str, text: str) -> None:
    h = Q(2, 7)
    found = [[exact(entry(scalar(h))) for entry in row] for row in facts(key, text).matrix]
    assert found == stepped(METHODS[key], parse_system(text), h)
    assert found != stepped(METHODS[key], parse_system(text), h + Q(1, 10**20))


def test_matrix_of_an_implicit_nystrom_method_is_that_of_the_implicit_midpoint_rule() -> None:
    for text in ("0 1; -3 0", CHAIN, STUCK):
        rows = parse_system(text)
        assert linear_step_matrix(MIDPOINT_NYSTROM, rows) == linear_step_matrix(MIDPOINT, rows)
        assert linear_step_matrix(NYSTROM_4, rows) != linear_step_matrix(MIDPOINT, rows)


@pytest.mark.parametrize("key", ["rk4", "sdirk2", "gauss3", "velocity_verlet", "nystrom4"])
def test_determinant_is_that_of_the_matrix_at_a_step(key: str) -> None:
    found, h = facts(key, CHAIN), scalar(Q(3, 8))
    assert exact(found.determinant(h)) == _cofactors([[exact(entry(h)) for entry in row] for row in found.matrix])
    off = [[exact(entry(h)) + Q(i == j, 10**20) for j, entry in enumerate(row)] for i, row in enumerate(found.matrix)]
    assert exact(found.determinant(h)) != _cofactors(off)


def _cofactors(rows: list[list[Any]]) -> Any:
    if len(rows) == 1:
        return rows[0][0]
    minors = ([row[:j] + row[j + 1 :] for row in rows[1:]] for j in range(len(rows)))
    return sum(
        ((-1) ** j * x * _cofactors(minor) for j, (x, minor) in enumerate(zip(rows[0], minors, strict=True))), Q(0)
    )


def radius(found: SystemFacts, h: arb) -> arb:
    """The spectral radius of M(h), by eigenvalues of the matrix in balls."""
    matrix = acb_mat([[at(entry, h) for entry in row] for row in found.matrix])
    sizes = [abs(x) for x in matrix.eig(nonstop=True)]
    total = sizes[0]
    for size in sizes[1:]:
        total = total.max(size)
    return total


# Systems with distinct eigenvalues of M near the limit, so that balls separate them: exact text, or decimal.
LIMITS = {
    ("rk4", DAMPED): "2.909799685490394332749367463504", ("rk4", COUPLED): "1.527433714783494202181090494221",
    ("forward_euler", DAMPED): "1/10", ("heun3", COUPLED): None, ("rk4", SPRINGS): "2*sqrt(6)/3",
    ("velocity_verlet", SPRINGS): "2*sqrt(3)/3", ("symplectic_euler", "0 1; -9/4 0"): "4/3",
    ("forest_ruth", CHAIN): None, ("nystrom4", CHAIN): None, ("rk4", "-21 19 -20; 19 -21 20; 40 -40 -40"): None,
    ("rk4", "-2 1 0; 1 -2 1; 0 1 -2"): None, ("sdirk2", DAMPED): "oo", ("gauss2", COUPLED): "oo",
    ("rk4", TWISTED): "0", ("velocity_verlet", TWISTED): "0", ("velocity_verlet", "0 1; 2 0"): "0",
    ("rk4", "0 1 0; 0 0 1; -5 -1 -1/2"): "0", ("dormand_prince54", "0 1 0; 0 0 1; -1 -3 -2"): None,
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("key", "text"), LIMITS)
def test_limit_of_h_is_where_powers_begin_to_grow(key: str, text: str) -> None:
    found = facts(key, text)
    limit = found.step_limit.limit
    assert is_where_growth_begins(limit, lambda h: radius(found, h))
    wanted = LIMITS[key, text]
    record = driftproof.facts(key, system=text, only=("step_limit",)).data["step_limit"]
    assert wanted is None or wanted in (record, *(record.values() if isinstance(record, dict) else ()))
    if isinstance(limit, RealRoot) and limit != ZERO_ROOT:
        for moved in (fmpq(10**9 - 1, 10**9), fmpq(10**9 + 1, 10**9)):
            assert not is_where_growth_begins(limit, lambda h: radius(found, h), moved)


def test_limit_is_the_least_of_those_of_the_eigenvalues() -> None:
    bounds = [bound for _, bound in facts("rk4", COUPLED).bounds]
    assert all(isinstance(bound, Bound) for bound in bounds)
    assert len({limit_text(bound.limit) for bound in bounds if isinstance(bound, Bound)}) == 1  # conjugates
    assert facts("rk4", COUPLED).step_limit.limit in [b.limit for b in bounds if isinstance(b, Bound)]
    diagonal = parse_system("-1 0 0; 0 -3 0; 0 0 -2")
    euler = driftproof.facts("forward_euler", system=diagonal, only=("eigenvalues", "step_limit")).data
    assert [record_text(e["limit"]) for e in euler["eigenvalues"]] == ["2", "1", "2/3"]
    assert record_text(euler["step_limit"]) == "2/3"


# (method, system): the limit, and whether powers are bounded there.
JORDAN = {
    ("rk4", "-1 1; 0 -1"): ("x**3 - 4*x**2 + 12*x - 24", False),
    ("rk4", STUCK): ("2*sqrt(2)", False), ("gauss2", STUCK): ("0", None), ("gauss2", "-1 1; 0 -1"): ("oo", None),
    ("velocity_verlet", STUCK): ("0", None), ("velocity_verlet", "0 1; 0 0"): ("0", None),
    ("backward_euler", "0 1; 0 0"): ("0", None), ("rk4", "0 1; -1 0"): ("2*sqrt(2)", True),
    ("velocity_verlet", "0 1; -1 0"): ("2", False),
    ("velocity_verlet", "0 0 1 0; 0 0 0 1; 1 1 0 0; 0 1 0 0"): ("0", None),
    ("chebyshev10_1", "-1 1; 0 -1"): ("200", False),
    ("forward_euler", "-1 -1 1 0; 1 -1 0 1; 0 0 -1 -1; 0 0 1 -1"): ("1", False),
    ("heun2", "-1 -1 1 0; 1 -1 0 1; 0 0 -1 -1; 0 0 1 -1"): ("x**3 - 2*x**2 + 2*x - 2", False),
    ("forward_euler", DAMPED): ("1/10", True), ("forward_euler", "-1 0; 0 -2"): ("1", True),
    ("symplectic_euler", "0 1; -9/4 0"): ("4/3", False),
    # Two eigenvalues with one limit, which one of them attains; and one that does not, with a limit farther out.
    ("forward_euler", "-1 -1 1 0 0; 1 -1 0 1 0; 0 0 -1 -1 0; 0 0 1 -1 0; 0 0 0 0 -2"): ("1", False),
    ("forward_euler", "-1 1 0; 0 -1 0; 0 0 -2"): ("1", True),
}  # fmt: skip


@pytest.mark.parametrize(("key", "text"), JORDAN)
def test_jordan_blocks_count(key: str, text: str) -> None:
    """Powers of R(hJ) grow linearly where |R| = 1, at the limit itself, where that is rational seen, or before it."""
    bound = facts(key, text).step_limit
    wanted, attained = JORDAN[key, text]
    assert (limit_text(bound.limit), bound.attained) == (wanted, attained)
    assert grows(facts(key, text), just_inside(bound.limit)) == (wanted == "0")
    if isinstance(bound.limit, RealRoot) and bound.limit.rational:
        assert grows(facts(key, text), bound.limit.rational) == (not attained)


def just_inside(limit: Limit) -> Q:
    """A rational step just below the limit; 1/3 where that is 0 or oo."""
    if not isinstance(limit, RealRoot) or limit == ZERO_ROOT:
        return Q(1, 3)
    with ctx.workprec(200):
        return Q(99, 100) * endpoints(limit.ball())[0]


def grows(found: SystemFacts, h: Q) -> bool:
    """Are the entries of M(h)**1024 more than 50 times those of M(h)**16, in balls?"""
    with ctx.workprec(4000):
        matrix = acb_mat([[at(entry, arb(fmpq(h.numerator, h.denominator))) for entry in row] for row in found.matrix])
        sizes = [max(float(abs(x).mid()) for x in (matrix**n).entries()) for n in (16, 1024)]
    return sizes[1] > 50 * max(sizes[0], 1e-6) and sizes[1] > 10


@pytest.mark.parametrize("key", ["velocity_verlet", "nystrom4"])
@pytest.mark.parametrize("text", [DAMPED, "-1", "0 2; -1 0", "0 1 0; 0 0 1; -1 -1 -1/2"])
def test_a_partitioned_method_needs_positions_and_velocities(key: str, text: str) -> None:
    with pytest.raises(ValueError, match=rf"{key} needs a system q' = v, v' = Kq: the matrix must be"):
        facts(key, text)


def test_matrix_of_a_runge_kutta_step_is_computed_only_when_asked_for() -> None:
    """Over a number field, of fifteen components, it takes a minute."""
    found = SystemFacts(METHODS["sdirk2"], parse_system(DAMPED))
    assert found.step_limit == ALWAYS
    assert "matrix" not in vars(found)
    assert len(found.matrix) == 2


STIFF = "0 1; -1000000 0"
STEPS = [Q(1, 1000), Q(1, 7), Q(1, 2), Q(3, 2), Q(9, 5), Q(5, 2), Q(3), Q(40)]


def radius_ends(found: SystemFacts, h: Q) -> tuple[Q, Q]:
    """Ends of an enclosure of the spectral radius of M(h)."""
    with ctx.workprec(300):
        return endpoints(radius(found, enclose(h)))


UNDAMPED, WITH_DAMPING = ("0 1; -1 0", SPRINGS, STIFF), (DAMPED, COUPLED)
SYSTEMS = [(key, text) for key in ("forward_euler", "rk4", "sdirk2") for text in (*UNDAMPED, *WITH_DAMPING)]
SYSTEMS += [(key, text) for key in ("velocity_verlet", "ruth3") for text in UNDAMPED]
SYSTEMS += [("gauss2", text) for text in WITH_DAMPING]


@pytest.mark.parametrize(("key", "text"), SYSTEMS)
def test_verdict_is_that_of_the_spectral_radius_where_that_is_not_one(key: str, text: str) -> None:
    found = facts(key, text)
    decided = 0
    for h in STEPS:
        low, high = radius_ends(found, h)
        if high < 1 or low > 1:
            decided += 1
            assert found.bounded_at(h) is (high < 1)
    assert decided


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
    ("backward_euler", "1", Q(2), (False, True, True)),  # growth, which large steps damp
    ("velocity_verlet", "0 1; 1 0", Q(1, 2), (False, False, False)),  # a saddle: e^t is a solution
]


@pytest.mark.parametrize(("key", "text", "turn", "verdicts"), TURNS)
def test_verdict_turns_at_the_limit(key: str, text: str, turn: Q | None, verdicts: tuple[bool, bool, bool]) -> None:
    found = facts(key, text)
    if turn is None:  # an irrational limit: doubles on either side
        with ctx.workprec(200):
            turn = Q(float(found.step_limit.limit.ball().mid()))  # type: ignore[union-attr]
        near = [found.bounded_at(turn * (1 + Q(k, 2**50))) for k in (-1, 1)]
        assert near == [True, False]
        return
    near_by = Q(1, 10**30)
    assert tuple(found.bounded_at(turn * x) for x in (1 - near_by, Q(1), 1 + near_by)) == verdicts


@pytest.mark.parametrize("key", ["rk4", "symplectic_euler", "radau_iia2", "yoshida4", "implicit_nystrom"])
@pytest.mark.parametrize("h", [Q(1, 3), Q(5, 2)])
@pytest.mark.parametrize("text", ["0 1; -4 0", "0 1; -2 0", "0 1; 3 0", "0 0 1 0; 0 0 0 1; 0 1 0 0; -1 0 0 0"])
def test_factor_is_the_spectral_radius_of_the_matrix(key: str, h: Q, text: str) -> None:
    """At rational and irrational frequencies, where the solution grows, and where an eigenvalue is truly complex.

    All eigenvalues of each system have one modulus, so the factor of the stiffest is the largest of all.
    """
    found = SystemFacts(METHODS.get(key, MIDPOINT_NYSTROM), parse_system(text))
    low, high = radius_ends(found, h)
    with ctx.workprec(300):
        factors = [enclose(found.factor_at(limit.eigenvalue, h)) for limit in found.bounds]
        assert all(factor.rad() < arb(2) ** -200 for factor in factors)
        assert not any(factor > fmpq(*high.as_integer_ratio()) for factor in factors)
        assert abs(enclose(found.stiffest_factor(h)) - fmpq(*low.as_integer_ratio())) < arb(2) ** -190


def test_stiffest_factor_is_that_of_the_eigenvalue_of_largest_modulus() -> None:
    """Of -1 and -1000 that of -1000; of ±i and -1/8 that of ±i; of 1 and -1 the larger one, 1/|1 - 3|."""
    assert facts("forward_euler", "998 1998; -999 -1999").stiffest_factor(Q(1, 2000)) == Q(1, 2)
    assert facts("backward_euler", "1 0; 0 -1").stiffest_factor(Q(3)) == Q(1, 2)
    turning = enclose(facts("backward_euler", "0 1 0; -1 0 0; 0 0 -1/8").stiffest_factor(Q(1)))
    assert float(turning) == pytest.approx(sqrt(1 / 2))
    # 1 - h + ... of -1, or sqrt(1 - h⁶/72 + ...) of ±i, which no float tells apart at this h
    found = facts("rk4", "-1 0 0; 0 0 1; 0 -1 0").stiffest_factor(Q(1, 10**20))
    assert significant(lambda: 1 - enclose(found), 2) == "6.9e-123"


@pytest.mark.parametrize(
    ("key", "text", "h", "factor"),
    [
        *(("heun2", "0 1; -5/4 -2", Q(1), Q(3, 8)), ("heun2", "0 1; -2 -4", Q(1, 2), Q(3, 4))),
        *(("heun2", "0 1; -2 -2", Q(1), Q(0)), ("kutta3", "0 1 0; 0 0 1; -3 -6 -3", Q(1), Q(1, 2))),
        ("velocity_verlet", "0 1; -2 0", Q(3, 2), Q(2)),
    ],
)
def test_factors_that_are_rational_are_fractions_at_irrational_and_complex_eigenvalues(key, text, h, factor) -> None:
    """(1 - w²)/2 at -1 ± wi, 3/4 at both of -2 ± √2, 0, 1/2 at three roots of a cubic; 2 beside 1/2 at ±√2 i."""
    found = facts(key, text)
    assert [found.factor_at(limit.eigenvalue, h) for limit in found.bounds] == [factor] * len(found.bounds)
    near = found.factor_at(found.bounds[0].eigenvalue, h + Q(1, 7))
    assert callable(near)
    assert abs(enclose(near) - fmpq(*factor.as_integer_ratio())) > 2**-9


def test_what_is_not_decided_is_refused() -> None:
    with pytest.raises(UndecidedLimitError, match="only simple"):
        facts("symplectic_euler", STUCK).bounded_at(Q(1, 2))
    blocks = "0 1 0 1 0 0; 0 0 1 0 1 0; -1 -1 -1/2 0 0 1; 0 0 0 0 1 0; 0 0 0 0 0 1; 0 0 0 -1 -1 -1/2"
    with pytest.raises(UndecidedLimitError, match="with a Jordan block"):
        facts("rk4", blocks).bounded_at(Q(1, 2))
    reversed_kick = Splitting("mine", "It turns where the solution grows", 0, "", (("kick", -1), ("drift", 1)))
    assert SystemFacts(reversed_kick, parse_system("0 1; 1 0")).step_limit == (rational_root(Q(2)), False)
    with pytest.raises(UndecidedLimitError, match="a Jordan block"):
        assert SystemFacts(reversed_kick, parse_system("0 0 1 0; 0 0 0 1; 1 1 0 0; 0 1 0 0")).step_limit
