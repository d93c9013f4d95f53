"""A value is not drafted where its sentence speaks of another method, step or quantity; it is where it may be meant."""

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.words.contradictions import SETTING, contradicted, methods_compared, methods_said_of
from tests.looping import some

Q, V, ERROR = "rk4.first_step.q", "rk4.first_step.v", "forward_euler.default.state_error"
REAL, IMAGINARY = "real_limit rk4", "imaginary_limit rk4"
DENIED = [
    ("RK4 is stable on the imaginary axis up to {2.785294}", REAL),
    ("RK4 is stable on the negative real axis up to {2.828427}", IMAGINARY),
    ("{2.785294} is where RK4 ends on the imaginary axis", REAL),
    ("The imaginary limit of RK4 is 2.828427 and its real limit {2.828427}", IMAGINARY),
    ("One step of RK4 gives v = {0.877604}", Q),
    ("One step of RK4 leads to the position {-0.479167}", V),
    ("One step of RK4 with h = 1/4 gives q = {0.877604}", Q),
    ("With Heun's method and h = 1/2, q = {0.877604}", Q),
    ("RK4 goes to (0.877604, -0.479167), and forward Euler to {0.877604}", Q),
    ("The phase error of forward Euler with h = 1/4 is {2.390}", ERROR),
    ("At t = 10, with h = 1/8, forward Euler is off by {2.390}", ERROR),
    ("At t = 5, forward Euler is off by {2.390}", "run forward_euler h=1/4 t=10 : state_error"),
    ("RK4 has order {4} and takes 4 evaluations per step", "rk4.evaluations_per_step"),
    ("RK4 has order 4 and takes {4} evaluations per step", "order rk4"),
    ("RK4 of order {4}: 4 stages", "stages rk4"),
    ("The trapezoid of order 2 has R(z) = (1+z/{2})/(1-z/2)", "order trapezoid"),
    ("BDF4 is of order {3}", "order bdf3"),
    ("With Heun's method and a step of\nh = 1/2, q = {0.877604}", Q),
    ("The axis of imaginary values is met up to {2}√2", "imaginary_limit symplectic_euler"),
    ("The axis of imaginary values is met up to √({2})", "imaginary_limit symplectic_euler"),
    ("Backward Euler has R(-1) = {0.5}", "error_constant backward_euler"),
    ("Velocity Verlet has order 2 and is stable for h < {2}", "order velocity_verlet"),
    ("{0.877604} is RK4's for h = 1/4, and not for h = 1/2", Q),
]
MEANT = [
    ("RK4's real and imaginary limits are {2.785294} and 2.828427", REAL),
    ("RK4's real and imaginary limits are 2.785294 and {2.828427}", IMAGINARY),
    ("RK4 reaches (q, v) = ({0.877604}, -0.479167)", Q),
    ("The position and the velocity after one step of RK4 are {0.877604}", Q),
    ("Forward Euler's state error is {2.390}, that of RK4 3.28e-4", ERROR),
    ("Forward Euler and RK4 are off by {2.390} and 3.28e-4", ERROR),
    ("Forward Euler has another phase. With h = 0.5 RK4 goes to {337/384}", Q),
    ("With h = 1/4 and then h = 1/2 RK4 goes to {0.877604}", Q),
    ("{0.877604} is RK4's for h = 1/2, and not for h = 1/4", Q),
    ("{0.877604} is RK4's, 0.875 velocity Verlet's", Q),
    ("without any word: {0.877604}", Q),
    ("| Heun |\n| {0.877604} |", Q),
    ("h = 1/0 is none: {0.877604}", Q),
    ("RK4 has order {4} and takes 4 evaluations per step", "order rk4"),
    ("RK4 has order 4 and takes {4} evaluations per step", "rk4.evaluations_per_step"),
    ("RK4 counts {4}", "order rk4"),
    ("RK4's real limit / 2 is 2.785294 / 2, it reaches {2.785294} / 1", REAL),
]


# What the author asked for is denied as well by a formula, and by another symbol before few digits.
DENIED_IF_ASKED = [
    ("M = 1 - h^{2}, where h is at most 2", "imaginary_limit symplectic_euler"),
    ("of order two, with γ = {1} - √2/2", "order backward_euler"),
    ("x' = x(y - {1})", "run heun2 y'=y y(0)=1 h=1 N=1 : y"),
    ("starts at ''x'' = {2}, ''y'' = 1", "run forward_euler y'=y y(0)=1 h=1 N=1 : y"),
    ("where h = {2} is too much", "run forward_euler h=1/10 t=1 : state_error"),
    ("to t = {10} in steps of h = 0.1", "run forward_euler h=1/10 t=1 : steps"),
]
MEANT_IF_ASKED = [
    ("of order p = {4} - the classical one", "order rk4"),
    ("stable to h = {2}", "imaginary_limit symplectic_euler"),
    ("there y = {2}", "run forward_euler y'=y y(0)=1 h=1 N=1 : y"),
    ("there w = {2.71}", "run rk4 y'=y y(0)=1 h=1 N=1 : y"),
    ("N = {10} steps", "run forward_euler h=1/10 t=1 : steps"),
]


SENTENCES = [(DENIED, True, False), (MEANT, False, False), (DENIED_IF_ASKED, True, True), (MEANT_IF_ASKED, False, True)]


@pytest.mark.parametrize(
    ("sentence", "question", "denied", "asked"), [(*each, *how) for those, *how in SENTENCES for each in those]
)
def test_what_the_sentence_denies_is_told_from_what_it_may_mean(sentence, question, denied, asked):
    start, end = sentence.index("{"), sentence.index("}") - 1
    assert contradicted(question, sentence.replace("{", "").replace("}", "").lower(), start, end, asked) is denied


def test_a_value_that_is_denied_is_a_guess_and_stands_behind_the_others():
    def best(text):
        suggestions = Suggestions(text)
        return [suggestions.look_alikes(number)[0] for number in numbers_in(text) if number.text == "0.875"]

    (right,) = best("Velocity Verlet with h = 1/2: q = 0.875")
    assert (right.question, right.strong) == ("step velocity_verlet h=1/2 : q", True)
    (other,) = best("Position Verlet with h = 1/2: q = 0.875, and not velocity Verlet")
    assert other.question == "step position_verlet h=1/2 : q"


def test_a_root_that_nothing_near_names_is_a_guess():
    text = "the gain is 2.828427124746190 dB"
    (number,) = numbers_in(text)
    assert not any(alike.strong for alike in some(Suggestions(text).look_alikes(number)))


def test_a_setting_is_a_whole_number_above_zero_with_its_own_letter():
    read = {"h = 0.1.": "0.1", "*h = 1/8*,": "1/8", "h =\n0.5 and": "0.5", "(h=12)": "12"}
    other = ("δh = 0.1", "x.h = 1", "h = 0.0", "h = 0.", "h = 10^6", "h = 10⁶", "h = 2*pi", "h = 1e-3", "h = 1.2.3")
    assert {text: SETTING["h"].findall(text) for text in read} == {text: [number] for text, number in read.items()}
    assert [text for text in other if SETTING["h"].search(text)] == []


@pytest.mark.parametrize(
    ("own", "said"),
    [
        ("velocity_verlet", "h = 0.1: @2.3e-02@ for velocity verlet, 2.1e-03 for symplectic euler"),
        ("symplectic_euler", "errors are 2.3e-02 (velocity verlet) and @2.1e-03@ (symplectic euler)"),
        ("velocity_verlet", "the errors of velocity verlet and symplectic euler are @2.3e-02@ and 2.1e-03"),
        ("adams_bashforth3", "with h = 0.1, ab2, ab3 and ab4 have 0.1, @0.2@ and 0.3"),
        ("trapezoid", "errors are 1.3×10^{-4} and @2×10^{-3}@ for rk4 and the trapezoidal rule"),
        ("heun2", "rk4 and heun have errors 0.1, after one step, and @0.2@, respectively"),
        ("rk4", "rk4 with h = 0.1 is off by @0.01@ (heun: 0.02)"),
        ("heun2", "it falls to 1.27816 in rk4's run and to @1.27104@ in heun's"),
        ("", "rk4 and heun give @0.36@"),
        ("", "rk4 and heun have x = @0.5@ and v = 0.3"),
        ("", "compared with rk4 the error is @0.01@"),
        ("", "heun is worse than rk4 by @0.01@"),
        ("", "rk4 has 4 stages and the error @0.01@"),
        ("", "with rk4, the error is @0.5@"),
    ],
)
def test_a_sentence_says_of_which_method_a_number_is(own, said):
    before, _, after = said.split("@")
    assert methods_said_of(before, after) == {*own.split()}


def test_a_ratio_is_of_errors_only_if_they_are_spoken_of():
    both = ("forward_euler", "rk4")
    assert methods_compared("with h = 0.1 the error of euler is ", " times that of rk4") == both
    assert methods_compared("the error of rk4 is ", " times smaller than that of euler") == both
    assert methods_compared("the cost of rk4 is ", " times that of euler") == ()
    assert methods_compared("the error of euler is ", " times that of the same method") == ()
