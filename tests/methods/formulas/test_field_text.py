"""Right-hand sides from text: exact numbers, powers written out as products, one line for what has no place."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx

from driftproof.methods.formulas.field_text import (
    PI,
    choices_as_functions,
    energy_of_table,
    field_of_table,
    field_of_text,
    rate_of_text,
    start_of_table,
)
from driftproof.numeric.advance import field_rate
from tests.looping import exactly

WRITTEN = {
    "-sin(y0)": "-sin(y0)", "0.1*y0 - 3e-2": "((1 / 10) * y0) - (3 / 100)", "y0^3": "(y0 * y0 * y0)",
    "-y0**2": "-(y0 * y0)", "(-y0)^2": "((-y0) * (-y0))", "1/y0^(3/2)": "1 / (y0 * sqrt(y0))", "y0^-1": "(1 / (y0))",
    "y0^0 + t": "1 + t", "y0^1 + y0^0.5": "y0 + sqrt(y0)", "sqrt(1 + y0)*(2 - t)": "sqrt(1 + y0) * (2 - t)",
    "tanh(2y0) abs(t)": "(1 - 2 / (exp(2 * (2 * y0)) + 1)) * abs(t)",
    "tan(2y0)^2 - ln(t)": "((sin(2 * y0) / cos(2 * y0)) * (sin(2 * y0) / cos(2 * y0))) - log(t)",
}  # fmt: skip


@pytest.mark.parametrize("text", WRITTEN)
def test_expression_is_written_in_products(text):
    assert rate_of_text(text) == WRITTEN[text]
    assert field_of_text([text]).rates == (WRITTEN[text],)


def test_components_are_parted_by_semicolons_or_listed():
    assert field_of_text("y1; -y0") == field_of_text(["y1", "-y0"]) == field_of_text(["y[1]", "-y[0]"])
    for text in ("x' = v, v' = -x", "x'=v;v'=-x", "x ' = v\n; v'= -x"):
        assert field_of_text(text) == field_of_text(["y1", "-y0"]) == field_of_table({"rates": text})
    for text in ("x'' = -x", 'x" = -x', "x''=-x", "x ' = dx, dx' = -x"):
        assert field_of_text(text) == field_of_text(["y1", "-y0"]), text
    two = field_of_text("x'' = -y' - x; y'' = x'")
    assert two == field_of_text(["y2", "y3", "-y3 - y0", "y2"])
    assert field_of_text("x'=dx; dx'=-x; y'=dy; dy'=-y").rates == ("y1", "-y0", "y3", "-y2")  # twin: as they stand
    known = field_of_text("x'=v, v' = k*(1 - x^2)*v - k x, k = 2/3")
    assert known == field_of_text(["y1", "(2/3)*(1 - y0^2)*y1 - (2/3) y0"])
    for wrong in ("x' = -k*x, k = ", "x' = -k*x, k = x = 2", "x' = -k*x, k = z", "k = 2"):
        with pytest.raises(ValueError, match=r"right-hand side|expected|'z' is not allowed"):
            field_of_text(wrong)
    for text in ("y1,2*y0", "0,5*y0", "x' = v, -x", "x' = v; x' = -v"):  # twin: may be a decimal, or is no equation
        with pytest.raises(ValueError, match=r"unexpected ','|is not allowed in a right-hand side"):
            field_of_text(text)
    with pytest.raises(ValueError, match="rates: 't' cannot name an unknown"):
        field_of_text("t' = 1; x' = t")
    assert len(rate_of_text("1 + x", {"x": 99_996 * "y"})) == 100_000
    with pytest.raises(ValueError, match="column 6: written out it has more than 100000 characters"):
        rate_of_text("t - (1 + x)", {"x": 99_997 * "y"})


def test_functions_with_kinks_and_jumps_are_choices():
    field = field_of_text(
        "max(y0, 1 - t, -3) + min(2 y0, t); sign(y1) + heaviside(t - 1) * floor(t) - mod(t + 1/4, 1/2 + 1)"
    )
    assert not field.smooth
    rate, chosen = field_rate(field), [(0.0, -2.0, 3.0), (0.5, 0.25, 0.0), (1.0, 7.0, -1.0), (3.5, 0.0, 0.5)]
    for t, q, v in exactly(4, chosen):
        rest = np.sign(v) + np.heaviside(t - 1, 1) * np.floor(t) - (t + 0.25) % 1.5
        assert rate(t, (q, v)) == [max(q, 1 - t, -3) + min(2 * q, t), rest]


def test_differences_are_compared_by_their_terms():
    """So that what opposite ones ask is asked of the same two numbers."""
    assert field_of_text("heaviside(1 - y0) + heaviside(y0 - 1)").rates == (
        "(1 if 1 >= y0 else 0) + (1 if y0 >= 1 else 0)",
    )
    assert field_of_text("sign(2*t - y0); heaviside(y0 * 2)").rates == (
        "(1 if (2 * t) > y0 else -1 if (2 * t) < y0 else 0)",
        "(1 if y0 * 2 >= 0 else 0)",
    )


@pytest.mark.parametrize("between", ["; ", ", "])
def test_commas_in_brackets_are_those_of_a_function(between):
    texts = ("max(1, mod(t, 2 * (1 + y0)))", "(y0)")
    assert field_of_text(between.join(texts)) == field_of_text(texts)


@pytest.mark.parametrize(
    "text", ["sign(y0) * sin(t)", "heaviside(1 - t)", "max(y0, 1, t)", "min(2 * t, y0)", "floor(y0)", "abs(y0)"]
)
def test_choices_are_shown_as_the_functions_that_they_came_from(text):
    shown = choices_as_functions(rate_of_text(text))
    assert rate_of_text(shown) == rate_of_text(text)
    assert " if " not in shown


def test_other_choices_are_shown_as_they_are():
    for rate in ("1 if t > 0 else 2", "t if y0 > 1 else 1", "1 if t >= 0 else -1 if t < 0 else 0"):
        assert choices_as_functions(rate) == rate


REFUSED = {
    "erf(y0)": r"column 1: the functions are sin, .*, sign, heaviside, each of one argument, max, min, and mod of",
    "sine(y0)": r"column 1: the functions are .* and mod of two; did you mean sin or sign\?$",
    "sinh(y0)": r"column 1: the functions are .* and mod of two$",
    "arctan(y0)": r"and mod of two$",
    "sin(y0, t)": r"column 1: the functions are .* and mod of two$",
    "max(y0)": r"column 1: the functions are",
    "mod(y0, 2, 3)": r"column 1: the functions are",
    "y0^(1/3)": r"column 1: an exponent must be a multiple of 1/2",
    "y; y1": r"rate 0, 'y': 'y' is not allowed",
    "y0; ": r"the right-hand side is empty",
    "-y0 + sin t": r"column 7: 'sin' is no number here; write sin\(t\)",
    "ty": r"column 1: 'ty' is no number here; write a product as t\*y",
    "y7": r"rate 0, 'y7': 'y7' is not allowed",
    "__import__('os')": r"is not allowed in a right-hand side",
    "((y0 + t)^64)^64*(y0^64)^64*(y0^64)^64*(y0^64)^64*(y0^64)^64": r"written out it has more than 100000 characters",
}


@pytest.mark.parametrize("text", REFUSED)
def test_other_text_is_refused_in_one_line(text):
    with pytest.raises(ValueError, match=REFUSED[text]) as caught:
        field_of_text(text)
    assert "\n" not in str(caught.value)


def test_table_holds_rates_and_exact_parameters():
    made = field_of_table({"rates": ["y1", "-k*y0"], "parameters": {"k": "0.1", "m": 3, "r": "1/3"}})
    assert dict(made.parameters) == {"k": Fraction(1, 10), "m": 3, "r": Fraction(1, 3)}
    for wrong, said in (({}, "rates is missing"), ({"rates": ["y0"], "parameters": {"k": "x"}}, "parameters.k")):
        with pytest.raises(ValueError, match=said):
            field_of_table(wrong)


def test_pi_is_enclosed_in_balls_and_the_nearest_double_in_floats():
    assert (float(PI), str(PI)) == (math.pi, "pi")
    assert PI().overlaps(arb.pi())
    low, high = PI.enclosure(200)
    assert 0 < high - low < Fraction(1, 2**190)
    with ctx.workprec(300):
        assert arb(low.numerator) / low.denominator < arb.pi() < arb(high.numerator) / high.denominator


def test_unknowns_have_names_and_parameters_may_be_expressions():
    """As lists and as tables; a name or an expression is set in the place of what it stands for."""
    plain = field_of_table({"rates": ["y1", "-(2*pi*f)^2*y0"], "parameters": {"f": 3}})
    named = {"x": "v", "v": "-w^2*x"}
    table = {"rates": named, "start": {"v": 0, "x": 1}, "parameters": {"f": 3, "w": "2*pi*f"}, "energy": "v^2/2"}
    assert field_of_table(table) == plain == field_of_table({**table, "rates": dict(named)})
    assert plain.parameters == (("f", 3), ("pi", PI))
    assert (start_of_table(table), energy_of_table(table)) == ([1, 0], "(y1 * y1) / 2")
    assert field_of_text("-50*(y - cos(t))").rates == field_of_text("-50*(y0 - cos(t))").rates
    assert (start_of_table({"start": 0}), start_of_table({"start": ["1", 2]})) == ([0], ["1", 2])
    assert field_of_table({"rates": "y1; -y0"}).rates == ("y1", "-y0")
    of_energy = {"rates": ["-y"], "energy": "pi * y"}
    assert (field_of_table(of_energy).parameters, energy_of_table(of_energy)) == ((("pi", PI),), "pi * y0")
    assert field_of_table({"rates": ["-pi*y"], "parameters": {"pi": 3}}).parameters == (("pi", 3),)
    assert field_of_table({"rates": ["-y*y0"], "parameters": {"y": 3}}).rates == ("-y * y0",)


REFUSED_TABLES = [
    ({"rates": ["y/2t"]}, r"column 4: after / or \^ write a product with its sign: 2\*t"),
    *(
        ({"rates": [x]}, "with its sign: |unexpected|functions")
        for x in ("y/2(1-y)", "y^2t", "2^-3y", "y 2", "2 erf(y)")
    ),
    ({"rates": ["-4x"]}, r"'x' is not allowed; write \+ - \* / with t, y0; for names of your own: rates\.x"),
    ({"rates": ["x' = v", "v' = -x"]}, r"column 2: \"'\" is not allowed.*; for names of your own: rates\.x"),
    ({"rates": ["-e*y"]}, r"'e' is not allowed; write \+ - \* / with t, y0; for names of your own: rates\.x"),
    ({"rates": {"x": "v", "v": "-e*x"}}, r"^rates\.v, '-e\*x': 'e' is not allowed; write \+ - \* / with t, x, v$"),
    ({"rates": {"x": "v", "v": "-sine(x)"}}, r"^rates\.v, '-sine\(x\)', column 2: the functions are"),
    ({"rates": {"x": "-x", "t": "1"}}, "rates: 't' cannot name an unknown"),
    ({"rates": {"x": "-a*x", "a": "1"}, "parameters": {"a": 2}}, "rates: 'a' cannot name an unknown"),
    ({"rates": {"x y": "1", "t": "1"}}, "rates: 'x y' cannot name an unknown"),
    ({"rates": ["y"], "parameters": {"w": "2*pie"}}, "parameters.w"),
    ({"rates": ["w*y"], "parameters": {"w": "2*v", "v": "pi"}}, "parameters.w"),
]


@pytest.mark.parametrize(("table", "said"), REFUSED_TABLES)
def test_table_that_names_wrongly_is_refused(table, said):
    with pytest.raises(ValueError, match=said):
        field_of_table(table)


def test_start_by_names_needs_the_names_of_the_rates():
    for wrong in ({"start": {"x": 1}, "rates": ["y1"]}, {"start": {"x": 1}, "rates": {"v": "1"}}):
        with pytest.raises(ValueError, match="start has the names x; rates must have the same names"):
            start_of_table(wrong)


@pytest.mark.parametrize(("text", "plain"), [
    ("-2y", "-2*y"), ("y(1 - y)", "y*(1 - y)"), ("2 sin(t) y/3", "2*sin(t)*y/3"), ("(1 - y)(2 - y)", "(1 - y)*(2 - y)"),
    ("k(1 - y)", "k*(1 - y)"), ("-y^2(1 - y)", "-y^2*(1 - y)"), ("2t - 3pi", "2*t - 3*pi"), ("2y0(1-t)", "2*y0*(1-t)"),
    ("(1 - y^2) y - 2", "(1 - y^2)*y - 2"),
])  # fmt: skip
def test_a_product_may_stand_without_its_sign_where_it_has_one_meaning(text: str, plain: str) -> None:
    assert field_of_text([text], {"k": Fraction(3)}) == field_of_text([plain], {"k": Fraction(3)})
