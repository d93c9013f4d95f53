"""Questions are parsed and never evaluated: what is read, what is refused, at which column, and how large it may be."""

from __future__ import annotations

import signal
from fractions import Fraction as Q

import pytest

from driftproof.methods.expression_tree import DEEPEST_NESTING, LONGEST_EXPRESSION, ExpressionParser
from driftproof.texts.questions.errors import QuestionError, time_limit
from driftproof.texts.questions.evaluate import value

ARITHMETIC = {
    "1 + 2 * 3": Q(7),
    "(1 + 2) * 3": Q(9),
    "8 / 4 / 2": Q(1),
    "1 - 2 - 3": Q(-4),
    "-2 ** 2": Q(-4),
    "(-2) ** 2": Q(4),
    "2 ^ -3": Q(1, 8),
    "2 ** (-3)": Q(1, 8),
    "8 ** (2/3)": Q(4),
    "(8/27) ** (1/3)": Q(2, 3),
    "((1/2) ** (1/3)) ** 3": Q(1, 2),
    "- - 3": Q(3),
    "+0.25e1 − 1/2": Q(2),
    ".5": Q(1, 2),
    "sqrt(9/4)": Q(3, 2),
    "sqrt(0)": Q(0),
    "abs(-1/3) + abs(1/3)": Q(2, 3),
    "log10(1/1000)": Q(-3),
    "log2(1024) / log10(10)": Q(10),
    "log2(1)": Q(0),
    "cos(0) + sin(0)": Q(1),
    "ratio(-3, 4)": Q(3, 4),
    "percent(1, 8)": Q(25, 2),
    "sqrt(2) * sqrt(2)": Q(2),
    "(1 + sqrt(5)) * (1 - sqrt(5))": Q(-4),
    "2 ** (1/3) * 2 ** (1/3) * 2 ** (1/3)": Q(2),
    "order rk4 + stages rk4 * 2": Q(12),
    "step rk4 h=1/2 : q - 1": Q(337, 384) - 1,
    "energy_multiplier forward_euler h=1/4 / 2": Q(17, 32),
    "2*step forward_euler h=1/2:q": Q(2),
}


@pytest.mark.parametrize("question", ARITHMETIC)
def test_arithmetic_is_read_as_mathematics_writes_it(question: str) -> None:
    assert value(question).exact == ARITHMETIC[question]


REFUSED = [
    ("", 1, "the question is empty"),
    ("   ", 4, "the question is empty"),
    ("1 +", 4, "the end stands where a number, a name or a bracket should"),
    ("(1", 3, "a bracket is not closed"),
    ("1 2", 3, "'2' has no place here; an operator"),
    ("1)", 2, "')' has no place"),
    ("1 $ 2", 3, "'$' has no place in a question"),
    ("__import__('os').system('ls')", 12, "has no place in a question"),
    ("rk4.__class__", 1, "is no id of a published value"),
    ("rk4.first_step.w", 1, "did you mean rk4.first_step.v"),
    ("eval(1)", 1, "'eval' is no function; there are abs, sqrt"),
    ("abs(1, 2)", 1, "abs takes 1 number"),
    ("ratio(1)", 1, "ratio takes 2 numbers"),
    ("1/0", 2, "it divides by zero"),
    ("0 ** -1", 1, "it divides by zero"),
    ("2 ** 65", 6, "an exponent is an integer from -64 to 64"),
    ("2 ** 9999999999", 6, "an exponent is an integer from -64 to 64"),
    ("2 ** 1.5", 6, "an exponent is an integer"),
    ("2 ** (1/0)", 10, "an exponent is an integer or a fraction of two"),
    ("2 ** x", 6, "an exponent is an integer"),
    ("(-2) ** (1/2)", 1, "a number below zero has no real root"),
    ("sqrt(-1)", 1, "a number below zero has no real root"),
    ("log10(0)", 1, "only a number above zero has a logarithm"),
    ("1e999999999", 1, "is too long"),
    ("(((2**64)**64)**64)**64", 2, "too long to write out"),
    ("energy_multiplier rk4 + 1", 23, "1 - h**6/72 + h**8/576 is no number"),
    ("energy_multiplier", 1, "is no id of a published value"),
    ("energy_multiplier rk5", 19, "unknown method 'rk5'"),
    ("energy_multipliers rk4", 1, "did you mean energy_multiplier"),
    ("energy_multiplier symplectic_euler", 1, "depends on the state"),
    ("energy_multiplier rk4 t=1", 23, "has no setting t here; it takes h"),
    ("energy_multiplier rk4 : foo", 25, "has no parts"),
    ("energy_multiplier backward_euler h=1e1200 from 1,0", 1, "starts nowhere"),
    ("stability_function backward_euler z=1", 1, "has a pole at z = 1"),
    ("stability_function velocity_verlet", 1, "only Runge-Kutta and collocation methods have R(z)"),
    ("order rk4 rk4", 11, "'rk4' has no place here; a colon and a readout may follow"),
    ("order rk4 at 1/4", 14, "rk4 has no parameter"),
    ("order sdirk_order_2 at (1 - x)", 24, "'x' is a name; write numbers"),
    ("order sdirk_order_2 at (1", 24, "a bracket is not closed"),
    ("order sdirk_order_2 at sqrt(2)", 24, "a number like 1/4 or 0.25 stands here, not 'sqrt'"),
    ("real_limit sdirk_order_2 sharp", 26, "knows no word sharp"),
    ("a_stable explicit_order_2 at 0", 30, "no method at alpha = 0"),
    ("order_fails rk4 : foo", 19, "it has tree, residual"),
    ("embedded_order rk4", 1, "rk4 has no embedded_order"),
    ("invariant symplectic_euler from 1,0", 1, "needs h"),
    ("dissipation symplectic_euler", 1, "the whole series vanishes"),
    ("one_step_matrix rk4", 1, "there are M_qq, M_qv, M_vq, M_vv"),
    ("step", 1, "is no id of a published value"),
    ("step :", 7, "the name of a readout, such as q, comes after the colon"),
    ("step : q", 1, "step needs h"),
    ("step h=1/2 : q", 1, "step is about a method"),
    ("step rk4 : q", 1, "step needs h"),
    ("step rk4 h=1/2", 1, "needs a readout after a colon"),
    ("step rk4 h=1/2 : speed", 18, "'speed' is no readout of step; there are q, v"),
    ("step rk4 h=0 : q", 1, "a step of size 0 goes nowhere"),
    ("step rk4 h=1/2 h=1/4 : q", 16, "'h' is given twice"),
    ("step rk4 N=2 steps=2 h=1 : q", 14, "'steps' is given twice"),
    ("step rk4 k=1/2 : q", 10, "'k' is no setting; there are h, t, N, steps, z"),
    ("step rk4 h=1/2/3 : q", 15, "'/' has no place in a number"),
    ("step rk4 h=1/2x : q", 15, "'x' has no place in a number"),
    ("step rk4 h=-: q", 13, "h: a number like 1/4 or 0.25 stands here, not ':'"),
    ("step rk4 h=1/2 N=1/2 : q", 16, "the number of steps is whole, and 1 at least"),
    ("step rk4 h=1/2 N=0 : q", 16, "the number of steps is whole, and 1 at least"),
    ("step rk4 h=1/2 t=1 : q", 16, "step has no setting t here; it takes h, N"),
    ("step rk4 h=1/2 from 1 : q", 23, "a start is a position, a comma and a velocity"),
    ("step rk4 h=1/2 from 1,0 from 1,0 : q", 25, "'from' has no place"),
    ("step rk4 h=1/2 : q deg", 20, "'deg' has no place; only angles have units"),
    ("step rk4 h=1/2 : phase_error miles", 30, "is no unit of an angle; there are deg"),
    ("step rk4 h=1/2 from 0,0 : phase_error", 27, "the phase error is undefined"),
    ("step rk4 h=1/2 : k5.q", 18, "rk4 has the slopes k1 to k4"),
    ("step gauss2 h=1/2 : k1.q", 21, "explicit Runge-Kutta methods have"),
    ("step sdirk_order_2 h=1/2 : q", 6, "is a family; choose a method with at, a value of gamma"),
    ("run rk4 h=1/4 : q", 1, "run needs two of h, t and N"),
    ("run rk4 h=1/4 t=10 N=40 : q", 1, "run needs two of h, t and N"),
    ("run rk4 h=1/3 t=1/2 : q", 1, "nearest that do: 1/2 and 1/4"),
    ("run rk4 h=1e-9 t=1e12 : q", 1, "more than 10**18 steps"),
    ("run gauss2 h=1/4 t=10 : evaluations", 25, "gauss2 is implicit"),
    ("run forward_euler h=1 N=600000 : q * 2", 1, "too long"),
    ("exact rk4 t=10 : q", 7, "the exact flow belongs to no method"),
    ("exact at 1/4 t=10 : q", 10, "the exact flow belongs to no method"),
    ("exact h=10 : q", 7, "exact has no setting h here; it takes t"),
    ("exact from 1,0 : q", 1, "exact needs t"),
    ("roundoff gauss2 h=1/4 : qq", 1, "is implicit"),
    ("roundoff rk4 h=1e400 : qq", 1, "overflows"),
    ("roundoff rk4 h=1e-400 : qq", 1, "a step of size 0 goes nowhere"),
    ("roundoff rk4 h=1/4 : foo", 22, "there are qq, qv, vq, vv, q, v, c"),
    ("run rk4 h=1 N=1 : phase_error + run rk4 h=1 N=1 : phase_error rad", 31, "degrees and radians do not add"),
    ("sqrt(run rk4 h=1 N=1 : phase_error)", 1, "a function of degrees is not defined"),
    ("1 / run rk4 h=1 N=1 : phase_error", 3, "has no unit of its own"),
    ("(run rk4 h=1 N=1 : phase_error) ** 2", 1, "powers of degrees are no unit"),
]


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_refusal_is_one_line_that_names_the_column_and_what_is_allowed(question: str, column: int, reason: str) -> None:
    with pytest.raises(QuestionError) as caught:
        value(question).digits(6)
    assert reason in caught.value.reason
    assert caught.value.column == column
    assert "\n" not in str(caught.value)
    assert f"column {column}: " in str(caught.value)


def test_question_too_long_or_nested_too_deep_is_refused_before_anything_is_computed() -> None:
    inside = "(" * DEEPEST_NESTING + "1" + ")" * DEEPEST_NESTING
    assert value(inside).exact == 1
    for deep in (f"({inside})", "-" * (DEEPEST_NESTING + 1) + "1", "abs(" * 41 + "1" + ")" * 41):
        with pytest.raises(QuestionError, match="nested deeper than 40 levels"):
            value(deep)
    assert value("1" + " " * (LONGEST_EXPRESSION - 1)).exact == 1
    with pytest.raises(QuestionError, match="at most 2000 characters, not 2001"):
        value("1" + " " * LONGEST_EXPRESSION)
    assert value("+".join(["1"] * 999)).exact == 999


def test_tokens_know_their_columns() -> None:
    assert [(t.text, t.column) for t in ExpressionParser("2**(−x.y) ").tokens] == [
        ("2", 1),
        ("**", 2),
        ("(", 4),
        ("-", 5),
        ("x.y", 6),
        (")", 9),
        ("", 11),
    ]


def test_numbers_are_ascii_and_exact() -> None:
    assert value("0.1 * 10").exact == 1
    for foreign in ("٣", "1²", "½", "１"):
        with pytest.raises(QuestionError, match="has no place"):
            value(foreign)


def test_units_follow_the_arithmetic() -> None:
    angle = "run rk4 h=1/4 t=10 : phase_error"
    assert value(f"2 * ({angle})").unit == "degrees"
    assert value(f"{angle} + 180").unit == "degrees"
    assert value(f"({angle}) / ({angle} deg)").unit is None
    assert value(f"percent({angle}, {angle})").unit == "%"
    assert value(f"-({angle} rad)").unit == "radians"
    assert value("roundoff rk4 h=1/4 : qq").unit == "u"


def test_evidence_is_the_weakest_of_the_parts() -> None:
    assert value("1 + order rk4").evidence == "PROVED"
    assert value("stages rk4 * order rk4").evidence == "COUNTED"
    assert value("stages rk4 * cos(1)").evidence == "CERTIFIED"
    assert value("claimed_order rk4 + stages rk4").evidence == "STATED"


def test_same_question_is_answered_once() -> None:
    assert value("order rk4") is value("order rk4")


def test_time_limit_ends_what_does_not_end_and_leaves_the_rest_alone() -> None:
    with time_limit("quick", 60):
        assert value("1 + 1").exact == 2
    assert signal.getitimer(signal.ITIMER_REAL) == (0, 0)
    assert signal.getsignal(signal.SIGALRM) == signal.SIG_DFL

    def for_ever() -> None:
        with time_limit("for ever", 0.05):
            while True:
                pass

    with pytest.raises(QuestionError, match=r"no answer within 0\.05 seconds"):
        for_ever()
    assert signal.getsignal(signal.SIGALRM) == signal.SIG_DFL


def test_long_runs_are_answered_by_squaring_and_long_numbers_enclosed() -> None:
    # In 10**12 steps of h = 1e-11, RK4 is off by h**4 t / 120 to leading order.
    found = value("run rk4 h=1e-11 t=10 : state_error")
    assert found.digits(5) == "8.3333e-46"
    # And behind by h**4 t / 120 radians.
    assert value("run rk4 N=1000000000000 t=10 : phase_error rad").digits(5) == "-8.3333e-46"
    assert value(f"step gauss2 h={'9' * 1000} : energy").digits(3) == "0.500"
