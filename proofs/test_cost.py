"""Counts of steps and evaluations, and what they leave open."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction as Q
from typing import Any

import pytest

from driftproof.methods.numbers.rationals import step_count
from driftproof.numeric.scenes import PRESETS
from driftproof.numeric.steppers import HAND_WRITTEN
from proofs.claims import CERTIFIED, COUNTED, PROVED, RESTRICTED, claim
from proofs.setting import (
    DEFAULT_H,
    END,
    EULER,
    FIRST_H,
    LESSON_METHODS,
    RK4,
    START,
    SYMPLECTIC,
    Real,
    counted_evaluations,
    energy,
    run,
    state_after,
)


class Tally:
    """A number that counts the operations on it in a counter that all results share."""

    def __init__(self, operations: Counter[str]) -> None:
        """Take the shared counter."""
        self.operations = operations

    def _count(self, name: str) -> Tally:
        self.operations[name] += 1
        return self

    def __add__(self, other: object) -> Tally:
        """Count an addition."""
        return self._count("+")

    def __mul__(self, other: object) -> Tally:
        """Count a multiplication."""
        return self._count("*")

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Tally:
        """Count a division."""
        return self._count("/")


def operations_of(key: str) -> Counter[str]:
    """The counts of the operations of one hand-written step, with calls of the force under "F"."""
    operations: Counter[str] = Counter()
    number = Tally(operations)
    HAND_WRITTEN[key](lambda q: q._count("F"), number, number, number)
    return operations


@claim("L092", evidence=COUNTED, by="counted calls")
def test_rk4_step_makes_four_evaluations(publish: Any) -> None:
    """A step of RK4 calls the acceleration four times."""
    calls = operations_of(RK4)["F"]
    assert calls == 4
    publish("rk4.evaluations_per_step", str(calls), Q(calls))


@claim("L093", evidence=COUNTED, by="counted calls")
def test_euler_steps_make_one_evaluation(publish: Any) -> None:
    """A step of either Euler method calls it once."""
    for key in (EULER, SYMPLECTIC):
        calls = operations_of(key)["F"]
        assert calls == 1
        publish(f"{key}.evaluations_per_step", str(calls), Q(calls))


@claim("L194", evidence=COUNTED, by="counted calls")
def test_evaluations_per_step_are_one_one_and_four(publish: Any) -> None:
    """Each Euler step evaluates the acceleration once, each RK4 step four times: 20 steps make 20, 20 and 80."""
    counts = [counted_evaluations(key, FIRST_H) for key in LESSON_METHODS]
    assert counts == [20, 20, 80]
    per_step = Q(counts[2], run(RK4, FIRST_H).steps)
    assert per_step == 4
    publish("rk4.evaluations_per_step", str(per_step), per_step)


@claim("L138", "L198", evidence=COUNTED, by="operations counted")
def test_evaluations_are_not_all_the_work() -> None:
    """The count is one operation of several: RK4 makes 4 evaluations to Euler's 1, but 32 other operations to 4."""
    others = {key: operations_of(key).total() - operations_of(key)["F"] for key in LESSON_METHODS}
    assert others == {EULER: 4, SYMPLECTIC: 4, RK4: 32}
    assert others[RK4] != 4 * others[EULER]


@claim("L094", evidence=RESTRICTED, by="exact quotient")
def test_every_run_ends_at_ten_of_h_that_divides_it() -> None:
    """Each scene's run goes from (1, 0) to t = 10: N·h = 10 exactly, for every preset step.

    Needed: an h that divides 10; with h = 3 no number of steps ends there.
    """
    for scene in PRESETS.values():
        assert (scene.start, scene.steps * scene.h) == (START, END)
    with pytest.raises(ValueError, match="does not divide"):
        step_count(END, Q(3))
    # In floats a hundred times a tenth is 10, but a hundred additions of it are not.
    tenth = float(Q(1, 10))
    assert 100 * tenth == 10
    assert sum([tenth] * 100) != 10


@claim("L197", evidence=COUNTED, by="counted calls")
def test_same_step_means_different_budgets() -> None:
    """At the same step the budgets differ, 40 and 160 evaluations; at a quarter of the step Euler spends 160, too."""
    assert (counted_evaluations(EULER, DEFAULT_H), counted_evaluations(RK4, DEFAULT_H)) == (40, 160)
    assert counted_evaluations(EULER, DEFAULT_H / 4) == counted_evaluations(RK4, DEFAULT_H)


@claim("L227", evidence=PROVED, by="exact rational arithmetic")
def test_exercise_one_energies_are_five_eighths() -> None:
    """Exercise 1: from (0, 1) with h = ½ both Euler methods reach the energy 5/8."""
    energies = [energy(*state_after(key, 1, FIRST_H, (Q(0), Q(1)))) for key in (EULER, SYMPLECTIC)]
    assert energies == [Q(5, 8), Q(5, 8)]
    assert energy(*state_after(SYMPLECTIC, 1, FIRST_H)) != Q(5, 8)


@claim("L235", evidence=PROVED, by="exact values compared")
def test_exercise_one_energy_is_above_the_start() -> None:
    """5/8 is above the initial ½."""
    assert energy(*state_after(SYMPLECTIC, 1, FIRST_H, (Q(0), Q(1)))) > energy(Q(0), Q(1)) == Q(1, 2)


@claim("L239", evidence=COUNTED, by="counted calls")
def test_exercise_two_budgets_are_equal(publish: Any) -> None:
    """Exercise 2: over 10, forward Euler with h = 1/10 and RK4 with h = 2/5 both make a hundred evaluations."""
    euler, rk4 = counted_evaluations(EULER, Q(1, 10)), counted_evaluations(RK4, Q(2, 5))
    assert (euler, rk4) == (100, 100)
    publish(f"{EULER}.exercise_2.evaluations", str(euler), Q(euler))


@claim("L244", evidence=CERTIFIED, by="disjoint enclosures")
def test_equal_counts_are_not_equal_accuracy() -> None:
    """Equal counts promise neither equal accuracy nor equal work: at 100 evaluations RK4 is over 290 times nearer.

    The other operations come to 25 times 32 against 100 times 4.
    """
    euler, rk4 = run(EULER, Q(1, 10)).state_error, run(RK4, Q(2, 5)).state_error
    assert Real(rk4) < Real(Q(22, 10_000))
    assert Real(Q(64, 100)) < Real(euler)
    assert 25 * (operations_of(RK4).total() - 4) != 100 * (operations_of(EULER).total() - 1)
