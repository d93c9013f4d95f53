"""The law of step sizes is fitted to errors and factors where it gives them all, with the numbers that went in."""

from __future__ import annotations

from fractions import Fraction
from math import exp, log

import pytest

from driftproof.blackbox.solvers.step_size_law import Law, LawPoint, _fitted, exceptions, fitted_law


@pytest.mark.parametrize("terms", [2, 3, 4])
def test_a_law_is_fitted_to_three_steps_more_than_it_has_numbers_all_of_which_are_close(terms):
    numbers = [0.25, 0.5, 0.125, 0.0625][:terms]  # log of safety, exponent, memory, filter

    def points(count, off=0.0):
        for n in range(count):
            error, before, growth = 1.0 + n, n * n / 7, (-1.0) ** (n // 2)
            logs = zip(numbers, (1.0, -error, before, growth), strict=False)
            yield LawPoint(
                error, 0.0, before, growth, exp(sum(x * y for x, y in logs) + off * (n == 9)), True, 0, False
            )

    assert _fitted([*points(terms + 2)], terms) is None
    assert _fitted([*points(terms + 3)], terms) == pytest.approx(numbers)
    assert _fitted([*points(40, 1.9e-4)], terms) == pytest.approx(numbers, abs=1e-4)
    assert _fitted([*points(40, 2.1e-4)], terms) is None


@pytest.mark.parametrize(("numbers", "noise", "fitted"), [
    ((0.25, 7 / 40 + 1e-6, 0.0), 9e-5, (Fraction(7, 40), 0)),  # factors this far off cannot tell these from 7/40 and 0
    ((0.25, 7 / 40, 0.002), 0.0, None),  # no controller remembers so little
    ((0.25, 0.03125**0.5, 0.04), 0.0, (pytest.approx(0.03125**0.5), Fraction(1, 25))),  # no fraction is near
    ((0.25, 7 / 40, 1 / 120), 0.0, (Fraction(7, 40), Fraction(1, 120))),
])  # fmt: skip
def test_exponents_are_fractions_of_denominators_in_use_unless_the_step_sizes_tell_otherwise(numbers, noise, fitted):
    points = []
    for n in range(40):
        error, before = n / 4 - 5, (7 * n % 40) / 4 - 5
        factor = exp(numbers[0] - numbers[1] * error + numbers[2] * before + noise * (-1) ** (n // 3))
        points.append(LawPoint(error, 0.0, before, 0.0, factor, True, 0, False))
    found = _fitted(points, 3)
    assert (found is None) is (fitted is None)
    assert found is None or (found[1], found[2]) == fitted


@pytest.mark.parametrize(("least", "most", "limits"), [(0.2, 12.8, (None, None)), (0.3, 4.0, (0.3, 4.0))])
def test_an_extreme_factor_is_a_limit_if_several_steps_have_it(least, most, limits):
    """A law 0.8 r^(-1/5) gives 0.2 and 12.8 once each; limits of 0.3 and 4 clip these and others."""
    errors = [5 * log(0.8 / x) for x in (0.2, 12.8, *(0.22 + n / 4 for n in range(40)))]
    factors = [min(max(0.8 * exp(-error / 5), least), most) for error in errors]
    points = [LawPoint(r, 0.0, 0.0, 0.0, x, r <= 0, 0, False) for r, x in zip(errors, factors, strict=True)]
    if least == 0.2:  # two errors that the rounded time of a jump makes larger than those that the code had
        points += [LawPoint(5 * log(0.8 / x), 0.0, 0.0, 0.0, 1.2 * x, False, 1, True) for x in (0.16, 0.165)]
    law = fitted_law("bogacki_shampine32", points)
    assert (law.smallest, law.largest, law.exponent) == (*limits, Fraction(1, 5))


@pytest.mark.parametrize(("exponent", "said"), [(1 / 3, "; after a rejection 0.5 r^(-1/3)"), (0, ", but 7 of 7 steps")])
def test_a_factor_that_forgets_the_error_is_no_law_of_steps_after_a_rejection(exponent, said):
    law = Law("of a pair", 0.9, Fraction(1, 5), 0, 0, None, None, None, False, 1.0, "")
    errors = [n / 4 - 5 for n in range(20)]
    points = [LawPoint(r, 0.0, 0.0, 0.0, 0.9 * exp(-r / 5), True, 0, False) for r in errors]
    points += [LawPoint(n / 4, 0.0, 0.0, 0.0, 0.5 * exp(-exponent * n / 4), False, 1, False) for n in range(1, 8)]
    assert exceptions(points, law, 0.01, 5.0).startswith(said)
