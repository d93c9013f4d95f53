"""The problems are what they say: matrices, forces, energies, derivatives, keys."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from flint import arb, arb_series, ctx

from driftproof.methods.formulas.vector_fields import VectorField, partial_derivative
from driftproof.numeric.problems.catalogue import PROBLEMS, problem_named
from driftproof.numeric.problems.problem import Problem
from tests.looping import exactly, some
from tests.witnesses.references.closed_forms import ball
from tests.witnesses.references.functions import derivative as all_derivatives
from tests.witnesses.references.functions import rate

key = lambda problem: problem.key
LINEAR = [p for p in PROBLEMS.values() if p.matrix is not None]
SECOND_ORDER = [p for p in PROBLEMS.values() if p.second_order]
CONSERVATIVE = [p for p in PROBLEMS.values() if p.energy is not None]
FAMILIES = {"explicit", "a_stable", "l_stable", "symplectic"}
OF_BALLS = {name: getattr(arb, name) for name in ("sin", "cos", "exp", "log", "sqrt")}
OF_SERIES = {name: getattr(arb_series, name) for name in OF_BALLS}


def states(problem: Problem) -> list[tuple[Fraction, ...]]:
    """Some that are nothing special, away from where a rate is not defined."""
    return [tuple(Fraction(7 * i * i + 11 * j + 1, 64) for i in range(len(problem.start))) for j in range(3)]


@pytest.mark.parametrize("problem", LINEAR, ids=key)
def test_matrix_times_the_state_is_the_rates_exactly(problem: Problem) -> None:
    f = rate(problem.field, lambda x: x)
    for y in some(states(problem)):
        product = [sum((a * x for a, x in zip(row, y, strict=True)), Fraction(0)) for row in problem.matrix or ()]
        assert f(None, y) == product
        assert f(None, (y[0] + 1, *y[1:])) != product


def energy_change(problem: Problem, energy: str, y: tuple[Fraction, ...]) -> arb:
    """dE/dt = Σ ∂E/∂yᵢ fᵢ in a ball."""
    names = problem.field.components
    gradient = VectorField(tuple(partial_derivative(energy, name) for name in names), problem.field.parameters)
    at = [ball(x) for x in y]
    f, g = (rate(field, ball, OF_BALLS)(arb(0), at) for field in (problem.field, gradient))
    return sum((a * b for a, b in zip(f, g, strict=True)), arb(0))


@pytest.mark.parametrize("problem", CONSERVATIVE, ids=key)
def test_energy_does_not_change_along_the_flow(problem: Problem) -> None:
    assert problem.energy is not None
    with ctx.workprec(300):
        for y in states(problem):
            change = energy_change(problem, problem.energy, y)
            assert change.contains(0)
            assert change.rad() < arb(10) ** -60
            assert not energy_change(problem, f"{problem.energy} + y0 / 1000", y).contains(0)


@pytest.mark.parametrize("problem", list(PROBLEMS.values()), ids=key)
def test_derivatives_are_those_that_series_find(problem: Problem) -> None:
    count = len(problem.start)
    with ctx.workprec(200):
        at = [ball(x) for x in states(problem)[0]]
        found = all_derivatives(problem.field, ball, OF_BALLS)(arb(1), at)
        for j in some(range(count)):
            moved = [arb_series([x, 1 if i == j else 0], 2) for i, x in enumerate(at)]
            slopes = rate(problem.field, ball, OF_SERIES)(arb_series([1], 2), moved)
            for i, slope in exactly(count, enumerate(slopes)):
                difference = slope[1] - found[i][j]
                assert difference.contains(0)
                assert difference.rad() < arb(10) ** -40


def test_rates_stay_exact_on_fractions_unless_they_call_a_function() -> None:
    calls = lambda problem: any(name in text for text in problem.field.rates for name in OF_BALLS)
    for problem in some((problem for problem in PROBLEMS.values() if not calls(problem)), 10):
        found = rate(problem.field, lambda x: x)(Fraction(1), states(problem)[0])
        assert all(isinstance(x, Fraction | int) for x in some(found)), problem.key


def test_problem_is_found_by_its_key_and_a_near_miss_is_answered() -> None:
    assert problem_named("robertson") is PROBLEMS["robertson"]
    with pytest.raises(ValueError, match="did you mean oregonator"):
        problem_named("oregonatr")


def test_every_problem_says_what_is_expected_of_some_class_of_method() -> None:
    for problem in PROBLEMS.values():
        assert problem.expected
        assert set(problem.expected) <= FAMILIES


def test_none_of_these_is_stiff_and_half_of_all_are() -> None:
    gentle = ["dahlquist_1", "harmonic_oscillator", "critically_damped_oscillator", "henon_heiles"]
    gentle += ["kepler", "kepler_eccentric", "kepler_extreme", "pendulum", "pendulum_near_separatrix"]
    assert not any(PROBLEMS[key].stiff for key in gentle)
    assert sum(problem.stiff for problem in PROBLEMS.values()) >= 17


def test_those_of_second_order_conserve_an_energy_and_all_that_could_be_are_said_to_be() -> None:
    """A field whose first half of rates are the second half of y, as they are, is of second order, but for damping."""
    assert CONSERVATIVE == SECOND_ORDER
    assert len(SECOND_ORDER) >= 10
    for problem in PROBLEMS.values():
        half, names = len(problem.start) // 2, problem.field.components
        is_one = problem.field.rates[:half] == names[half:] != () and all(
            partial_derivative(force, v) == "0" for force in problem.field.rates[half:] for v in names[half:]
        )
        assert is_one == problem.second_order, problem.key


def test_digits_file_holds_the_problems_and_no_others() -> None:
    text = (Path(__file__).parents[3] / "driftproof/numeric/problems/digits.json").read_text(encoding="utf-8")
    assert set(json.loads(text)) == set(PROBLEMS)
