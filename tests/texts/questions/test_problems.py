"""Runs on problems and on y' = λy are those of Fractions and of floats; constants, exponents and counts of steps."""

from __future__ import annotations

import math
from fractions import Fraction as Q
from pathlib import Path

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.texts.questions.evaluate import value
from tests.texts.questions.refusals import demand_refusal

MINE = """
rates = ["y1", "-g * sin(y0)"]
start = ["1/2", "0"]
end = "2"
parameters.g = "9.81"
"""


def by_hand(steps: int, h: float) -> np.ndarray:
    """Heun's method on the pendulum of MINE, in floats."""
    f = lambda y: np.array([y[1], -9.81 * math.sin(y[0])])
    y = np.array([0.5, 0.0])
    for _ in range(steps):
        k = f(y)
        y = y + h / 2 * (k + f(y + h * k))
    return y


def test_run_on_a_problem_of_a_file_is_that_of_a_float_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(MINE, encoding="utf-8")
    q, v = (float(value(f"run heun2 problem=mine.toml h=1/16 16 steps : y{i}").digits(17)) for i in (0, 1))
    assert abs(by_hand(16, 1 / 16) - [q, v]).max() < 1e-13  # 16 steps of some ten roundings of numbers below 2
    fine = by_hand(4096, 1 / 4096)  # off by about 1e-6: 9.81 h**2
    assert abs(float(value("exact problem=mine.toml t=1 : y0").digits(17)) - fine[0]) < 1e-5
    error = value("run heun2 problem=mine.toml h=1/16 t=1 : state_error").digits(4)
    assert float(error) == pytest.approx(np.hypot(*(by_hand(16, 1 / 16) - fine)), rel=1e-3)
    assert value("run heun2 problem=mine.toml h=1/16 t=1 : steps").exact == 16
    assert (
        value("exact problem=mine.toml t=1 : y0")
        .digits(40)
        .startswith(value("exact problem=mine.toml t=1 : y0").digits(30)[:29])
    )


@pytest.mark.parametrize("key", ["rk4", "backward_euler", "gauss2", "heun2"])
def test_run_on_decay_is_the_power_of_the_stability_function(key: str) -> None:
    factor = value(f"stability_function {key} z=-1/2").exact
    assert value(f"run {key} lambda=-2 h=1/4 t=1 : y").exact == factor**4
    off = abs(float(factor**4) - math.exp(-2))
    assert float(value(f"run {key} lambda=-2 h=1/4 t=1 : state_error").digits(6)) == pytest.approx(off, rel=1e-5)
    assert value(f"step {key} lambda=-2 h=1/4 : exact.y").exact_text == "exp(-1/2)"
    assert METHODS[key].key == key


# Question -> the beginning of its decimal, to the digits that a float has surely.
KNOWN = {
    "pi": math.pi, "e": math.e, "2*pi/3": 2 * math.pi / 3, "exp(-1/4)": math.exp(-0.25), "exp(0)": 1.0, "ln(1)": 0.0,
    "ln(exp(2))": 2.0, "cos(pi/3)": 0.5, "(17/16)**1000": (17 / 16) ** 1000,
    "run rk4 h=1/1000 1000 steps : steps": 1000.0,
}  # fmt: skip


@pytest.mark.parametrize("question", KNOWN)
def test_constants_functions_powers_and_counts_of_steps(question: str) -> None:
    assert float(value(question).digits(12)) == pytest.approx(KNOWN[question], rel=1e-11)


def test_power_too_long_to_write_out_is_enclosed() -> None:
    assert value("(17/16)**1000").exact == Q(17, 16) ** 1000
    huge = value("(17/16)**100000")
    assert (huge.evidence, huge.digits(3)) == ("CERTIFIED", "7.83e2632")
    assert value("(-1)**999999").digits(2) == "-1.0"


REFUSED = [
    ("run rk4 problem=nope h=1/4 t=1 : y0", 17, "unknown problem 'nope'"),
    ("run rk4 problem=pendulum h=1/3 t=1/2 : y0", 17, "does not divide"),
    ("run rk4 problem=pendulum h=1/4 t=1 from 1,0 : y0", 1, "a problem has its own start"),
    ("run rk4 problem=pendulum lambda=1 h=1/4 t=1 : y0", 17, "two problems"),
    ("run rk4 problem=pendulum h=1/4 t=1 : y7", 38, "no readout of run; there are y0"),
    ("run rk4 problem=pendulum h=1e-9 t=1 : y0", 17, "at most 100000"),
    ("run velocity_verlet problem=kaps h=1/4 t=1 : y0", 29, "second-order"),
    ("order rk4 problem=pendulum", 19, "about no problem"),
    ("run rk4 lambda=-1 h=1/3 t=1/2 : y", 1, "does not divide"),
    ("run velocity_verlet lambda=-1 h=1/4 t=1 : y", 5, "no stability_function"),
    ("ln(0)", 1, "only a number above zero has a logarithm"),
    ("exact problem=pendulum h=1 t=1 : y0", 24, "has no setting h here"),
]


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_what_has_no_answer_is_refused_at_its_column(question: str, column: int, reason: str) -> None:
    demand_refusal(question, column, reason)
