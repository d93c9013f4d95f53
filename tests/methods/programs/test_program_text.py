"""Splittings and Nyström methods on systems q'' = F(t, q): steps by hand, exact fractions, and what is refused."""

from __future__ import annotations

import ast
import math
from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.programs.explicit_steps import field_source
from driftproof.methods.programs.program_text import maker
from driftproof.methods.schemes import MethodError, Nystrom, Splitting
from driftproof.numeric.steps.engine import compiled_runner, runner
from tests.float_bits import bits
from tests.numeric.engine_runs import OSCILLATOR, PENDULUM

SECOND_ORDER = [method for method in METHODS.values() if method.explicit and isinstance(method, Splitting | Nystrom)]
# Those whose steps have few digits in fractions, which each force squares.
SHORT = [
    m for m in SECOND_ORDER if m.field is None and (len(m.parts) <= 5 if isinstance(m, Splitting) else m.stages <= 4)
]
VERLET, NYSTROM = METHODS["velocity_verlet"], METHODS["nystrom5"]
R3 = "((y0 * y0 + y1 * y1) * sqrt(y0 * y0 + y1 * y1))"
KEPLER = VectorField(("y2", "y3", f"-y0 / {R3}", f"-y1 / {R3}"))
ECCENTRIC = (0.5, 0.0, 0.0, math.sqrt(3.0))  # e = 1/2 at the pericentre
# Polynomial forces, one of which reads the time and one a parameter.
PUSHED = VectorField(("y2", "y3", "t * y1 - a * y0 * y0", "t * t - y0 * y1"), (("a", Q(2, 3)),))


def exact_step(method, y, t, h):
    """One step for `PUSHED` by loops over the table, in fractions, all components at once."""
    q, v = list(y[:2]), list(y[2:])
    force = lambda s, q: [s * q[1] - Q(2, 3) * q[0] * q[0], s * s - q[0] * q[1]]
    if isinstance(method, Splitting):
        drifted = Q(0)
        for kind, c in method.parts:
            if kind == "kick":
                v = [x + c * h * k for x, k in zip(v, force(t + drifted * h, q), strict=True)]
            else:
                q, drifted = [x + c * h * w for x, w in zip(q, v, strict=True)], drifted + c
        return (*q, *v)
    forces = []
    for node, row in zip(method.c, method.a, strict=True):
        place = [
            q[m] + node * h * v[m] + h * h * sum(a * k[m] for a, k in zip(row, forces, strict=False)) for m in (0, 1)
        ]
        forces.append(force(t + node * h, place))
    q1 = [
        q[m] + h * v[m] + h * h * sum(b * k[m] for b, k in zip(method.b_position, forces, strict=True)) for m in (0, 1)
    ]
    v1 = [v[m] + h * sum(b * k[m] for b, k in zip(method.b_velocity, forces, strict=True)) for m in (0, 1)]
    return (*q1, *v1)


@pytest.mark.parametrize("method", SHORT, ids=lambda m: m.key)
def test_a_step_in_fractions_is_the_one_of_loops_over_the_table(method):
    source = field_source(method, PUSHED)
    step = maker(source.step(), method.key)(*(c for _, c in source.coefficients))
    start, t, h = (Q(1, 2), Q(-1, 3), Q(2), Q(1, 5)), Q(3, 7), Q(1, 10)
    assert all(c != 0 for _, c in source.coefficients)
    assert step(start, t, h) == exact_step(method, start, t, h)
    assert step(start, t, h) != exact_step(method, start, t + Q(1, 10**9), h)


def test_components_that_do_not_meet_are_stepped_each_alone():
    """Two oscillators and a pendulum, apart from each other: the bits of three runs of one component."""
    field = VectorField(("y3", "y4", "y5", "-y0", "-sin(y1)", "-y2"))
    for method in (VERLET, NYSTROM):
        y = runner(method, field)((0.3, 1.0, -2.0, -0.7, 0.5, 0.25), 0.1, 0, 40)
        for i, (alone, *start) in enumerate(((OSCILLATOR, 0.3, -0.7), (PENDULUM, 1.0, 0.5), (OSCILLATOR, -2.0, 0.25))):
            assert bits(y[i], y[i + 3]) == bits(*runner(method, alone)(tuple(start), 0.1, 0, 40))


@pytest.mark.parametrize("method", SECOND_ORDER, ids=lambda m: m.key)
def test_each_kick_or_stage_evaluates_the_accelerations_once_and_no_other_rate(method):
    calls = [
        node
        for node in ast.walk(ast.parse(field_source(method, VectorField(("y1", "sin(y0)"))).run()))
        if _is_sine(node)
    ]
    if isinstance(method, Splitting):
        assert len(calls) == sum(kind == "kick" and c != 0 for kind, c in method.parts)
    else:
        assert len(calls) <= method.stages


def _is_sine(node):
    return isinstance(node, ast.Call) and getattr(node.func, "id", "") == "sin"


@pytest.mark.slow
def test_a_compiled_run_of_a_system_has_the_same_bits():
    pytest.importorskip("numba")
    for method, field, compensated in (
        (METHODS["rk4"], PUSHED, False),
        (VERLET, KEPLER, True),
        (NYSTROM, KEPLER, True),
    ):
        compiled, plain = (make(method, field, compensated=compensated) for make in (compiled_runner, runner))
        assert bits(*compiled(ECCENTRIC, 0.01, 0, 300)) == bits(*plain(ECCENTRIC, 0.01, 0, 300))


def test_compensation_of_a_system_keeps_what_additions_lose():
    """Of 2^12 steps along an orbit's radius, against the same steps in fractions of 120 bits.

    Velocity Verlet's coefficients are floats, so that the map is the same. What compensation leaves is the rounding of
    forces, which h makes small.
    """
    h, steps, start = 2.0**-12, 2**12, (1.0, 0.25)
    field = VectorField(("y1", "1 / (y0 * y0 * y0) - 1 / (y0 * y0)"))  # the radius of an orbit
    q, v, step = Q(1), Q(1, 4), Q(h)
    force = lambda q: _short(1 / (q * q * q) - 1 / (q * q))
    for _ in range(steps):
        v = v + step / 2 * force(q)
        q = _short(q + step * v)
        v = _short(v + step / 2 * force(q))
    plain, kept = (runner(VERLET, field, compensated=c)(start, h, 0, steps) for c in (False, True))
    error = lambda y: max(abs(Q(y[0]) - q), abs(Q(y[1]) - v)) * 2**53
    assert error(kept) < 2
    assert error(plain) > 4 * error(kept)


def _short(x):
    return Q(round(x * 2**120), 2**120)


@pytest.mark.parametrize("method", [VERLET, NYSTROM], ids=lambda m: m.key)
@pytest.mark.parametrize(
    ("rates", "what"),
    [
        (("10 * (y1 - y0)", "-y0", "y1"), "a second-order system has as many velocities as positions, not 3 rates"),
        (("2 * y1", "-y0"), r"the rate of y0 is '2 \* y1'; a second-order system needs 'y1'"),
        (("y3", "y2", "-y0", "-y1"), "the rate of y0 is 'y3'; a second-order system needs 'y2': positions come first"),
        ((f"y1{' * y0' * 10}", "-y0"), "the rate of y0 is no velocity; a second-order system needs 'y1'"),
        (("y1", f"-y1{' * y0' * 10}"), "the rate of y1 reads the velocity y1; kicks"),
        (("y1", "-y0 - y1"), "the rate of y1, '-y0 - y1', reads the velocity y1"),
        (("y2", "y3", "-y0", "sin(t) - y2 * y1"), "reads the velocity y2"),
    ],
)
def test_what_is_no_second_order_system_is_refused_in_one_line(method, rates, what):
    with pytest.raises(MethodError, match=what) as caught:
        field_source(method, VectorField(rates))
    assert "\n" not in str(caught.value)
    assert field_source(METHODS["rk4"], VectorField(rates))
