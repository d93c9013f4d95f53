"""Wrong programs: the definitions are right, and what steps, runs or reads out is not; which named check notices."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction as Q
from typing import Any

import numpy as np
import pytest

from driftproof.methods.schemes import Method, RungeKutta, Splitting
from driftproof.methods.stepping import Step
from driftproof.numeric import readouts, run, steppers
from driftproof.numeric.scenes import Scene
from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.symbolic.derivation import one_step
from driftproof.symbolic.derivation.one_step import matrix_of, one_step_matrix
from driftproof.symbolic.linear import oscillator as linear_oscillator
from driftproof.symbolic.runs import OscillatorRun
from tests.nine import NINE, is_printed


def exactly_the_definition() -> bool:
    """The hand-written steppers are their definitions over Q[h, q, v]."""
    return all(matrix_of(step) == one_step_matrix(NINE[key]) for key, step in steppers.HAND_WRITTEN.items())


def printed_matrix() -> bool:
    """The generic step of each method has the one-step matrix that is in the books."""
    return all(map(is_printed, NINE.values()))


def scene(asked: str, **changed: Any) -> Scene:
    given: dict[str, Any] = {"name": "c", "selected": "rk4", "h": Q(1, 4), "t": Q(10)}
    return Scene(**{**given, "readouts": (asked,), **changed})


# Roundings of numbers below 4, or 180 for angles: a run of 40 steps makes at most 40 * 50, none of which grows more
# than 4 times, and a planted error is a million times larger.
ROUNDINGS = Q(40 * 50 * 4, 2**53)


def ends_at_the_certified_end(key: str) -> bool:
    found = run.run_method(scene("final_state"), key)["final_state"]
    certified = OscillatorRun(NINE[key], Q(1, 4), Q(10)).final_state
    return all(is_near(x, value, 4 * ROUNDINGS) for x, value in zip(found, certified, strict=True))


def is_near(x: float, value: Any, slack: Q) -> bool:
    low, high = endpoints(enclose(value))
    return low - slack <= Q(x) <= high + slack


def certified_run() -> bool:
    """Float runs end where certified runs end, up to rounding."""
    return all(ends_at_the_certified_end(key) for key in NINE)


def trajectory_length() -> bool:
    when, path = run.run_method(scene("trajectory"), "rk4")["trajectory"]
    return len(when) == len(path) == 41 and tuple(path[0]) == (1.0, 0.0)


def quarter_turn_ahead() -> bool:
    """Clockwise is ahead: (0, -1) is a quarter turn ahead of (1, 0)."""
    return bool(readouts.phase_error((0.0, -1.0), (1.0, 0.0)) == 90)


def half_open_interval() -> bool:
    """Angles on both sides of half a turn wrap into [-180, 180), and half a turn itself is -180."""
    states = [(-1.0, v) for v in (-0.5, -1e-9, -0.0, 0.0, 1e-9, 0.5)]
    found = [readouts.phase_error(a, b) for a in states for b in [(1.0, 0.0), *states]]
    return all(-180 <= x < 180 for x in found) and readouts.phase_error((-1.0, 0.0), (1.0, 0.0)) == -180


def undefined_at_the_origin() -> bool:
    return readouts.phase_error((0.0, 0.0), (1.0, 0.0)) is None


def counted_evaluations() -> bool:
    """A stepper that calls the force five times is counted five times, whatever the tableau has."""

    def wasteful(force: Any, q: Any, v: Any, h: Any) -> Any:
        return steppers.rk4(force, q, v, h + 0 * force(q))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "float_stepper", lambda key: wasteful)
        return bool(run.run_method(scene("evaluations"), "rk4")["evaluations"] == 200)


def energy_of_the_start() -> bool:
    """Half a kinetic and half a potential part: 1/2 from (1, 0), and the change is measured from the start."""
    change = run.run_method(scene("energy_change", t=Q(0), start=(Q(3), Q(4))), "rk4")["energy_change"]
    return bool(readouts.energy((3.0, 4.0)) == 12.5 and change == 0)


def euclidean_distance() -> bool:
    return bool(readouts.state_error((1.0, 0.0), (0.0, -1.0)) == 2**0.5)


def single_rounding_of_times() -> bool:
    return [float(t) for t in run.times_of_steps(Q(1, 10), 1000)] == [float(Q(i, 10)) for i in range(1001)]


def hundred_steps() -> bool:
    """Ten in steps of a tenth, where adding up tenths is one short."""
    return bool(run.run_method(scene("steps", h=Q(1, 10)), "rk4")["steps"] == 100)


def certified_readouts() -> bool:
    """The readouts of a float run are those of the certified run, up to rounding."""
    certified = OscillatorRun(NINE["forward_euler"], Q(1, 4), Q(10))
    return all(
        is_near(run.run_method(scene(name), "forward_euler")[name], getattr(certified, name), 180 * ROUNDINGS)
        for name in ("state_error", "energy", "energy_change", "phase_error")
    )


CHECKS: list[Callable[[], bool]] = [
    exactly_the_definition,
    printed_matrix,
    certified_run,
    certified_readouts,
    trajectory_length,
    quarter_turn_ahead,
    half_open_interval,
    undefined_at_the_origin,
    counted_evaluations,
    energy_of_the_start,
    euclidean_distance,
    single_rounding_of_times,
    hundred_steps,
]


def caught_by() -> set[str]:
    return {check.__name__ for check in CHECKS if not check()}


def test_nothing_is_caught_where_nothing_is_planted() -> None:
    assert caught_by() == set()


@dataclass(frozen=True)
class Planted:
    """An error: what replaces `name` in `module`, made from what was there."""

    error: str
    module: Any
    name: str
    replacement: Callable[[Any], Any]
    caught: Callable[[], bool]


def in_table(key: str, step: Step) -> Callable[[Any], Any]:
    return lambda table: {**table, key: step}


def drift_backwards(stepper: Any) -> Any:
    def wrong(method: Method, lift: Any) -> Any:
        if isinstance(method, Splitting):
            parts = tuple((kind, -c if kind == "drift" else c) for kind, c in method.parts)
            return stepper(replace(method, parts=parts), lift)
        return stepper(method, lift)

    return wrong


def coefficients_ignored(stepper: Any) -> Any:
    return lambda method, lift: stepper(method, lambda c: lift(Q(1) if isinstance(method, Splitting) else c))


def force_backwards(stepper: Any) -> Any:
    return lambda method, lift: lambda force, q, v, h: stepper(method, lift)(lambda x: -force(x), q, v, h)


def stages_forgotten(stepper: Any) -> Any:
    def wrong(method: Method, lift: Any) -> Any:
        if isinstance(method, RungeKutta):
            method = replace(method, a=tuple(tuple(Q(0) for _ in row) for row in method.a))
        return stepper(method, lift)

    return wrong


def rk4_with(weights: tuple[int, int, int, int], half: int = 2) -> Step:
    def step(force: Any, q: Any, v: Any, h: Any) -> Any:
        k1 = v, force(q)
        k2 = v + h * k1[1] / half, force(q + h * k1[0] / half)
        k3 = v + h * k2[1] / 2, force(q + h * k2[0] / 2)
        k4 = v + h * k3[1], force(q + h * k3[0])
        dq, dv = (sum(w * k[i] for w, k in zip(weights, (k1, k2, k3, k4), strict=True)) for i in (0, 1))
        return q + h * dq / 6, v + h * dv / 6

    return step


def one_step_short(integrate: Any) -> Any:
    return lambda step, force, start, h, steps, *rest: integrate(step, force, start, h, steps - 1, *rest)


def unwrapped(_: Any) -> Any:
    def phase(state: Any, exact: Any) -> Any:
        return float(np.degrees(np.arctan2(-state[1], state[0]) - np.arctan2(-exact[1], exact[0])))

    return phase


def closed_at_the_wrong_end(right: Any) -> Any:
    return lambda state, exact: 180.0 if (x := right(state, exact)) == -180 else x


def reading(name: str, read: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda table: {**table, name: read}


def method_of(finished: Any) -> Any:
    return NINE[finished.scene.selected]


EULER_REUSING_Q: Step = lambda F, q, v, h: (q + h * v, v + h * F(q + h * v))
POSITION_FIRST: Step = lambda F, q, v, h: (q + h * v, v + h * F(q + h * v))
TABLE = [
    Planted("Euler reuses the new position", steppers, "HAND_WRITTEN", in_table("forward_euler", EULER_REUSING_Q),
            exactly_the_definition),
    Planted("symplectic Euler updates the position first", steppers, "HAND_WRITTEN",
            in_table("symplectic_euler", POSITION_FIRST), exactly_the_definition),
    Planted("RK4 weights 1, 2, 2, 1 become 1, 1, 3, 1", steppers, "HAND_WRITTEN",
            in_table("rk4", rk4_with((1, 1, 3, 1))), exactly_the_definition),
    Planted("RK4 takes thirds for halves", steppers, "HAND_WRITTEN", in_table("rk4", rk4_with((1, 2, 2, 1), 3)),
            exactly_the_definition),
    Planted("RK4 adds where it subtracts", steppers, "HAND_WRITTEN", in_table("rk4", rk4_with((1, 2, 2, -1))),
            exactly_the_definition),
    Planted("drifts run backwards", one_step, "stepper", drift_backwards, printed_matrix),
    Planted("splitting coefficients are all 1", one_step, "stepper", coefficients_ignored, printed_matrix),
    Planted("the force has the other sign", one_step, "stepper", force_backwards, printed_matrix),
    Planted("stages do not see each other", one_step, "stepper", stages_forgotten, printed_matrix),
    Planted("the run is one step short", run, "integrate", one_step_short, certified_run),
    Planted("the exact state is one step late", readouts, "exact_state", lambda f: lambda s, t: f(s, t + 0.25),
            certified_readouts),
    Planted("the phase error has the other sign", readouts, "phase_error", lambda f: lambda a, b: f(b, a),
            quarter_turn_ahead),
    Planted("the phase error is not wrapped", readouts, "phase_error", unwrapped, half_open_interval),
    Planted("half a turn is +180", readouts, "phase_error", closed_at_the_wrong_end, half_open_interval),
    Planted("the origin has phase 0", readouts, "phase_error", lambda f: lambda a, b: f(a, b) or 0.0,
            undefined_at_the_origin),
    Planted("the phase is in radians", readouts, "phase_error", lambda f: lambda a, b: np.radians(f(a, b) or 0),
            quarter_turn_ahead),
    Planted("evaluations are stages times steps", run, "_READ",
            reading("evaluations", lambda run: run.scene.steps * method_of(run).stages), counted_evaluations),
    Planted("evaluations are steps", run, "_READ", reading("evaluations", lambda run: run.scene.steps),
            counted_evaluations),
    Planted("energy lacks its half", readouts, "energy", lambda f: lambda z: 2 * f(z), energy_of_the_start),
    Planted("energy change is measured from 1/2", readouts, "float_energy_change",
            lambda f: lambda z, _: readouts.energy(z) - 0.5, energy_of_the_start),
    Planted("state error is the sum of distances", readouts, "state_error",
            lambda f: lambda a, b: abs(a[0] - b[0]) + abs(a[1] - b[1]), euclidean_distance),
    Planted("state error looks at the position only", readouts, "state_error", lambda f: lambda a, b: abs(a[0] - b[0]),
            euclidean_distance),
    Planted("times are summed up", run, "times_of_steps", lambda f: lambda h, n: np.cumsum([0.0, *n * [float(h)]]),
            single_rounding_of_times),
    Planted("the trajectory misses the start", run, "_READ", reading("trajectory", lambda run: (
        run.path[1:], run.path[1:])), trajectory_length),
    Planted("steps are int(t / h) in floats, of sums", Scene, "steps", lambda f: property(
        lambda s: int(sum(float(s.h) for _ in range(int(s.t / s.h))) / float(s.h))), hundred_steps),
]  # fmt: skip


@pytest.mark.parametrize("planted", TABLE, ids=[planted.error for planted in TABLE])
def test_planted_error_is_caught_by_its_check(planted: Planted, monkeypatch: pytest.MonkeyPatch) -> None:
    right = vars(planted.module)[planted.name]
    monkeypatch.setattr(planted.module, planted.name, planted.replacement(right))
    assert planted.caught.__name__ in caught_by()


def test_every_check_of_the_table_catches_something() -> None:
    assert {check.__name__ for check in CHECKS} - {planted.caught.__name__ for planted in TABLE} == set()


def test_common_error_of_exact_and_float_is_caught_by_a_witness_outside_both(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the interpreter wrong on both sides the two sides agree, and only what is not stepped tells."""
    for module in (one_step, linear_oscillator, steppers):
        monkeypatch.setattr(module, "stepper", drift_backwards(vars(module)["stepper"]))
    assert ends_at_the_certified_end("velocity_verlet")
    assert "printed_matrix" in caught_by()
