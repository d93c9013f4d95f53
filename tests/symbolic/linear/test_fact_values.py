"""Functions as facts: their values, their texts, and f(x²) written out."""

from fractions import Fraction as Q

import pytest
from flint import fmpq_poly

from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.fact_values import ExactFunction

F = fraction(fmpq_poly([1, -1]), fmpq_poly([4, 1]))


def test_a_function_has_values_and_a_text_and_so_has_that_of_a_square():
    plain, squared = ExactFunction(F, "z"), ExactFunction(F, "h", 2)
    assert (plain(Q(1, 2)), squared(Q(1, 2))) == (Q(1, 9), Q(3, 17))
    assert (str(plain), str(squared)) == ("(1/4 - z/4)/(1 + z/4)", "(1/4 - h**2/4)/(1 + h**2/4)")
    assert squared.inflated()(3) == squared(3) != plain(3)
    assert plain.inflated() is plain
    assert (squared.as_formula().text, squared.as_formula().function) == (str(squared), squared)
    with pytest.raises(ZeroDivisionError):
        plain(-4)
