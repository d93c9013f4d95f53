"""What a number might be is suggested, the best first; an author's questions go before ours."""

from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.texts.claims.known_values import KnownValue
from driftproof.texts.claims.suggestions import Suggestions
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import numbers_in
from tests.looping import exactly


def suggested(text):
    suggestions = Suggestions(text)
    return [suggestions.look_alikes(number) for number in numbers_in(text) if number.label is None]


@pytest.mark.parametrize(
    ("text", "best"),
    [
        ("one step of RK4 leads to the position 337/384", "rk4.first_step.q"),
        ("one step of RK4 leads to 0.877604", "rk4.first_step.q"),
        ("forward Euler, h = 1/4, t = 10: state error 2.390297", "forward_euler.default.state_error"),  # published
        ("forward Euler's state error is 2.390 at the end", "forward_euler.default.state_error"),
        ("with RK4, h = 1/8 and t = 2: energy change -1.26e-7", None),
        ("RK4, h = 1/5, t = 2: the state error is 2.7e-5", "run rk4 h=1/5 t=2 : state_error"),
        ("RK4 is stable up to 2.828", "imaginary_limit rk4"),
        ("Crank-Nicolson method, h = 1/5, t = 2: the state error is 6.63e-3", "run trapezoid h=1/5 t=2 : state_error"),
        ("forward Euler, h = 1/4: each step multiplies the energy by 1.0625", "energy_multiplier forward_euler h=1/4"),
        ("forward Euler's energy, N = 16, h = 1/4: 1.3190", "run forward_euler h=1/4 N=16 : energy"),
        ("after 16 time steps of h = 1/4 forward Euler's energy is 1.3190", "run forward_euler h=1/4 N=16 : energy"),
        ("16 of those of h = 1/4: forward Euler's energy is 1.3190", None),
        ("nothing like it: 0.123456", None),
        ("not a number 1/0", None),
    ],
)
def test_best_suggestion_is_the_value_whose_names_are_near(text, best):
    *_, last = suggested(text)
    assert (last[0].question if last else None) == best


def test_suggestion_is_strong_only_where_the_digits_or_the_names_say_so():
    for text, strong in (("RK4 with h = 1/2: 0.877604", [True, True]), ("about 0.877604", [False, False])):
        assert [candidate.strong for candidate in suggested(text)[-1]] == strong, "of which method?"
    for text, strong in (("0.5", False), ("2.4", False), ("2.39", False), ("0.090", False)):
        assert {candidate.strong for candidate in suggested(f"about {text}")[0]} == {strong}, text
    assert suggested("forward Euler's state error is 2.390 at the end")[-1][0].strong
    of_roots = [suggested(f"t = 2: the {name}q is -0.41614684")[-1][0].strong for name in ("", "exact ")]
    assert of_roots == [False, True], "a letter is no name"
    assert Suggestions("about 0.5", ["1/2"]).look_alikes(numbers_in("about 0.5")[0])[0].question == "1/2"
    exact = [value(candidate.question).exact == Q(1, 2) for candidate in suggested("about 0.5")[0]]
    assert exact == sorted(exact, reverse=True), "what is equal stands before what is rounded"
    assert {*exact} == {True, False}
    (candidates,) = suggested("the exact energy is 0.5")
    assert (candidates[0].question, candidates[0].strong) == ("exact.energy", True)


def test_names_of_a_value_are_near_within_a_line_of_the_number():
    for spaces, near in ((91, True), (92, False)):  # the number, and 100 characters before it
        alike = suggested(f"order rk4{' ' * spaces}4")[-1]
        assert [one.strong for one in alike if one.question == "order rk4"] == [near]


def test_so_many_methods_steps_and_times_are_asked_of_and_no_more():
    given = ["h = 1/123456789012345678", "h = 1/12345678901234567"]  # of 20 characters, and of 19
    given += [f"{letter} = {'1/' * (letter == 'h')}{n}" for letter in "htN" for n in range(2, 9)]
    text = " ".join([*METHODS, *given])
    asked = [question.split() for question in Suggestions(text)._questions()]
    assert [len({words[1] for words in asked if words[0] == kind}) for kind in ("order", "run")] == [20, 6]
    assert {words[2] for words in asked if words[0] == "step"} == {"h=1/12345678901234567", "h=1/2", "h=1/3", "h=1/4"}
    assert {words[3] for words in asked if words[0] == "run"} == {"t=2", "t=3", "N=2", "N=3"}
    after_n, at_t = ({words[-1] for words in asked if given in words} for given in ("N=2", "t=2"))
    assert after_n == at_t - {"steps"}
    asked = [question.split() for question in Suggestions("h = 1/2000, h = 3/10, N = 10001")._questions()]
    runs = {words[2] for words in asked if words[0] == "run"}
    assert runs == {"h=1/4", "h=1/2"}, "neither long ones, nor those that end beside t"


def test_suggested_value_is_spelled_as_the_number_is():
    text = "RK4 and forward Euler: 2.390, 3.3e-4, 337/384, 160, 0.8776"
    numbers = [n for n in numbers_in(text) if n.label is None]
    for number, candidates in exactly(5, zip(numbers, suggested(text), strict=True)):
        assert candidates
        assert all(number.text in candidate.form.spellings(value(candidate.question)) for candidate in candidates)


def test_round_numbers_say_no_more_than_their_digits_before_the_zeros():
    assert not any(one.strong for text in ("1.000000", "4.0000000", "40.00") for one in suggested(f"| {text} |")[0])
    assert suggested("RK4: the order is 4")[-1][0].strong
    assert not suggested("the first step: y + 0.5 k")[0][0].strong, "a step size of ours, which is no value"


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


def test_a_percentage_is_a_hundred_times_the_value_and_a_solution_is_exact():
    found = best_of(NOTE, "20.7")
    assert found == "percent(run Euler y'=-2y, y(0)=1, h=0.1, t=1 : relative_error, 1)"
    assert best_of(NOTE.replace("20.7%", "20.7"), "20.7") != found
    assert best_of(NOTE.replace("0.02796", "0.02796%"), "0.02796") is None
    assert best_of(NOTE, "0.135335").endswith("exact.y")
    assert not best_of(NOTE.replace("solution there is", "error with h = 0.5 is"), "0.135335").endswith("exact.y")


def test_one_digit_that_agrees_does_not_hide_a_wrong_number():
    nowhere = {question for question, *_ in Suggestions(NOTE, [OF_NOTE]).nowhere()}
    assert "run Heun y'=-2y, y(0)=1, h=0.1, t=1 : y" in nowhere  # 0.13745 is printed as 0.13748; 0.1 is a start
    right = {question for question, *_ in Suggestions(NOTE.replace("0.13748", "0.13745"), [OF_NOTE]).nowhere()}
    assert nowhere - right == {"run Heun y'=-2y, y(0)=1, h=0.1, t=1 : y"}


# Of 90 numbers of two digits one in 20 is asked for, or of 9000 of four digits one in 100 is usual, or one more.
@pytest.mark.parametrize(("x", "chosen", "most"), [("0.34", (), 4), ("0.337", (), 45), ("0.3371", None, 90)])
def test_so_many_values_leave_a_number_of_few_digits_strong_and_one_more_does_not(x, chosen, most):
    suggestions, (number,) = Suggestions(f"about {x}", ["0.3371"] if chosen == () else []), numbers_in(x)
    for count, strong in ((most, True), (most + 1, False)):
        questions = ["0.3371", *(f"{n}.5" for n in range(1, count))]
        suggestions.__dict__["_known"] = [KnownValue(question, value(question), chosen) for question in questions]
        suggestions._spelled.clear()
        suggestions._alike.clear()
        assert [alike.strong for alike in suggestions.look_alikes(number)] == [strong]


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


def test_the_head_of_a_column_says_which_fact_a_digit_is_and_an_interval_may_be_negative():
    text = "| Method | stages | order |\n| RK4 | 4 | 4 |\nThe stability interval of RK4 is (-2.785, 0)."
    suggestions = Suggestions(text)
    numbers = [x for x in numbers_in(text) if x.label is None and x.text in ("4", "-2.785")]
    found = [suggestions.look_alikes(x)[0] for x in numbers]
    assert [one.question for one in found] == ["stages rk4", "order rk4", "-real_limit rk4"]
    assert all(one.strong for one in found)
    assert not Suggestions(text.replace("interval", "limit")).look_alikes(numbers[-1])


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


def test_zeros_at_the_end_of_the_value_that_the_place_names_are_digits():
    """With h = 1/2, forward Euler has 0.25."""
    for h, strong in (("0.5", True), ("0.25", False)):
        text = f"y' = -y, y(0) = 1. Euler at t = 1:\n| h | y |\n| {h} | 0.2500 |\n| 0.5 | 0.1 |"
        number = next(x for x in numbers_in(text) if x.text == "0.2500")
        assert any(one.strong for one in Suggestions(text).look_alikes(number)) is strong


def test_a_row_at_time_t_is_of_the_run_of_as_many_steps_and_its_column_has_a_name():
    table = "| t | Euler | RK4 |\n| 0.2 | 0.8 | 0.829293 |\n| 0.4 | 1.152 | 1.214 |"
    suggestions = Suggestions(table, ["run {Euler,RK4} y'=y-t^2+1, y(0)=0.5, h=0.2, N={1,2} : y"])
    _, *values = [number for number in numbers_in(table) if number.label is None]
    found = {number.text: suggestions.look_alikes(number)[:1] for number in values}
    assert {text for text, alike in found.items() if alike and alike[0].strong} == {"0.8", "0.829293", "1.152", "1.214"}


def test_the_last_step_size_given_before_a_number_decides_between_equal_values():
    text = "RK4 with h = 0.2 to t = 2, and then RK4.\nNow h = 0.1, t = 1:\nRK4 needs 40 evaluations."
    assert suggested(text)[-1][0].question == "run rk4 h=1/10 t=1 : evaluations"


def best_of(text, spelled):
    (number,) = [each for each in numbers_in(text) if each.text == spelled]
    return next((alike.question for alike in Suggestions(text, [OF_NOTE]).look_alikes(number)), None)


def test_an_asked_question_without_an_answer_is_refused():
    with pytest.raises(QuestionError, match="unknown method"):
        Suggestions("1.5", ["step {nope} h=1 : q"]).look_alikes(numbers_in("1.5")[0])
    with pytest.raises(QuestionError, match="does not divide"):
        Suggestions("1.5", ["run rk4 h={3,4} t=1 : q"]).look_alikes(numbers_in("1.5")[0])


def test_tie_of_a_solution_is_no_suggestion_and_takes_no_time():
    """y' = t sqrt(y), y(0) = 1 is 25/16 at t = 1, which balls do not tell from 1.562 or 1.563."""
    suggestions = Suggestions("1.563 or 1.5625", ["exact rates=(t*sqrt(y0)) from 1 t=1 : y0"])
    assert [len(suggestions.look_alikes(n)) for n in numbers_in(suggestions.text)] == [0, 1]


def test_a_draft_encloses_a_stated_solution_in_few_steps_and_says_which_it_did_not():
    lorenz = "x' = 10(y - x), y' = x(28 - z) - y, z' = xy - 8/3 z, x(0) = 1, y(0) = 1, z(0) = 1"
    suggestions = Suggestions(f"{lorenz}. At t = 1/4, x is 11.04284. At t = 200, x is 1.2345.")
    asked = [x for x in numbers_in(suggestions.text) if "." in x.text]
    assert [len(suggestions.look_alikes(x)) for x in exactly(2, asked)] == [1, 0]
    *_, (why, refused) = suggestions.not_asked.items()
    assert "few steps" in why
    assert [one[-9:] for one in exactly(3, refused)] == ["t=200 : x", "t=200 : y", "t=200 : z"]


def test_number_of_seventy_places_is_suggested_and_one_of_eighty_takes_too_many_bits():
    for places, count in ((70, 1), (80, 0)):
        text = value("exp(1)").places(places)
        assert len(Suggestions(text, ["exp(1)"]).look_alikes(numbers_in(text)[0])) == count


@pytest.mark.parametrize("spelled", ["1.45722e-07", "1.45722E-7", "1.45722e-007", "1.45722×10^{-7}"])
def test_exponents_of_any_program_are_read(spelled):
    suggestions = Suggestions(spelled, ["run rk4 rates=(t*sqrt(y0)) from 1 h=1/10 t=1 : state_error"])
    assert suggestions.look_alikes(numbers_in(spelled)[0])[0].strong


def test_questions_are_asked_of_a_draft_only(refusal):
    assert "--ask needs --init" in refusal("check", "a.md", "--claims", "c.toml", "--ask", "pi")


NO_METHODS = """The tower is 2.828 m high and 1.414 m wide, a cup holds 1.0625 litres, the error rate was 2.390297
and the limit is 2.828. 337/384 of all guests came back, the state has 0.877604 of them. At t = 10 the energy is
0.499933."""


def test_a_text_without_methods_has_no_value_of_one_by_chance():
    suggestions, numbers = Suggestions(NO_METHODS), [x for x in numbers_in(NO_METHODS) if x.text != "10"]
    alike = {x.text: suggestions.look_alikes(x) for x in numbers}
    assert len(alike) == 7
    assert all(alike.values()), "each is a value of the lesson"
    assert not [one for some in alike.values() for one in some if one.strong]


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


def test_columns_for_numbers_of_steps_give_their_step_sizes_beside_one_in_the_text():
    text = "P' = 0.6 P (1 - P/100), P(0) = 10 with h = 0.5. Errors at t = 5:\n\n"
    text += "| method | N = 10 | N = 40 |\n| RK4 | {} | {} |"
    run = "run rk4 P'=0.6*P*(1-P/100), P(0)=10, t=5, N={} : error"
    text = text.format(*(value(run.format(n)).digits(4) for n in (10, 40)))
    suggestions, numbers = Suggestions(text), numbers_in(text)[-2:]
    assert [suggestions.look_alikes(x)[0].strong for x in numbers] == [True, True]
    assert ["h=0.5," in suggestions.look_alikes(x)[0].question for x in numbers] == [True, False]


def test_an_ambiguous_name_is_of_all_its_methods_and_no_slip_of_another():
    text = "For y' = t - y^2, y(0) = 1 and h = 0.1, the explicit midpoint method has y = {} at t = 2.\n"
    text += "Ralston's has y = {} at t = 2."
    run = "run {} y'=t - y^2, y(0)=1, h=0.1, t=2 : y"
    text = text.format(*(value(run.format(key)).places(6) for key in ("midpoint2", "ralston2")))
    suggestions, numbers = Suggestions(text), [x for x in numbers_in(text) if len(x.text) > 6]
    assert [suggestions.look_alikes(x)[0].strong for x in numbers] == [True, True]
    assert not any(map(suggestions.slips, numbers))


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


@pytest.mark.parametrize(
    "said",
    [
        "From h = 0.5 to h = 0.25 the error of RK4 falls by the factor {}",
        "Halving h from 0.5 to 0.25 divides the error of RK4 by {}",
    ],
)
def test_a_ratio_of_errors_is_known_by_its_two_step_sizes(said):
    text = f"y' = 0.8*y*(1 - y/5), y(0) = 0.5, to t = 5 with h = 1, 0.5 or 0.25. {said.format('15.7')}."
    suggestions = Suggestions(text)
    (best,) = [
        one for one in suggestions.look_alikes(next(x for x in numbers_in(text) if x.text == "15.7")) if one.strong
    ]
    assert best.question.startswith("ratio(run rk4 ")
    assert "h=0.5, t=5 : error, " in best.question


def test_a_time_in_its_column_is_no_value():
    """The trapezoidal rule has 1.50 at the time 1.5."""
    text = "y' = -0.8y, y(0) = 5 with h = 0.25 by Euler's method and the trapezoidal rule.\n"
    text += "| t | Euler |\n| 1.50 | 1.3107 |\n"
    suggestions = Suggestions(text)
    time, y = numbers_in(text)[-2:]
    assert suggestions.look_alikes(y)[0].strong
    assert suggestions.look_alikes(time)
    assert not any(one.strong for one in suggestions.look_alikes(time))
