"""What a number might be is suggested, the best first; an author's questions go before ours."""

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import numbers_in
from tests.texts.sample import claims_and_slips

TABLE = """
| n | t   | y     | error |
| 2 | 0.4 | 0.04  | 0.052 |
| 3 | 0.6 | 0.128 | 0.094 |
| 5 | 1.0 | 0.489 | 0.229 |
"""
ASKED = ["run forward_euler rates=(t+y0) from 0 h=0.2 t={0.4,0.6,1.0} : {y0,state_error}"]


def test_values_that_the_author_asks_for_are_strong_on_the_line_of_what_was_chosen():
    suggestions = Suggestions(TABLE, ASKED)
    found = {n.text: suggestions.look_alikes(n) for n in numbers_in(TABLE)}
    run = "run forward_euler rates=(t+y0) from 0 h=0.2"
    assert not found["0.04"][0].strong, "one digit, and one number of the line"
    for number, question in {"0.128": "t=0.6 : y0", "0.094": "t=0.6 : state_error"}.items():
        assert (found[number][0].question, found[number][0].strong) == (f"{run} {question}", True), number
    assert not found["0.489"], "0.48832 is 0.488"
    slips = {
        question.rpartition("t=")[2]: [n.text for n in slips] for question, _, slips, vague in suggestions.nowhere()
    }
    assert slips == {"0.4 : y0": [], "1.0 : y0": ["0.489"], "1.0 : state_error": []}
    assert [[n.text for n in vague] for *_, vague in suggestions.nowhere()] == [["0.04"], [], []]
    few = Suggestions("0.4 or 0.41", ["0.412 + {1..5} - {1..5}"]).nowhere()
    assert [[n.text for n in vague] for *_, vague in few] == [["0.41"]] * 5, "one digit is no guess"
    itself = Suggestions("a\n0.652", ["{0.652} - 0.027"])
    assert not itself.slips(numbers_in(itself.text)[0]), "beside what was chosen, and not the same number"
    rows = Suggestions("| RK4 | 1.64872 |\n| Heun | 1.64745 |", ["run {Heun,RK4} lambda=1 h=1/10 t=1/2 : {exact.y,y}"])
    assert rows.look_alikes(numbers_in(rows.text)[1])[0].question == "run RK4 lambda=1 h=1/10 t=1/2 : y"
    text = "It is -1/2 for Euler and -1/3 for Heun. BDF2 has -1/3."
    constants, numbers = Suggestions(text, ["error constant of {Euler,BDF2}"]), numbers_in(text)
    assert [constants.look_alikes(numbers[i])[0].strong for i in (1, -1)] == [False, True]
    alone = Suggestions("0.128 and 0.052", ASKED)
    assert [one.strong for n in numbers_in(alone.text) for one in alone.look_alikes(n)[:1]] == [True, False]


NOTE = """\
Euler's method on y' = -2y, y(0) = 1 reaches 0.10737 at t = 1 with h = 0.1, which is off by 20.7% or 0.02796.
The solution there is 0.135335, and y = 0.1 is a start. Heun's method reaches 0.13748, and RK4 with h = 0.5 0.1406."""
OF_NOTE = "run {Euler,Heun} y'=-2y, y(0)=1, h={0.1,0.5}, t=1 : {y,error,relative_error,exact.y}"


def test_one_digit_that_agrees_does_not_hide_a_wrong_number():
    nowhere = {question for question, *_ in Suggestions(NOTE, [OF_NOTE]).nowhere()}
    assert "run Heun y'=-2y, y(0)=1, h=0.1, t=1 : y" in nowhere  # 0.13745 is printed as 0.13748; 0.1 is a start
    right = {question for question, *_ in Suggestions(NOTE.replace("0.13748", "0.13745"), [OF_NOTE]).nowhere()}
    assert nowhere - right == {"run Heun y'=-2y, y(0)=1, h=0.1, t=1 : y"}


def test_a_slip_is_a_wrong_digit_or_sign_or_two_neighbours_exchanged_and_no_number_of_few_digits():
    wrong = [("1.3591", "1.3519"), ("1.35914", "1.35924"), ("2.785", "-2.785"), ("1/120", "-1/120")]
    none = [("1.35914", "1.35914"), ("1.35914", "1.35851"), ("2.785", "2.758"), ("2.7", "-2.7"), ("1.3", "1.20000")]
    for asked, printed in wrong + none:
        suggestions, (number,) = Suggestions(f"is {printed}.", [asked]), numbers_in(f"is {printed}.")
        assert suggestions.slips(number) == ({asked: asked} if (asked, printed) in wrong else {}), printed
    for printed, best in (("73.53", ["angle bdf4"]), ("74.3", [])):  # 73.35, or 73.4
        angle = Suggestions(f"The angle of BDF4 is {printed}.", ["angle {bdf3,bdf4}"])
        assert [*angle.slips(numbers_in(angle.text)[-1])] == best
    row = Suggestions("| 0.6 | 0.182 |", ASKED)
    assert [*row.slips(numbers_in(row.text)[1])] == ["run forward_euler rates=(t+y0) from 0 h=0.2 t=0.6 : y0"]


@pytest.mark.parametrize(
    ("said", "value"),
    [
        ("Euler, h = 0.1: 0.108", "0.107"),  # or 0.0280 or 0.135, for which it is no slip
        ("RK4, h = 0.1: 0.17", None),  # 0.14, or 0.00
        ("Euler, h = 0.1: the error 0.038", None),
        ("Euler, h = 0.1: the error 0.028", None),
        ("Euler, h = 0.002: 501 evaluations", None),
        ("RK4, h = 0.002: 2001 evaluations", "2000"),
        ("x'' = -x, x(0) = 1, x'(0) = 0. Position Verlet, h = 0.0005, t = 1: 2001 evaluations", None),
        ("x'' = -x, x(0) = 1, x'(0) = 0. Position Verlet, h = 0.0005, t = 1: 2002 evaluations", "2000"),
        ("Euler, h = 0.1: the error 0.135353", "0.135335"),  # the solution
        ("Euler, h = 0.1: the error 0.13543", None),
        ("Euler, h = 0.1: Y(1) = 0.1064", "0.1074"),  # no slip of a digit or two, and within 1 in 100 of it
        ("Euler, h = 0.1: y(1) = 0.1064", "0.1074"),
        ("Euler, h = 0.1: y(1) = 0.1063", None),
        ("Euler, h = 0.1: y(1) = 0.1353", None),  # the solution
    ],
)
def test_a_slip_for_what_a_problem_asks_has_few_digits_where_its_place_names_few_values(said, value):
    letter = "Y" if "Y" in said else "y"
    text = f"{letter}' = -2{letter}, {letter}(0) = 1, to t = 1. {said}"
    assert [*Suggestions(text).slips(numbers_in(text)[-1]).values()] == [value][: value is not None]


DAMPED = "run forward_euler y'=-y, y(0)=1, energy=y^2/2, h=0.1, t=0.1"


@pytest.mark.parametrize(
    ("text", "asked", "strong"),  # of the last number
    [
        ("The error of RK4 changes by -1.0e-08.", "0 * order {RK4} - 1.02e-8", True),
        ("Heun and RK4 with h = 0.1 are off by factors of 4.00.", "ratio(4.001, 1)", False),
        ("With h = 0.100 for RK4.", "0.1 + 0 * order {RK4}", False),
        ("Euler, h = 0.1: the largest change is 0.09500", f"{DAMPED} : largest_energy_change", True),  # its size
    ],
)
def test_zeros_at_the_end_are_digits_of_what_the_author_asks_for(text, asked, strong):
    found = Suggestions(text, [asked]).look_alikes(numbers_in(text)[-1])
    assert any(one.strong for one in found) is strong


def test_a_value_of_another_step_size_or_the_solution_is_weak_where_the_place_names_a_value():
    """With RK4, h = 1, y is 0.3750; the solution is 0.3679, and 0.3681 is y with h = 1/2."""
    text = "y' = -y, y(0) = 1, to t = 1, h = 0.5 or 1. With h = 1, RK4 gives y(1) = {}, the exact value is 0.3679."
    for number, strong, slips in (
        ("0.3750", True, []),
        ("0.3681", False, []),
        ("0.3679", False, []),
        ("0.3740", False, ["0.3750"]),
    ):
        suggestions = Suggestions(text.format(number))
        first = next(x for x in numbers_in(suggestions.text) if x.text == number)
        assert any(one.strong for one in suggestions.look_alikes(first)) is strong, number
        assert [*suggestions.slips(first).values()] == slips
    last = numbers_in(suggestions.text)[-1]
    assert suggestions.look_alikes(last)[0].question.startswith("exact")


def test_a_value_in_the_row_of_another_step_size_is_misplaced_and_no_claim():
    """Forward Euler has 0.3164 with h = 1/4 and 0.3277 with h = 1/5."""
    table = "y' = -y, y(0) = 1. At t = 1:\n| h | Euler |\n| 0.25 | {} |\n| 0.2 | {} |"
    for values, misplaced in ((("0.3164", "0.3277"), []), (("0.3277", "0.3164"), ["0.3164", "0.3277"])):
        suggestions = Suggestions(table.format(*values))
        numbers = [x for x in numbers_in(suggestions.text) if x.text in values]
        assert [slip for x in numbers for slip in suggestions.slips(x).values()] == misplaced
        assert [suggestions.look_alikes(x)[0].strong for x in numbers] == [not misplaced] * 2


COPIES = """Let y' = -2y, y(0) = 1: with h = 0.1 Heun's method gives 0.137448 at t = 1; {} it gives {}.

| t | Heun, h = 0.1 |
| 0.5 | {} |
| 1.0 | 0.137448 |
"""


@pytest.mark.parametrize(
    ("where", "x", "y"), [("with h = 0.05", "0.137448", "0.370740"), ("at t = 0.5", "0.137448", "0.137448")]
)
def test_a_number_copied_to_another_step_size_or_time_is_no_value(where, x, y):
    text = COPIES.format(where, x, y)
    suggestions, numbers = Suggestions(text), [x for x in numbers_in(text) if len(x.text) > 6]
    strong = [bool(found) and found[0].strong for found in map(suggestions.look_alikes, numbers)]
    assert strong == [True, False, y == "0.370740", True]
    if y == x:  # the row says the time
        assert [*suggestions.slips(numbers[2]).values()] == ["0.370740"]


SWAPPED = """x' = v, v' = -4x, x(0) = 1, v(0) = 0 with h = 0.1 at t = 1:

| method | x | x' |
| Heun | {} | {} |
"""


def test_unknowns_that_are_exchanged_are_slips_and_a_velocity_has_its_column():
    run = "run heun2 x'=v, v'=-4x, x(0)=1, v(0)=0, h=0.1, t=1 : {}"
    x, v = (value(run.format(name)).places(6) for name in "xv")
    for row, strong, slips in (((x, v), [True, True], [None, None]), ((v, x), [False, False], [x, v])):
        text = SWAPPED.format(*row)
        suggestions, numbers = Suggestions(text), [x for x in numbers_in(text) if len(x.text) > 6]
        assert [suggestions.look_alikes(x)[0].strong for x in numbers] == strong
        assert [next(iter(suggestions.slips(x).values()), None) for x in numbers] == slips


@pytest.mark.parametrize("label", ["odeint", "Kutta's new method", "LSODA"])
def test_a_row_or_an_item_of_another_program_is_of_no_method(label):
    """The value of Kutta's method is near: of Heun's it would be a slip."""
    for line in ("| Heun | 0.368541 |\n| {} | 0.367862 |", "* Heun: 0.368541\n* {}: 0.367862"):
        text = f"y' = -y, y(0) = 1, h = 0.1. At t = 1:\n\n| method | y |\n{line.format(label)}"
        suggestions = Suggestions(text)
        right, other = (x for x in numbers_in(text) if len(x.text) > 6)
        assert suggestions.look_alikes(right)[0].strong
        assert not suggestions.slips(other), line


@pytest.mark.parametrize("said", ["It has", "Heun has"])
def test_what_another_method_of_the_text_gives_is_no_slip_where_its_name_is_far(said):
    text = (
        "We solve y' = 0.8 y (1 - y/5), y(0) = 0.5 with h = 0.25. The two-step Adams-Bashforth method needs a starting "
        f"value; we take one step of Heun. {said} y = 3.667272 at t = 4."
    )
    suggestions, number = Suggestions(text), next(x for x in numbers_in(text) if x.text == "3.667272")
    assert not suggestions.slips(number)
    assert suggestions.look_alikes(number)[0].strong == (said == "It has")


DECAY = "y' = -y, y(0) = 2, h = 0.25.\n\n| t | Euler | error |\n"


def _decay(t, readout):
    return value(f"run forward_euler y'=-y, y(0)=2, h=0.25, t={t} : {readout}").places(4)


@pytest.mark.parametrize(("rows", "slips"), [(("0.5", "0.75", "1"), ["1.1250"]), (("1",), [])])
def test_a_number_far_from_what_its_place_names_is_a_slip_where_the_rest_of_its_column_is_right(rows, slips):
    text = DECAY + "".join(f"| {t} | {_decay(t, 'y')} | {_decay(t, 'error')} |\n" for t in rows)
    for wrong in ("1.9871", "0.0112"):
        suggestions = Suggestions(
            text.replace(_decay("0.5", "y"), wrong).replace("| 1 | 0.6328", f"| 1 | {_decay('1', 'y')}")
        )
        found = [slip for x in numbers_in(suggestions.text) for slip in suggestions.slips(x).values()]
        assert found == slips, wrong


TOGETHER = "x' = v, v' = -4x, x(0) = 1, v(0) = 0. With h = 0.1 at t = 1 Heun's method has x = {} and v = {}; {}."


@pytest.mark.parametrize(
    ("v", "rest", "slips"),
    [
        ("-3.4", "", 0),  # too few digits
        ("-1.12345", "", 1),
        (None, "RK4 has -1.23712", 1),
        (None, "RK4 has 12.5371", 0),  # written otherwise
        (None, "cos 1 is 0.54030", 0),  # another value
        (None, "RK4 took 0.41231 s", 0),
    ],
)
def test_beside_a_value_of_the_same_run_or_of_another_method_a_number_far_from_its_own_is_a_slip(v, rest, slips):
    x, right = (value(f"run heun2 x'=v, v'=-4x, x(0)=1, v(0)=0, h=0.1, t=1 : {name}").places(5) for name in "xv")
    text = TOGETHER.format(x, v or right, rest)
    suggestions = Suggestions(text)
    found = [slip for number in numbers_in(text) for slip in suggestions.slips(number).values()]
    assert len(found) == slips, found


FACTS = """\
| Name | Class | Order | Stages | Real limit | Imaginary stability limit |
| Forward Euler | `Euler` | 1 | 1 | 2 | 0 |
| Heun | `Heun2` | 2 | 2 | 2 | 0 |
| Kutta's third-order method | `K3` | 3 | 3 | 2.51 | 1.73 |
| Classical RK4 | `Rk4` | 4 | 4 | 2.79 | 2.83 |
| Velocity Verlet | `Verlet` | 2 | 1 | - | 2 |
"""


@pytest.mark.parametrize(
    ("right", "wrong", "slips"),
    [
        ("", "", []),
        ("2.83 |", "2.38 |", ["2.83"]),
        ("| 3 | 3 |", "| 2 | 3 |", ["3"]),
        ("| 4 | 4 |", "| 4 | 5 |", ["4"]),
        ("| 1 | 1 | 2 |", "| 1 | 1 | 2.5 |", ["2.0"]),
        ("| - |", "| 2 |", []),
    ],
)
def test_in_a_column_of_facts_each_number_is_that_of_its_row_or_a_slip(right, wrong, slips):
    """The stages of a splitting are counted in several ways, so Verlet's 1 is neither."""
    suggestions = Suggestions(FACTS.replace(right, wrong, 1))
    numbers = [x for x in numbers_in(suggestions.text) if x.label is None]
    assert [slip for x in numbers for slip in suggestions.slips(x).values()] == slips
    weak = [x for x in numbers if not any(one.strong for one in suggestions.look_alikes(x))]
    assert len(weak) == len(slips) + 1 + (right == "| - |")
    assert {one.question for x in numbers for one in suggestions.look_alikes(x) if one.strong} >= {"stages kutta3"}


def test_an_angle_of_stability_is_that_of_the_method_before_it():
    text = "BDF3 is A(86.0°)-stable, BDF4 A(73.4°)-stable, BDF5 A(51.8°)-stable and BDF6 A(18.7°)-stable."
    suggestions = Suggestions(text)
    numbers = [x for x in numbers_in(text) if x.label is None]
    assert [any(one.strong for one in suggestions.look_alikes(x)) for x in numbers] == [True, True, True, False]
    assert suggestions.slips(numbers[-1]) == {"angle bdf6": "17.8"}


GROWTH = "y' = 0.8*y*(1 - y/5), y(0) = 0.5, to t = 5 (exact: 4.29243):\n\n| h | Euler | Heun | RK4 |\n"


def test_the_numbers_of_a_table_whose_heads_do_not_say_it_say_that_they_are_errors():
    rows = "| 1 | 1.43e-1 | 1.11e-1 | 1.86e-3 |\n| 0.5 | 4.95e-2 | 2.75e-2 | 1.20e-4 |\n"
    rows += "| 0.25 | 2.11e-2 | 6.98e-3 | 7.68e-6 |\n"
    suggestions = Suggestions(GROWTH + rows)
    numbers = [x for x in numbers_in(GROWTH + rows) if "e" in x.text]
    strong = [any(one.strong for one in suggestions.look_alikes(x)) for x in numbers]
    assert strong == [True] * 7 + [False, True]
    assert [*suggestions.slips(numbers[7]).values()] == ["6.89e-3"]
    two = Suggestions(GROWTH + "| 1 | 1.43e-1 | 1.11e-1 | 1.00e-3 |\n| 0.5 | 1e-1 | 1e-2 | 1e-3 |")
    assert not any(one.strong for x in numbers_in(two.text) if "e" in x.text for one in two.look_alikes(x))


LISTED = """x'' = -4x, x(0) = 1, x'(0) = 0. With h = 0.05 the positions at t = 10 of symplectic Euler, velocity Verlet
and RK4 are {}, {} and {}, respectively."""


def test_of_methods_in_a_list_each_has_its_number_and_exchanged_ones_are_slips():
    first, second, third = "0.35458", "0.40045", "0.40810"
    for numbers, slips in (((first, second, third), []), ((second, first, third), [first, second])):
        suggestions = Suggestions(text := LISTED.format(*numbers))
        listed = [x for x in numbers_in(text) if len(x.text) > 6]
        assert [slip for x in listed for slip in suggestions.slips(x).values()] == slips
        assert [any(one.strong for one in suggestions.look_alikes(x)) for x in listed] == [not slips, not slips, True]


@pytest.mark.parametrize(("last", "slips"), [("0.06", ["2.948e-3"]), ("0.04, to t = 0.4", [])])
def test_the_value_of_another_step_size_than_the_last_is_a_slip_also_where_the_time_is_said_elsewhere(last, slips):
    text = (
        "y' = -40 y, y(0) = 1. We take h = 0.04 until t = 0.4, then h = {}: after 10 steps (t = 0.6) RK4 has 2.090e-06."
    )
    text = text.format(last).replace("(t = 0.6) ", "(t = 0.6) " * bool(slips))
    suggestions, number = Suggestions(text), numbers_in(text)[-1]
    assert [*suggestions.slips(number).values()] == slips
    assert any(one.strong for one in suggestions.look_alikes(number)) is not bool(slips)


@pytest.mark.parametrize(
    ("said", "z"), [("At z = -10 the stability functions are", "-10"), ("At z = -8 the stability functions are", "-8")]
)
def test_the_value_of_a_stability_function_is_no_slip_of_a_run(said, z):
    text = f"y' = -y^3, y(0) = 2 to t = 1. {said} 0.09091 for backward Euler and -0.66667 for the trapezoidal rule."
    claimed, slips = claims_and_slips(text)
    values = (
        ["stability_function backward_euler z=-10", "stability_function trapezoid z=-10"] if z == "-10" else ["", ""]
    )
    assert [claimed["0.09091"], claimed["-0.66667"]] == values
    assert slips == {}


def test_one_letter_is_the_stability_function_where_its_argument_is_given():
    text = "y' = -40 y, y(0) = 1, h = 0.04. Here h*lambda = -1.6.\nRK4  R = 0.2704\ntrapezoidal rule  R = 0.111181\n"
    claimed, slips = claims_and_slips(text)
    assert claimed["0.2704"] == "stability_function rk4 z=-1.6"
    assert slips == {"0.111181": ["0.111111"]}


HALVED = """\
Take y' = 0.8 y (1 - y/10), y(0) = 1. The errors at t = 5 of Euler, Heun and RK4 are:

| h | Euler | Heun | RK4 |
| 0.5 | 0.09909 | 0.055000 | 2.41e-4 |
| 0.25 | 0.04225 | 0.013780 | 1.54e-5 |
| 0.125 | 0.01960 | 0.003462 | 9.72e-7 |

Going from 0.25 to 0.125 divides the error of RK4 by 15.81; the observed orders of all three are 1.108, 1.993 and {}.
"""


@pytest.mark.slow
def test_an_observed_order_is_the_logarithm_of_the_ratio_of_errors_of_the_two_step_sizes():
    claimed, slips = claims_and_slips(HALVED.format("3.983"))
    for spelled, method in (("1.108", "forward_euler"), ("1.993", "heun2"), ("3.983", "rk4")):
        assert claimed[spelled].startswith(f"log2(ratio(run {method} y'=0.8 y*(1 - y/10), y(0)=1, h=0.25, t=5 : error,")
    assert claimed["15.81"].startswith("ratio(run rk4")
    assert slips == {}
    # Euler's ratio, Heun's theoretical order, and the observed order of the step sizes before: no claims.
    for other in ("2.156", "2.00", "3.971"):
        assert claims_and_slips(HALVED.format(other))[0][other] == ""


def test_step_sizes_that_are_not_halved_have_an_observed_order_too():
    text = "y' = -y, y(0) = 1. The errors of Heun at t = 1 are 0.022746 for h = 1/2 and 0.0028604 for h = 1/5, "
    claimed, _ = claims_and_slips(text + "so the observed order is 2.2628.")
    assert claimed["2.2628"] == (
        "ln(ratio(run heun2 y'=-y, y(0)=1, h=0.5, t=1 : error, run heun2 y'=-y, y(0)=1, h=0.2, t=1 : error))/ln(5/2)"
    )


def test_a_factor_is_of_the_errors_that_stand_before_it():
    text = (
        "θ'' = -sin(θ), θ(0) = 1.2, θ'(0) = 0. Velocity Verlet with h = 0.1 has an error of 0.0018566 in θ at t = 5, "
        "and with h = 0.05 an error of 0.00046376 in θ, a factor of 4.0034 less."
    )
    claimed, slips = claims_and_slips(text)
    assert claimed["4.0034"].count(" : error.theta") == 2
    assert slips == {}
    assert "4.0034" in text
    whole = claims_and_slips(
        text.replace("error of 0.0018566 in θ", "error of 0.0020617").replace("0.00046376 in θ", "0.00051486")
    )
    assert whole[0]["4.0034"] == ""


def test_a_bound_on_the_orders_of_several_methods_is_the_order_of_none():
    number = numbers_in(text := "The BDF methods are zero-stable up to order 6. BDF6")[0]
    assert {one.question: one.strong for one in Suggestions(text).look_alikes(number)}["order bdf6"] is False


@pytest.mark.parametrize(("first", "second"), [("at t = 0.1", "at t = 0.2"), ("after one step", "after two")])
def test_a_state_in_brackets_is_at_the_time_behind_it(first, second):
    text = "u' = u*(1.5 - v), v' = v*(u - 2), u(0) = 2, v(0) = 1. The explicit midpoint rule with h = 0.1 has "
    text += f"(u, v) = (2.10250, 1.00500) {first} and (2.20804, 1.02061) {second}."
    claimed, slips = claims_and_slips(text)
    assert claimed["2.20804"].endswith("t=0.2 : u")
    assert slips == {}
    assert claims_and_slips(text.replace("1.02061", "1.02016"))[1] == {"1.02016": ["1.02061"]}


FACTS_SAID = [
    ("* Gauss with two stages: order {}, A-stable.", "4", "3", "order gauss2 is 4"),
    ("RK4, of order {}, is explicit.", "4", "5", "order rk4 is 4"),
    ("* Trapezoidal rule: order 2, R(∞) = {}.", "-1", "0", "limit_at_infinity trapezoid is -1"),
    ("The SSPRK(4,3) method has order {}.", "3", "4", "order ssprk43 is 3"),
]


@pytest.mark.parametrize(("said", "right", "wrong", "slip"), FACTS_SAID)
def test_an_order_or_a_limit_right_behind_the_name_of_its_method_is_that_of_the_method(said, right, wrong, slip):
    for number, slips in ((right, {}), (wrong, dict([slip.split(" is ")]))):
        text = said.format(number)
        at = text.index(number, text.index(" = ") if "∞" in text else text.index("order"))
        found = next(x for x in numbers_in(text) if x.start == at)
        suggestions = Suggestions(text)
        assert suggestions.slips(found) == slips
        assert any(one.strong for one in suggestions.look_alikes(found)) is not bool(slips)


@pytest.mark.parametrize(
    "said",
    [
        "RK4 has order 5 in the local error.",
        "RK4 is of order 5 or so.",
        "RK4 has order 3(2) here.",
        "It is false that RK4 has order 5.",
        "RK4: stage order 1.",
        "RK4: |R(∞)| = 1.",
    ],
)
def test_another_order_than_that_of_the_method_is_no_slip(said):
    suggestions = Suggestions(said)
    found = [x for x in numbers_in(said) if x.label is None]
    assert [suggestions.slips(x) for x in found] == [{}] * len(found)
    assert found[0].text in said
