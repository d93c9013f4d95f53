"""One-step matrices, conserved quadratics, modified Hamiltonians, phase: against exponentials, shears and solves."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import acb, acb_poly, arb, arb_mat, ctx, fmpq, fmpq_mat, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from driftproof import strategies
from methods.number_field import cube_root, square_root
from methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from symbolic.energy import energy_multiplier as polynomial_multiplier
from symbolic.linear.invariants import (
    conserved_quadratics,
    definite_limit,
    modified_hamiltonian,
    quadratics_by_elimination,
)
from symbolic.linear.limits import INFINITY, data
from symbolic.linear.matrices import StepMatrix, product
from symbolic.linear.oscillator import (
    determinant,
    energy_multiplier,
    energy_multiplier_of,
    is_matrix_symmetric,
    linear_step_matrix,
    one_step_matrix,
    spread,
    stability_function_of,
    trace,
)
from symbolic.linear.phase import (
    angle_error,
    angle_series,
    damping,
    damping_series,
    dispersion,
    dispersion_series,
    dissipation,
    dissipation_series,
    error_constant,
    is_linearly_symmetric,
    linear_order,
    matrix_error,
    modified_factor_series,
    modified_rate,
)
from symbolic.linear.polynomials import at_ball, coefficients, evaluate, exact, from_scalars, polynomial, scalar
from symbolic.linear.rational_functions import RationalFunction, fraction
from symbolic.linear.text import polynomial_text
from symbolic.one_step import entries
from symbolic.one_step import one_step_matrix as polynomial_matrix
from tests.nine import NINE

Z = fmpq_poly([0, 1])
ONE, NIL = fraction(fmpq_poly([1])), fraction(fmpq_poly())
ROOT_3 = square_root(3)


def runge_kutta(a: Any, b: Any, c: Any) -> RungeKutta:
    return RungeKutta("given", "Given", 0, "butcher-2016, 231", a, b, c)


GAUSS_2 = runge_kutta(
    ((Q(1, 4), Q(1, 4) - ROOT_3 / 6), (Q(1, 4) + ROOT_3 / 6, Q(1, 4))),
    (Q(1, 2), Q(1, 2)),
    (Q(1, 2) - ROOT_3 / 6, Q(1, 2) + ROOT_3 / 6),
)
MIDPOINT = runge_kutta(((Q(1, 2),),), (Q(1),), (Q(1, 2),))
BACKWARD = runge_kutta(((Q(1),),), (Q(1),), (Q(1),))
GAUSS_3 = Collocation("gauss3", "Gauss", 6, "hairer-wanner-1996, IV.5", (Q(-1, 20), Q(3, 5), Q(-3, 2), Q(1)))
W = 1 / (2 - cube_root(2))
TRIPLE_JUMP = Splitting(
    "triple_jump",
    "Triple jump",
    4,
    "yoshida-1990, 4",
    (("drift", W / 2), ("kick", W), ("drift", (1 - W) / 2), ("kick", 1 - 2 * W), ("drift", (1 - W) / 2), ("kick", W),
     ("drift", W / 2)),
)  # fmt: skip
# The implicit midpoint rule for q'' = F(q): Ā = A², b̄ = bA.
MIDPOINT_NYSTROM = Nystrom("nystrom", "Nyström", 2, "x", (Q(1, 2),), ((Q(1, 4),),), (Q(1, 2),), (Q(1),))
EXPLICIT_NYSTROM = Nystrom(
    "nystrom4",
    "Nyström 4",
    4,
    "nystrom-1925, 9",
    (Q(0), Q(1, 2), Q(1)),
    ((0, 0, 0), (Q(1, 8), 0, 0), (0, Q(1, 2), 0)),
    (Q(1, 6), Q(1, 3), Q(0)),
    (Q(1, 6), Q(4, 6), Q(1, 6)),
)
MORE: dict[str, Method] = {
    "gauss2": GAUSS_2,
    "midpoint": MIDPOINT,
    "backward": BACKWARD,
    "gauss3": GAUSS_3,
    "triple_jump": TRIPLE_JUMP,
    "nystrom_implicit": MIDPOINT_NYSTROM,
    "nystrom_explicit": EXPLICIT_NYSTROM,
}
EVERY: dict[str, Method] = {**NINE, **MORE}


# ---- matrices


@pytest.mark.parametrize("key", NINE)
def test_matrix_is_the_one_that_the_step_gives_on_sympys_polynomials(key: str) -> None:
    ours = one_step_matrix(NINE[key])
    theirs = entries(polynomial_matrix(NINE[key]))
    for entry, other in zip((*ours[0], *ours[1]), theirs, strict=True):
        wanted = {power: Q(int(c.numerator), int(c.denominator)) for (power,), c in other.terms()}
        assert {k: c for k, c in enumerate(coefficients(entry.num)) if c} == wanted
        assert entry.den == ONE.den


@given(strategies.splittings(max_pairs=3))
def test_matrix_of_a_splitting_is_the_product_of_its_shears(method: Splitting) -> None:
    total = [[ONE, NIL], [NIL, ONE]]
    for kind, c in method.parts:
        shear = [[ONE, NIL], [fraction(-scalar(c) * Z), ONE]]
        if kind == "drift":
            shear = [[ONE, fraction(scalar(c) * Z)], [NIL, ONE]]
        total = [[x * p + y * r for p, r in zip(*total, strict=True)] for x, y in shear]
    assert one_step_matrix(method) == tuple(map(tuple, total))


@pytest.mark.parametrize("key", ["gauss2", "midpoint", "backward", "gauss3"])
def test_implicit_step_solves_its_equations(key: str) -> None:
    """Q(hJ) M = P(hJ), multiplied out."""
    m, r = one_step_matrix(MORE[key]), stability_function_of(MORE[key])
    assert r is not None
    num, den = (_at_rotation(p) for p in (r.num, r.den))
    left = [[den[i][0] * m[0][j] + den[i][1] * m[1][j] for j in range(2)] for i in range(2)]
    assert left == num
    assert m == linear_step_matrix(MORE[key], [[0, 1], [-1, 0]])


def _at_rotation(p: Any) -> list[list[RationalFunction]]:
    cosine = from_scalars([c * (1, 0, -1, 0)[k % 4] for k, c in enumerate(p.coeffs())])
    sine = from_scalars([c * (0, 1, 0, -1)[k % 4] for k, c in enumerate(p.coeffs())])
    return [[fraction(cosine), fraction(sine)], [fraction(-sine), fraction(cosine)]]


def test_implicit_nystrom_is_the_implicit_midpoint_rule() -> None:
    assert one_step_matrix(MIDPOINT_NYSTROM) == one_step_matrix(MIDPOINT)
    twin = Nystrom("nystrom", "Nyström", 2, "x", (Q(1, 2),), ((Q(1, 5),),), (Q(1, 2),), (Q(1),))
    assert one_step_matrix(twin) != one_step_matrix(MIDPOINT)


SYSTEMS: dict[str, list[list[Q | int]]] = {
    "two springs": [[0, 0, 1, 0], [0, 0, 0, 1], [-2, 1, 0, 0], [1, -2, 0, 0]],
    "a saddle": [[0, 1], [Q(1, 3), 0]],
    "a general matrix": [[1, Q(1, 2), 0], [-3, 0, 2], [0, 1, -1]],
    "a Jordan block": [[2, 1], [0, 2]],
}


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("key", ["rk4", "backward", "midpoint", "gauss3"])
def test_linear_step_is_p_over_q_of_the_matrix(name: str, key: str) -> None:
    rows, r = SYSTEMS[name], stability_function_of(EVERY[key])
    assert r is not None
    m, h = linear_step_matrix(EVERY[key], rows), fmpq(2, 7)
    a = fmpq_mat([[scalar(x) * h for x in row] for row in rows])
    num, den = (_power_sum(p, a) for p in (r.num, r.den))
    assert den * fmpq_mat([[entry(h) for entry in row] for row in m]) == num


def _power_sum(p: Any, a: Any) -> Any:
    total = a * 0
    identity = fmpq_mat([[fmpq(int(i == j)) for j in range(a.ncols())] for i in range(a.nrows())])
    for c in reversed(p.coeffs()):
        total = total * a + identity * c
    return total


def test_splitting_on_coupled_springs() -> None:
    """In the eigenvectors (1, 1) and (1, -1) of K the step is that of the oscillator with ω² = 1 and 3."""
    m = linear_step_matrix(NINE["velocity_verlet"], SYSTEMS["two springs"])
    (qq, qv), (vq, vv) = linear_step_matrix(NINE["velocity_verlet"], [[0, 1], [-3, 0]])
    moved = [row[0] - row[1] for row in m], [row[2] - row[3] for row in m]
    assert moved[0] == [qq, -qq, vq, -vq]
    assert moved[1] == [qv, -qv, vv, -vv]
    nystrom = linear_step_matrix(EXPLICIT_NYSTROM, [[0, 1], [-1, 0]])
    assert nystrom == one_step_matrix(EXPLICIT_NYSTROM)


@pytest.mark.parametrize("rows", [[[0, 1], [-1, 1]], [[0, 2], [-1, 0]], [[0, 1, 0], [0, 0, 1], [1, 0, 0]]])
def test_splitting_refuses_what_is_not_separable(rows: list[list[int]]) -> None:
    with pytest.raises(ValueError, match="splitting needs"):
        linear_step_matrix(NINE["velocity_verlet"], rows)


def test_linear_system_must_be_square_and_exact() -> None:
    with pytest.raises(ValueError, match="square"):
        linear_step_matrix(NINE["rk4"], [[0, 1]])
    with pytest.raises(TypeError, match="exact"):
        linear_step_matrix(NINE["rk4"], [[0.5]])


@pytest.mark.parametrize("key", NINE)
def test_energy_multiplier_agrees_with_the_polynomial_one(key: str) -> None:
    ours = energy_multiplier(one_step_matrix(NINE[key]))
    if isinstance(NINE[key], Splitting):
        assert ours is None
        return
    theirs = polynomial_multiplier(polynomial_matrix(NINE[key]))
    assert ours is not None
    wanted = {power // 2: Q(int(c.numerator), int(c.denominator)) for (power,), c in theirs.terms()}
    assert {k: c for k, c in enumerate(coefficients(ours.num)) if c} == wanted


@pytest.mark.parametrize("key", ["rk4", "backward", "midpoint", "gauss2", "gauss3"])
def test_determinant_is_the_energy_multiplier_of_a_runge_kutta_method(key: str) -> None:
    m, r = one_step_matrix(EVERY[key]), stability_function_of(EVERY[key])
    assert r is not None
    assert energy_multiplier(m) == energy_multiplier_of(r)
    assert determinant(m) == fraction(spread(energy_multiplier_of(r).num), spread(energy_multiplier_of(r).den))


def test_backward_euler_damps_and_the_midpoint_rule_does_not() -> None:
    assert energy_multiplier(one_step_matrix(BACKWARD)) == fraction(fmpq_poly([1]), 1 + Z)
    assert energy_multiplier(one_step_matrix(MIDPOINT)) == ONE


# ---- conserved quadratics


def pulled_back(m: StepMatrix, symmetric: list[list[Any]]) -> list[list[RationalFunction]]:
    """MᵀSM."""
    s = [[fraction(fmpq_poly() + x) for x in row] for row in symmetric]
    size = range(len(m))
    half = [[_sum(s[i][k] * m[k][j] for k in size) for j in size] for i in size]
    return [[_sum(m[k][i] * half[k][j] for k in size) for j in size] for i in size]


def _sum(values: Any) -> RationalFunction:
    total = NIL
    for value in values:
        total = total + value
    return total


@pytest.mark.parametrize("key", EVERY)
def test_quadratics_are_conserved_and_all_of_them(key: str) -> None:
    m = one_step_matrix(EVERY[key])
    forms = conserved_quadratics(m)
    assert len(forms) == (1 if determinant(m) == ONE else 0)
    assert forms == quadratics_by_elimination(m)
    for form in forms:
        s = form.symmetric()
        assert pulled_back(m, s) == [[fraction(fmpq_poly() + x) for x in row] for row in s]
        s[0][0] = s[0][0] + fmpq(1, 10**30)
        assert pulled_back(m, s) != [[fraction(fmpq_poly() + x) for x in row] for row in s]


INVARIANTS = {
    "symplectic_euler": (("1/2", "-h/2", "1/2"), "2"),
    "symplectic_euler_position_first": (("1/2", "h/2", "1/2"), "2"),
    "velocity_verlet": (("1/2 - h**2/8", "0", "1/2"), "2"),
    "position_verlet": (("1/2", "0", "1/2 - h**2/8"), "2"),
    "midpoint": (("1/2", "0", "1/2"), "oo"),
    "gauss2": (("1/2", "0", "1/2"), "oo"),
}


@pytest.mark.parametrize("key", INVARIANTS)
def test_invariants_of_known_methods_and_where_they_are_definite(key: str) -> None:
    (form,) = conserved_quadratics(one_step_matrix(EVERY[key]))
    texts = tuple(polynomial_text(c, "h") for c in form.coefficients)
    assert (texts, data(definite_limit(form))["exact"]) == INVARIANTS[key]


def test_a_higher_dimensional_system_conserves_several_quadratics() -> None:
    """Two uncoupled oscillators of one frequency: for the midpoint rule 4, the energies and two mixed ones."""
    rows = [[0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0], [0, -1, 0, 0]]
    m = linear_step_matrix(MIDPOINT, rows)
    forms = conserved_quadratics(m)
    assert len(forms) == 4
    for form in forms:
        s = form.symmetric()
        assert pulled_back(m, s) == [[fraction(fmpq_poly() + x) for x in row] for row in s]
    assert len(conserved_quadratics(linear_step_matrix(MIDPOINT, SYSTEMS["two springs"]))) == 2
    assert conserved_quadratics(linear_step_matrix(BACKWARD, rows)) == []


def test_the_identity_conserves_every_quadratic() -> None:
    assert len(conserved_quadratics(((ONE, NIL), (NIL, ONE)))) == 3
    assert len(conserved_quadratics(((ONE, NIL), (NIL, -ONE)))) == 2
    half = fraction(fmpq_poly([fmpq(1, 2)]))
    assert len(conserved_quadratics(((ONE, NIL), (NIL, half)))) == 1


# ---- the modified Hamiltonian


SYMPLECTIC = [key for key, method in EVERY.items() if determinant(one_step_matrix(method)) == ONE]


@pytest.mark.parametrize("key", SYMPLECTIC)
def test_flow_of_the_modified_hamiltonian_is_the_step(key: str) -> None:
    """exp(h J S) in balls, at h = 3/4, against M(3/4)."""
    m = one_step_matrix(EVERY[key])
    found = modified_hamiltonian(m)
    assert found is not None
    with ctx.workprec(200):
        h = arb(fmpq(3, 4))
        cosine = _at(found.cosine, h)
        factor = cosine.acos() / (1 - cosine**2).sqrt() * h
        q2, qv, v2 = (_at(f, h) * factor for f in (found.q2, found.qv, found.v2))
        flow = arb_mat([[qv, 2 * v2], [-2 * q2, -qv]]).exp()  # q' = ∂H/∂v, v' = -∂H/∂q
        for i in range(2):
            for j in range(2):
                difference = flow[i, j] - _at(m[i][j], h)
                assert difference.contains(0)
                assert difference.rad() < arb(2) ** -150


def _at(f: RationalFunction, x: arb) -> arb:
    return at_ball(f.num, x) / at_ball(f.den, x)


def test_modified_hamiltonian_of_verlet() -> None:
    found = modified_hamiltonian(one_step_matrix(NINE["velocity_verlet"]))
    assert found is not None
    assert found.cosine == fraction(1 - Z**2 / 2)
    assert (found.q2, found.qv, found.v2) == (fraction(fmpq(1, 2) - Z**2 / 8), NIL, fraction(fmpq_poly([fmpq(1, 2)])))
    assert data(found.limit)["exact"] == "2"
    series = modified_factor_series(one_step_matrix(NINE["velocity_verlet"]), 7)
    assert [str(exact(c)) for c in series] == ["1", "0", "1/6", "0", "1/30", "0", "1/140"]


@pytest.mark.parametrize("key", ["rk4", "forward_euler", "backward"])
def test_there_is_no_modified_hamiltonian_where_area_is_not_conserved(key: str) -> None:
    assert modified_hamiltonian(one_step_matrix(EVERY[key])) is None


def test_there_is_no_modified_hamiltonian_of_a_hyperbolic_step() -> None:
    assert modified_hamiltonian(((fraction(1 + Z**2), fraction(Z)), (fraction(Z), ONE))) is None


# ---- phase and error


PHASES: dict[str, tuple[int, str, tuple[int, str], tuple[int, str] | None]] = {
    "forward_euler": (2, "-1/2", (3, "-1/3"), (2, "1/2")),
    "backward": (2, "1/2", (3, "-1/3"), (2, "-1/2")),
    "midpoint": (3, "1/12", (3, "-1/12"), None),
    "rk4": (5, "-1/120", (5, "-1/120"), (6, "-1/144")),
    "rk38": (5, "-1/120", (5, "-1/120"), (6, "-1/144")),
    "gauss2": (5, "-1/720", (5, "-1/720"), None),
    "gauss3": (7, "1/100800", (7, "-1/100800"), None),
}


@pytest.mark.parametrize("key", PHASES)
def test_error_dispersion_and_dissipation(key: str) -> None:
    r = stability_function_of(EVERY[key])
    assert r is not None
    power, constant, phase, size = PHASES[key]
    assert (error_constant(r).power, str(error_constant(r).coefficient)) == (power, constant)
    assert linear_order(r) == power - 1
    assert (dispersion(r).power, str(dispersion(r).coefficient)) == phase
    found = dissipation(r)
    assert (found and (found.power, str(found.coefficient))) == size
    assert is_linearly_symmetric(r) == (size is None)


@pytest.mark.parametrize("key", PHASES)
def test_phase_by_r_and_by_the_matrix(key: str) -> None:
    r, m = stability_function_of(EVERY[key]), one_step_matrix(EVERY[key])
    assert r is not None
    assert angle_series(m, 14) == dispersion_series(r, 14)
    assert damping_series(m, 14) == dissipation_series(r, 14)
    assert (angle_error(m), damping(m)) == (dispersion(r), dissipation(r))
    assert matrix_error(m)[0] == error_constant(r).power
    assert is_matrix_symmetric(m) == is_linearly_symmetric(r)


ANGLES = {
    "symplectic_euler": (2, (3, "1/24")),
    "velocity_verlet": (3, (3, "1/24")),
    "position_verlet": (3, (3, "1/24")),
}


@pytest.mark.parametrize("key", ANGLES)
def test_splittings_lead_by_h_cubed_over_24(key: str) -> None:
    m = one_step_matrix(NINE[key])
    power, phase = ANGLES[key]
    assert matrix_error(m)[0] == power
    assert (angle_error(m).power, str(angle_error(m).coefficient)) == phase
    assert damping(m) is None
    assert is_matrix_symmetric(m) == key.endswith("verlet")


@pytest.mark.parametrize("key", [*PHASES, *ANGLES, "triple_jump", "nystrom_explicit"])
def test_series_of_the_angle_in_balls(key: str) -> None:
    """At h = 2**-12 the series to h**15 is the angle itself but for a relative 2**-100, say."""
    m = one_step_matrix(EVERY[key])
    with ctx.workprec(400):
        h = arb(2) ** -12
        half, area = _at(trace(m), h) / 2, _at(determinant(m), h)
        angle = acb(half, (area - half**2).sqrt()).arg() - h
        series = sum((_constant(c) * h**k for k, c in enumerate(angle_series(m, 16))), arb(0))
        assert abs(angle - series) < h**15
        wrong = series + h**14
        assert not abs(angle - wrong) < h**15


def _constant(c: Any) -> arb:
    return at_ball(fmpq_poly([1]) * c, arb(0))


@pytest.mark.parametrize("key", ["rk4", "backward", "gauss2"])
def test_modified_rate_exponentiates_to_r(key: str) -> None:
    r = stability_function_of(EVERY[key])
    assert r is not None
    rate = modified_rate(r, 20)
    assert (exact(rate[0]), exact(rate[1])) == (0, 1)
    with ctx.workprec(300):
        z = arb(2) ** -10
        total = sum((_constant(c) * z**k for k, c in enumerate(rate)), arb(0))
        value = acb_poly([_constant(c) for c in r.num.coeffs()])(z) / acb_poly([_constant(c) for c in r.den.coeffs()])(
            z
        )
        assert abs(value - total.exp()) < z**19


def test_an_inconsistent_splitting_has_its_rate_in_a_quadratic_field() -> None:
    """σ² is the sum of the kicks times that of the drifts: 10/9 · 9/10 is consistent, 10/9 needs sqrt(10)."""

    def split(kick: Q, drift: Q) -> StepMatrix:
        parts = (("kick", kick / 2), ("drift", drift), ("kick", kick / 2))
        return one_step_matrix(Splitting("s", "S", 0, "x", parts))

    assert angle_error(split(Q(10, 9), Q(9, 10))).power == 3
    found = angle_error(split(Q(10, 9), Q(1)))
    assert (found.power, str(found.coefficient)) == (1, "-1 + 1/9*sqrt(90)")
    assert angle_error(split(Q(4, 9), Q(1))).coefficient == Q(-1, 3)
    with pytest.raises(ValueError, match="no positive rational"):
        angle_error(split(Q(-1), Q(1)))


@given(st.fractions(-2, 2, max_denominator=9), st.fractions(-2, 2, max_denominator=9))
def test_evaluation_of_a_rational_function(x: Q, y: Q) -> None:
    f = fraction(1 + Z * 2, 3 + Z**2)
    assert exact(f(scalar(x))) == (1 + 2 * x) / (3 + x * x)
    total = f + fraction(Z)
    assert exact(total(scalar(y))) == (1 + 2 * y) / (3 + y * y) + y
    assert exact(evaluate(polynomial([1, 2]), scalar(ROOT_3))) == 1 + 2 * ROOT_3
    assert product([[fmpq(1), fmpq(2)]], [[fmpq(3)], [fmpq(4)]]) == [[11]]
    assert definite_limit(conserved_quadratics(one_step_matrix(MIDPOINT))[0]) is INFINITY
