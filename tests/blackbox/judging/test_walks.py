"""Steps far from home: right code passes there, and what is wrong there alone is caught and said to be."""

from dataclasses import replace

import numpy as np
import pytest

from driftproof.blackbox.judging.nonlinear_problems import driven
from driftproof.blackbox.judging.specification import Allowance, Domain, Specification
from driftproof.blackbox.judging.walks import Walker, _Place, back_and_on, there_and_back, walked
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.judging.test_nonlinear_step import SOLVED, iterated
from tests.blackbox.transcripts import Asked

RK4, VERLET = (Specification(METHODS[key]) for key in ("rk4", "velocity_verlet"))
EULER = Specification(METHODS["forward_euler"])


def rk4_at(times):
    """RK4 whose right-hand side is asked at other times."""
    return lambda f, t, y, h: codes.rk4(lambda at, z: f(times(at, t), z), t, y, h)


def rk4_ending(end):
    """RK4 that ends elsewhere, of the end and the start."""
    return lambda f, t, y, h: end(np.array(codes.rk4(f, t, y, h)), y)


def going_on(f, t, y, h, last={}):  # noqa: B006
    """RK4 whose first slope, where a step goes on, is the last one of the step before, which is at another place."""
    k1 = last["slope"] if last.get("t") == t and len(last["slope"]) == len(y) else f(t, y)
    k2 = f(t + h / 2, y + h * k1 / 2)
    k3 = f(t + h / 2, y + h * k2 / 2)
    k4 = f(t + h, y + h * k3)
    last.update(t=t + h, slope=k4)
    return y + h * (k1 + 2 * k2 + 2 * k3 + k4) / 6


def remembering_the_time_alone(f, t, y, h, last={}):  # noqa: B006
    """Heun's method, which keeps the slope at its end, and takes it wherever the next step begins at that time."""
    k1 = last["slope"] if last.get("t") == t and len(last["slope"]) == len(y) else f(t, y)
    end = y + h * (k1 + f(t + h, y + h * k1)) / 2
    last.update(t=t + h, slope=f(t + h, end))
    return end


def positions_from_the_fourth_stay(force, q, v, h):
    end, speed = codes.velocity_verlet(force, q, v, h)
    return np.append(end[:3], q[3:]) if np.size(q) > 3 else end, speed


def last_position_is_kicked_by_the_force_before(force, q, v, h):
    before, (end, speed) = force(q), codes.velocity_verlet(force, q, v, h)
    return end, speed + (h / 2 * (before - force(end)) * (np.arange(np.size(q)) == 4) if np.size(q) > 3 else 0)


def remembering_all_but_the_function(f, t, y, h, kept={}):  # noqa: B006
    """RK4 with a cache of its answers by t, y and h."""
    key = (t, h, tuple(y))
    kept.setdefault(key, codes.rk4(f, t, y, h))
    return kept[key]


def one_position_after_the_other(force, q, v, h):
    """Velocity Verlet of lists, whose force takes one position and is not told which."""
    ends = [codes.velocity_verlet(force, *pair, h) for pair in zip(np.ravel(q), np.ravel(v), strict=True)]
    return [q1 for q1, _ in ends], [v1 for _, v1 in ends]


WRONG = {
    "a cache": (remembering_all_but_the_function, RK4),
    "times in binary32": (rk4_at(lambda at, t: float(np.float32(at))), RK4),
    "a clock that stands": (rk4_at(lambda at, t: min(at, 10)), RK4),
    "no sign of t": (rk4_at(lambda at, t: abs(at)), RK4),
    "the last of five": (rk4_ending(lambda end, y: np.append(end[:4], y[4:]) if len(y) > 4 else end), RK4),
    "no small slopes": (rk4_ending(lambda end, y: np.where((abs(end - y) < 1e-8) & (len(y) > 2), y, end)), RK4),
    "a stale slope": (going_on, RK4),
    "a slope of its time": (remembering_the_time_alone, Specification(METHODS["heun2"])),
    "the fourth position": (positions_from_the_fourth_stay, VERLET),
    "the last position": (last_position_is_kicked_by_the_force_before, VERLET),
    "NaN": (rk4_ending(lambda end, y: end * (np.nan if len(y) == 3 else 1)), RK4),
}


@pytest.mark.parametrize(("step", "wanted"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_elsewhere_alone_is_caught_and_named(step, wanted, as_before):
    asked = Asked(step)
    passed, words, _ = walked(opened(asked.code), wanted)
    assert passed is False
    as_before(words, asked)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["forward_euler", "rk4", "dormand_prince54", "yoshida6", "nystrom5", "ssprk104"])
def test_explicit_methods_are_themselves_everywhere_by_their_force(key, as_before):
    asked = Asked(stepper(METHODS[key], float))
    as_before(tuple(walked(opened(asked.code, "force"), Specification(METHODS[key]))), asked)


def positive_times_only(f, t, y, h):
    if t < 0:
        raise ValueError("t is negative")
    return codes.rk4(f, t, y, h)


RIGHT = [codes.rk4, codes.rk4_without_time, codes.rk4_of_one_number, positive_times_only]
RIGHT = [(step, RK4) for step in (*RIGHT, codes.in_precision(codes.rk4, np.float32))]
RIGHT += [(codes.velocity_verlet_in_time, VERLET), (one_position_after_the_other, VERLET)]
RIGHT += [(iterated("gauss2"), Specification(METHODS["gauss2"], SOLVED))]


@pytest.mark.parametrize(("step", "wanted"), RIGHT)
def test_right_codes_are_right_everywhere_and_it_is_said_where_and_what_they_refuse(step, wanted, as_before):
    asked = Asked(step)
    passed, words, _ = walked(opened(asked.code), wanted)
    assert passed is True, words
    as_before(words, asked)


# Of one number, one call and 12 roundings: the number, 1 for slopes, and the time in its own units, twice; or a solver.
@pytest.mark.parametrize(("share", "right"), [(0.9, True), (1.1, False), (-0.9, True), (-1.1, False)])
def test_a_step_is_held_to_the_roundings_of_its_numbers_its_slopes_and_its_time(share, right):
    place, t, h = _Place((0.5,), 2, -1.0), 0.75, 0.0625
    allowed = 12 * 2.0**-53 * 2 * (1 + 0.25 / 0.5 + 0.75 * 4)
    subject = opened(lambda f, t, y, h: y + h * f(t, y) + share * allowed * 0.5)
    walker, problem = Walker(subject, EULER), place.problem(driven(1, timed=True))
    found = walker.compared(problem, t, [0.25], h)
    assert found.wrong == (() if right else ("y[0]",))
    assert found.place == "in a step of 0.0625 from t = 0.75"
    assert found.numbers.startswith(f"y[0] is {found.end[0]!r} where forward_euler gives ")


# A domain, a place within it, and one that is not.
DOMAINS = [
    (Domain(largest_state=2.0), _Place((1.0, -0.5)), _Place((1.0, -1.125))),
    (Domain(smallest_state=0.5), _Place((1.0, -0.5)), _Place((1.0, -0.4375))),
    (Domain(largest_step=0.2), _Place(pace=-1), _Place(pace=-2)),
    (Domain(smallest_step=1 / 60), _Place(pace=1), _Place(pace=2)),
    (Domain(largest_state=1e300, smallest_state=0.0), _Place((-(2.0**341),)), _Place((2.0**-342,))),
    (Domain(smallest_step=1e-300), _Place(pace=170), _Place(pace=171)),
]


@pytest.mark.parametrize(("domain", "within", "beyond"), DOMAINS)
def test_a_place_is_within_a_domain_that_holds_its_numbers_twice_and_its_steps(domain, within, beyond):
    assert [place.within(domain, opened(codes.rk4)) for place in (within, beyond)] == [True, False]


def test_no_step_is_taken_outside_of_the_domain():
    capped = rk4_ending(lambda end, y: np.clip(end, -100, 100))
    assert walked(opened(capped), RK4)[0] is False
    assert walked(opened(capped), replace(RK4, domain=Domain(largest_state=90.0)))[0] is True
    short = walked(opened(codes.rk4), replace(RK4, domain=Domain(largest_step=2.0**-19)))
    assert short == (None, "the domain is too small for it", "")


def test_allowances_hold_there_too():
    short = lambda f, t, y, h: codes.rk4(f, t, y, float(np.float32(h)))
    assert walked(opened(short), RK4)[0] is False
    assert walked(opened(short), replace(RK4, allowance=Allowance(step_in_binary32=True)))[0] is True
    by_quotient = Specification(METHODS["symplectic_euler"], Allowance(velocity_from_positions=True))
    assert walked(opened(codes.velocity_from_positions), by_quotient)[0] is True
    assert back_and_on(opened(codes.velocity_from_positions), by_quotient)[0] is True


def test_steps_back_are_looked_at_where_the_right_hand_side_is_ours():
    assert walked(opened(rk4_at(lambda at, t: t + abs(at - t))), RK4)[0] is True
    refused = back_and_on(opened(lambda f, t, y, h: codes.rk4(f, t, y, h if h > 0 else 1 / 0)), RK4)
    assert refused[0] is None
    short = back_and_on(opened(codes.rk4), replace(RK4, domain=Domain(largest_step=2.0**-19)))
    assert short == (True, "6 steps with h < 0 within the bound", "")
    built_in = back_and_on(opened(lambda q, v, h: (q + h * v, v - h * q)), EULER)
    assert built_in == (True, "6 steps with h < 0 within the bound", "")


def test_few_steps_back_are_asked_for_where_those_ahead_are_right(as_before):
    said = []
    for step in (codes.rk4, rk4_at(lambda at, t: t + abs(at - t))):
        asked, again = Asked(step), Asked(step)
        found = back_and_on(opened(asked.code), RK4), there_and_back(Walker(opened(again.code), RK4))
        said += [tuple(found[0]), asked, tuple(found[1]), again]
    as_before(*said)
