"""On a stiff and on an extreme problem every method does what is expected of its class; order reduction is proved."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.numeric.engine import field_runner
from driftproof.numeric.implicit import StageEquationsUnsolved, implicit_stepper
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.work_precision.integrators import field_rate
from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.stability_function import prothero_robinson, tableau
from tests.numeric.implicit_runs import implicit_run
from tests.witnesses.stiff_error import stiff_error

Tableau = RungeKutta | Collocation
TABLEAUX = {key: m for key, m in METHODS.items() if isinstance(m, Tableau)}
EXPLICIT = [key for key, m in TABLEAUX.items() if isinstance(m, RungeKutta) and m.explicit]
IMPLICIT = [key for key in TABLEAUX if key not in EXPLICIT]
RIGHT, WRONG, NOT_FINITE, REFUSED = "right", "wrong", "not finite", "refused"


def end(method: Tableau, problem: Problem, steps: int) -> list[float] | None:
    """The state at the end, which may hold infinities or NaN; None where a step was refused."""
    h, start = float(problem.t / steps), tuple(map(float, problem.start))
    if method.key in EXPLICIT:
        try:
            return list(field_runner(method, problem.field)(start, h, 0, steps))
        except (OverflowError, ZeroDivisionError, ValueError):
            return None
    try:
        return list(implicit_run(implicit_stepper(method, field_rate(problem.field)), start, h, steps).y)
    except StageEquationsUnsolved:
        return None


def outcome(method: Tableau, problem: Problem, steps: int, tolerance: float) -> str:
    found = end(method, problem, steps)
    if found is None:
        return REFUSED
    if not all(map(math.isfinite, found)):
        return NOT_FINITE
    right = map(float, problem.reference.states[-1])
    return RIGHT if max(abs(a - b) for a, b in zip(found, right, strict=True)) < tolerance else WRONG


def holds_for_any_stiffness(key: str) -> bool:
    """Stable, and with errors that do not grow with h |lambda|: those of Lobatto IIIB do."""
    try:
        return stiff_error(TABLEAUX[key]).decay >= 0
    except ValueError:
        return False


# h/epsilon = 15625: beyond every explicit method's limit, and small beside what the solution does.
KAPS = PROBLEMS["kaps"]


@pytest.mark.parametrize("key", EXPLICIT)
def test_explicit_methods_overflow_or_are_refused_on_a_stiff_problem(key: str) -> None:
    assert outcome(TABLEAUX[key], KAPS, 64, 0.01) in (NOT_FINITE, REFUSED)


@pytest.mark.parametrize("key", [key for key in IMPLICIT if holds_for_any_stiffness(key)])
def test_implicit_methods_are_right_on_a_stiff_problem(key: str) -> None:
    assert outcome(TABLEAUX[key], KAPS, 64, 0.01) == RIGHT


def test_lobatto_iiib_errs_the_more_the_stiffer_and_is_wrong_there() -> None:
    assert stiff_error(TABLEAUX["lobatto_iiib3"]).decay == -1
    assert outcome(TABLEAUX["lobatto_iiib3"], KAPS, 64, 0.01) == WRONG


@pytest.mark.parametrize("key", ["forward_euler", "rk4"])
def test_explicit_methods_are_right_on_a_stiff_pair_within_their_limit_and_not_beyond(key: str) -> None:
    assert outcome(TABLEAUX[key], PROBLEMS["stiff_pair"], 1024, 0.01) == RIGHT
    assert outcome(TABLEAUX[key], PROBLEMS["stiff_pair"], 256, 0.01) != RIGHT


def predicted(key: str, z: Fraction, steps: int) -> tuple[float, float]:
    """log10 of |R(z)|^steps, and R(z), exactly until the last."""
    value = exact(stability_function_of(TABLEAUX[key])(scalar(z)))  # type: ignore[misc]
    low, _ = endpoints(enclose(value))
    size = abs(low)
    logarithm = (size.numerator.bit_length() - size.denominator.bit_length()) * math.log10(2) if size else -math.inf
    return steps * logarithm, float(low)


@pytest.mark.parametrize("key", [*EXPLICIT, *IMPLICIT])
def test_decay_of_a_million_follows_the_stability_function_and_overflows_where_that_says_so(key: str) -> None:
    problem, steps = PROBLEMS["dahlquist_1e6"], 32
    size, factor = predicted(key, Fraction(-1000000, steps), steps)
    found = end(TABLEAUX[key], problem, steps)
    if abs(factor) <= 1:
        assert found is not None
        assert abs(found[0]) <= 1
    elif size > 330:
        assert found is None or not math.isfinite(found[0])
    else:
        assert found is not None
        assert abs(found[0]) > 1


# Local error C h^k (h lambda)^-m, R(oo), order on stiff problems.
REDUCED = {
    "backward_euler": (2, 1, Fraction(1, 2), 0, 1),
    "implicit_midpoint": (2, 0, Fraction(1, 4), -1, 2),
    "trapezoid": (3, 1, Fraction(1, 6), -1, 2),
    "gauss2": (3, 0, Fraction(1, 36), 1, 2),
    "gauss3": (4, 0, Fraction(1, 480), -1, 4),
    "radau_ia3": (3, 0, Fraction(1, 60), 0, 3),
    "radau_iia2": (3, 1, Fraction(1, 9), 0, 2),
    "radau_iia3": (4, 1, Fraction(1, 80), 0, 3),
    "lobatto_iiic3": (3, 1, Fraction(1, 12), 0, 2),
}


@pytest.mark.parametrize("key", REDUCED)
def test_order_on_stiff_problems_is_that_of_the_first_term_of_the_error(key: str) -> None:
    error = stiff_error(TABLEAUX[key])
    assert (error.power, error.decay, error.coefficient, error.at_infinity, error.order) == REDUCED[key]


def test_order_is_reduced_for_collocation_of_two_stages_and_more() -> None:
    for key in ("gauss2", "gauss3", "radau_ia3", "radau_iia3", "lobatto_iiic3"):
        assert stiff_error(TABLEAUX[key]).order < TABLEAUX[key].claimed_order


def test_order_on_stiff_problems_is_refused_where_errors_grow() -> None:
    with pytest.raises(ValueError, match="unstable"):
        stiff_error(METHODS["rk4"])


def defect(method: Tableau, power: int, z: Fraction) -> Fraction:
    """phi(1) - y1 of one step h = 1 from 0 on y' = z (y - phi) + phi', phi = t^power: stages by elimination."""
    data = tableau(method)
    a, b, c = (
        [[Fraction(str(x)) for x in row] for row in data.a],
        *([Fraction(str(x)) for x in v] for v in (data.b, data.c)),
    )
    right = [power * x ** (power - 1) - z * x**power for x in c]
    rows = [[(i == j) - z * x for j, x in enumerate(row)] + [right[i]] for i, row in enumerate(a)]
    for i in range(len(rows)):
        pivot = next(r for r in range(i, len(rows)) if rows[r][i])
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for r in range(len(rows)):
            if r != i:
                rows[r] = [x - rows[r][i] * y for x, y in zip(rows[r], rows[i], strict=True)]
    return 1 - sum((w * row[-1] for w, row in zip(b, rows, strict=True)), Fraction(0))


# Both sides are quotients of polynomials of degree stages + 1 at most: equal at 2 stages + 4 points, they are equal.
@pytest.mark.parametrize("key", ["backward_euler", "trapezoid", "radau_iia2", "lobatto_iiic3"])
def test_error_of_a_step_is_exactly_the_function_of_prothero_and_robinson(key: str) -> None:
    method = TABLEAUX[key]
    for power in range(1, 6):
        function = prothero_robinson(method, power)
        for z in (Fraction(-i - 1, 3) for i in range(2 * method.stages + 4)):
            assert Fraction(str(exact(function(scalar(z))))) * math.factorial(power) == defect(method, power, z)


def order_seen(key: str, coarse: int, fine: int) -> float:
    problem = PROBLEMS["prothero_robinson"]
    right = float(problem.reference.states[-1][0])
    errors = []
    for steps in (coarse, fine):
        found = end(TABLEAUX[key], problem, steps)
        assert found is not None
        errors.append(abs(found[0] - right))
    return float(np.log(errors[0] / errors[1]) / np.log(fine / coarse))


@pytest.mark.parametrize("key", ["implicit_midpoint", "gauss2", "gauss3", "radau_ia3", "radau_iia2", "radau_iia3"])
def test_order_seen_on_prothero_and_robinsons_equation_is_the_reduced_one(key: str) -> None:
    reduced, full = stiff_error(TABLEAUX[key]).order, TABLEAUX[key].claimed_order
    seen = order_seen(key, 20, 40)
    assert abs(seen - reduced) < 0.4
    assert full == reduced or seen < full - 0.5
