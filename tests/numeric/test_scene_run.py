"""A scene of a problem: its readouts beside a run written out by hand, its refusals, and where a run ends."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from math import hypot, isfinite

import pytest

from driftproof import PROBLEMS, Scene
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.advance import advance, float_start
from driftproof.numeric.run import NonFiniteReadout, NonFiniteState, RunEnded, run_method
from driftproof.numeric.scene_run import run_scene
from driftproof.numeric.scenes import PRESETS, READOUTS, has

KEPLER = PROBLEMS["kepler"]
OF_PROBLEM = tuple(name for name in READOUTS if has(KEPLER, name))


def of_kepler(h: Q = Q(1, 50), selected: str = "velocity_verlet", readouts: tuple[str, ...] = OF_PROBLEM) -> Scene:
    return Scene("mine", selected, h, Q(20), readouts=readouts, problem=KEPLER)


def kepler_by_hand(steps: int, h: float) -> tuple[list[list[float]], int]:
    """Kick, drift, kick around a centre of mass 16/25, at pericentre; and how often the force was computed."""
    y, calls = [float(x) for x in KEPLER.start], 0
    path = [y]
    for _ in range(steps):
        x, y_, u, v = path[-1]
        r = hypot(x, y_) ** 3 / 0.64
        u, v = u - h / 2 * x / r, v - h / 2 * y_ / r
        x, y_ = x + h * u, y_ + h * v
        r = hypot(x, y_) ** 3 / 0.64
        path.append([x, y_, u - h / 2 * x / r, v - h / 2 * y_ / r])
        calls += 2
    return path, calls


def test_readouts_of_a_problem_are_those_of_a_run_by_hand() -> None:
    found = run_scene(of_kepler(), "velocity_verlet")
    path, calls = kepler_by_hand(1000, 0.02)
    # Both round some ten times a step, each by u of numbers of size 2; three orbits enlarge that some 100 times.
    close = pytest.approx(path[-1], abs=1000 * 10 * 2 * 2**-53 * 100, rel=0)
    assert list(found["final_state"]) == close
    assert list(found["exact_state"]) == [float(x) for x in KEPLER.reference.states[-1]]
    off = hypot(*(x - y for x, y in zip(found["final_state"], found["exact_state"], strict=True)))
    assert found["state_error"] == pytest.approx(off, rel=1e-12, abs=0)
    assert off > 0.01
    energies = [(u * u + v * v) / 2 - 0.64 / hypot(x, y) for x, y, u, v in (path[0], found["final_state"])]
    assert found["energy_change"] == pytest.approx(energies[1] - energies[0], abs=1e-14)
    assert found["energy"] == pytest.approx(energies[1], abs=1e-14)
    changes = [(u * u + v * v) / 2 - 0.64 / hypot(x, y) - energies[0] for x, y, u, v in path]
    assert found["largest_energy_change"] == pytest.approx(max(changes, key=abs), abs=1e-14)
    assert abs(found["largest_energy_change"]) > abs(found["energy_change"])
    assert (found["steps"], found["evaluations"]) == (1000, calls)
    times, states = found["trajectory"]
    assert (len(times), times[-1], tuple(states[-1])) == (1001, 20.0, found["final_state"])


@pytest.mark.slow
def test_only_what_is_asked_for_is_answered_and_implicit_stages_are_counted() -> None:
    found = run_scene(of_kepler(selected="gauss4", readouts=("state_error", "evaluations")), "gauss4")
    assert set(found) == {"state_error", "evaluations"}
    assert found["state_error"] < 1e-11
    assert found["evaluations"] > 4 * 1000


@pytest.mark.parametrize("readouts", [("final_state",), ("final_state", "trajectory")])
def test_steps_know_their_time_whether_or_not_they_are_taken_together(readouts: tuple[str, ...]) -> None:
    timed = PROBLEMS["prothero_robinson"]
    scene = Scene("mine", "radau_iia2", Q(1, 4), Q(10), readouts=readouts, problem=timed)
    alone = advance(METHODS["radau_iia2"], timed)(float_start(timed), 0.25, 0, 40)
    counted: list[int] = []
    found = run_scene(scene, "radau_iia2", lambda steps: (counted.append(i) or i for i in range(steps)))
    assert found["final_state"] == alone
    assert counted == list(range(40)), "progress counts every step, once"


def test_without_a_problem_it_is_the_oscillator() -> None:
    assert run_scene(PRESETS["compare"], "rk4") == run_method(PRESETS["compare"], "rk4")


def test_a_run_that_ends_early_says_at_which_step_and_why() -> None:
    """Overflow that is infinite, after as many steps as by hand; that raises; and stages that there are none of."""
    stiff, count = PROBLEMS["robertson"], 0
    scene = Scene("far", "forward_euler", stiff.t / 100, stiff.t, readouts=("state_error",), problem=stiff)
    run, y = advance(METHODS["forward_euler"], stiff), float_start(stiff)
    while all(map(isfinite, y)):
        y, count = run(y, 1e9, count, count + 1), count + 1
    with pytest.raises(NonFiniteState, match=f"no longer finite after step {count}$") as ended:
        run_scene(scene, "forward_euler")
    assert ended.value.step == count > 3
    falling = replace(stiff, field=replace(stiff.field, rates=("log(30000000000 - t)", "0 * y0", "0 * y0")))
    with pytest.raises(RunEnded, match=r"^the run ends at step 31: "):
        run_scene(replace(scene, problem=falling), "forward_euler")
    with pytest.raises(RunEnded, match=r"^the run ends at step 1: not solved after 128 iterations$"):
        run_scene(replace(scene, selected="gauss2"), "gauss2")
    with pytest.raises(ValueError, match="a second-order system"):
        run_scene(scene, "velocity_verlet")
    star = PROBLEMS["henon_heiles"]  # leaps that square the state: of 10**200, say, whose cube no double holds
    scene = Scene("far", "forward_euler", star.t / 12, star.t, readouts=("state_error",), problem=star)
    assert isfinite(run_scene(scene, "forward_euler")["state_error"])
    with pytest.raises(NonFiniteReadout, match=r"^energy overflows binary64 at the final state$"):
        run_scene(replace(scene, readouts=("energy",)), "forward_euler")


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"start": (Q(0), Q(1))}, "the problem fixes the start; remove `start`"),
        ({"readouts": ("largest_error",)}, "the problem kepler has no readout largest_error; choose from final_state"),
        ({"readouts": ("phase_error",)}, "the problem kepler has no readout phase_error; choose from final_state"),
        ({"panels": ("position",)}, "the problem kepler has no panel position; choose from table"),
        ({"t": Q(7, 3), "h": Q(1, 3)}, "the solution of kepler is known only at t = 5/2, 5, .*, 20$"),
        ({"problem": replace(KEPLER, key="k.toml"), "t": Q(1)}, "20; another `end` in its file gives others$"),
    ],
)
def test_what_a_problem_has_not_is_refused_in_one_line(changed: dict[str, object], message: str) -> None:
    about = {"readouts": ("state_error",), "problem": KEPLER, **changed}
    with pytest.raises(ValueError, match=message) as refused:
        Scene("mine", "rk4", **({"h": Q(1, 2), "t": Q(20)} | about))  # type: ignore[arg-type]
    assert "\n" not in str(refused.value)


def test_an_energy_is_shown_where_the_problem_has_one() -> None:
    without = PROBLEMS["robertson"]
    with pytest.raises(ValueError, match="the problem robertson has no readout energy; choose from"):
        Scene("mine", "rk4", without.t, without.t, readouts=("energy",), problem=without)
