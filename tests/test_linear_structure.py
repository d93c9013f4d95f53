"""Symplecticity and symmetry of the irreducible method, SSP coefficients, order reduction, points of the boundary."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_mat, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from driftproof import strategies
from methods.number_field import square_root
from methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from symbolic.linear.irreducible import Stages, matchings, reduced, stages_of
from symbolic.linear.limits import INFINITY, data
from symbolic.linear.monotonicity import monotonicity_conditions, ssp_coefficient
from symbolic.linear.order_reduction import prothero_robinson
from symbolic.linear.oscillator import is_matrix_symmetric, one_step_matrix, stability_function_of
from symbolic.linear.polynomials import at_ball, coefficients, exact, polynomial, scalar
from symbolic.linear.rational_functions import RationalFunction, fraction
from symbolic.linear.real_roots import ZERO, RealRoot
from symbolic.linear.region import boundary_points, points_at
from symbolic.linear.stability_function import stability_function
from symbolic.linear.structure import (
    adjoint,
    is_first_same_as_last,
    is_stiffly_accurate,
    is_symmetric,
    is_symplectic,
    reduced_word,
    symplectic_residuals,
)
from tests.nine import NINE

Z = fmpq_poly([0, 1])
ROOT_2, ROOT_3 = square_root(2), square_root(3)


def runge_kutta(a: Any, b: Any) -> RungeKutta:
    rows = tuple(tuple(x + Q(0) for x in row) for row in a)
    return RungeKutta("given", "Given", 0, "x", rows, tuple(b), tuple(sum(row, Q(0)) for row in rows))


GAUSS_2 = runge_kutta(((Q(1, 4), Q(1, 4) - ROOT_3 / 6), (Q(1, 4) + ROOT_3 / 6, Q(1, 4))), (Q(1, 2), Q(1, 2)))
MIDPOINT = runge_kutta(((Q(1, 2),),), (1,))
TRAPEZOID = runge_kutta(((0, 0), (Q(1, 2), Q(1, 2))), (Q(1, 2), Q(1, 2)))
# One point three times over: the last stage counts for nothing, the first two are the midpoint rule's.
MIDPOINT_THRICE = runge_kutta(((Q(1, 2), 0, 0), (Q(1, 3), Q(1, 6), 0), (0, 7, 7)), (Q(1, 4), Q(3, 4), 0))
LOBATTO_IIIB_2 = runge_kutta(((Q(1, 2), 0), (Q(1, 2), 0)), (Q(1, 2), Q(1, 2)))
RADAU_IIA_2 = runge_kutta(((Q(5, 12), Q(-1, 12)), (Q(3, 4), Q(1, 4))), (Q(3, 4), Q(1, 4)))
SDIRK = runge_kutta(((1 - ROOT_2 / 2, 0), (ROOT_2 / 2, 1 - ROOT_2 / 2)), (ROOT_2 / 2, 1 - ROOT_2 / 2))
QIN_ZHANG = runge_kutta(((Q(1, 4), 0), (Q(1, 2), Q(1, 4))), (Q(1, 2), Q(1, 2)))
GAUSS_3 = Collocation("gauss3", "Gauss", 6, "x", (Q(-1, 20), Q(3, 5), Q(-3, 2), Q(1)))
RADAU_3 = Collocation("radau3", "Radau", 5, "x", (Q(-1, 10), Q(9, 10), Q(-9, 5), Q(1)))
LOBATTO_3 = Collocation("lobatto3", "Lobatto", 4, "x", (0, Q(1, 2), Q(-3, 2), Q(1)))
STORMER = Nystrom("stormer", "Störmer", 2, "x", (Q(0), Q(1)), ((0, 0), (Q(1, 2), 0)), (Q(1, 2), 0), (Q(1, 2), Q(1, 2)))
NYSTROM_4 = Nystrom(
    "nystrom4",
    "Nyström",
    4,
    "x",
    (Q(0), Q(1, 2), Q(1)),
    ((0, 0, 0), (Q(1, 8), 0, 0), (0, Q(1, 2), 0)),
    (Q(1, 6), Q(1, 3), Q(0)),
    (Q(1, 6), Q(4, 6), Q(1, 6)),
)
EXAMPLES = {
    "gauss2": (GAUSS_2, True, True),
    "midpoint": (MIDPOINT, True, True),
    "trapezoid": (TRAPEZOID, False, True),
    "midpoint with three stages": (MIDPOINT_THRICE, True, True),
    "lobatto_iiib2, the midpoint rule in disguise": (LOBATTO_IIIB_2, True, True),
    "radau_iia2": (RADAU_IIA_2, False, False),
    "qin_zhang": (QIN_ZHANG, True, True),
    "gauss3": (GAUSS_3, True, True),
    "radau3": (RADAU_3, False, False),
    "lobatto3": (LOBATTO_3, False, True),
    "stormer": (STORMER, True, True),
    "nystrom4": (NYSTROM_4, False, False),
    "rk4": (NINE["rk4"], False, False),
    "velocity_verlet": (NINE["velocity_verlet"], True, True),
    "symplectic_euler": (NINE["symplectic_euler"], True, False),
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_symplectic_and_symmetric(name: str) -> None:
    method, symplectic, symmetric = EXAMPLES[name]
    assert (is_symplectic(method), is_symmetric(method)) == (symplectic, symmetric)


@pytest.mark.parametrize("name", EXAMPLES)
def test_what_holds_for_every_problem_holds_for_the_oscillator(name: str) -> None:
    method, symplectic, symmetric = EXAMPLES[name]
    m = one_step_matrix(method)
    (qq, qv), (vq, vv) = m
    area = qq * vv - qv * vq
    assert not symplectic or area == fraction(fmpq_poly([1]))
    assert not symmetric or is_matrix_symmetric(m)


def test_trapezoid_looks_symplectic_on_the_oscillator_and_is_not() -> None:
    assert one_step_matrix(TRAPEZOID) == one_step_matrix(MIDPOINT)
    assert symplectic_residuals(stages_of(TRAPEZOID)) == {"1,1": Q(-1, 4), "2,2": Q(1, 4)}


def test_a_coefficient_off_by_ten_to_the_minus_thirty_is_noticed() -> None:
    off = Q(1, 10**30)
    rows = ((Q(1, 4) + off, GAUSS_2.a[0][1]), GAUSS_2.a[1])
    assert not is_symplectic(runge_kutta(rows, GAUSS_2.b))
    assert not is_symmetric(runge_kutta(rows, GAUSS_2.b))
    nodes = tuple(x + (off if k == 0 else 0) for k, x in enumerate(GAUSS_3.node_polynomial))
    assert not is_symplectic(Collocation("off", "Off", 0, "x", nodes))


def test_irreducible_form_of_a_method_in_disguise() -> None:
    assert reduced(stages_of(MIDPOINT_THRICE)) == Stages(((Q(1, 2),),), ((Q(1),),), (Q(1, 2),))
    assert reduced(stages_of(LOBATTO_IIIB_2)).weights == ((Q(1),),)
    assert reduced(stages_of(GAUSS_2)) == stages_of(GAUSS_2)
    assert len(reduced(stages_of(runge_kutta(((0, 0), (1, 0)), (0, 0)))).a) == 1
    assert symplectic_residuals(stages_of(LOBATTO_IIIB_2))  # as it stands it does not satisfy the condition


@given(strategies.runge_kutta_methods(max_stages=4))
def test_irreducible_form_has_the_same_r(method: RungeKutta) -> None:
    small = reduced(stages_of(method))
    again = RungeKutta("small", "Small", 0, "x", small.a, small.weights[0], small.c)
    assert stability_function(again) == stability_function(method)
    assert reduced(small) == small


@given(strategies.runge_kutta_methods(max_stages=3), st.permutations(range(3)))
def test_a_permuted_method_is_recognised(method: RungeKutta, order: list[int]) -> None:
    order = [i for i in order if i < method.stages]
    permuted = Stages(
        tuple(tuple(method.a[i][j] for j in order) for i in order),
        (tuple(method.b[i] for i in order),),
        tuple(method.c[i] for i in order),
    )
    assert next(matchings(permuted, stages_of(method)), None) is not None


def test_adjoint_twice_is_the_method() -> None:
    for method in (GAUSS_2, RADAU_IIA_2, NYSTROM_4, STORMER):
        assert adjoint(adjoint(stages_of(method))) == stages_of(method)
    assert adjoint(stages_of(RADAU_IIA_2)) != stages_of(RADAU_IIA_2)


def test_adjoint_of_a_nystrom_method_inverts_its_matrix() -> None:
    other = adjoint(stages_of(NYSTROM_4))
    back = Nystrom("adjoint", "Adjoint", 4, "x", other.c, other.a, *other.weights)
    m, n = one_step_matrix(NYSTROM_4), one_step_matrix(back)
    h = fmpq(1, 3)
    forward, backward = (fmpq_mat([[f(s * h) for f in row] for row in x]) for x, s in ((m, -1), (n, 1)))
    assert forward * backward == fmpq_mat([[1, 0], [0, 1]])


def test_reduced_word_of_a_splitting() -> None:
    parts = (("kick", Q(1, 4)), ("drift", Q(0)), ("kick", Q(1, 4)), ("drift", Q(1)), ("kick", Q(1, 2)))
    method = Splitting("verlet", "Verlet", 2, "x", parts)
    assert reduced_word(method) == list(NINE["velocity_verlet"].parts)
    assert is_symmetric(method)
    nothing = Splitting("nothing", "Nothing", 0, "x", (("kick", Q(1)), ("drift", Q(0)), ("kick", Q(-1))))
    assert reduced_word(nothing) == []


def test_stiff_accuracy_and_the_first_stage() -> None:
    assert [is_stiffly_accurate(m) for m in (RADAU_IIA_2, RADAU_3, LOBATTO_3, TRAPEZOID)] == [True] * 4
    assert [is_stiffly_accurate(m) for m in (GAUSS_2, GAUSS_3, NINE["rk4"], NINE["position_verlet"])] == [False] * 4
    assert [is_first_same_as_last(m) for m in (TRAPEZOID, LOBATTO_3, RADAU_3, RADAU_IIA_2)] == [
        True,
        True,
        False,
        False,
    ]


# ---- SSP

SSP: dict[str, tuple[RungeKutta, str]] = {
    "forward Euler": (NINE["forward_euler"], "1"),
    "SSP(2,2)": (NINE["heun2"], "1"),
    "SSP(3,3)": (runge_kutta(((0, 0, 0), (1, 0, 0), (Q(1, 4), Q(1, 4), 0)), (Q(1, 6), Q(1, 6), Q(2, 3))), "1"),
    "SSP(3,2)": (runge_kutta(((0, 0, 0), (Q(1, 2), 0, 0), (Q(1, 2), Q(1, 2), 0)), (Q(1, 3), Q(1, 3), Q(1, 3))), "2"),
    "SSP(4,3)": (
        runge_kutta(
            ((0, 0, 0, 0), (Q(1, 2), 0, 0, 0), (Q(1, 2), Q(1, 2), 0, 0), (Q(1, 6), Q(1, 6), Q(1, 6), 0)),
            (Q(1, 6), Q(1, 6), Q(1, 6), Q(1, 2)),
        ),
        "2",
    ),
    "classical RK4": (NINE["rk4"], "0"),
    "explicit midpoint": (NINE["midpoint2"], "0"),
    "Ralston": (runge_kutta(((0, 0), (Q(2, 3), 0)), (Q(1, 4), Q(3, 4))), "1/2"),
    "backward Euler": (runge_kutta(((1,),), (1,)), "oo"),
    "implicit midpoint": (MIDPOINT, "2"),
    "trapezoid": (TRAPEZOID, "2"),
    "SDIRK with sqrt(2)": (SDIRK, "1 + sqrt(2)"),
    "Gauss 2": (GAUSS_2, "0"),
}  # fmt: skip


@pytest.mark.parametrize("name", SSP)
def test_ssp_coefficient_of(name: str) -> None:
    method, radius = SSP[name]
    assert data(ssp_coefficient(method))["exact"] == radius


def ssp_10_4() -> RungeKutta:
    """The ten-stage method of order 4 (ketcheson-2008)."""
    rows = [[Q(1, 6)] * i + [Q(0)] * (10 - i) for i in range(5)]
    rows += [[Q(1, 15)] * 5 + [Q(1, 6)] * (i - 5) + [Q(0)] * (10 - i) for i in range(5, 10)]
    return runge_kutta(rows, [Q(1, 10)] * 10)


def test_ssp_coefficient_of_the_ten_stage_method_is_six() -> None:
    assert data(ssp_coefficient(ssp_10_4()))["exact"] == "6"
    assert data(ssp_coefficient(MIDPOINT_THRICE))["exact"] == "2"  # of the irreducible form


@pytest.mark.parametrize("name", ["SSP(3,3)", "SSP(4,3)", "SSP(3,2)", "Ralston", "implicit midpoint"])
def test_conditions_hold_inside_the_radius_and_not_beyond(name: str) -> None:
    """The second formula: K(I + rK)⁻¹ by a solve with rational matrices at r (1 ± 10⁻¹²)."""
    method, text = SSP[name]
    radius = Q(text)
    for r, holds in ((radius * Q(10**12 - 1, 10**12), True), (radius, True), (radius * Q(10**12 + 1, 10**12), False)):
        assert _monotonic(method, r) == holds


def _monotonic(method: RungeKutta, r: Q) -> bool:
    size = method.stages + 1
    k = fmpq_mat([[*map(scalar, row), 0] for row in (*method.a, method.b)])
    identity = fmpq_mat([[int(i == j) for j in range(size)] for i in range(size)])
    inverse = k * (identity + k * scalar(r)).inv()
    rows = [[inverse[i, j] for j in range(size)] for i in range(size)]
    return all(x >= 0 for row in rows for x in row) and all(sum(row) * scalar(r) <= 1 for row in rows)


def test_monotonicity_conditions_by_two_ways() -> None:
    """The nilpotent series against the adjugate: an implicit method with a diagonal of zero size."""
    stages = stages_of(SSP["SSP(4,3)"][0])
    explicit = monotonicity_conditions(stages)
    at = [p(fmpq(3, 5)) for p in explicit]
    size = len(stages.a)
    shifted = fmpq_mat(
        [[int(i == j) + fmpq(3, 5) * scalar(x) for j, x in enumerate(row)] for i, row in enumerate(stages.a)]
    )
    inverse = fmpq_mat([[scalar(x) for x in row] for row in (*stages.a, *stages.weights)]) * shifted.inv()
    assert {inverse[i, j] for i in range(size + 1) for j in range(size)} - {fmpq(0)} <= set(at)


# ---- order reduction


def test_order_reduction_functions_of_sdirk_and_radau() -> None:
    """ψₖ vanishes up to the stage order; Radau IIA is stiffly accurate: ψ tends to 0 as z grows."""
    zero = fraction(fmpq_poly())
    for power in (1, 2):
        assert prothero_robinson(RADAU_IIA_2, power) == zero
    third = prothero_robinson(RADAU_IIA_2, 3)
    assert third != zero
    assert third.at_infinity() == 0
    assert prothero_robinson(MIDPOINT, 1) == zero
    assert prothero_robinson(MIDPOINT, 2).at_infinity() == Q(1, 4)
    with pytest.raises(ValueError, match="numbered from 1"):
        prothero_robinson(MIDPOINT, 0)


@pytest.mark.parametrize("stages", [GAUSS_3, RADAU_3, LOBATTO_3])
def test_collocation_has_stage_order_s(stages: Collocation) -> None:
    zero = fraction(fmpq_poly())
    assert [prothero_robinson(stages, k) == zero for k in range(1, 5)] == [True, True, True, False]


def test_order_reduction_by_nodes_and_by_the_monomial_basis() -> None:
    by_nodes = Collocation("gauss2", "Gauss", 4, "x", (Q(1, 6), Q(-1), Q(1)))
    for power in range(1, 7):
        assert prothero_robinson(GAUSS_2, power) == prothero_robinson(by_nodes, power)


@pytest.mark.parametrize("method", [NINE["rk4"], RADAU_IIA_2, MIDPOINT, QIN_ZHANG])
def test_error_on_prothero_and_robinsons_problem(method: RungeKutta) -> None:
    """φ = t³ and a step from t = 1 by the stage equations, solved over Q: the error is Σ ψₖ(z) hᵏ φ⁽ᵏ⁾(1), exactly."""
    h, z, start = Q(1, 5), Q(-7, 3), Q(1)
    size, lam = method.stages, z / h
    times = [start + c * h for c in method.c]
    forcing = [3 * t**2 - lam * t**3 for t in times]
    # kᵢ = λ(y₀ + h Σ aᵢⱼ kⱼ) + forcingᵢ
    matrix = fmpq_mat([[scalar(Q(int(i == j)) - z * x) for j, x in enumerate(row)] for i, row in enumerate(method.a)])
    slopes = matrix.inv() * fmpq_mat(size, 1, [scalar(lam * start**3 + f) for f in forcing])
    end = start**3 + h * sum(b * exact(slopes[i, 0]) for i, b in enumerate(method.b))
    derivatives = {1: 3 * start**2, 2: 6 * start, 3: Q(6)}
    error = sum(exact(prothero_robinson(method, k)(scalar(z))) * h**k * d for k, d in derivatives.items())
    assert (start + h) ** 3 - end == error
    assert error != 0


# ---- the boundary of the stability region


@pytest.mark.parametrize("name", ["rk4", "gauss2", "radau_iia2", "sdirk"])
def test_boundary_points_have_modulus_one(name: str) -> None:
    method = {"rk4": NINE["rk4"], "gauss2": GAUSS_2, "radau_iia2": RADAU_IIA_2, "sdirk": SDIRK}[name]
    r = stability_function_of(method)
    assert r is not None
    points = boundary_points(r, 4, bits=100)
    assert len({point.cosine for point in points}) == 9
    with ctx.workprec(400):
        for cosine, z in points:
            value = _at(r, z)
            assert abs(value).contains(1)
            assert value.real.contains(fmpq(*cosine.as_integer_ratio()))
            assert abs(value).rad() < arb(2) ** -60


def _at(r: RationalFunction, z: acb) -> acb:
    num, den = (acb_poly([at_ball(fmpq_poly([1]) * c, arb(0)) for c in p.coeffs()]) for p in (r.num, r.den))
    return num(z) / den(z)


def test_boundary_on_the_axes_is_where_the_limits_are() -> None:
    r = stability_function_of(NINE["rk4"])
    assert r is not None
    real = [z for z in points_at(r, Q(1)) if z.imag.is_zero()]
    limit = RealRoot((-24, 12, -4, 1), 0)
    assert any((-z.real).overlaps(limit.ball()) for z in real)
    assert points_at(fraction(fmpq_poly([1])), Q(1, 2)) == []


def test_multiple_boundary_points_are_found_once() -> None:
    """T₁₀ touches ±1: double roots of R = ±1; over Q(√3) too."""
    before, now = fmpq_poly([1]), 1 + Z / 100
    for _ in range(9):
        before, now = now, 2 * (1 + Z / 100) * now - before
    assert len(points_at(fraction(now), Q(1))) == 6
    assert len(points_at(fraction(now), Q(-1))) == 5
    square = polynomial([1, ROOT_3]) * polynomial([1, ROOT_3])
    assert len(points_at(fraction(1 + square - square[0], fmpq_poly([1])), Q(1))) == 2
    assert len(points_at(fraction(square), Q(1))) == 2
    (double,) = points_at(fraction(square * square * 2 - 1), Q(-1))
    assert (double.real + 1 / arb(3).sqrt()).contains(0)
    assert coefficients(square)[1] == 2 * ROOT_3
    assert ZERO is not INFINITY
