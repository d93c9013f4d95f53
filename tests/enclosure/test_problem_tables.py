"""A problem is read from its table exactly, from rates or from code; what is no problem is refused in one line."""

from __future__ import annotations

import re
from fractions import Fraction as Q
from math import pi

import numpy as np
import pytest

from driftproof.enclosure.problem_tables import given_problem, nearest, number_entry, problem_table, steps_to


def test_function_and_rates_give_one_field_with_the_energy_in_doubles():
    spring = {"start": ["1", "0"], "parameters": {"k": "0.5"}, "energy": "y1^2/2 + k*y0^2/2"}
    code = problem_table({**spring, "function": lambda t, y, k: [y[1], -k * y[0]]})
    text = problem_table({**spring, "rates": ["y1", "-k * y0"]})
    assert code.start == text.start == (Q(1), Q(0))
    assert dict(code.field.parameters) == {"double_0": Q(-1, 2)}
    assert dict(text.field.parameters) == {"k": Q(1, 2)}
    assert text.energy == "((y1 * y1) / 2) + (k * (y0 * y0) / 2)"
    assert code.energy == "((y1 * y1) / 2) + ((1 / 2) * (y0 * y0) / 2)"


def test_parameters_stand_in_a_start_and_an_end():
    table = {"rates": {"x": "v", "v": "-x"}, "start": {"x": "a*(1-e)", "v": "a"}, "end": "10*b"}
    values = {"a": "2", "e": "1/4", "b": "a/8"}
    given = given_problem({**table, "parameters": values}, {"e": "1/2"})
    assert (given.start, given.end) == ((Q(1), Q(2)), Q(5, 2))
    with pytest.raises(ValueError, match=re.escape("start.x, 'a*(1-e)' with parameters, is '(2)*(1-e)'; write a num")):
        problem_table({**table, "parameters": {"a": "2"}})


def test_parameters_are_replaced_or_are_keywords_and_texts_have_none():
    spring = {"rates": ["y1", "-k * y0"], "parameters": {"k": 0.5, "c": 1}}
    assert dict(given_problem(spring, {"k": "1/3"}).f.parameters) == {"k": Q(1, 3), "c": Q(1)}
    found = given_problem(lambda t, y, k: [k * y[0]], [("k", "0.5")]).f
    assert found(0.0, [3.0]) == [1.5]
    told = {"single": np.float32(0.1), "half": np.float16(0.1), "large": 2**53 + 1, "third": Q(1, 3)}
    assert given_problem(lambda t, y, **its: its, told).f(0.0, []) == told | {"third": 1 / 3}
    assert dict(given_problem({"rates": ["k"], "parameters": {"k": np.float32(0.1)}}).f.parameters) == {
        "k": Q(str(float(np.float32(0.1))))
    }
    of_table = given_problem({"function": lambda t, y, **its: its, "parameters": told}).f(0.0, [])
    assert of_table == told | {"third": 1 / 3}
    driven = {"function": lambda t, y, w: [w * y[0]], "parameters": {"f": 3, "g": 2, "w": "2*f"}}
    with pytest.raises(TypeError, match="unexpected keyword argument 'g'"):  # stands nowhere
        given_problem(driven).f(0.0, [1.0])
    del driven["parameters"]["g"]
    assert given_problem(driven).f(0.0, [1.0]) == [6.0]
    for given, words in (
        (spring, "unknown parameter 'g'; choose from k, c"),
        ({"rates": ["y0"]}, "no parameter 'g'; it has none"),
        ("-y0", "parameters are of a .toml file, a dict or a function; write them into the text"),
    ):
        with pytest.raises(ValueError, match=re.escape(words)):
            given_problem(given, {"g": 1})


@pytest.mark.parametrize("given", [{"rates": ["-k * y0"], "parameters": {"k": 2}}, lambda t, y, k: -k * y])
def test_a_parameter_has_one_value_at_a_time(given):
    with pytest.raises(ValueError, match=r"^k has one value at a time, but is given 0\.1 and 0\.3$"):
        given_problem(given, [("k", 0.1), ("k", 0.3)])
    assert given_problem(given, [("k", 0.1)])


@pytest.mark.parametrize(
    "rates", [{"x": "-v", "v": "x"}, "x' = -v, v' = x"], ids=["a table of names", "equations in one text"]
)
def test_unknowns_are_named_as_their_rates_name_them(rates):
    found = problem_table({"rates": rates, "start": {"v": 2, "x": "1/3"}})
    assert (found.unknowns, found.start, found.energy) == (("x", "v"), (Q(1, 3), Q(2)), None)
    assert problem_table({"rates": ["-y"], "start": 1}).unknowns == ()


REFUSED = {
    "start is missing; write a list": {},
    "rates is missing": {"start": []},
    r"start\[0\] is 'pi/x'; write a number such as .*2\*pi": {"start": ["pi/x"]},
    r"start\[0\]: 'sin\(t\)', column 1: 'sin' is not a function": {"start": ["sin(t)"]},
    "give either rates or function, not both": {"start": [0], "rates": ["y0"], "function": "m:f"},
    "function is int, which cannot be called": {"start": [0], "function": "sys:maxsize"},
    "start has 2 entries, but the rates need 1": {"start": [1, 2], "rates": ["y0"]},
    r"start\[0\] is \[1\]; write a number": {"start": [[1]], "rates": ["y0"]},
    "it is a method, not a problem": {"family": "runge_kutta", "A": [[0]], "b": [1]},
    "a problem has no key 'width'; its keys are rates": {"start": [1], "rates": ["y0"], "width": 2},
    r"energy, 'v\^2': 'v' is not allowed; .* with t, x$": {"start": {"x": 1}, "rates": {"x": "-x"}, "energy": "v^2"},
    r"rates\[0\], 'y0 \+', column 5": {"start": [1], "rates": ["y0 +"]},
}


@pytest.mark.parametrize("message", REFUSED)
def test_table_that_is_no_problem_is_refused_in_one_line(message):
    with pytest.raises(ValueError, match=f"^{message}") as refused:
        problem_table(REFUSED[message])
    assert "\n" not in str(refused.value)


def test_a_step_size_divides_an_end_that_is_the_double_of_a_number():
    end = Q(2 * pi)
    asked = {"pi/50": [100], "2*pi/7, pi/3": [7, 6], "sqrt(3)": [5], "1/4:1/16": [4, 8, 16]}
    ends = {"sqrt(3)": nearest(number_entry("5*sqrt(3)", "end")), "1/4:1/16": Q(1)}
    for text, steps in asked.items():
        assert steps_to(ends.get(text, end), text) == [ends.get(text, end) / n for n in steps]
    assert steps_to(end, (end / 4, "pi/8")) == [end / 4, end / 16]
    for wrong in ("1/50", "pi/50.3", "-pi", "pi-pi", "sqrt(2)/3", "10^40*pi", 0.5):
        with pytest.raises(ValueError, match=r"does not divide t = 6.283185307179586, the nearest double .* 2\*pi/100"):
            steps_to(end, wrong)
