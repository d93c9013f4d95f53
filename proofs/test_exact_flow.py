"""The oscillator: its equations, exact solution, energy and units."""

from __future__ import annotations

import sympy
from sympy import QQ, Rational, cos, ring, sin, sqrt, symbols

from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.readouts import exact_state
from driftproof.numeric.scenes import PRESETS
from driftproof.symbolic.algebra.certified import certified_sign
from driftproof.symbolic.derivation.one_step import matrix
from proofs.claims import CERTIFIED, PROVED, RESTRICTED, claim
from proofs.derivations.physical import Spring
from proofs.setting import END, LESSON_METHODS, START, M, Real, energy, run

t = symbols("t", real=True)
POSITION, VELOCITY = cos(t), -sin(t)


def rate(q: sympy.Expr, v: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr]:
    """The right-hand side F(q, v) = (v, -q), with the force that all steppers use."""
    return v, oscillator(q)


@claim("L015", evidence=PROVED, by="read off definition")
def test_rate_is_velocity_and_minus_position() -> None:
    """The position changes at rate v, the velocity at rate -q."""
    _, q, v = ring("q, v", QQ)
    assert rate(q, v) == (v, -q)
    assert rate(q, v) != (v, q)


@claim("L057", evidence=PROVED, by="read off definition")
def test_rate_is_linear_with_rotation_generator() -> None:
    """The rate is Jz with J = ((0, 1), (-1, 0)), and J squared is minus the identity."""
    _, q, v = ring("q, v", QQ)
    J = matrix([[0, 1], [-1, 0]])
    assert rate(q, v) == (0 * q + 1 * v, -1 * q + 0 * v)
    assert J * J == matrix([[-1, 0], [0, -1]])


@claim("L016", evidence=PROVED, by="read off definition")
def test_start_is_unit_position_at_rest() -> None:
    """The start is (1, 0), position 1 with velocity 0: there every scene begins."""
    assert START == (1, 0)
    assert {scene.start for scene in PRESETS.values()} == {START}


@claim("L017", evidence=PROVED, by="eliminate, both ways")
def test_second_order_equation_of_first_order_pair() -> None:
    """The pair q' = v, v' = -q is the equation q'' = -q: each follows from the other, with v = q'.

    q'' + q is the derivative of q' - v plus v' + q, so it is 0 where both are; and where v stands for q', the first is
    0 and the second is q'' + q.
    """
    q, v = (sympy.Function(name)(t) for name in "qv")
    rates = rate(q, v)
    first, second = q.diff(t) - rates[0], v.diff(t) - rates[1]
    equation = q.diff(t, 2) + q
    assert sympy.expand(first.diff(t) + second - equation) == 0
    assert [part.subs(v, q.diff(t)).doit() for part in (first, second)] == [0, equation]


@claim("L018", evidence=PROVED, by="checked, and the only one")
def test_solution_is_cosine_and_minus_sine() -> None:
    """The solution that starts at (1, 0) is (cos t, -sin t): it starts there and obeys both equations.

    It is the only one: the difference (a, b) of two obeys them as well, so a² + b² stays what it is at the start, 0.
    """
    a, b = (sympy.Function(name)(t) for name in "ab")
    da, db = rate(a, b)
    assert sympy.expand((a**2 + b**2).diff(t).subs({a.diff(t): da, b.diff(t): db})) == 0
    assert (POSITION.subs(t, 0), VELOCITY.subs(t, 0)) == START
    assert (POSITION.diff(t), VELOCITY.diff(t)) == rate(POSITION, VELOCITY)
    assert (POSITION.diff(t), -VELOCITY.diff(t)) != rate(POSITION, -VELOCITY)


@claim("L019", evidence=PROVED, by="differentiate both components")
def test_derivatives_of_solution() -> None:
    """d/dt cos t = -sin t = v, and d/dt (-sin t) = -cos t = -q."""
    assert POSITION.diff(t) == VELOCITY
    assert VELOCITY.diff(t) == -POSITION


@claim("L020", "L106", evidence=PROVED, by="angular velocity computed")
def test_solution_runs_clockwise_on_unit_circle() -> None:
    """The exact path is the unit circle, run clockwise from (1, 0): radius 1, angular velocity -1."""
    assert (POSITION.subs(t, 0), VELOCITY.subs(t, 0)) == (1, 0)
    assert sympy.trigsimp(POSITION**2 + VELOCITY**2) == 1
    counterclockwise = POSITION * VELOCITY.diff(t) - VELOCITY * POSITION.diff(t)
    assert sympy.trigsimp(counterclockwise) == -1


@claim("L021", evidence=PROVED, by="Hamilton's equations hold")
def test_energy_generates_the_motion() -> None:
    """E = ½(q² + v²) is the energy: ∂E/∂v = q' and -∂E/∂q = v'."""
    _, q, v = ring("q, v", QQ)
    E = (q**2 + v**2) / 2
    assert (E.diff(v), -E.diff(q)) == rate(q, v)


@claim("L022", evidence=PROVED, by="chain rule, expanded")
def test_energy_rate_is_zero() -> None:
    """Along the solution E' = q q' + v v' = q v - v q, and that is 0."""
    _, q, v = ring("q, v", QQ)
    dq, dv = rate(q, v)
    assert q * dq + v * dv == 0
    damped = dv - v
    assert q * dq + v * damped != 0


@claim("L009", evidence=RESTRICTED, by="chain rule, expanded")
def test_undamped_energy_constant_and_forced_not() -> None:
    """Without damping the oscillator keeps its energy.

    Needed: no force f from outside, either; it changes the energy at the rate vf, as damping by -v does at -v².
    """
    _, q, v, f = ring("q, v, f", QQ)
    dq, dv = rate(q, v)
    assert q * dq + v * dv == 0
    assert q * dq + v * (dv - v) == -(v**2)
    assert q * dq + v * (dv + f) == v * f


@claim("L014", evidence=CERTIFIED, by="disjoint enclosures")
def test_every_method_misses_the_known_solution() -> None:
    """The known solution shows what each method gets wrong: at h = ¼ all miss it at t = 10, by different distances."""
    errors = [run(key, PRESETS["default"].h).state_error for key in LESSON_METHODS]
    assert all(certified_sign(error) > 0 for error in errors)
    assert Real(errors[2]) < Real(errors[1])
    assert Real(errors[1]) < Real(errors[0])


@claim("L097", evidence=PROVED, by="shared setting read")
def test_every_method_runs_the_same_problem() -> None:
    """In each scene all methods solve the same equations from the same start over the same interval."""
    for scene in PRESETS.values():
        assert scene.methods == LESSON_METHODS
        assert (scene.start, scene.t) == (START, END)
    for key in LESSON_METHODS:  # to first order in h each step is the same z + hJz
        first_order = M(key) - matrix([[1, 0], [0, 1]])
        assert [entry.coeff(entry.ring.gens[0]) for entry in first_order.to_list_flat()] == [0, 1, -1, 0]


@claim("L104", evidence=PROVED, by="sum of cosines, sign")
def test_segment_between_exact_samples_misses_the_solution() -> None:
    """A straight segment is no solution between samples: half-way between exact ones it is cos(h/2) times the solution.

    So it is too close to the centre for every 0 < h < 2π, since 1 - cos² = sin² > 0 there.
    """
    half = symbols("half", positive=True)  # of the step h
    for component in (POSITION, VELOCITY):
        chord, arc = (component + component.subs(t, t + 2 * half)) / 2, component.subs(t, t + half)
        assert sympy.simplify(sympy.expand_trig(chord - cos(half) * arc)) == 0
        assert sympy.simplify(sympy.expand_trig(chord - arc)) != 0
    assert sympy.trigsimp(1 - cos(half) ** 2) == sin(half) ** 2


@claim("L024", evidence=PROVED, by="change of variables")
def test_spring_becomes_normalised_oscillator() -> None:
    """With ω = sqrt(k/m), t = ωτ, q = x/L and v = ẋ/(Lω), the spring m x'' = -k x becomes q' = v, v' = -q."""
    m, k, L, tau = symbols("m k L tau", positive=True)
    x = sympy.Function("x")(tau)
    spring = Spring(m, k, L)
    q, v = spring.state(x, x.diff(tau))
    newton = {x.diff(tau, 2): -k * x / m}
    assert sympy.simplify(q.diff(tau) / spring.omega - v) == 0
    assert sympy.simplify(v.diff(tau).subs(newton) / spring.omega + q) == 0
    assert sympy.simplify(v.diff(tau).subs(newton) + q) != 0  # without the scaled time it does not


@claim("L025", evidence=PROVED, by="dimensions cancel")
def test_normalised_state_has_no_dimension() -> None:
    """q and v are pure numbers: changing the units of mass, length and time leaves them unchanged."""
    m, k, L, x, velocity = symbols("m k L x velocity", positive=True)
    kg, metre, second = symbols("kg metre second", positive=True)
    rescaled = Spring(m * kg, k * kg / second**2, L * metre).state(x * metre, velocity * metre / second)
    plain = Spring(m, k, L).state(x, velocity)
    assert [sympy.simplify(a - b) for a, b in zip(rescaled, plain, strict=True)] == [0, 0]
    assert sympy.simplify(x * metre - x) != 0


@claim("L026", evidence=PROVED, by="change of variables")
def test_physical_energy_is_k_L_squared_times_normalised() -> None:
    """½mẋ² + ½kx² = kL²·½(q² + v²)."""
    m, k, L, x, velocity = symbols("m k L x velocity", positive=True)
    spring = Spring(m, k, L)
    q, v = spring.state(x, velocity)
    assert sympy.expand(spring.energy(x, velocity) - k * L**2 * (q**2 + v**2) / 2) == 0
    assert sympy.expand(spring.energy(x, velocity) - k * (q**2 + v**2) / 2) != 0


@claim("L027", evidence=PROVED, by="scaled time solved")
def test_dimensionless_step_lasts_h_over_omega() -> None:
    """A dimensionless step h takes the physical time h/ω, so that t = ωτ advances by h."""
    m, k, L, h = symbols("m k L h", positive=True)
    spring = Spring(m, k, L)
    assert sympy.simplify(spring.omega * spring.duration(h) - h) == 0
    assert sympy.simplify(spring.duration(h) - h * sqrt(m / k)) == 0


def test_float_readout_of_the_exact_state_is_the_same_solution() -> None:
    """The exact state in floats is the flow proved here: shown by running its code on symbols."""
    c, s = sympy.Symbol("c"), sympy.Symbol("s")

    class Angle:
        """Stands for t where the readout asks for its cosine and sine."""

        def cos(self) -> sympy.Symbol:
            return c

        def sin(self) -> sympy.Symbol:
            return s

    import numpy as np

    at_angle = np.array([Angle()], dtype=object)
    q, v = exact_state((1, 0), at_angle)
    assert (q[0], v[0]) == (c, -s)
    assert energy(*START) == Rational(1, 2)
