"""What a number might be is suggested, the best first; an author's questions go before ours."""

import pytest

from driftproof.texts.claims.suggestions import Suggestions
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import numbers_in

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
    four, limits = "The angle of BDF4 is 73.53.", "RK4's real limit is 2.7835 here."
    for text, asked, best in ((four, ["angle {bdf3,bdf4}"], "angle bdf4"), (limits, [], "real_limit rk4")):
        suggestions, (number,) = Suggestions(text, asked), [x for x in numbers_in(text) if "." in x.text]
        assert [*suggestions.slips(number)] == [best], text
    other = "RK4 is stable on the imaginary axis to 2.7835.", "RK4 takes 2.7835.", limits.replace("2.7835", "2.7905")
    three = Suggestions(four.replace("73.53", "74.3"), ["angle {bdf3,bdf4}"])  # 73.4
    assert not three.slips(numbers_in(three.text)[-1])
    assert [*Suggestions(four).slips(numbers_in(four)[-1])] == ["angle bdf4"]
    for text in (four.replace("angle of ", ""), limits.replace("RK4", "Heun"), *other):
        assert not Suggestions(text).slips(next(x for x in numbers_in(text) if "." in x.text)), text
    row = Suggestions("| 0.6 | 0.182 |", ASKED)
    assert [*row.slips(numbers_in(row.text)[1])] == ["run forward_euler rates=(t+y0) from 0 h=0.2 t=0.6 : y0"]


@pytest.mark.parametrize(
    ("said", "value"),
    [
        ("Euler, h = 0.1: 0.108", "0.107"),  # or 0.0280 or 0.135, for which it is no slip
        ("RK4, h = 0.1: 0.17", None),  # 0.14, or 0.00
        ("Euler, h = 0.1: the error 0.038", "0.028"),
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


def test_a_limit_with_a_minus_has_slips_too():
    for text, right in (
        ("RK4's real stability interval ends at -2.7583.", "-2.7853"),
        ("RK4's real limit is 2.7583.", "2.7853"),
    ):
        assert [*Suggestions(text).slips(numbers_in(text)[-1]).values()] == [right]


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


@pytest.mark.parametrize(("of", "slips"), [("0.75", ["0.6328"]), ("2", [])])
def test_what_a_run_has_a_step_before_or_after_the_time_of_the_place_is_a_slip(of, slips):
    text = f"y' = -y, y(0) = 2. With h = 0.25, Euler has y = {_decay(of, 'y')} at t = 1."
    found = Suggestions(text).slips(next(x for x in numbers_in(text) if len(x.text) > 5))
    assert [*found.values()] == slips


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


def claims_and_slips(text):
    """What each number of a text with a point in it is claimed to be, "" for nothing, and the slips."""
    suggestions, numbers = Suggestions(text), [x for x in numbers_in(text) if "." in x.text]
    best = {x.text: ones[0] if (ones := suggestions.look_alikes(x)) else None for x in numbers}
    claimed = {text: one.question if one and one.strong else "" for text, one in best.items()}
    return claimed, {x.text: [*suggestions.slips(x).values()] for x in numbers if suggestions.slips(x)}


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


def test_a_state_in_brackets_is_at_the_time_behind_it():
    text = "u' = u*(1.5 - v), v' = v*(u - 2), u(0) = 2, v(0) = 1. The explicit midpoint rule with h = 0.1 has "
    claimed, slips = claims_and_slips(
        text + "(u, v) = (2.10250, 1.00500) at t = 0.1 and (2.20804, 1.02061) at t = 0.2."
    )
    assert claimed["2.20804"].endswith("t=0.2 : u")
    assert slips == {}


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


PRINTED = """\
x'' = -sin(x), x(0) = 1.2, x'(0) = 0, with velocity Verlet:

|  t  | x | v |
| 1.0 | 0.750793 | -0.858106 |
| 2.0 | -0.307404 | -1.085820 |
| 3.0 | {} | -0.412849 |
| 4.0 | -1.059828 | 0.503024 |

With h = 0.1 it has -0.194978 at t = 5, with h = 0.05 it has -0.196370.
"""


def test_a_table_of_one_run_has_one_step_size_and_a_value_of_another_one_is_a_slip():
    claimed, slips = claims_and_slips(PRINTED.format("-1.106636"))
    assert slips == {}
    assert claimed["-1.106636"].endswith("h=0.1, t=3 : x")
    claimed, slips = claims_and_slips(PRINTED.format("-1.106295"))
    assert slips == {"-1.106295": ["-1.106636"]}
    assert claimed["-1.106295"] == ""


def _found(text):
    """What each number of two digits or more, or of an order, is strongly like, and is a slip for."""
    suggestions, found = Suggestions(text), list[tuple[str, bool, list[str]]]()
    for number in numbers_in(text):
        alike = suggestions.look_alikes(number)[:1]
        found.append((number.text, any(one.strong for one in alike), [*suggestions.slips(number).values()]))
    return found


BEAD = "A bead has x'' = x - x^3, x(0) = 0.5, x'(0) = 0. Errors of the state at t = 4, with h = 0.1:\n\n"


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize(
    "said",
    [
        "* {} for velocity Verlet, {} for symplectic Euler.",
        "* {} (velocity Verlet) and {} (symplectic Euler).",
        "* {} [velocity Verlet] and {} [symplectic Euler].",
        "* Velocity Verlet / symplectic Euler: {} / {}",
        "* The errors of velocity Verlet and symplectic Euler are {} and {}.",
        "* Velocity Verlet is off by {}, symplectic Euler by {}.",
    ],
)
def test_a_number_whose_method_is_named_is_of_no_other_and_an_exchanged_pair_is_named(said):
    right, wrong = ("2.115e-03", "2.265e-02"), ("2.265e-02", "2.115e-03")
    assert _found(BEAD + said.format(*right))[-2:] == [(x, True, []) for x in right]
    assert _found(BEAD + said.format(*wrong))[-2:] == [
        ("2.265e-02", False, ["2.115e-3"]),
        ("2.115e-03", False, ["2.265e-2"]),
    ]


@pytest.mark.parametrize(
    "said",
    [
        "Implicit Euler and trapezoidal rule have orders {} and {}.",
        "Implicit Euler divides the error by two, the trapezoidal rule by four; the methods have orders {} and {}.",
    ],
)
def test_orders_of_a_list_are_those_of_its_methods(said):
    assert _found(said.format(1, 2)) == [("1", True, []), ("2", True, [])]
    assert _found(said.format(2, 1)) == [("2", False, ["1"]), ("1", False, ["2"])]


COLUMNS = """For y' = -y, y(0) = 1 and h = 0.1, the 3/8 rule and Heun's third-order method give

| t | y (3/8) | y (HEAD) |
|---|---|---|
| 0.5 | 0.6065309 | 0.6065170 |
| 1 | 0.3678798 | 0.3678628 |
| 2 | 0.1353355 | LAST |
"""


@pytest.mark.parametrize(
    ("head", "last", "slips"),
    [
        ("own", "0.1353231", {}),
        ("own", "0.1353232", {"0.6065170": ["0.6065309"], "0.3678628": ["0.3678798"], "0.1353232": ["0.1353231"]}),
        ("RK4", "0.1353231", {"0.6065170": ["0.6065309"], "0.3678628": ["0.3678798"], "0.1353231": ["0.1353355"]}),
        ("Heun 3", "0.1353232", {"0.1353232": ["0.1353231"]}),
    ],
)
def test_a_column_that_no_method_heads_is_the_one_value_that_all_its_numbers_fit(head, last, slips):
    assert claims_and_slips(COLUMNS.replace("HEAD", head).replace("LAST", last))[1] == slips


@pytest.mark.parametrize(("column", "solution"), [("| 3/8 rule ", True), ("", False)])
def test_the_unknown_as_a_function_of_time_is_the_solution_beside_columns_of_methods(column, solution):
    text = f"For y' = -y, y(0) = 1 and h = 0.5, Heun:\n\n| t {column}| y(t) |\n|---|---|\n"
    rows = [f"| 1 | {'0.3680556 | ' * bool(column)}0.3678794 |", f"| 2 | {'0.1354649 | ' * bool(column)}0.1353353 |"]
    claimed = claims_and_slips(text + "\n".join(rows))[0]
    assert claimed["0.1353353"].startswith("exact") is solution


ORDERS = """For u' = -2u + sin(t), u(0) = 1, with starting values by RK4, errors at t = 2:

| h | AB2 | order | AB3 | order |
|---|---|---|---|---|
| 0.2 | 8.566e-03 | {} | 2.946e-03 | {} |
| 0.1 | 2.002e-03 | {} | 3.585e-04 | {} |
| 0.05 | 4.819e-04 | {} | 4.303e-05 | {} |
"""


@pytest.mark.parametrize(
    ("orders", "slips"),
    [
        (("--", "--", "2.097", "3.039", "2.055", "3.058"), {}),
        (("2.097", "3.039", "2.055", "3.058", "--", "--"), {}),
        (("--", "--", "2.098", "3.039", "2.055", "3.085"), {"3.085": ["3.058"]}),
        (("--", "--", "2.097", "3.058", "2.055", "3.039"), {"3.058": ["3.039"], "3.039": ["3.058"]}),
    ],
)
def test_a_column_order_beside_step_sizes_has_observed_orders_of_two_rows_each(orders, slips):
    """A last digit that rounded errors may give is no slip."""
    claimed, found = claims_and_slips(ORDERS.format(*orders))
    assert found == slips
    assert all(claimed[x].startswith("log2(") for x in orders if x not in {"--", "2.098", *slips})


def test_observed_orders_in_rows_of_methods_are_of_the_step_sizes_that_the_text_may_mean():
    rows = "| method | h = 0.1 | h = 0.05 | observed order |\n|---|---|---|---|\n"
    rows += "| trapezoidal rule | 7.01e-03 | 1.67e-03 | 2.02 |\n| implicit midpoint | 2.68e-03 | 6.61e-04 | 2.00 |\n"
    text = f"For y' = -y^3, y(0) = 2, errors at t = 1:\n\n{rows}\nThe order compares h = 0.05 with h = 0.025."
    claimed, slips = claims_and_slips(text)
    assert claimed["2.02"].startswith("log2(ratio(run trapezoid")
    assert slips == {}


def test_a_column_of_energy_changes_is_read_by_its_sign_for_them():
    text = "A bead has x'' = x - x^3, x(0) = 0.5, x'(0) = 0, energy E = v^2/2 - x^2/2 + x^4/4, v = x'. With h = 0.2:"
    text += "\n\n| method | t | E | ΔE |\n|---|---|---|---|\n| explicit Euler | 4 | 0.41007 | {} |"
    assert claims_and_slips(text.format("0.51945"))[0]["0.51945"].endswith(" : energy_change")
    assert {*claims_and_slips(text.format("0.51954"))[1]["0.51954"]} == {"0.51945"}


def test_slopes_in_a_list_are_k1_k2_and_so_on_of_the_step():
    text = "For dP/dt = 0.8 P (1 - P/5) - 0.3, P(0) = 1 and h = 0.5, the slopes of the first step of RK4 are "
    claimed, slips = claims_and_slips(text + "0.3400, 0.3796, 0.3841 and 0.4236.")
    assert [claimed[x][-4:] for x in ("0.3400", "0.3796", "0.3841")] == ["k1.P", "k2.P", "k3.P"]
    assert slips == {"0.4236": ["0.4263"]}
    assert claims_and_slips(text + "0.3400, 0.3841, 0.3796 and 0.4263.")[1].keys() == {"0.3841", "0.3796"}


@pytest.mark.parametrize(("named", "claimed"), [("Kutta's third-order method", True), ("Heun's method", False)])
def test_kutta_in_a_row_is_the_third_order_method_where_the_text_names_it(named, claimed):
    rows = "| method | h = 0.1 |\n|---|---|\n| Kutta | 1.661e-05 |"
    text = f"For y' = -y, y(0) = 1, {named} and RK4 have errors at t = 1:\n\n{rows}"
    assert bool(claims_and_slips(text)[0]["1.661e-05"]) is claimed


@pytest.mark.parametrize(
    ("ab2", "ab3", "slips"), [("5/12", "3/8", []), ("3/8", "5/12", [["5/12"], ["3/8"]]), ("-5/12", "-3/8", [])]
)
def test_facts_exchanged_between_two_rows_are_slips_and_another_sign_is_a_convention(ab2, ab3, slips):
    text = f"| method | error constant |\n|---|---|\n| AB2 | {ab2} |\n| AB3 | {ab3} |\n| AB4 | 251/720 |"
    assert [found for _, _, found in _found(text) if found] == slips


def test_a_head_with_3_8_in_brackets_names_that_method():
    text = "For y' = -y, y(0) = 1 and h = 0.1, the 3/8 rule gives\n\n"
    text += "| t | y (Heun 3) | y (3/8) |\n|---|---|---|\n| 1 | 0.3678628 | {} |"
    assert _found(text.format("0.3678798"))[-1] == ("0.3678798", True, [])
    assert _found(text.format("0.3678789"))[-1] == ("0.3678789", False, ["0.3678798"])


SATURATES = "P' = 0.8 P (1 - P/12), P(0) = 1.5, with RK4 and h = 0.5.\n\n"
OF_RK4, OF_SOLUTION = "10.636069", "10.636323"


@pytest.mark.parametrize(
    ("said", "right"),
    [
        ("The solution is P(t) = 12/(1 + 7 exp(-0.8t)). At t = 5 it is {}.", OF_SOLUTION),
        ("At t = 5 the exact value is {}.", OF_SOLUTION),
        ("RK4 is off at t = 5, for the truth is {}.", OF_SOLUTION),
        ("At t = 5, RK4 gives {}.", OF_RK4),
        ("The solution grows. At t = 5, RK4 is at {}.", OF_RK4),
        ("RK4 is of order 4. At t = 5 it is at {}.", OF_RK4),
    ],
)
def test_what_is_said_of_the_solution_is_no_value_of_a_method_nor_the_other_way_round(said, right):
    for number in (OF_RK4, OF_SOLUTION):
        text = SATURATES + said.format(number)
        suggestions, numbers = Suggestions(text), [x for x in numbers_in(text) if x.text == number]
        alike = suggestions.look_alikes(numbers[0])
        assert bool(alike and alike[0].strong) == (number == right), number


TWO_VALUES = "y' = -2ty, y(0) = 1, RK4, h = 0.1. The solution has {} and y(1) = 0.367879."
RATIOS = SATURATES + "At t = 5 RK4 has 10.636069. The last ratios of the errors are 1.91, 4.01 and 16.04."


@pytest.mark.parametrize(("said", "value"), [("y(2) = 0.01831564", None), ("y(2) = 0.01835164", "t=2 : y")])
def test_the_time_of_the_next_value_is_not_that_of_this_one(said, value):
    suggestions = Suggestions(text := TWO_VALUES.format(said))
    slips = [suggestions.slips(x) for x in numbers_in(text) if x.text.startswith("0.0183")]
    assert [question[-7:] for one in slips for question in one] == [value] * bool(value)


def test_ratios_of_errors_are_no_slips_of_a_state():
    suggestions, numbers = Suggestions(RATIOS), numbers_in(RATIOS)
    assert [x.text for x in numbers if suggestions.slips(x)] == []
    assert [x.text for x in numbers if suggestions.look_alikes(x)[:1] and suggestions.look_alikes(x)[0].strong] == [
        OF_RK4
    ]


MULTIPLIERS = """| {z} | {a} | {b} |
|---|---|---|
| -2.5 | -1.5 | {} |
| -3 | -2 | 2.5 |"""


@pytest.mark.parametrize(
    ("above", "heads"),
    [
        ("Multipliers:", ("z", "R(z) forward Euler", "R(z) Heun")),
        ("The stability functions:", ("hλ", "forward Euler", "Heun")),
    ],
)
def test_in_rows_of_arguments_a_column_of_a_method_has_its_stability_function(above, heads):
    for number, strong in (("1.625", True), ("1.652", False)):
        text = f"{above}\n\n" + MULTIPLIERS.format(number, **dict(zip("zab", heads, strict=True)))
        suggestions, of = Suggestions(text), {x.text: x for x in numbers_in(text) if x.label is None}
        alike = {x: suggestions.look_alikes(of[x])[:1] for x in ("-1.5", "-2", "2.5", number)}
        live = [one.question for found in alike.values() for one in found if one.strong]
        assert live == [
            "stability_function forward_euler z=-2.5",
            "stability_function forward_euler z=-3",
            "stability_function heun2 z=-3",
            *["stability_function heun2 z=-2.5"] * strong,
        ]
        assert suggestions.slips(of[number]) == ({} if strong else {"stability_function heun2 z=-2.5": "1.625"})


SPRING = "x' = v, v' = -4x, x(0) = 1, v(0) = 0, E = v^2/2 + 2x^2. Throughout, h = 0.1 and energy counts.\n\n"


@pytest.mark.parametrize(
    "said",
    [
        "Show that the determinant of the step of symplectic Euler is 1.",
        "The first step leads forward Euler to x_1 = 1",
    ],
)
def test_a_single_digit_is_no_value_whose_names_stand_in_another_sentence(said):
    suggestions = Suggestions(text := SPRING + said)
    alike = suggestions.look_alikes(numbers_in(text)[-1])
    assert not [one.question for one in alike if one.strong and "y'=" not in one.question and "v'=" not in one.question]


@pytest.mark.parametrize(("said", "slips"), [("off by 0.0179 %", 1), ("loses 0.0179 % of the energy", 0)])
def test_a_part_of_the_energy_is_no_relative_error(said, slips):
    text = (
        SPRING.replace("energy counts", "RK4 to t = 10")
        + f"At t = 10 RK4 with h = 0.1 is {said}, and 0.0197 % relative."
    )
    suggestions = Suggestions(text)
    found = [suggestions.slips(x) for x in numbers_in(text) if x.text == "0.0179"]
    assert [len(one) for one in found] == [slips]


COOLING = "u'=-3u + t, u(0)=2"
STALE = """\
Exercise A
Solve u' = -3u + t, u(0) = 2 with h = {} by Euler's method and Heun's method.
| t | Euler | Heun |
| 0.25 | {} | {} |
| 0.5 | {} | {} |
| 1.0 | {} | {} |
Exercise B
Repeat. The errors at t = 1:
| method | h = 0.125 | h = 0.0625 |
| Euler | {} | {} |
| Heun | {} | {} |
"""


@pytest.mark.parametrize(("said", "claimed"), [("0.125", 6), ("0.25", 0)])
def test_a_table_is_of_the_step_size_of_its_own_section(said, claimed):
    runs = [
        f"run {by} {COOLING}, h=0.125, t={t} : u" for t in ("0.25", "0.5", "1") for by in ("forward_euler", "heun2")
    ]
    errors = [
        f"run {by} {COOLING}, h={h}, t=1 : error" for by in ("forward_euler", "heun2") for h in ("0.125", "0.0625")
    ]
    printed = [value(one).places(5) for one in (*runs, *errors)]
    found, slips = claims_and_slips(STALE.format(said, *printed))
    assert [found[x] for x in printed[:6]] == (runs if claimed else [""] * 6)
    assert len(slips) == 6 - claimed
    assert [found[x] for x in printed[6:]] == errors


SWING = "Velocity Verlet and RK4 swing. Here is x'' = -2sin(x), x(0) = 0.9, x'(0) = 0, and E = 1/2 x'^2 - 2cos(x)."


@pytest.mark.parametrize(
    ("said", "slips"),
    [
        (
            "In def verlet(x, v, h) a step of h = 0.2 follows.\n| method | energy |\n| RK4 | -1.242607 |",
            [],
        ),  # -1.242602
        ("RK4 has E = -1.243223 at t = 0.2, h = 0.2. At the start it is E = -2cos 0.9 = -1.243220.", ["-1.243224"]),
    ],
)
def test_what_is_said_of_the_start_or_by_no_method_of_the_text_is_no_slip_of_a_run(said, slips):
    assert [*claims_and_slips(f"{SWING}\n{said}")[1].values()] == [slips][: len(slips)]


def test_a_factor_beside_one_is_no_slip_of_a_change_of_few_digits():
    for number, slips in (("1.04", {}), ("0.0451", {"10*0.00431": "0.0431"})):
        text = f"Up to t = 10 it grows by 1 + h^2 = {number}, says Euler."
        assert Suggestions(text, ["{10}*0.00431"]).slips(numbers_in(text)[-1]) == slips


@pytest.mark.parametrize(
    ("said", "question"),
    [
        ("t = 6, 30 steps of h = 0.2. With h = 0.4 RK4 makes {120}", ""),
        ("t = 6, 30 steps of h = 0.2. With h = 0.2 RK4 makes {120}", "run rk4 h=1/5 t=6 : evaluations"),
        ("t = 6 and h = 0.2: RK4 is best, but makes {30}", ""),
        ("t = 6 and h = 0.2: beside Euler's 30, RK4 makes {120}", "run rk4 h=1/5 t=6 : evaluations"),
    ],
)
def test_a_count_of_evaluations_is_of_the_method_and_the_steps_of_its_own_step_size(said, question):
    text = f"RK4 is run up to {said.replace('{', '').replace('}', '')} evaluations of f, against 30 for Euler."
    number = next(x for x in numbers_in(text) if x.text == said[said.index("{") + 1 : -1] and x.start > 60)
    assert [one.question for one in Suggestions(text).look_alikes(number)[:1] if one.strong] == [question][
        : len(question)
    ]


@pytest.mark.parametrize(
    ("said", "claimed"),
    [
        ("For small q, q'' = -q. RK4 is then stable up to {}", "imaginary_limit rk4"),
        ("For large s, s' = -3s. RK4 is then stable up to {}", "real_limit rk4"),
        ("For small q, q'' = -q. On the real axis RK4 is stable up to {}", "real_limit rk4"),
        ("RK4 is stable up to 2√2 = {}", "imaginary_limit rk4"),
    ],
)
def test_a_limit_is_of_the_axis_of_the_equation_before_it_and_what_a_calculation_gives(said, claimed):
    for limit, number in (("real_limit rk4", "2.785"), ("imaginary_limit rk4", "2.828")):
        assert claims_and_slips(said.format(number))[0][number] == (claimed if limit == claimed else "")


ROWS = """For s' = -2s + 1, s(0) = 0 and t = 1:
| method | h = 0.2 | h = 0.1 | ratio |
| Euler error | 2.879e-02 | 1.398e-02 | 2.06 |
| Heun error | 5.029e-03 | 1.056e-03 | 4.76 |
| RK4 error | 4.037e-05 | 2.133e-06 | 18.93 |
"""
ROWS_OF_ORDERS = (
    ROWS.replace("ratio", "observed order").replace("2.06", "1.04").replace("4.76", "2.25").replace("18.93", "4.24")
)
COLUMNS_OF_RUNS = """For s' = -2s + 1, s(0) = 0, here are the errors at t = 1:
| h | Euler s | Euler error | Heun error | RK4 error |
| 0.2 | 0.461120 | 0.0288 | 0.00503 | 4.04e-05 |
| 0.1 | 0.446313 | 0.0140 | 0.00106 | 2.13e-06 |
"""


@pytest.mark.parametrize(
    ("text", "changed"),
    [
        (ROWS, {}),
        (ROWS, {"5.029e-03": "4.037e-05", "4.037e-05": "5.029e-03"}),  # exchanged
        (ROWS, {"2.06": "3.06"}),
        (ROWS, {"4.76": "4.77"}),  # of rounded errors
        (COLUMNS_OF_RUNS, {}),
        (COLUMNS_OF_RUNS, {"0.461120": "0.435200"}),  # a step too early
        (COLUMNS_OF_RUNS, {"0.00106": "0.00137"}),
        (COLUMNS_OF_RUNS, {"0.0140": "0.0288"}),  # three digits with the last zero
        (ROWS_OF_ORDERS, {"1.04": "1.36"}),
    ],
)
def test_where_row_and_head_tell_all_another_number_is_a_slip(text, changed):
    written = text
    for right, wrong in changed.items():
        written = written.replace(f"| {right} |", f"| <{wrong}> |")
    claimed, slips = claims_and_slips(written.replace("<", "").replace(">", ""))
    known = {} if changed == {"4.76": "4.77"} else changed
    assert {x: float(y[0]) for x, y in slips.items()} == {wrong: float(right) for right, wrong in known.items()}
    assert not any(claimed[wrong] for wrong in changed.values())


FALLS = """\
For s' = -2s + 1, s(0) = 0 and t = 1 we take h = 0.2, h = 0.1 and h = 0.05. With each halving, the error of Euler's
method falls by a factor of {} and then {}; that of Heun's method by {} and {}.
These ratios are observed orders of {} and {}. It is {} times as dear.
"""
RIGHT = ("2.059", "2.032", "4.761", "4.337", "1.042", "2.251", "2.06")


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"2.059": "2.032", "2.032": "2.059"},  # exchanged
        {"4.761": "2.032"},  # Euler's
        {"1.042": "2.251", "2.251": "1.042"},
    ],
)
def test_ratios_in_prose_are_of_the_only_two_runs_that_have_them_and_go_on_from_large_steps_to_small_ones(changed):
    suggestions = Suggestions(FALLS.format(*(changed.get(x, x) for x in RIGHT)))
    numbers = [x for x in numbers_in(suggestions.text) if "." in x.text][-7:]
    claimed = [any(one.strong for one in suggestions.look_alikes(x)[:1]) for x in numbers]
    assert claimed == [*(x not in changed for x in RIGHT[:-1]), False]
    assert not any(suggestions.slips(x) for x in numbers if x.text in RIGHT and x.text not in changed.values())
