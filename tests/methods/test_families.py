"""A TOML tableau with a declared parameter becomes a family, exactly, and whatever is wrong is said in one line."""

from __future__ import annotations

import re
from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.families import FAMILIES, Family, ParameterFunction, parameter_function, parse_function
from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.schemes import MethodError
from driftproof.methods.tableau_file import read_method
from driftproof.reports.fact_sheet import facts
from tests.methods.conftest import Write
from tests.symbolic.linear.family_examples import THETA

TEXT = """
family = "runge_kutta"
title = "Theta by hand"
claimed_order = 1
parameter = "theta"
A = [[0, 0], ["1 - theta", "theta"]]
b = ["1 - theta", "theta"]
"""


def test_tableau_with_a_parameter_is_a_family(write: Write) -> None:
    found = read_method(write(TEXT))
    assert isinstance(found, Family)
    assert (found.a, found.b, found.c, found.parameter) == (THETA.a, THETA.b, THETA.c, "theta")
    assert (found.key, found.title, found.claimed_order, found.stages) == ("mine", "Theta by hand", 1, 2)
    names = ("order_sets", "real_limit", "a_stable", "stability_function")
    assert facts(found, only=names).data == facts(THETA, only=names).data
    assert not found.explicit
    assert FAMILIES["explicit_order_2"].explicit


def test_nodes_may_be_given_and_poles_are_kept(write: Write) -> None:
    found = read_method(write(TEXT.replace('"theta"],\n', '"theta"],\n') + 'c = ["1/theta", 0.5]\n'))
    assert isinstance(found, Family)
    assert found.c == (parameter_function((1,), (0, 1)), parameter_function((Q(1, 2),)))
    with pytest.raises(MethodError, match="mine is not defined at theta = 0, a pole"):
        found.member(Q(0))


HEAD = 'family = "runge_kutta"\nparameter = "t"\n'
WRONG = [
    (HEAD + "A = [['x']]\nb = [1]", "A[0][0]: 'x', column 1: 'x' is an unknown name; the parameter is t"),
    (HEAD + "A = [['t + exit(t)']]\nb = [1]", "column 5: 'exit' is not a function; use sqrt and cbrt"),
    (HEAD + "A = [['1/(t - t)']]\nb = [1]", "division by zero"),
    (HEAD + "A = [['sqrt(2)']]\nb = [1]", "'sqrt(2)' is irrational; with a parameter, all numbers must be rational"),
    (HEAD + "A = [['t + sqrt(2)']]\nb = [1]", "irrational numbers cannot be combined with a parameter"),
    (HEAD + "A = []\nb = []", "A needs as many rows and columns as b and c have entries, at least one"),
    (
        HEAD + "A = [['t']]\nb = [1]\ndecimal = true",
        "decimal = true is not allowed: a tableau with a parameter must be exact",
    ),
    (
        HEAD + "A = [['t']]\nb = [1]\nb_embedded = [1]",
        "a runge_kutta has no key 'b_embedded'; its keys are family, key",
    ),
    (HEAD + "A = [['t']]\nb = [1]\n[roots]\ns3 = 'sqrt(3)'", "parameter and [roots] exclude each other"),
    (HEAD.replace('"t"', "3") + "A = [[0]]\nb = [1]", "parameter is 3; write a letter and up to 30 letters"),
    (HEAD.replace('"t"', '"a b"') + "A = [[0]]\nb = [1]", "parameter is 'a b'; write a letter"),
    (HEAD.replace('"t"', '"sqrt"') + "A = [[0]]\nb = [1]", "parameter is 'sqrt'; write a letter"),
    (
        HEAD.replace("runge_kutta", "splitting") + "parts = [['kick', 't']]",
        "a splitting has no key 'parameter'; its keys are",
    ),
]


@pytest.mark.parametrize(("text", "reason"), WRONG, ids=range(len(WRONG)))
def test_wrong_family_is_refused_in_one_line(refusal, text, reason) -> None:  # type: ignore[no-untyped-def]
    assert reason in refusal(text)


# --- functions of a parameter


PARAMETER = parameter_function((0, 1))


def functions() -> st.SearchStrategy[ParameterFunction]:
    coefficients = st.lists(st.fractions(-3, 3, max_denominator=5), min_size=1, max_size=3)
    return st.builds(parameter_function, coefficients, coefficients.filter(any))


@pytest.mark.slow
@given(functions(), functions(), st.fractions(-5, 5, max_denominator=11))
def test_arithmetic_of_functions_is_that_of_their_values(f: ParameterFunction, g: ParameterFunction, x: Q) -> None:
    try:
        a, b = f(x), g(x)
    except ZeroDivisionError:
        return
    assert ((f + g)(x), (f - g)(x), (f * g)(x), (-f)(x)) == (a + b, a - b, a * b, -a)
    assert ((2 - f)(x), (f + 1)(x), (Q(1, 2) * f)(x)) == (2 - a, a + 1, a / 2)
    if b:
        assert (f / g)(x) == a / b
        assert (1 / g)(x) == 1 / b
    assert (f + g == g + f, f - f == parameter_function((0,))) == (True, True)
    assert (f + 1 == f) is False


def test_equal_functions_are_equal_objects_and_others_are_refused() -> None:
    assert parameter_function((0, 2), (0, 4)) == parameter_function((Q(1, 2),))
    assert parameter_function((1, 2, 1), (1, 1)) == PARAMETER + 1
    assert (1 / PARAMETER)(square_root(2)) == square_root(2) / 2
    assert [bool(parameter_function((n,))) for n in (-1, 0, 1)] == [True, False, True]
    assert len(parse_function("t**64*t**34", "t", "here").coefficients) == 100
    with pytest.raises(ValueError, match="its degree in the parameter is too large"):
        parse_function("t**64*t**35", "t", "here")
    with pytest.raises(ZeroDivisionError):
        parameter_function((1,), (0, 0))
    with pytest.raises(TypeError, match="no exact arithmetic between a function of a parameter"):
        _ = PARAMETER * 0.5


def test_a_member_at_a_pole_is_refused() -> None:
    with pytest.raises(MethodError, match="explicit_order_2 is not defined at alpha = 0, a pole of its coefficients"):
        FAMILIES["explicit_order_2"].member(Q(0))
    assert FAMILIES["explicit_order_2"].member(Q(1)).claimed_order == 0
    with pytest.raises(MethodError, match="as many rows and columns"):
        Family("x", "X", "t", 0, "x", THETA.a, THETA.b[:1], THETA.c)


@given(st.text("0123456789t", min_size=1, max_size=9), st.data())
def test_a_function_has_the_values_that_arithmetic_gives_it(atoms: str, data: st.DataObject) -> None:
    """Atoms joined by drawn signs, so that most texts are functions; poles are skipped by the choice of the value."""
    signs = data.draw(st.lists(st.sampled_from(["+", "-", "*", "/"]), min_size=len(atoms), max_size=len(atoms)))
    expression = "".join(f"{sign} ({atom} + 1)" for sign, atom in zip(["+", *signs[1:]], atoms, strict=True))
    value = data.draw(st.fractions(0, 2, max_denominator=7))
    wanted = eval(re.sub(r"\d+", r"Q('\g<0>')", expression), {"Q": Q, "t": value})
    assert parse_function(expression, "t", "here")(value) == wanted
    assert parse_function(f"({expression})*t", "t", "here")(value) == value * wanted
