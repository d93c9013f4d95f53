"""The strategies we ship reach what they promise, nothing else, and refuse arguments that no value satisfies."""

from __future__ import annotations

import sys
from collections.abc import Callable
from fractions import Fraction as Q
from math import copysign, isfinite
from typing import Any

import pytest
from hypothesis import Phase, find, given, settings
from hypothesis.errors import NoSuchExample

from driftproof import strategies
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.strategies import STABILITY_LIMITS, step_by_ulps

TINY = sys.float_info.min
REACHED: dict[str, tuple[Any, Callable[[Any], bool]]] = {
    "a subnormal": (strategies.finite_floats(), lambda x: 0 < x < TINY),
    "the smallest subnormal": (strategies.finite_floats(), lambda x: x == 5e-324),
    "minus zero": (strategies.finite_floats(), lambda x: x == 0 and copysign(1, x) < 0),
    "a huge negative number": (strategies.finite_floats(), lambda x: x < -1e308),
    "an ordinary number": (strategies.finite_floats(-3, 3), lambda x: 0.1 < x < 10),
    "a mantissa of all ones": (strategies.finite_floats(), lambda x: x == sys.float_info.max),
    "both components huge": (strategies.states(), lambda z: min(map(abs, z)) > 1e308),
    "components that cancel but for an ulp": (strategies.states(), lambda z: 0 < abs(z[0] + z[1]) <= abs(z[0]) / 2**52),
    "no step at all": (strategies.steps(), lambda h: h == 0),
    "a step of a tenth": (strategies.steps(), lambda h: h == 0.1),
    "a subnormal step": (strategies.steps(), lambda h: 0 < abs(h) < TINY),
    "the largest step": (strategies.steps(max_value=2.5), lambda h: h == 2.5),
    "a step above 2 by an ulp": (strategies.steps_near_stability_limits(), lambda h: h == step_by_ulps(2.0, 1)),
    "a step below 2 sqrt 2": (
        strategies.steps_near_stability_limits(),
        lambda h: h == step_by_ulps(STABILITY_LIMITS[1], -1),
    ),
    "the origin": (strategies.rational_states(), lambda z: z == (0, 0)),
    "a negative rational step": (strategies.rational_steps(), lambda h: h < 0),
    "four stages that see each other": (
        strategies.runge_kutta_methods(),
        lambda m: m.stages == 4 and all(m.a[i][i - 1] for i in (1, 2, 3)),
    ),
    "a splitting of six parts, drift first": (
        strategies.splittings(),
        lambda m: len(m.parts) == 6 and m.parts[0][0] == "drift",
    ),
    "a part that runs backwards": (strategies.splittings(), lambda m: any(c < 0 for _, c in m.parts)),
}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("name", REACHED)
def test_strategy_reaches(name: str) -> None:
    strategy, wanted = REACHED[name]
    drawing = settings(max_examples=20_000, database=None, phases=[Phase.generate], derandomize=True)
    assert wanted(find(strategy, wanted, settings=drawing))


def test_what_no_strategy_can_reach_is_not_found() -> None:
    drawing = settings(max_examples=200, database=None, phases=[Phase.generate])
    with pytest.raises(NoSuchExample):
        find(strategies.finite_floats(), lambda x: not isfinite(x), settings=drawing)


@given(strategies.finite_floats(-10, 20))
def test_drawn_floats_keep_to_their_exponents(x: float) -> None:
    assert x == 0 or 2.0**-10 <= abs(x) < 2.0**21


@given(strategies.finite_floats() | strategies.steps() | strategies.steps_near(-1e300))
def test_drawn_floats_are_finite(x: float) -> None:
    assert isfinite(x)


@given(strategies.steps_near(1.0, ulps=3))
def test_steps_near_are_so_many_ulps_away_at_most(h: float) -> None:
    assert abs(Q(h) - 1) <= Q(3, 2**52)


@given(strategies.rationals(max_size=3, max_denominator=7))
def test_drawn_rationals_keep_to_their_bounds(x: Q) -> None:
    assert abs(x) <= 3
    assert x.denominator <= 7


@given(strategies.runge_kutta_methods(2, 3), strategies.splittings(2))
def test_drawn_methods_keep_to_their_sizes(tableau: RungeKutta, splitting: Splitting) -> None:
    assert tableau.stages in (2, 3)
    assert len(splitting.parts) in (2, 4)
    assert all(a != b for (a, _), (b, _) in zip(splitting.parts, splitting.parts[1:], strict=False))


IMPOSSIBLE: list[Callable[[], Any]] = [
    lambda: strategies.finite_floats(5, 4),
    lambda: strategies.finite_floats(min_exponent=-1023),
    lambda: strategies.finite_floats(max_exponent=1024),
    lambda: strategies.states(5, 4),
    lambda: strategies.steps(1.0, 0.5),
    lambda: strategies.steps(float("nan"), 1.0),
    lambda: strategies.steps(0.0, float("inf")),
    lambda: strategies.steps_near(1.0, -1),
    lambda: strategies.steps_near(float("inf")),
    lambda: strategies.steps_near(sys.float_info.max),
    lambda: strategies.rationals(-1),
    lambda: strategies.rationals(1, 0),
    lambda: strategies.rational_steps(0),
    lambda: strategies.rational_states(-1),
    lambda: strategies.runge_kutta_methods(0),
    lambda: strategies.runge_kutta_methods(3, 2),
    lambda: strategies.splittings(0),
]


@pytest.mark.parametrize("ask", IMPOSSIBLE, ids=range(len(IMPOSSIBLE)))
def test_impossible_arguments_raise_when_asked_and_not_when_drawn(ask: Callable[[], Any]) -> None:
    with pytest.raises(ValueError, match=r"need|give|at least one|no nonzero"):
        ask()


def test_profiles_are_those_of_the_house() -> None:
    default, ci, thorough = (settings.get_profile(name) for name in ("default", "ci", "thorough"))
    assert (default.deadline, default.print_blob) == (None, True)
    assert (ci.derandomize, ci.deadline) == (True, None)
    assert thorough.max_examples > 10 * default.max_examples


CHOSEN = """
import os, runpy
for name in ("CI", "HYPOTHESIS_PROFILE"): os.environ.pop(name, None)
os.environ.update({env})
runpy.run_path("conftest.py")
from hypothesis import settings
print(settings().derandomize, settings().max_examples)
"""


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    ("env", "chosen"),
    [
        ({}, "False 50"), ({"CI": "true"}, "True 100"), ({"CI": "false"}, "False 50"),
        ({"HYPOTHESIS_PROFILE": "thorough", "CI": "true"}, "False 2000"),
    ],
    ids=["nothing", "CI", "CI off", "named"],
)  # fmt: skip
def test_profile_is_chosen_by_the_environment(
    env: dict[str, str], chosen: str, fresh_python: Callable[[str], str]
) -> None:
    assert fresh_python(CHOSEN.format(env=env)) == chosen


def test_strategies_register_no_profile_on_import(fresh_python: Callable[[str], str]) -> None:
    profiles = "sorted(hypothesis.settings._profiles)"
    code = f"import hypothesis\nbefore = {profiles}\nimport driftproof.strategies\nprint(before == {profiles})"
    assert fresh_python(code) == "True"
