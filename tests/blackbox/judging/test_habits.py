"""What a step does besides the method is named: a habit of codes, or roundings that its bound does not count."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.judging.habits import explain_by_habits
from driftproof.blackbox.judging.specification import NO_ALLOWANCE, Allowance, Specification
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.checks.habits import plain
from tests.blackbox.transcripts import Asked


def verlet_by_positions(q, v, h):
    end = q + h * (v - h / 2 * q)
    return end, (end - q) / h - h / 2 * end


def test_a_velocity_that_is_a_difference_of_positions_is_named_in_the_verdict():
    report = verify(verlet_by_positions, "velocity_verlet", examples=200)
    named = "is not velocity_verlet to roundoff; it is, if the velocity is a difference of positions over h"
    assert report.verdict == named
    assert not report.passed


class Factored:
    """Backward Euler by Newton's iteration, whose matrix is that of the first h if it is `kept`."""

    def __init__(self, kept):
        """Nothing kept yet."""
        self.kept, self.inverse, self.size = kept, None, None

    def step(self, f, t, y, h):
        """One step."""
        if self.inverse is None or (not self.kept and self.size != h):
            slopes = [(f(t + h, y + 1e-7 * e) - f(t + h, y - 1e-7 * e)) / 2e-7 for e in np.eye(len(y))]
            self.inverse, self.size = np.linalg.inv(np.eye(len(y)) - h * np.column_stack(slopes)), h
        z = np.array(y, float)
        for _ in range(60):
            moved = self.inverse @ (y + h * f(t + h, z) - z)
            z = z + moved
            if np.abs(moved).max() < 1e-14 * (1 + np.abs(z).max()):
                break
        return z


def test_a_matrix_that_is_kept_where_h_changes_is_shown_by_two_steps_and_is_no_slow_iteration():
    solved = Allowance(solver_tolerance=1e-10)
    assert verify(Factored(False).step, "backward_euler", allowance=solved, examples=100, isolate=False).passed
    report = verify(Factored(True).step, "backward_euler", allowance=solved, isolate=False)
    assert report.verdict == "is not backward_euler to the tolerance stated; it is, if a new object makes each step"
    steps = next(line for line in report.text().splitlines() if "to reproduce" in line).partition(": ")[2].split("; ")
    step = Factored(True).step
    ends = [eval(each, {"step": step, "numpy": np}) for each in steps]
    assert len(steps) == 2
    assert np.abs(ends[-1] - 0.5).max() > 1e-10


def test_an_error_too_large_for_a_float_refutes_and_has_no_number_of_digits():
    report = verify(lambda q, v, h: (1e300, v - h * q), "forward_euler", examples=50, isolate=False)
    assert report.passed is False
    assert report.verdict.startswith("is not forward_euler")


def in_binary32_first(q, v, h):
    return plain(q, v, float(np.float32(h)))


EXPLAINED = {
    "h in binary32": (in_binary32_first, "symplectic_euler"),
    "a velocity from positions": (verlet_by_positions, "velocity_verlet"),
    "by its force": (codes.velocity_verlet, "velocity_verlet"),
    "another": (plain, "velocity_verlet"),
    "by collocation": (lambda q, v, h: (q + h * v, v - h * q), "gauss2"),
}


@pytest.mark.parametrize("name", EXPLAINED)
def test_what_explains_a_step_is_what_it_was(name, as_before):
    step, key = EXPLAINED[name]
    asked = Asked(step)
    solved = NO_ALLOWANCE if METHODS[key].explicit else Allowance(solver_tolerance=1e-9)
    found = explain_by_habits(opened(asked.code), Specification(METHODS[key], solved), examples=60)
    as_before(found.holds, found.but_for, *found.lines, asked)


def averaged(part):
    def step(f, t, y, h):
        y1 = y + h * f(t, y)
        return part * (y + y1 + h * f(t + h, y1))

    return step


def in_parts(parts, stale=False):
    """Velocity Verlet with a force that is a sum of so many equal parts, or one of them wrongly kept."""

    def step(force, q, v, h):
        for _ in range(parts):
            v = v + h / 2 * (force(q) / parts)
        before, q = q, q + h * v
        for i in range(parts):
            v = v + h / 2 * (force(before if stale and not i else q) / parts)
        return q, v

    return step


@pytest.mark.parametrize("parts", [2, 3])
def test_a_kick_that_is_added_in_parts_has_roundings_of_its_own(parts):
    found = verify(in_parts(parts), "velocity_verlet", isolate=False)
    assert found.passed
    assert "1000 steps within 3 times the derived bound, as where kicks are added in parts" in found.verdict
    assert verify(in_parts(parts, stale=True), "velocity_verlet", isolate=False).passed is False


@pytest.mark.slow
def test_a_last_stage_that_is_an_average_has_roundings_of_its_own_and_other_faults_beside_them():
    found = verify(averaged(0.5), "heun2", isolate=False)
    assert found.passed
    assert (
        "1000 steps within 4 times the derived bound, as in averages of stages, the largest error 1.1" in found.verdict
    )
    assert not verify(averaged(0.5 + 2e-15), "heun2", isolate=False).passed
    few = verify(lambda f, t, y, h: averaged(0.5)(f, t, y, float(np.float32(h))), "heun2", isolate=False)
    assert few.verdict == "is not heun2 to roundoff; it is, if h is rounded to binary32 first"
