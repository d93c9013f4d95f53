"""Text as a right-hand side: the same in floats and in balls, where its numbers are exact."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb, ctx

from driftproof.enclosure.arithmetic.evaluations import Evaluation
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.fields import enclosed_rates
from driftproof.enclosure.fields.text_fields import field_function, right_hand_side
from driftproof.methods.formulas.field_text import field_of_text
from driftproof.methods.numbers.number_field import square_root
from tests.looping import exactly


def in_balls(f, t, y):
    evaluation = Evaluation()
    rates = enclosed_rates(f, Enclosed(evaluation, arb(t)), [Enclosed(evaluation, arb(x)) for x in y])
    return [rate.value for rate in rates], evaluation.doubles


def test_text_means_the_same_in_floats_and_in_balls():
    f = right_hand_side("sin(y1)/(2 + y0^2); exp(-t) - log(y1)*sqrt(y0)", 2)
    balls, _ = in_balls(f, 0.5, (1.25, 0.75))
    for ball, x in exactly(2, zip(balls, f(0.5, (1.25, 0.75)), strict=True)):
        assert abs(float(ball.mid()) - x) < 1e-15


def test_numbers_of_a_text_are_exact():
    with ctx.workprec(128):
        (ball,), doubles = in_balls(right_hand_side("0.1*y0", 1), 0, (1.0,))
        assert (10 * ball - 1).contains(0)
        assert not (10 * arb(0.1) - 1).contains(0)
    assert doubles == set()


def test_parameters_are_exact_and_other_expressions_know_them():
    field = field_of_text("k*y0", {"k": square_root(2), "third": Fraction(1, 3)})
    ((ball,), _), ((other,), _) = (in_balls(g, 0, (3.0,)) for g in (
        field_function(field), field_function(field, ["k*third*y0"])
    ))  # fmt: skip
    assert (ball * ball - 18).contains(0)
    assert (other * other - 2).contains(0)
    assert ball.rad() < 1e-14


def test_function_is_taken_as_it_is():
    assert right_hand_side(divmod, 1) is divmod


@pytest.mark.parametrize("given", ["y1; gamma(y0)", 3, [1, 2], ""])
def test_what_is_no_right_hand_side_is_refused(given):
    with pytest.raises(ValueError, match="f is not a right-hand side"):
        right_hand_side(given, 2)
