"""Values that a number may be: the questions that braces stand for, and when one is meant."""

from fractions import Fraction as Q

import pytest

from driftproof.texts.claims.known_values import KnownValue, questions_in
from driftproof.texts.questions.evaluate import value


def test_braces_are_chosen_from_in_every_way_and_equal_braces_alike():
    every_way = [f"step rk4 h=1/{h} N={n} : q" for h in (2, 4) for n in (1, 2)]
    assert [*questions_in("step rk4 h=1/{2,4} N={1..2} : q")] == every_way
    assert questions_in("{1..2} - {1..2} + {a_b}") == {"1 - 1 + a_b": ("1", "a_b"), "2 - 2 + a_b": ("2", "a_b")}
    assert questions_in("1/3") == {"1/3": ()}
    assert len(questions_in("{1..2000}")) == 2000
    with pytest.raises(ValueError, match="expands to 2001 questions"):
        questions_in("{1..2001}")
    with pytest.raises(ValueError, match="expands to 0 questions"):
        questions_in("a - {3..1}")


def test_braces_of_one_setting_that_are_equally_long_go_together():
    halved = "run rk4 h={1/2,1/4} t={1,2} : q - run rk4 h={1/4,1/8} t={1,2} : q"
    pairs = [(h, half, t) for h, half in (("1/2", "1/4"), ("1/4", "1/8")) for t in (1, 2)]
    assert [*questions_in(halved)] == [f"run rk4 h={h} t={t} : q - run rk4 h={x} t={t} : q" for h, x, t in pairs]
    assert len(questions_in("h={1,2} h={1,2,3} t={4,5}")) == 12


def test_an_asked_value_of_one_digit_needs_two_names_nearby():
    for chosen, digits, fit, meant in ((("2",), 1, 1, False), (("2",), 2, 1, True), (("2", "3"), 1, 2, True)):
        assert KnownValue("", value("0.4"), chosen).is_meant(Q(2, 5), digits, fit, rivals=5) is meant


def test_the_numbers_of_a_value_are_those_chosen_and_the_time_of_so_many_of_the_first_steps():
    two = KnownValue("run rk4 h=1/2 N=3 : q - run rk4 h=1/4 N=6 : q", value("1"), ("3",))
    assert two.numbers == [{3, Q(3, 2)}]
