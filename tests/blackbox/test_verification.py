"""A verdict says what agrees, what is undecided, or what the stepper is instead, and no more than was seen."""

from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.judging.specification import Domain
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.implicit_steppers import all_at_once, fixed_point, newton, one_by_one, simplified, table, with_entry
from tests.blackbox.judging.test_nonlinear_step import kick_drift_kick
from tests.blackbox.matching.test_linear_match import newmark_in_displacements
from tests.blackbox.test_verify import (
    SHORT,
    SOLVED,
    backward_euler,
    held,
    symplectic_euler,
    velocity_verlet_of_the_oscillator,
)
from tests.blackbox.transcripts import summed, titles


def in_fractions(f, t, y, h):
    """RK4 in exact arithmetic, which returns fractions."""
    exact = lambda at, z: np.array([Fraction(float(x)) for x in f(float(at), [float(x) for x in z])])
    return codes.rk4(exact, Fraction(t), np.array([Fraction(float(x)) for x in y]), Fraction(h))


def generated(f, t, y, h):
    """A generator of (t, y), the start first."""
    while True:
        yield t, y
        t, y = t + h, codes.rk4(f, t, y, h)


def remembering(f, t, y, h, kept={}):  # noqa: B006
    moved = h * f(t, y) + (kept["left"] if np.shape(kept.get("left")) == np.shape(y) else 0)
    kept["left"] = moved - ((y + moved) - y)
    return y + moved


def in_one_buffer(f, t, y, h, kept=np.empty(2)):  # noqa: B008
    end = codes.rk4(f, t, y, h)
    if len(y) == 2:
        kept[:] = end
    return kept if len(y) == 2 else end


def iterated(most=150, longest=None):
    """The trapezoid by as many iterations in every step, however far apart the last ones are."""

    def step(f, t, y, h):
        h = min(h, longest) if longest else h
        k = last = f(t, y)
        for _ in range(most):
            last = f(t + h, y + h / 2 * (k + last))
        return y + h / 2 * (k + last)

    return step


def in_place(f, t, y, h):
    y += codes.rk4(f, t, y, h) - y
    return y


def refusing(q, v, h):
    if h < 0:
        raise ValueError("h has to be positive")
    return symplectic_euler(q, v, h)


def first_row_only(q, v, h):
    q1, v1 = symplectic_euler(q, v, h)
    return (q1, v1) if np.size(q) == 1 else (np.append(q1[:1], q[1:]), np.append(v1[:1], v[1:]))


def capped(q, v, h):
    v = min(v - h * q, 100.0)
    return q + h * v, v


def raising_far_out(f, t, y, h):
    if np.max(np.abs(y)) > 500:
        raise ValueError("too far")
    return codes.rk4(f, t, y, h)


def with_estimate(f, t, y, h):
    y1 = codes.rk4(f, t, y, h)
    return y1, y1 - y - h * f(t, y)


def with_estimate_of_small_states(f, t, y, h):
    return with_estimate(f, t, y, h) if max(map(abs, y)) < 2 else codes.rk4(f, t, y, h)


def iterated_three_times(f, t, y, h):
    return y + h * f(t + h, y + h * f(t + h, y + h * f(t + h, y)))


class Stale:
    """Euler's method with the force of the step before."""

    kept = 0.0

    def step(self, force, q, v, h):
        old, self.kept = self.kept, force(q)
        return q + h * v, v + h * old


def to_an_end(f, t, y, h):
    end = t + h
    while t < end:
        t, y = t + h, y + h * f(t, y)
    return y


def pendulum(theta, omega, dt):
    omega = omega - 9.81 * dt * np.sin(theta)
    return theta + dt * omega, omega


def other_row(pair="fehlberg45"):
    rows, _, nodes = codes.floats(METHODS[pair])
    return codes.tableau(rows, [float(x) for x in METHODS[pair].b_embedded], nodes)


def newmark_of_rounds(beta):
    def step(force, x, v, dt):
        a0 = a1 = force(x)
        for _ in range(50):
            a1 = force(x + dt * v + dt**2 * ((0.5 - beta) * a0 + beta * a1))
        return x + dt * v + dt**2 * ((0.5 - beta) * a0 + beta * a1), v + dt / 2 * (a0 + a1)

    return step


PAIR = "fehlberg45, with the embedded weights propagated: the row of order 5, not that of order 4"
REUSED = codes.tableau([[], [0.5], [0.5], [0.0, 0.0, 1.0]], [1 / 6, 1 / 3, 1 / 3, 1 / 6], [0.0, 0.5, 0.5, 1.0])
MIDPOINT = one_by_one(table("implicit_midpoint"), fixed_point)
# A step, what it should be, then titles of sections (or "" for the verdict) with words in them, and the options that it
# is held with; the verdicts themselves, where no linear algebra is in them, stand in the transcript.
VERDICTS = {
    **{
        name: (codes.RK4_AT_WRONG_TIMES[name], "rk4", "Nonlinear step: FAILED", "")
        for name in ("at time 0", "a clock restarted", "a clock stopped", "the third number left")
    },
    "a method": (codes.rk38, METHODS["rk38"]),
    "built in": (velocity_verlet_of_the_oscillator, "velocity_verlet"),
    "back": (symplectic_euler, "symplectic_euler", "Steps back: passed", "6 steps with h < 0", "Several: passed", ""),
    "in fractions": (in_fractions, "rk4"), "a generator": (generated, "rk4"),
    "in time": (codes.velocity_verlet_in_time, "velocity_verlet"),
    "of one number": (codes.rk4_of_one_number, "rk4"), "another of one": (codes.rk4_of_one_number, "rk38"),
    "nothing": (lambda f, t, y, h: None, "rk4", "What to do", "make this one call return an answer, or"),
    "complex": (lambda f, t, y, h: f(t, 1j * y), "rk4"),
    "memory": (remembering, "forward_euler"),
    "in place": (in_place, "rk4", "", "of it; remark: it changes its argument and returns it"),
    "one buffer": (in_one_buffer, "rk4", "", "of it; remark: an answer is overwritten by the next call"),
    "no step back": (lambda q, v, h: symplectic_euler(q, v, abs(h)), "symplectic_euler"),
    "to an end": (to_an_end, "forward_euler", "Steps back: not tested", "it does not run backwards: h < 0 does nothing",
        "", "; remark: it does not run backwards"),
    "forwards": (refusing, "symplectic_euler", "Steps back: not tested", "raises ValueError: h has to be positive"),
    "one row": (first_row_only, "symplectic_euler"),
    "of one state": (lambda q, v, h: symplectic_euler(float(q), float(v), h), "symplectic_euler",
        "Several: not tested", ""),
    "the row of order 5": (other_row(), "fehlberg45_embedded"),
    "not of order 4": (other_row(), "fehlberg45"), "far": (raising_far_out, "rk4"),
    "of a pendulum": (pendulum, "symplectic_euler", "What would decide it", "a force among its arguments"),
    "capped": (capped, "symplectic_euler", "Identified instead: faults", "100"),
    "not reached": (capped, "symplectic_euler", {"domain": Domain(largest_state=30.0)}),
    "left out": (kick_drift_kick("halves", left=1), "velocity_verlet"),
    "a clock": (kick_drift_kick("halves", times=(0, 0)), "velocity_verlet"),
    "no h": (lambda q, v, h: (q + h * v, v - q), "forward_euler"),
    "reused": (REUSED, "rk4"),
    "too strong": (codes.composed([("kick", 1.001), ("drift", 1)]), "symplectic_euler"),
    "drifts first": (codes.composed([(kind, float(x)) for kind, x in METHODS["forest_ruth"].parts]), "yoshida4",
        "", "is not yoshida4; it is forest_ruth, which is yoshida4 with kicks and drifts exchanged"),
    "stale": (Stale().step, "forward_euler"),
    "an estimate": (with_estimate, "rk4", "Error estimate: not tested", "rk4 defines no error estimate"),
    "at times": (with_estimate_of_small_states, "rk4", "Error estimate: not tested", "besides y1 at some steps only"),
    "iterated": (iterated_three_times, "backward_euler",
        "", "is not backward_euler", "Coefficients: undecided", "read as 3 explicit stages", {"allowance": SOLVED}),
    "solved otherwise": (backward_euler, "implicit_midpoint", "", "is not implicit_midpoint", {"allowance": SOLVED}),
    "diverging": (MIDPOINT, "implicit_midpoint", "", "its iteration does not converge at h = ",
        "What would decide it", "rounding: --largest-step 0.5 --largest-state 1", {"allowance": SOLVED}),
    "diverging in as many": (iterated(), "trapezoid", "", "its iteration does not converge at h = 2; for h <= 0.5",
        {"allowance": SOLVED}),
    "Newmark's, of 50 rounds": (newmark_of_rounds(0.25), "trapezoid", "", "its iteration does not converge at h = 2;",
        "What would decide it", "rounding: --largest-step 0.5 --largest-state 1000", {"allowance": SOLVED}),
    "another beta, of 50 rounds": (newmark_of_rounds(0.3), "trapezoid", "", "is not trapezoid", {"allowance": SOLVED}),
    "capped in as many": (iterated(longest=0.75), "trapezoid", "", "is not trapezoid", {"allowance": SOLVED}),
    "three iterations": (iterated(3), "trapezoid", "", "is not trapezoid, but a variant of it, with 3 fixed",
        {"allowance": SOLVED}),
    "capped in h": (lambda f, t, y, h: all_at_once(table("backward_euler"))(f, t, y, min(h, 0.75)), "backward_euler",
        "", "is not backward_euler", {"allowance": SOLVED}),
    "cut short": (lambda f, t, y, h: y + h * f(t + h, y + h * f(t + h, y + h * f(t + h, y))), "backward_euler",
        "", "is not backward_euler", {"allowance": SOLVED}),
    "near by": (MIDPOINT, "implicit_midpoint",
        "", "is implicit_midpoint to the", {"allowance": SOLVED, "domain": replace(SHORT, largest_step=1.0)}),
    "one entry": (all_at_once(with_entry("radau_iia2", 0, 1, -0.08)), "radau_iia2",
        "", "is not radau_iia2; it is radau_iia2 except for a[0][1]: -2/25 instead of -1/12",
        "Coefficients: FAILED", "row 0 of A sums to ",
        {"allowance": SOLVED, "domain": SHORT}),
    "other entries": (codes.tableau([[], [0.75]], [1 / 3, 2 / 3], [0.0, 0.75]), "midpoint2"),
    "half a unit late": (codes.RK4_AT_WRONG_TIMES["half a unit late"], "rk4",
        "", "but not on y' = f(t, y): with h = 2, the time of call 1 is 0.5",
        "Nonlinear step: FAILED", "", "Coefficients: undecided", "it has no tableau: with h = 2"),
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", VERDICTS)
def test_a_verdict_says_what_was_seen(name, as_before):
    step, method, *rest = VERDICTS[name]
    how = rest.pop() if rest and isinstance(rest[-1], dict) else {}
    report = held(step, method, **how)
    assert "off by 0.0e" not in report.text()
    as_before(report.passed, *(titles if "allowance" in how else summed)(report))
    for title, words in zip(rest[::2], rest[1::2], strict=True):
        section = report.section(title)
        assert words in ("\n".join(section.lines) if section else report.verdict if not title else ""), (title, report)
        assert section or not title, title


EARLY = {
    "one iteration": (partial(newton, most=1),
        "power 1 of the nonlinearity, as after one iteration of Newton's method"),
    "a kept Jacobian": (partial(simplified, most=2), "power 2 of the nonlinearity, as after 2 with one Jacobian"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("solver", "seen"), EARLY.values(), ids=EARLY)
def test_a_solver_that_stops_early_fails_and_is_told_by_the_power_of_its_error(solver, seen, as_before):
    step = all_at_once(table("backward_euler"), solver)
    report = held(step, "backward_euler", allowance=SOLVED, domain=SHORT)
    assert report.passed is False
    words = "is not backward_euler to the tolerance stated: its coefficients agree, but its solver"
    assert report.verdict.startswith(words)
    assert seen in report.verdict
    assert report.section("Coefficients: FAILED")
    named = identify(step, isolate=False)
    assert seen in named.verdict
    as_before(report.verdict, *titles(report), named.verdict, *titles(named))


def test_a_division_by_a_step_of_0_is_not_what_makes_a_method_unknown():
    report = verify(newmark_in_displacements(0.6), "trapezoid", isolate=False, allowance=SOLVED)
    assert report.verdict == "is not trapezoid; it is not a known method"
    assert report.section("Identified instead: faults").lines[0].startswith("it divides by h = 0")


def test_a_step_in_several_parts_is_shown_how_to_make_one_of_them():
    def in_parts(f, t, y, dt, substeps=4):
        for i in range(substeps):
            y = codes.rk4(f, t + i * dt / substeps, y, dt / substeps)
        return y

    verdict = verify(in_parts, "rk4", examples=20, isolate=False).verdict
    assert verdict.endswith("; write: def wrapped(f, t, y, h): return in_parts(f, t, y, h, substeps=1)")
