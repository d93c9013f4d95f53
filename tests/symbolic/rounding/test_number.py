"""Numbers that carry an exact polynomial and a bound: every power is kept, and what cannot be followed is refused."""

from __future__ import annotations

import math
from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.methods.numbers.number_field import square_root
from driftproof.numeric.steppers import symplectic_euler
from driftproof.symbolic.rounding import number
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat
from driftproof.symbolic.rounding.number import RefusedOperation, constant
from driftproof.symbolic.rounding.polynomials import ETA, D, absolute_value, constant_term, terms
from driftproof.symbolic.rounding.polynomials import H as STEP
from driftproof.symbolic.rounding.polynomials import Q as STATE
from driftproof.symbolic.rounding.polynomials import V as VELOCITY
from driftproof.symbolic.rounding.step_bound import step_bound
from tests.changes import coefficients
from tests.symbolic.rounding.programs import IRRATIONAL

ROOT = square_root(2)


def test_every_power_of_d_is_kept():
    """n products in a row: exactly ((1 + d)^n - 1)|h^n q|, and eta/2 at each, carried on by the factors that follow."""
    n = 6

    def multiply(force, q, v, h):
        for _ in range(n):
            q = q * h
        return q, v

    error = step_bound(multiply).outputs[0].error
    underflow = sum(((1 + D) * STEP) ** k for k in range(n)) * ETA / 2
    assert error == ((1 + D) ** n - 1) * STEP**n * STATE + underflow


def test_the_product_of_two_rounded_numbers_counts_both_errors_and_their_product():
    error = step_bound(lambda force, q, v, h: ((h * h) * (h * v), v)).outputs[0].error
    first, second = ((1 + D) * x + ETA / 2 for x in (STEP**2, STEP * VELOCITY))
    assert error == (1 + D) * first * second - STEP**3 * VELOCITY + ETA / 2


@pytest.mark.parametrize("emin", [-1022, 2, 3])
def test_highest_powers_are_gathered_in_lower_ones(emin: int, monkeypatch: pytest.MonkeyPatch):
    """Down to d and eta, d³ eta² becomes d eta/4, as d <= 1/2 and eta <= 1; where eta is 2 it stays."""
    monkeypatch.setattr(number, "MOST_D", 1)
    monkeypatch.setattr(number, "MOST_ETA", 1)
    error = step_bound(lambda force, q, v, h: ((h * h) * (h * v), v), FloatFormat("of 3 bits", 3, emin, 1023))
    first, second = ((1 + D) * x + ETA / 2 for x in (STEP**2, STEP * VELOCITY))
    wanted = (1 + D) * first * second - STEP**3 * VELOCITY + ETA / 2
    if emin < 3:
        wanted = sum(
            as_fmpq(c / 2 ** max(in_d - 1, 0)) * D ** min(in_d, 1) * ETA ** min(in_eta, 1) * STEP**in_h * VELOCITY**in_v
            for (in_d, in_eta, in_h, _, in_v), c in terms(wanted)
        )
    assert error.outputs[0].error == wanted


@pytest.mark.parametrize("fmt", [BINARY64, BINARY32, BINARY16], ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", IRRATIONAL)
def test_each_coefficient_is_rounded_correctly_and_owns_up_to_just_its_distance(key: str, fmt: FloatFormat):
    """fl(c) by enclosures; float(c) finds the double by bisection, another way."""
    found = set(coefficients(METHODS[key]).values())
    assert found
    for c in found:
        lifted = constant(c, fmt)
        if fmt == BINARY64:
            assert lifted.stored_value == Q(float(c))
        assert constant_term(lifted.exact) == c
        error = sum(k * fmt.relative_error**in_d for (in_d, *_), k in terms(lifted.error))
        distance = absolute_value(c - lifted.stored_value)
        assert distance <= error <= distance * (1 + 2 * fmt.u**2)
        assert error <= fmt.u * absolute_value(c)
    third, d = constant(Q(1, 3), fmt), fmt.relative_error
    error = sum(k * d**in_d for (in_d, *_), k in terms(third.error))
    assert error == abs(Q(1, 3) - third.stored_value) / fmt.u * (d + d**2 + 2 * d**3)


def test_what_divides_by_an_irrational_constant_has_the_exact_quotient():
    def halved(force, q, v, h):
        return q / constant(ROOT, BINARY64), v

    (qq, _, _, _), error = step_bound(halved).entries, step_bound(halved).first_order[0][0]
    assert qq == {0: 1 / ROOT}
    distance = absolute_value(1 / ROOT - 1 / Q(float(ROOT))) / BINARY64.u
    assert absolute_value(1 / ROOT + distance - constant_term(error)) < Q(1, 2**100)


REFUSED = {
    "a comparison of computed values": lambda force, q, v, h: (q, v) if q > v else (v, q),
    "a branch on a computed value": lambda force, q, v, h: (q, v) if q else (v, q),
    "division by something that depends on q, v or h": lambda force, q, v, h: (q / h, v),
    "a function of math": lambda force, q, v, h: (math.sin(q), v),
    "a call of sin": lambda force, q, v, h: (np.sin(q), v),
    "a call of sqrt": lambda force, q, v, h: (q.sqrt(), v),
    "a conversion to int": lambda force, q, v, h: (int(q), v),
    "a power, a library call": lambda force, q, v, h: (q**2, v),
    "a floor division": lambda force, q, v, h: (q // 2, v),
    "rounding a value": lambda force, q, v, h: (round(q), v),
    "abs()": lambda force, q, v, h: (abs(q), v),
    "division by zero": lambda force, q, v, h: (q / 0, v),
    "a set or dictionary of computed values": lambda force, q, v, h: ({q: 1}[q], v),
    "not a finite number": lambda force, q, v, h: (q + math.inf, v),
    "which is str": lambda force, q, v, h: (q * "2", v),
    "which is bool": lambda force, q, v, h: (q * True, v),
    "which is complex": lambda force, q, v, h: (q * 1j, v),
    "which is Algebraic and not a finite number": lambda force, q, v, h: (q * ROOT, v),
}


def test_arithmetic_of_constants_is_that_of_floats():
    c = constant(Q(1, 3), BINARY64)
    pairs = (
        (2 / c, 2 / (1 / 3)), (-c, -(1 / 3)), (c - 1, 1 / 3 - 1), (1 - c, 1 - 1 / 3), (+c, 1 / 3),
        (c * c, (1 / 3) ** 2),
    )  # fmt: skip
    for x, wanted in pairs:
        assert x.stored_value == Q(wanted)
    with pytest.raises(AttributeError, match="__array__"):
        _ = c.__array__


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_bounded_is_refused_with_the_line_that_does_it(what):
    with pytest.raises(RefusedOperation) as refusal:
        step_bound(REFUSED[what])
    message = str(refusal.value)
    assert message.startswith(f"{__file__}:{REFUSED[what].__code__.co_firstlineno}: `")
    assert what in message
    assert "lambda force, q, v, h:" in message


def test_a_refusal_points_into_the_force_when_the_force_is_to_blame():
    def pendulum(q):
        return -math.sin(q)

    with pytest.raises(RefusedOperation, match=r"test_number.py:\d+: `return -math.sin\(q\)`"):
        step_bound(symplectic_euler, force=pendulum)
