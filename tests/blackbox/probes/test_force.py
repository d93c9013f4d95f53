"""The Nyström table of a float code is read to the last bit, as kicks and drifts where it is a composition of these."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.blackbox.probes.force import ForceReading, _Probe, _Run, read_forces
from driftproof.blackbox.probes.scripted_answers import Control, NotReadable, Rounding
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.transcripts import Asked


def read(step):
    return read_forces(opened(step))


coefficients = st.floats(-4, 4, allow_subnormal=False).filter(lambda x: abs(x) > 1e-3)
weights = st.lists(coefficients, min_size=4, max_size=4).map(tuple)


@given(weights, weights, weights, st.lists(weights, min_size=4, max_size=4))
@settings(max_examples=30)
def test_any_nystrom_table_comes_out_as_it_went_in(c, b_position, b_velocity, rows):
    a = tuple(tuple(x if j < i else 0.0 for j, x in enumerate(row)) for i, row in enumerate(rows))
    reading = read(codes.nystrom(c, a, b_position, b_velocity))
    assert (reading.c, reading.a, reading.drift) == (c, a, 1.0)
    assert (reading.b_position, reading.b_velocity) == (b_position, b_velocity)


@given(st.lists(coefficients, min_size=2, max_size=9), st.booleans())
@settings(max_examples=30)
def test_any_splitting_comes_out_as_it_went_in_up_to_rounding(numbers, kick_first):
    kinds = ("kick", "drift") if kick_first else ("drift", "kick")
    parts = [(kinds[i % 2], x) for i, x in enumerate(numbers)]
    seen = read(codes.composed(parts)).parts
    assert [kind for kind, _ in seen] == [kind for kind, _ in parts]
    for (kind, x), (_, y) in zip(seen, parts, strict=True):
        # A kick is read as it is; a drift is a product by the kick before it, over that kick: three roundings.
        assert abs(x - y) <= (0 if kind == "kick" else 4 * 2.0**-53 * abs(y))


def test_a_table_one_rounding_off_a_splitting_is_one_and_one_off_by_1e_12_is_none():
    b = (0.5, 0.5)
    assert read(codes.nystrom((0.0, 1.0), ((0.0, 0.0), (np.nextafter(0.5, 1), 0.0)), (0.5, 0.0), b)).parts is not None
    assert read(codes.nystrom((0.0, 1.0), ((0.0, 0.0), (0.5 + 1e-12, 0.0)), (0.5, 0.0), b)).parts is None


def calling_once_more(force, q, v, h):
    q, v = codes.symplectic_euler(force, q, v, h)
    force(q)
    return q, v


def kicked(kick):
    """Symplectic Euler with another kick, of the velocity, the force, the position and h."""

    def step(force, q, v, h):
        v = kick(v, force(q), q, h)
        return q + h * v, v

    return step


def wrapped(force, q, v, h):
    v = v + h * force(q)
    return (q + h * v + 4) % 8 - 4, v


def iterated(force, q, v, h):
    middle = q
    for _ in range(100):
        before, middle = middle, q + h / 2 * (v + h / 2 * force(middle))
        if abs(middle - before) < 1e-12:
            break
    return q + h * (v + h / 2 * force(middle)), v + h * force(middle)


class Remembering:
    """Verlet that keeps its last acceleration, whatever state it is given next."""

    def __init__(self):
        self.last = 0.0

    def __call__(self, force, q, v, h):
        v = v + h / 2 * self.last
        q = q + h * v
        self.last = force(q)
        return q, v + h / 2 * self.last


class Anticipating:
    """Starts from where the first force of the step before would have led."""

    kept = 0.0

    def step(self, force, q, v, h):
        self.kept = first = force(q + h * self.kept)
        return q + h * v, v + h * force(q + h * first)


def at_times(times):
    """Velocity Verlet, called in three ways, whose force is told these times for t and t + h."""

    def of_a_field(f, t, y, h):
        (q, v), (first, last) = y, times(t, h)
        v = v + h / 2 * f(first, [q, v])[1]
        q = q + h * v
        return [q, v + h / 2 * f(last, [q, v])[1]]

    def of_a_force(force, q, v, t, h):
        first, last = times(t, h)
        v = v + h / 2 * force(q, first)
        q = q + h * v
        return q, v + h / 2 * force(q, last)

    def time_first(force, t, q, v, h):
        return of_a_force(lambda q, t: force(t, q), q, v, t, h)

    return of_a_field, of_a_force, time_first


TIMES = {"right": lambda t, h: (t, t + h), "once": lambda t, h: (t, t), "squared": lambda t, h: (t, t + h * h)}
TIMES |= {"from 0": lambda t, h: (0 * t, h)}
ASKED = {f"{name}, {step.__name__}": step for name, times in TIMES.items() for step in at_times(times)}
ASKED |= {
    step.__name__: step
    for step in (
        *(codes.symplectic_euler, codes.velocity_from_positions, codes.symplectic_euler_in_a_field, codes.half_moved),
        *(codes.velocity_verlet, codes.velocity_verlet_by_acceleration, codes.position_verlet_calling_twice, codes.rk4),
        calling_once_more,
    )
}
ASKED |= {"without a sign": lambda force, q, v, h: codes.velocity_verlet(force, q, v, abs(h))}
# Their trial steps would not do.
UNTRIED = {
    "remembering": Remembering(), "anticipating": Anticipating().step, "wrapped": wrapped, "iterated": iterated,
    "never calls": lambda force, q, v, h: (q + h * v, v),
    "without_h": lambda force, q, v, h: (q + v, v + h * force(q)),
    "with_drag": kicked(lambda v, k, q, h: v * (1 - 0.04 * h) + h * k),
    "with_a_spring": kicked(lambda v, k, q, h: v + h * (k - q)),
    "with_h_squared_in_the_kick": kicked(lambda v, k, q, h: v + h * h * k),
    "limited": kicked(lambda v, k, q, h: min(max(v + h * k, -2), 2)),
    "heavy": kicked(lambda v, k, q, h: v + h * (k - 9.81)),
}  # fmt: skip


@pytest.mark.parametrize("name", [*ASKED, *UNTRIED])
def test_all_that_is_asked_of_a_step_and_said_is_as_before(name, as_before):
    asked = Asked((ASKED | UNTRIED)[name])
    subject = opened(codes.symplectic_euler if name in UNTRIED else asked.code)
    if name in UNTRIED:
        subject.function = asked.code
    try:
        reading = read_forces(subject)
        as_before(reading, *reading.lines, asked)
    except NotReadable as refused:
        as_before(refused, asked)


# Three nodes and drifts, of which the largest counts, if it is no less than 1; each force moves a place by so much.
@pytest.mark.parametrize(
    ("nodes", "drift", "length", "pushes"),
    [((0.0, -3.0), 2.0, 3.0, (5.0, 12.0)), ((0.5, 0.25), -4.0, 4.0, (5.0, 16.0)), ((0.5, 0.0), 0.5, 1.0, (5.0, 7.0))],
)
def test_a_control_may_be_off_by_the_rounding_of_all_that_it_adds(nodes, drift, length, pushes, monkeypatch):
    probe = _Probe(opened(codes.velocity_verlet), 1.0)
    rows = ((0.0, 0.0), (-5.0, 0.0))
    reading = ForceReading(nodes, rows, (2.0, -7.0), (1.0, -4.0), drift, BINARY64, stage_error=2.0**-30)
    size, of = 11 + 0.5 * length * 13 + 0.25 * (pushes[0] * 17 + pushes[1] * 19), Rounding(BINARY64, 2).of
    allowed = probe._allowed(reading, -11.0, -13.0, -0.5, [17.0, -19.0])
    assert allowed == (of(2 * size), of(2 * (13 + 2 * size / 0.5)))
    assert reading.rounding == Rounding(BINARY64, 2, 2.0**-28)
    control = Control("", "", h=-0.5, time=-7.0)
    for share, held in ((0.95, True), (1.05, False)):
        off = share * of(2 * (7 + 0.5 * max(map(abs, nodes))))
        times = [-7 - 0.5 * nodes[0], -7 - 0.5 * nodes[1] + off]
        monkeypatch.setattr(probe, "_controlled", lambda control, times=times: _Run([], 0.0, 0.0, times, []))
        assert (probe._wrong_time(reading, control) == "") is held
