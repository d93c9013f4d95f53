"""Questions are parsed and never evaluated: what is read, what is refused, at which column, and how large it may be."""

from fractions import Fraction as Q

import pytest

from driftproof.methods.formulas.expression_tree import DEEPEST_NESTING, LONGEST_EXPRESSION, ExpressionParser
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from tests.texts.questions.refusals import require_refusal

ARITHMETIC = {
    "1 + 2 × 3": Q(7), "(1 + 2) * 3": Q(9), "8 / 4 / 2": Q(1), "1 - 2 - 3": Q(-4), "-2 ** 2": Q(-4),
    "(-2) ** 2": Q(4), "2 ^ -3": Q(1, 8), "2 ** (-3)": Q(1, 8), "8 ** (2/3)": Q(4), "(8/27) ** (1/3)": Q(2, 3),
    "((1/2) ** (1/3)) ** 3": Q(1, 2), "- - 3": Q(3), "+0.25e1 − 1/2": Q(2), ".5": Q(1, 2), "sqrt(9/4)": Q(3, 2),
    "sqrt(0)": Q(0), "abs(-1/3) + abs(1/3)": Q(2, 3), "log10(1/1000)": Q(-3), "log2(1024) / log10(10)": Q(10),
    "log2(1)": Q(0), "exp(0) - ln(1)": Q(1), "log10(10**60000)": Q(60000), "run rk4 h=1e-17 t=10 : steps": Q(10**18),
    "cos(0) - 2 * sin(0)": Q(1), "ratio(-3, 4)": Q(3, 4), "percent(1, 8)": Q(25, 2), "sqrt(2) * sqrt(2)": Q(2),
    "(1 + sqrt(5)) * (1 - sqrt(5))": Q(-4), "2 ** (1/3) * 2 ** (1/3) * 2 ** (1/3)": Q(2),
    "order rk4 + stages rk4 * 2": Q(12), "(run rk4 y'=1 y(0)=1 h=1 t=1 : y) + order rk4": Q(6),
    "R(-2) of rk4 - R(-2) heun2": Q(1, 3) - 1, "R(-1/2) of sdirk_order_2 at 1/4": Q(49, 81),
    "step rk4 h=1/2 : q - 1": Q(337, 384) - 1,
    "energy_multiplier forward_euler h=1/4 / 2": Q(17, 32),
    "2*step forward_euler h=1/2:q": Q(2), "0 ** 0": Q(1), "4 ^ 1.5 + 4 ** (-0.5)": Q(17, 2),
    "(2**64) ** (1/64)": Q(2),
    "run forward_euler y'=0.8y(1-y/5), y(0)=1, h=1/4, t=1/4 : y": Q(29, 25),
    "run forward_euler y'=2 t y(2 - y)(1) + y, y(0)=1, h=1/4, t=1/4 : y": Q(5, 4),
    "run rk4 rates=((y0)*(y1), (-y0)) from 1,1 h=1/4 t=1/4 : y1": Q(2262647, 3145728),
}  # fmt: skip


@pytest.mark.parametrize("question", ARITHMETIC)
def test_arithmetic_is_read_as_mathematics_writes_it(question):
    assert value(question).exact == ARITHMETIC[question]


REFUSED = [
    ("", 1, "the question is empty"), ("   ", 4, "the question is empty"),
    ("1 +", 4, "expected a number, a name or a bracket, found the end"),
    ("(1", 3, "a bracket is not closed"), ("1 2", 3, "unexpected '2'; expected an operator"),
    ("1)", 2, "unexpected ')'"), ("1 $ 2", 3, "'$' is not allowed in a question"),
    ("__import__('os').system('ls')", 17, "'.' is not allowed in a question"),
    ("__import__('os')", 1, "'__import__' is not a function"),
    ("2 ** 1000001", 6, "an exponent is an integer from -1000000 to 1000000"),
    ("2 ** 9999999999", 6, "an exponent is an integer from -1000000 to 1000000"),
    ("run rk4 h=1 3 steps 3 steps : q", 23, "'steps' is given twice"),
    ("run rk4 problem=a problem=b h=1 : y0", 19, "'problem' is given twice"),
    ("2 ** 1.23456789", 6, "an exponent is an integer"),
    ("2 ** (1/0)", 10, "an exponent is an integer or a fraction of two integers"),
    ("2 ** x", 6, "an exponent is an integer"), ("1e999999999", 1, "is too long"),
    ("2,5", 2, "or the end; a decimal has a point"),
    ("1,6 %", 5, "'%' is not allowed in a question; a percentage is percent(a, b)"),
    ("run rk4 rates=(e^t) from 1 h=1 t=1 : y0", 16, "or a decimal; write exp(t) for e^t"),
    ("rk4 y'=y, y(1)=1, h=1, t=1 : y", 13, "time starts at 0: write the initial value as y(0) = ..."),
    ("order rk4 rk4", 11, "unexpected 'rk4'; a colon and a readout may follow"),
    ("step rk4 h=1/2 h=1/4 : q", 16, "'h' is given twice"),
    ("step rk4 N=2 steps=2 h=1 : q", 14, "'steps' is given twice"),
    ("step rk4 k=1/2 : q", 10, "'k' is not a setting; use h, t, N, steps, z, lambda, problem"),
    ("R(-2)", 1, "stability_function needs a method"), ("R(2*2) rk4", 4, "unexpected '*' in a number"),
    ("R(-2 rk4", 6, "the bracket of R is not closed; found 'rk4'"),
    ("step rk4 h=1/2 from 1 : q", 1, "a start is a position and a velocity"),
    ("half + s", 1, "'half' is not the id of a published value"), ("half' : q", 5, "unexpected \"'\"; expected"),
    ("step rk4 h=1/2 from 1,0 from 1,0 : q", 25, "'from' is given twice"),
]  # fmt: skip


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_what_is_no_question_is_refused_at_its_column(question, column, reason):
    require_refusal(question, column, reason)


def test_question_too_long_or_nested_too_deep_is_refused_before_anything_is_computed():
    inside = "(" * DEEPEST_NESTING + "1" + ")" * DEEPEST_NESTING
    assert value(inside).exact == 1
    for deep in (f"({inside})", "-" * (DEEPEST_NESTING + 1) + "1", "abs(" * 41 + "1" + ")" * 41):
        with pytest.raises(QuestionError, match="nested deeper than 40 levels"):
            value(deep)
    assert value("1" + " " * (LONGEST_EXPRESSION - 1)).exact == 1
    with pytest.raises(QuestionError, match="at most 2000 characters, not 2001"):
        value("1" + " " * LONGEST_EXPRESSION)
    assert value("+".join(["1"] * 999)).exact == 999


def test_tokens_know_their_columns():
    tokens = " ".join(f"{token.text}@{token.column}" for token in ExpressionParser("2**(−x.y) ").tokens)
    assert tokens == "2@1 **@2 (@4 -@5 x.y@6 )@9 @11"
