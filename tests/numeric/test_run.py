"""Float runs: only what is asked for, exact step counts and times, and honest ends where the float range ends."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as Q
from math import cos, hypot, inf, nan, sin
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric import readouts
from driftproof.numeric import run as run_module
from driftproof.numeric.readouts import ON_THE_WAY
from driftproof.numeric.run import (
    NonFiniteReadout,
    NonFiniteState,
    RunEnded,
    integrate,
    require_float_steps,
    run_method,
    times_of_steps,
)
from driftproof.numeric.scenes import READOUTS, Scene
from driftproof.numeric.steppers import forward_euler, rk4
from driftproof.strategies import rational_steps
from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.symbolic.runs import OscillatorRun
from tests.nine import NINE


def scene(**changed: Any) -> Scene:
    given: dict[str, Any] = {"name": "test", "selected": "forward_euler", "h": Q(1, 4), "t": Q(10)}
    return Scene(**{**given, "readouts": ("state_error",), **changed})


SPIED = {
    **{key: {"exact_state", "state_error"} for key in ("state_error", "largest_error")},
    "exact_state": {"exact_state"}, "energy": {"energy"},
    **{
        f"{which}energy_{of}": {"float_energy_change", "energy"}
        for which in ("", "largest_") for of in ("change", "error")
    },
    "phase_error": {"exact_state", "phase_error"},
}  # fmt: skip


@pytest.mark.parametrize("asked", READOUTS)
def test_each_readout_is_computed_only_when_asked_for(asked: str, monkeypatch: pytest.MonkeyPatch) -> None:
    called: set[str] = set()

    def spy(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *arguments: (called.add(name), function(*arguments))[1]

    for name in ("exact_state", "state_error", "energy", "float_energy_change", "phase_error"):
        monkeypatch.setattr(readouts, name, spy(name, getattr(readouts, name)))
    assert list(run_method(scene(readouts=(asked,)), "rk4")) == [asked]
    assert called == SPIED.get(asked, set())


@pytest.mark.parametrize("asked", READOUTS)
def test_trajectory_is_kept_and_calls_are_counted_only_when_asked_for(
    asked: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: dict[str, Any] = {}

    def spy(step: Any, force: Any, start: Any, h: Any, steps: int, record: Any, counter: Any) -> Any:
        seen.update(force=force, record=record)
        return integrate(step, force, start, h, steps, record, counter)

    monkeypatch.setattr(run_module, "integrate", spy)
    run_method(scene(readouts=(asked,)), "rk4")
    assert (seen["record"] is not None) == (asked in ON_THE_WAY)
    assert (seen["force"] is not oscillator) == (asked == "evaluations")


def test_the_largest_error_is_that_of_all_steps() -> None:
    """Symplectic Euler's states lie on an ellipse, and so come nearer to the circle again."""
    found = run_method(scene(readouts=("trajectory", "largest_error"), h=Q(1, 2)), "symplectic_euler")
    apart = [hypot(q - cos(t), v + sin(t)) for t, (q, v) in zip(*found["trajectory"], strict=True)]
    assert found["largest_error"] == pytest.approx(max(apart), rel=1e-12)
    assert max(apart) > apart[-1]


def test_asking_for_nothing_is_an_error() -> None:
    silent = scene(readouts=(), panels=("position",))
    with pytest.raises(ValueError, match="scene 'test' names no readout; name at least one"):
        run_method(silent, "rk4")


@pytest.mark.parametrize("key", NINE)
def test_float_run_is_the_certified_run_up_to_rounding(key: str) -> None:
    """Each of 40 steps makes at most 20 roundings of terms below 4, the largest state; none grows more than 4 times."""
    rounding = Q(40 * 20 * 4 * 4, 2**53)
    asked = ("final_state", "exact_state", "state_error", "energy", "energy_change", "phase_error")
    found = run_method(scene(readouts=asked), key)
    exact = OscillatorRun(NINE[key], Q(1, 4), Q(10))
    certified = [*exact.final_state, *exact.exact_state, exact.state_error, exact.energy, exact.energy_change]
    certified.append(exact.phase_error)
    floats = [*found["final_state"], *found["exact_state"], *(found[name] for name in asked[2:])]
    for x, value in zip(floats, certified, strict=True):
        low, high = endpoints(enclose(value))
        # The energy multiplies what two components of at most 4 are off by with up to 4 each; the phase is in degrees.
        assert low - 60 * 8 * rounding <= Q(x) <= high + 60 * 8 * rounding


def test_run_one_step_short_is_not_the_certified_run() -> None:
    found = run_method(scene(t=Q(39, 4), readouts=("final_state",)), "rk4")["final_state"]
    exact = OscillatorRun(NINE["rk4"], Q(1, 4), Q(10)).final_state
    assert max(abs(Q(x) - y) for x, y in zip(found, exact, strict=True)) > Q(1, 100)


@pytest.mark.parametrize(("key", "calls"), [("forward_euler", 40), ("rk4", 160), ("velocity_verlet", 80)])
def test_evaluations_are_counted_calls(key: str, calls: int) -> None:
    assert run_method(scene(readouts=("evaluations", "steps")), key) == {"evaluations": calls, "steps": 40}


def test_evaluations_follow_the_stepper_and_not_the_tableau(monkeypatch: pytest.MonkeyPatch) -> None:
    def wasteful(force: Any, q: Any, v: Any, h: Any) -> Any:
        force(q)
        return rk4(force, q, v, h)

    monkeypatch.setattr(run_module, "float_stepper", lambda key: wasteful)
    assert run_method(scene(readouts=("evaluations",)), "rk4")["evaluations"] == 200


def test_no_steps_return_the_start_and_no_error() -> None:
    found = run_method(scene(t=Q(0), start=(Q(1, 3), Q(-2)), readouts=READOUTS), "rk4")
    assert found["final_state"] == found["exact_state"] == (1 / 3, -2.0)
    assert (found["state_error"], found["energy_change"], found["phase_error"]) == (0, 0, 0)
    assert (found["steps"], found["evaluations"]) == (0, 0)
    assert [len(part) for part in found["trajectory"]] == [1, 1]


@given(rational_steps(), st.integers(0, 50))
@example(Q(1, 10), 1000)  # where sums of 0.1 are others
def test_every_time_is_rounded_once_and_no_sum(h: Q, steps: int) -> None:
    assert [float(x) for x in times_of_steps(h, steps)] == [float(i * h) for i in range(steps + 1)]


def test_times_that_would_round_twice_are_refused() -> None:
    assert times_of_steps(Q(1, 2**53 - 1), 1)[1] == float(Q(1, 2**53 - 1))
    for h, steps in [(Q(1, 2**53), 1), (Q(2**40), 2**13), (Q(1, 10**20), 5)]:
        with pytest.raises(OverflowError, match="round more than once"):
            times_of_steps(h, steps)


def test_trajectory_holds_the_start_and_every_state_in_order() -> None:
    when, path = run_method(scene(t=Q(1), readouts=("trajectory",)), "forward_euler")["trajectory"]
    assert path.shape == (5, 2)
    state = (1.0, 0.0)
    for i in range(5):
        assert tuple(path[i]) == state
        state = forward_euler(oscillator, *state, 0.25)
    assert list(when) == [0, 0.25, 0.5, 0.75, 1]


@pytest.mark.parametrize("counted", [0, 1, 1000])
def test_run_stops_at_the_first_state_that_is_not_finite_and_says_where(counted: int) -> None:
    """Doubling steps: 2^1024 is the first power of two that is no double."""

    def double(force: Any, q: Any, v: Any, h: Any) -> Any:
        return 2 * q, v

    with pytest.raises(NonFiniteState) as caught:
        integrate(double, oscillator, (2.0**counted, 0.0), 1.0, 10**9)
    assert caught.value.step == 1024 - counted
    assert caught.value.state == (inf, 0.0)
    assert str(caught.value) == f"overflow: the state is no longer finite after step {1024 - counted}"


@pytest.mark.parametrize("start", [(nan, 0.0), (0.0, inf), (-inf, nan)])
def test_start_that_is_not_finite_stops_the_run_at_once(start: tuple[float, float]) -> None:
    for steps in (10, 0):
        with pytest.raises(NonFiniteState, match="the start itself is not finite") as caught:
            integrate(rk4, oscillator, start, 0.25, steps)
        assert caught.value.step == 0
        assert "overflow" not in str(caught.value)


ENERGIES = [
    (Q(10**200), 1, "energy", "overflows"), (Q(10**200), 1, "energy_change", "overflows"),
    (Q(1, 10**170), 10, "energy", "underflows"), (Q(1, 10**170), 10, "energy_change", "underflows"),
    (Q(1, 10**170), 0, "energy", "underflows"),
]  # fmt: skip


@pytest.mark.parametrize(("size", "t", "asked", "way"), ENERGIES)
def test_energy_that_no_double_holds_is_refused_where_distances_are_not(size: Q, t: int, asked: str, way: str) -> None:
    given = {"t": Q(t), "start": (size, Q(0))}
    assert run_method(scene(**given), "rk4")["state_error"] <= size / 100 * t
    with pytest.raises(NonFiniteReadout, match=f"^{asked} {way} binary64 at the final state"):
        run_method(scene(**given, readouts=(asked,)), "rk4")


def test_energy_of_no_state_and_change_over_no_steps_are_0_and_the_largest_energy_is_none_too_large() -> None:
    for start, t in ((Q(0), 10), (Q(1, 10**170), 0)):
        asked = ("energy_change", "energy")[: 2 if start == 0 else 1]
        found = run_method(scene(t=Q(t), start=(start, Q(0)), readouts=asked), "rk4")
        assert found == dict.fromkeys(asked, 0)
    assert 1e308 < abs(run_method(scene(start=(Q(15 * 10**153), Q(0)), readouts=("energy",)), "rk4")["energy"]) < 2e308


@pytest.mark.parametrize("asked", ["exact_state", "state_error", "phase_error"])
def test_exact_state_that_overflows_is_refused_and_gives_no_undefined_phase(asked: str) -> None:
    """From 1.5e308 (1, 1) the exact state reaches 2.1e308 at t = 3/4, and one step of symplectic Euler stays below."""
    corner = {"h": Q(3, 4), "t": Q(3, 4), "start": 2 * (Q(15 * 10**307),)}
    with pytest.raises(NonFiniteReadout, match=r"the exact state at t = 0\.75 overflows binary64"):
        run_method(scene(**corner, readouts=(asked,)), "symplectic_euler")
    state = run_method(scene(**corner, readouts=("final_state",)), "symplectic_euler")
    assert max(state["final_state"]) > 1.7e308


def test_subnormal_starts_run_and_signed_zero_is_zero() -> None:
    tiny = Q(5e-324)
    found = run_method(scene(start=(tiny, Q(0)), readouts=("final_state", "phase_error")), "rk4")
    assert found["final_state"] != (0, 0)
    assert found["phase_error"] is None or -180 <= found["phase_error"] < 180
    assert integrate(rk4, oscillator, (-0.0, 0.0), 0.25, 10) == (0, 0)


BEYOND = [
    ({"start": (Q(10**309), Q(0))}, "start q is larger than the largest binary64"),
    ({"start": (Q(0), Q(1, 10**400))}, "start v rounds to 0: the smallest positive binary64"),
    ({"h": Q(1, 10**400), "t": Q(1, 10**400)}, "h rounds to 0: the smallest positive binary64"),
    ({"h": Q(10**400), "t": Q(10**400)}, "h is larger than the largest binary64"),
    ({"h": Q(10**16 + 1), "t": Q(10**16 + 1)}, "t is too large: no binary64 is near enough"),
    ({"h": 2**24 + Q(1, 2**29), "t": 2**24 + Q(1, 2**29)}, "t is too large"),
]


@pytest.mark.parametrize(("changed", "message"), BEYOND, ids=range(len(BEYOND)))
def test_number_that_no_double_comes_near_is_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        run_method(scene(**{"readouts": ("steps",), **changed}), "forward_euler")


def test_number_that_is_a_double_is_not_refused_however_large() -> None:
    assert run_method(scene(h=Q(10**20), t=Q(2 * 10**20), readouts=("steps",)), "forward_euler") == {"steps": 2}
    halfway = 2**23 + Q(1, 2**30)  # between two doubles, which are 2^-29 apart there
    assert run_method(scene(h=halfway, t=halfway, readouts=("steps",)), "forward_euler") == {"steps": 1}


def test_implicit_stages_are_solved_and_the_force_is_counted() -> None:
    """(1 + h²/4) q₁ = (1 - h²/4) q + h v, and likewise v: the midpoint rule turns the state."""
    found = run_method(scene(readouts=("final_state", "evaluations")), "implicit_midpoint")
    c, s = (1 - 1 / 64) / (1 + 1 / 64), (1 / 4) / (1 + 1 / 64)
    state = complex(c, -s) ** 40
    # Newton leaves no more than its rounding, some ten units in the last place of the state, at each step.
    assert found["final_state"] == pytest.approx((state.real, state.imag), abs=40 * 10 * 2**-53)
    # At the guess and after a correction, which nearly solves a linear equation: from two to four calls a step.
    assert 40 * 2 < found["evaluations"] < 40 * 4


def test_implicit_stages_that_there_are_none_of_end_the_run(tmp_path: Path) -> None:
    """A and the oscillator's matrix both have the eigenvalues ±i: at h = 1 the stage equations are singular."""
    path = tmp_path / "singular.toml"
    path.write_text('family = "runge_kutta"\nA = [[0, 1], [-1, 0]]\nb = ["1/2", "1/2"]')
    assert run_method(scene(selected=str(path)), str(path))
    with pytest.raises(RunEnded, match="the step by h = 1 "):
        run_method(scene(selected=str(path), h=Q(1)), str(path))


def test_run_of_too_many_steps_is_refused_at_once_and_names_the_way_out() -> None:
    require_float_steps(10**8)
    with pytest.raises(ValueError, match="100000001 steps; a float run takes at most 100000000, and `driftproof run`"):
        run_method(scene(h=Q(1), t=Q(10**8 + 1)), "rk4")


def test_counter_sees_every_step() -> None:
    seen: list[int] = []

    def counter(steps: int) -> Any:
        return (seen.append(i) or i for i in range(steps))

    run_method(scene(), "rk4", counter)
    assert seen == list(range(40))
