"""Facts of methods in sentences: orders, stages, evaluations, and limits of stability of the equation before them."""

import re

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.words.stated_facts import (
    fact_of,
    is_bound,
    is_on_the_safe_side,
    linear_equations,
    properties_in,
)
from tests.looping import exactly

LIMITS = "y' = -50y:\n\n| method | largest stable h |\n|---|---|\n| Euler | 0.04 |\n| Heun | 0.04 |\n"


@pytest.mark.parametrize(
    ("text", "fact", "slip"),  # of the number in brackets
    [
        ("On y' = -50y Euler needs h ≤ [0.04].", "real_limit forward_euler / 50", None),
        ("On y' = -50y Euler needs h ≤ 0.04, RK4 h ≤ [0.0557].", "real_limit rk4 / 50", None),
        ("On y' = -50y Euler needs h ≤ [0.05].", "real_limit forward_euler / 50", "0.04"),
        ("On y' = -50y RK4 needs h ≤ [0.05].", "real_limit rk4 / 50", None),  # and so it is stable
        ("On y' = -50y it takes h ≤ [0.0557] (RK4).", "real_limit rk4 / 50", None),
        ("y' = -1000 (y - cos t), y(0) = 0: RK4 is stable if h ≤ [0.002758].", "real_limit rk4 / 1000", "0.002785"),
        ("y' = -1000 (y - cos t), y(0) = 0: RK4 is stable if h ≤ [0.0027].", "real_limit rk4 / 1000", None),
        ("On x'' = -4x Verlet's velocity Verlet is stable for h ≤ [1].", "imaginary_limit velocity_verlet / 2", None),
        ("On y' = -2.5y, Euler is stable for h ≤ [0.8].", "real_limit forward_euler / (5/2)", None),
        ("On y' = -y/10, Euler is stable for h ≤ [20].", "real_limit forward_euler / (1/10)", None),
        ("On x'' = -x, RK4 is stable for h ≤ [2.785].", "imaginary_limit rk4", "2.828"),
        ("On y' = -2y RK4 blows up for h > [1.4142].", "real_limit rk4 / 2", "1.3926"),
        ("On y' = -2y RK4 blows up for h > [1.5].", "real_limit rk4 / 2", None),  # that it does
        ("On y' = -2y RK4 blows up for h > [1.3].", "real_limit rk4 / 2", "1.4"),
        ("On y' = -λ y, AB2 is stable for hλ ≤ [1].", "real_limit adams_bashforth2", None),
        ("y' = -4y, y(0) = 1. Put z = 1.5. Euler is stable for h < [2.5].", "real_limit forward_euler / 4", "0.5"),
        ("y' = y^2. Euler's method is stable for h < [2.5].", None, None),
        ("On y' = -50y it needs h ≤ [0.05].", None, None),
        ("RK4 has [5] stages.", "stages rk4", "4"),
        ("RK4 has [five] stages.", "stages rk4", "four"),
        ("The classical Runge-Kutta method (RK4) has four stages and order [4].", "order rk4", None),
        ("In short, Heun's method is old. It has [two] stages.", "stages heun2", None),
        ("Heun's method has order [3].", "order heun2", "2"),
        ("Störmer-Verlet has order [four].", "order position_verlet", "two"),
        ("Euler is a method of order [one], RK4 of order four.", "order forward_euler", None),
        ("Euler is a method of order one, RK4 of order [five].", "order rk4", "four"),
        ("Euler needs one evaluation per step, midpoint two, RK4 [four].", "evaluations_per_step rk4", None),
        ("After 10 steps Euler used 10 evaluations, midpoint 20, and RK4 [44].", "10*evaluations_per_step rk4", "40"),
        ("The ten steps cost Euler ten evaluations, Heun's method [twenty].", "10*evaluations_per_step heun2", None),
        ("Euler with h = 1/16 needs [sixteen] evaluations up to t = 1.", "16*evaluations_per_step forward_euler", None),
        ("RK4 with h = 1/4 has [fifteen] evaluations up to t = 1.", "4*evaluations_per_step rk4", "sixteen"),
        ("Velocity Verlet needs [one] evaluation per step.", None, None),  # or two
        ("RK4 is one of [four] methods.", None, None),
        ("A Runge-Kutta method of order [two] is cheap.", None, None),
        ("The Dormand-Prince method has [six] stages.", None, None),  # or seven
        ("Heun with [three] stages has order three.", None, None),
        ("RK4 needs [5] evaluations per step with an error estimate.", None, None),
        (f"{LIMITS}| RK4 | [0.0557] |", "real_limit rk4 / 50", None),
        (f"{LIMITS}| RK4 | [0.0577] |", "real_limit rk4 / 50", "0.0557"),
        (f"{LIMITS}| RK4 | ≤ [0.05] |", "real_limit rk4 / 50", None),  # cut off
        ("R(z) tends to R(∞) = [1] for the trapezoidal rule.", "limit_at_infinity trapezoid", "-1"),
        (f"{LIMITS}| implicit Euler | [0.05] |", "real_limit backward_euler / 50", None),
        ("On x'' = -10x, RK4 explodes for dt > [0.8944].", "imaginary_limit rk4 / sqrt(10)", None),
        ("RK4 with h = 0.2 takes 10 steps and [44] evaluations.", "10*evaluations_per_step rk4", "40"),
        ("RK4 on y' = -50y needs h ≤ [0.0125] for three digits.", "real_limit rk4 / 50", None),
        ("On y' = -50y RK4 is stable up to h = [0.0577].", "real_limit rk4 / 50", "0.0557"),
        ("Kutta's third-order method needs 6 steps, and RK4 [3] steps or 12 evaluations.", None, None),
        ("Kutta's third-order method needs 6 steps or [22] evaluations.", "6*evaluations_per_step kutta3", "18"),
        ("On the real axis AB3 is stable up to 6/11, AB4 up to [0.3].", "real_limit adams_bashforth4", None),
        ("On the real axis AB3 is stable; two-step Adams--Moulton up to [3].", "real_limit adams_moulton2", "6"),
        ("On the imaginary axis RK4 reaches 2.8284, and Heun [0].", "imaginary_limit heun2", None),
        ("On the imaginary axis RK4 reaches [2.82].", "imaginary_limit rk4", None),  # cut off
        ("It is stable in a sector of half-angle α: BDF3 has 86.03°, BDF4 [51.84]°.", "angle bdf4", "73.35"),
        ("Neither RK4 nor Heun's method has [three] stages.", None, None),
        ("On the imaginary axis RK4 reaches 2.8. BDF4 [51.84] is old.", None, None),
        ('"Kutta 3" is Kutta\'s method of order [two].', "order kutta3", "three"),
        ("Heun's method is of [third] order.", "order heun2", "second"),
        ("Use the [third]-order Adams-Bashforth method AB2.", "order adams_bashforth2", "second"),
        ("In Taylor's [second]-order RK4 comparison it is small.", None, None),
        ("Halving the step [doubles] the error of Euler.", "1/power(2, order forward_euler)", "halves"),
        ("Halving the step [halves] the error of Euler.", "1/power(2, order forward_euler)", None),
        ("Doubling the step [doubles] the error of Euler.", "power(2, order forward_euler)", None),
        ("Halving the step makes that of RK4 [four] times smaller.", "power(2, order rk4)", "sixteen"),
        ("Halving the step makes that of RK4 sixteen times [larger].", "-power(2, order rk4)", "smaller"),
        ("Halving h [doubles] the error of Euler's method.", "1/power(2, order forward_euler)", "halves"),
        ("Halving h halves the error of Euler and makes that of RK4 about [four] times smaller.",
         "power(2, order rk4)", "sixteen"),
        ("AB2 and the trapezoidal rule are of [third] order.", "order adams_bashforth2", "second"),
        ("RK4 and Heun's method are of [second] order.", None, None),
        ("RK4 is of fourth order and symplectic Euler of [second] order.", "order symplectic_euler", "first"),
        ("On x'' = -x forward Euler is stable for [no] h at all.", "imaginary_limit forward_euler", None),
        ("On x'' = -x forward Euler is stable for [every] h.", "imaginary_limit forward_euler", "no"),
        ("On y' = -y RK4 is stable for [every] h.", "real_limit rk4", "2.785"),
        ("On y' = -y backward Euler is stable for [every] h.", "real_limit backward_euler", None),
        ("RK4 is of fourth order, the error in one step of [fifth] order.", None, None),
        ("Richardson extrapolated Euler is of [second] order.", None, None),
        ("RK4 is of fourth order, Heun of [third].", "order heun2", "second"),
        ("Euler is of first, Heun of [third] and RK4 of fourth order.", "order heun2", "second"),
        ("Euler is of first, Heun of [second] and RK4 of fourth order.", "order heun2", None),
        ("RK4 is a fourth-order method, Heun a [third]-order one.", "order heun2", "second"),
        ("RK4 (order [five]) is better.", "order rk4", "four"),
        ("Heun's method, with order [three], is cheap.", "order heun2", "two"),
        ("Take RK4 with order [four], and wait.", "order rk4", None),
        ("RK4 is in the group of [third], Heun in that of second.", None, None),
        ("RK4 is the best of [three].", None, None),
        ("For [second]-order equations RK4 is fine; for [first] order RK4 is, too.", None, None),
        ("If the step is halved, the error of RK4 is [four] times smaller than that of Heun.", None, None),
        ("Halving the step [doubles] the cost of Euler, and only halves the error of RK4.", None, None),
    ],
)  # fmt: skip
def test_a_sentence_gives_a_fact_that_its_number_is_or_is_a_slip_for(text, fact, slip):
    at, plain = text.index("["), re.sub("[][]", "", text)
    suggestions = Suggestions(plain)
    (number,) = [x for x in (*numbers_in(plain), *suggestions.words) if x.start == at] or [None]
    found = suggestions._fact_at(number) if number else None
    assert found == fact
    if number:
        assert [*suggestions.slips(number).values()] == [slip] * (slip is not None)
        is_right = suggestions.look_alikes(number)[:1] and suggestions.look_alikes(number)[0].strong
        assert not (is_right and (slip or not fact))


def test_what_bounds_step_sizes_is_a_limit_of_the_equation_before_it():
    sizes = [
        (one.limit, one.size) for one in linear_equations("y' = -2.5y. It is not u' = u^2. Also x' = v, v' = -4x.")
    ]
    assert sizes == [("real_limit", "5/2"), ("", ""), ("imaginary_limit", "2")]
    assert linear_equations("x'' = -3x")[0].size == "sqrt(3)"
    assert [is_bound(one) for one in ("stable for h ≤ ", "step sizes up to ", "with h = ")] == [True, True, False]
    assert [is_on_the_safe_side(one, 1, 2) for one in ("stable for h <", "unstable for h >")] == [True, False]


def test_several_methods_have_one_fact_if_it_is_the_same_of_all():
    assert fact_of("order", ["velocity_verlet", "position_verlet"]) == "order position_verlet"
    assert fact_of("order", ["rk4", "heun2"]) is None
    assert fact_of("stages", ["velocity_verlet"]) is None


@pytest.mark.parametrize(
    ("text", "question", "answer", "holds"),
    [
        ("So BDF2 is A-stable.", "a_stable bdf2", "yes", True),
        ("BDF3 is A-stable", "a_stable bdf3", "yes", False),
        ("the Crank-Nicolson\nmethod is not\nL-stable", "l_stable trapezoid", "no", True),
        ("Leapfrog is symplectic", "symplectic position_verlet", "yes", True),
        ("Euler's method is A-stable", "a_stable forward_euler", "yes", False),
        ("Heun's is not A-stable", "a_stable heun2", "no", True),
        ("It is so if R(∞) = 0. Backward Euler is L-stable", "l_stable backward_euler", "yes", True),
        ("classical RK4 is symmetric", "symmetric rk4", "yes", False),
        ("The trapezoidal rule is also L-stable", "l_stable trapezoid", "yes", False),
    ],
)
def test_a_property_is_a_fact_that_holds_or_not(text, question, answer, holds):
    (found,) = properties_in(text)
    assert (found.question, found.answer, found.holds) == (question, answer, holds)
    assert text.replace("\n", " ")[found.start :].startswith(found.phrase)


def test_two_properties_of_one_sentence_are_two_facts_and_what_stands_between_commas_none():
    found = [*properties_in("The trapezoidal rule is A-stable but not L-stable. RK4, of order 4, is symplectic.")]
    assert [(one.question, one.answer, one.holds) for one in found] == [
        ("a_stable trapezoid", "yes", True),
        ("l_stable trapezoid", "no", True),
        ("symplectic rk4", "yes", False),
    ]
    assert found[0].phrase == found[1].phrase == "trapezoidal rule is A-stable but not L-stable"
    for text, holds in (
        ("Backward Euler and BDF2 are both A-stable", [True, True]),
        ("Neither RK4 nor backward Euler is A-stable", [True, False]),
        ("RK4 is neither A- nor L-stable", [True, True]),
        ("Backward Euler is both A- and L-stable", [True, True]),
        ("The trapezoidal rule is A- but not L-stable", [True, True]),
        ("The trapezoidal rule is A- and L-stable", [True, False]),
        ("Backward Euler is neither A-stable nor L-stable", [False, False]),
        ("The trapezoidal rule is A-stable, but not L-stable", [True, True]),
        ("Backward Euler has R = 1, the trapezoidal rule -1; neither is A-stable", [False, False]),
    ):
        assert [one.holds for one in exactly(2, properties_in(text))] == holds


@pytest.mark.parametrize(
    "text",
    [
        *("It is A-stable", "RK4 is fast", "RK4 is symplectically ill", "RK4 is L", "So RK4 is A-stable?"),
        *("True or false: RK4 is A-stable.", "It is a myth that RK4 is A-stable", "Nobody says that RK4 is A-stable"),
        *("RK4 nor Heun is A-stable", "The regions of RK4 and BDF2 are symmetric", "BDF2 but not RK4 is A-stable"),
        *("Backward Euler is not A- and L-stable", "RK4 is A- or L-stable"),
        *("Unlike RK4 and Heun, both are A-stable", "Nobody says that neither RK4 nor Heun is A-stable"),
    ],
)
def test_nothing_is_read_into_other_words_questions_and_denials(text):
    assert not [*properties_in(text)]
