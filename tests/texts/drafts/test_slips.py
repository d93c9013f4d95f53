"""What numbers in tables and in prose are claimed to be, and which are slips for what their place names."""

import re

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import numbers_in
from tests.texts.sample import claims_and_slips, strong_and_slips

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


def test_a_difference_may_have_its_sign_where_an_error_is_asked():
    house = "A house cools by T' = -0.2 (T - 3), T(0) = 21. With h = 1, the signed error T_5 - T(5) is {} for Euler."
    assert strong_and_slips(house.format("-0.7236"))[-1] == ("-0.7236", False, [])
    assert strong_and_slips(house.format("0.7263"))[-1] == ("0.7263", False, ["0.7236"])


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
    assert strong_and_slips(BEAD + said.format(*right))[-2:] == [(x, True, []) for x in right]
    assert strong_and_slips(BEAD + said.format(*wrong))[-2:] == [
        ("2.265e-02", False, ["2.115e-3"]),
        ("2.115e-03", False, ["2.265e-2"]),
    ]


LOTKA = """\
Hares x' = x - x y and foxes y' = -y + x y begin at x(0) = 1, y(0) = 2. V = x - ln x + y - ln y is conserved: {}
The orders are 1 and 2."""


@pytest.mark.parametrize(
    ("said", "claimed"),
    [
        ("here V = 2.30685.", "t=0 : energy"),
        ("Heun's method is used with h = 0.1 up to t = 1.\n\nThen V = 2.30685.", ""),
        ("with h = 0.1 the invariant of RK4 is 2.30685 at t = 1.", "h=0.1, t=1 : energy"),
    ],
)
def test_an_invariant_is_an_energy_and_one_that_is_kept_is_of_no_run_unless_said_so(said, claimed):
    found, slips = claims_and_slips(LOTKA.format(said))
    assert slips == {}
    assert found["2.30685"][-len(claimed) :] == claimed
    assert not any(strong for x, strong, _ in strong_and_slips(LOTKA.format(said))[-2:])


def test_a_number_is_of_the_step_size_in_its_row_whatever_the_head_of_that_is():
    sizes = {h: value(f"run heun2 lambda=-2 h={h} t=1 : y").places(5) for h in ("0.1", "0.05", "0.025")}
    rows = "".join(f"| {h} | {y} |\n" for h, y in sizes.items())
    said = "We solve y' = -2y, y(0) = 1 up to t = 1 with h = 0.1 and h = 0.05. h = 0.025."
    assert claims_and_slips(f"{said}\n\n| spacing | Heun |\n{rows}")[1] == {}


def test_a_table_without_a_right_number_is_of_another_problem():
    text = "We solve y' = -RATEy, y(0) = 1 up to t = 1.\n\n| h | Heun |\n| 0.1 | 0.13745 |\n| 0.05 | 0.13582 |\n"
    text += "| 0.025 | 0.13545 |\n| 0.0125 | 0.13537 |\n"
    for rate, off in (("2", []), ("3", ["0.13745", "0.13582", "0.13545", "0.13537"])):
        tables = [numbers for numbers, _ in Suggestions(text.replace("RATE", rate)).tables_off()]
        assert [x.text for numbers in tables for x in numbers] == off


ORDERS = """Forward Euler and Heun on T' = -0.2 (T - 3), T(0) = 21 with h = 1:

| t | Euler | Heun |
| 5 | 8.8982 | 9.6733 |

The error at t = 5:

| h | Euler | Heun |
| 1 | 0.72359 | 0.0514872 |
| 0.5 | 0.34562 | 0.0119078 |

The observed order is the binary logarithm of the ratio of two errors that follow each other:

| h | Euler | Heun |
| 1 to 0.5 | 1.066 | 2.112 |
| 0.5 to 0.25 | 1.031 | 2.055 |
"""


def test_a_table_whose_numbers_are_something_else_is_not_said_to_be_off():
    assert [*Suggestions(ORDERS).tables_off()] == []


def test_orders_of_a_list_are_those_of_its_methods():
    said = "Implicit Euler and trapezoidal rule have orders {} and {}."
    assert strong_and_slips(said.format(1, 2)) == [("1", True, []), ("2", True, [])]
    assert strong_and_slips(said.format(2, 1)) == [("2", False, ["1"]), ("1", False, ["2"])]


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
    assert [found for _, _, found in strong_and_slips(text) if found] == slips


def test_a_head_with_3_8_in_brackets_names_that_method():
    text = "For y' = -y, y(0) = 1 and h = 0.1, the 3/8 rule gives\n\n"
    text += "| t | y (Heun 3) | y (3/8) |\n|---|---|---|\n| 1 | 0.3678628 | {} |"
    assert strong_and_slips(text.format("0.3678798"))[-1] == ("0.3678798", True, [])
    assert strong_and_slips(text.format("0.3678789"))[-1] == ("0.3678789", False, ["0.3678798"])


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


OSCILLATES = "x'' = -4x, x(0) = 1, x'(0) = 0, E = v^2/2 + 2x^2. We take h = 0.1.\n\n"


@pytest.mark.parametrize(
    ("said", "claimed", "slips"),  # of the last percentage
    [
        ("Euler's energy grows by 4.0 % per step", True, []),
        ("The energy of Euler's method grows. After 100 steps it has grown by 4950 %", True, []),
        ("RK4 loses 0.000088 % of its energy in each step, so that after 10 steps it has lost 0.00088 %", True, []),
        ("Heun's method gains 0.0400 % of the energy in each step and 0.401 % after 10 steps", True, []),
        ("Euler's energy grows. After 10 steps the amplitude has grown by 21.7 %", False, []),  # relative error: 22.7
    ],
)
def test_a_percentage_by_which_the_energy_grows_is_that_of_the_run_or_of_a_step(said, claimed, slips):
    suggestions = Suggestions(text := OSCILLATES + said + ".")
    number = [x for x in numbers_in(text) if text.startswith(" %", x.end)][-1]
    strong = [one.question for one in suggestions.look_alikes(number)[:1] if one.strong]
    assert [" : relative_energy_change" in one for one in strong] == [True] * claimed
    assert sorted({*suggestions.slips(number).values()}) == slips


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
        (ROWS, {"4.76": "4.77"}),  # of rounded errors
        (COLUMNS_OF_RUNS, {}),
        (COLUMNS_OF_RUNS, {"0.00106": "0.00137"}),
        (COLUMNS_OF_RUNS, {"0.0140": "0.0288"}),  # three digits with the last zero
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


DECAY = "y' = -3y, y(0) = 2, to t = 1 with h = 0.2, h = 0.1 and h = 0.05."
SWINGS = "θ'' = -sin θ, θ(0) = 1.2, θ'(0) = 0 and E = ω²/2 - cos θ. We take h = 0.1.\n"
MOVES = "x'' = -4x, x(0) = 1, x'(0) = 0, E = v^2/2 + 2x^2, h = 0.1.\n| method | energy at t = 5 | relative change |\n"
PAIRS = "y' = -y, y(0) = 1, to t = 1 with h = 0.1: Heun, Ralston, Euler, RK4, the 3/8 rule, Kutta's third-order method"


PAIRED = f"{DECAY} Observed orders, log_2 of the ratio of two errors:\n| method | 0.2 to 0.1 | 0.1 to 0.05 |\n| RK4 | "
MINE = "θ'' = -sin(θ), θ(0) = 1.2, θ'(0) = 0, with the energy E = (1/2)ω^2 - cos(θ), ω = θ'. "
FALLS = MINE.replace("sin(θ)", "sin(θ) - 0.2θ'")
LARGEST = f"{MINE}\n| method | energy change at t = 2 | largest energy change |\n| Verlet, h = 0.1 | -0.001262 | "
TWO = "x'' = -x, y'' = -4y, x(0) = 1, y(0) = 0, x'(0) = 0, y'(0) = 1, to t = 1 with velocity Verlet. "


@pytest.mark.parametrize(
    ("text", "number", "claim", "slip"),
    [
        (f"{DECAY} Halving the step from 0.2 to 0.1 divides the error of RK4 by 20.6", "20.6", "h=0.1, t=1", ""),
        (f"{DECAY} Halving the step from 0.2 to 0.1 divides the error of RK4 by 18.1", "18.1", "", "20.6"),
        (f"{DECAY}\n| method | y |\n| Heun | 0.105340 |\n| Kutta's third | 0.099747 |", "0.099747", "", "0.099527"),
        (f"{DECAY}\n| method | y |\n| BS3 | 0.099147 |\n| Nemo's | 0.099147 |", "0.099147", "", ""),
        (f"{DECAY}\n| t | 0.4 | 1 |\n| y(t) | 0.602388 | 0.099574 |", "0.602388", "exact", ""),
        (f"{DECAY}\n| t | 0.4 | 1 |\n| y(t) | 0.099574 | 0.602388 |", "0.602388", "", "0.099574"),
        (f"{DECAY}\n| h | 0.2 | 0.1 |\n| RK4 error | 5.35e-04 | 2.59e-05 |", "5.35e-04", "h=0.2, t=1", ""),
        (f"{DECAY}\n| h | 0.2 | 0.1 |\n| RK4 error | 2.59e-05 | 5.35e-04 |", "2.59e-05", "", "5.35e-4"),
        (f"{DECAY} With h = 0.2 the pair of Cash and Karp has y_1 = 1.097660", "1.097660", "", "1.097621"),
        (f"{SWINGS}At the start it is E = -0.362358. At t = 2 RK4 has ω = -1.0872045", "-0.362358", "", ""),
        (f"{SWINGS}RK4 swings. At t = 2 the pendulum is at ω = -1.0872045", "-1.0872045", "exact", ""),
        (f"{SWINGS}| RK4 | distance from the truth |\n| t = 2 | 1.28e-06 |", "1.28e-06", "error", ""),
        (f"{MOVES}| RK4 | 1.9999116 | -0.00442 % |", "-0.00442", "relative_energy_change", ""),
        (f"{MOVES}| RK4 | 1.9999116 | -0.00442 % |\n| Verlet | 1.993773 | 0.311 % |", "0.311", "", "-0.311"),
        (f"{MOVES}| RK4 | 19.999116 | -0.00442 % |", "19.999116", "", "1.9999116"),
        (f"{PAIRED}4.367 | 4.181 |", "4.367", "log2(", ""),
        (f"{PAIRED}4.376 | 4.181 |", "4.376", "", "4.367"),
        (f"{DECAY} Halving it, Heun's errors fall by factors of 4.580 and 5.494", "4.580", "", ""),
        (f"{PAIRS}. Dormand-Prince arrives at 0.367879442", "0.367879442", "dormand_prince54", ""),
        (f"{PAIRS}, BS3, BS5, RKF45, RKF78, midpoint RK2. DVERK arrives at 0.367879442", "0.367879442", "", ""),
        ("AB2 has the error constant 5/12, the trapezoidal rule 1/12", "1/12", "", ""),
        (f"{DECAY} With h = 0.1 RK4 is 222 times as accurate as Heun's method", "222", "ratio(run heun2", ""),
        (f"{DECAY} With h = 0.1 Heun's method is 222 times as accurate as RK4", "222", "", ""),
        (f"{DECAY} At h = 0.1 RK4 is 232 times more accurate than Heun's method", "232", "", "222"),
        (f"{DECAY} Heun takes h = 0.1. With the same step RK4 makes an error 220 times smaller", "220", "ratio(", ""),
        (f"{DECAY} Heun takes h = 0.1. With the same step RK4 makes an error 230 times smaller", "230", "", ""),
        (f"{DECAY} Heun takes h = 0.1 and RK4 makes an error 232 times smaller", "232", "", "222"),
        (f"{DECAY} Heun takes h = 0.2, RK4 h = 0.1. RK4 makes an error 232 times smaller", "232", "", ""),
        (f"{DECAY} Heun takes h = 0.1. Half of it makes the error of RK4 220 times smaller", "220", "", ""),
        (f"{DECAY} Going from h = 0.2 to h = 0.1 makes the error of RK4 20.6 times smaller", "20.6", "h=0.1, t=1", ""),
        (f"{DECAY} With h = 0.1 Heun's relative error is 5.79 percent", "5.79", "relative_error", ""),
        (f"{DECAY} With h = 0.05 RK4 needs 20 steps", "20", "steps", ""),
        (f"{DECAY} Look at t = 0.5, too. To t = 1 with h = 0.05 RK4 needs 10 steps", "10", "", "20"),
        ("V' = (5 - V)/0.5, V(0) = 0, to t = 1. With h = 0.1 RK4 takes 5 steps", "5", "", ""),
        (f"{DECAY} With h = 0.1 RK4\nis off by 5.35e-04", "5.35e-04", "", "2.59e-5"),
        (f"{DECAY} The companion of BS3 with h = 0.2 is 1.0844", "1.0844", "embedded.y", ""),
        (f"{DECAY} The error estimate of BS3 with h = 0.2 is 0.00360", "0.00360", "estimate.y", ""),
        (f"{FALLS}At t = 2 the energy has fallen to -0.577289. RK4 has h = 0.1", "-0.577289", "exact ", ""),
        (f"{FALLS}At t = 2 the energy has fallen to -0.577298. RK4 has h = 0.1", "-0.577298", "", "-0.577289"),
        (f"{FALLS}Euler goes like symplectic Euler, h = 0.1:\n| t | ω |\n| 0.1 | -0.0932039 |", "-0.0932039", "", ""),
        (f"{MINE}The energy is -0.362358 at the start. RK4 has h = 0.1", "-0.362358", "exact ", ""),
        (f"{MINE}The energy is 0.362358 at the start. RK4 has h = 0.1", "0.362358", "", "-0.362358"),
        (f"{MINE}With h = 0.1, the energy of RK4 has fallen by 8.7e-8 at t = 2", "8.7e-8", "abs(", ""),
        (f"{MINE}With h = 0.1, the energy of RK4 has risen by 8.7e-8 at t = 2", "8.7e-8", "", ""),
        (f"{LARGEST}-0.001423 |", "-0.001423", "largest_energy_change", ""),
        (f"{LARGEST}-0.001262 |", "-0.001262", "", ""),  # at the end
        (f"{TWO}From h = 0.2 to h = 0.1 the position error falls by a factor of 4.060", "4.060", "position_error", ""),
        ("On y' = -2y AB3 needs h ≤ 0.3", "0.3", "", ""),
        ("On y' = -2y AB3 needs h ≤ 0.27", "0.27", "real_limit", ""),
    ],
)
def test_readings_of_places(text, number, claim, slip):
    suggestions = Suggestions(text + ".")
    (*_, last) = [x for x in numbers_in(suggestions.text) if x.text == number]
    held = [one.question for one in suggestions.look_alikes(last)[:1] if one.strong]
    assert [claim in one for one in held] == [True] * bool(claim)
    assert {*suggestions.slips(last).values()} == {slip} - {""}


COOLS = "We solve T' = -0.1 (T - 20) with T(0) = 90.\n\n"
OF_TWO = "h = 2 and h = 1", "2.8140", "1.3441"
LISTS_OF_SIZES = [
    ("The errors of Euler at t = 10 for {} are {} and {}.", *OF_TWO),
    ("Going from {} the error of Euler at t = 10 falls from {} to {}.", "h = 2 to h = 1", *OF_TWO[1:]),
    ("For {}, respectively, Euler has at t = 10 the errors {} and {}.", "h = 2 and 1", *OF_TWO[1:]),
]


@pytest.mark.parametrize(("said", "sizes", "coarse", "fine"), LISTS_OF_SIZES)
def test_numbers_of_a_list_are_of_the_step_sizes_of_a_list_before_in_their_order(said, sizes, coarse, fine):
    claimed, slips = claims_and_slips(COOLS + said.format(sizes, coarse, fine))
    assert [re.search("h=([12])", claimed[x])[1] for x in (coarse, fine)] == ["2", "1"]
    assert slips == {}
    claimed, slips = claims_and_slips(COOLS + said.format(sizes, fine, coarse))
    assert (claimed[fine], claimed[coarse]) == ("", "")
    assert {*slips} == {fine, coarse}


@pytest.mark.parametrize("goes_on", ["and explicit Euler with the same step at", "while explicit Euler comes to"])
def test_another_method_of_the_sentence_is_no_start_of_a_multistep_one(goes_on):
    text = (
        "x'' = (1 - x^2) x' - x, x(0) = 2, x'(0) = 0 with h = 0.2.\n\nAB2, started with one step of Heun, arrives at "
    )
    claimed, _ = claims_and_slips(f"{text}x = 1.51333 for t = 1, {goes_on} x = 1.53680.")
    assert [claimed[x][:12] for x in ("1.51333", "1.53680")] == ["run adams_ba", "run forward_"]
    claimed, _ = claims_and_slips(f"{text}x = 1.53680 for t = 1, {goes_on} x = 1.51333.")
    assert [claimed[x] for x in ("1.51333", "1.53680")] == ["", ""]


ASKED = """We solve y' = -2y + t, y(0) = 1 with h = 0.1.

| t | Euler | Heun | RK4 |
| 0.2 | 0.65000 | 0.69050 | 0.68791 |
| 0.4 | 0.46200 | {} | {} |
| 0.6 | {} | 0.43001 | 0.42650 |
"""


@pytest.mark.parametrize("asked", ["y'=-2y + t", "y'=t-2y"])
@pytest.mark.parametrize(
    ("wrong", "slips"),
    [
        (("0.51515", "0.51167", "0.37768"), {}),
        (("0.51515", "0.51167", "0.46200"), {"0.46200": {"0.37768"}}),  # of the row above
        (("0.51167", "0.51515", "0.37768"), {"0.51167": {"0.51515"}, "0.51515": {"0.51167"}}),
        (("0.51515", "0.51166", "0.37768"), {"0.51166": {"0.51167"}}),  # of the solution
    ],
)
def test_an_asked_value_is_that_of_its_row_and_column(asked, wrong, slips):
    runs = f"run {{Euler,Heun,RK4}} {asked}, y(0)=1, h=0.1, t={{0.2,0.4,0.6}} : y"
    text = ASKED.format(*wrong)
    suggestions = Suggestions(text, [runs, runs.replace("run {Euler,Heun,RK4}", "exact").replace("h=0.1, ", "")])
    found = {x.text: {*suggestions.slips(x).values()} for x in numbers_in(text) if suggestions.slips(x)}
    assert found == slips
    held = [x.text for x in numbers_in(text) if len(x.text) > 6 and suggestions.look_alikes(x)[0].strong]
    assert len(held) == 9 - len(slips)


def test_behind_a_unit_stands_the_method_of_a_number():
    said = "With y' = -2y, y(0) = 1, h = 0.1 s y is at t = 1 s {} V by backward Euler and {} m/s by the trapezoid."
    right, wrong = (strong_and_slips(said.format(*x))[-2:] for x in (("0.1615", "0.1344"), ("0.1344", "0.1615")))
    assert right == [("0.1615", True, []), ("0.1344", True, [])]
    assert wrong == [("0.1344", False, ["0.1615"]), ("0.1615", False, ["0.1344"])]


@pytest.mark.parametrize(("said", "holds"), [("grows", True), ("shrinks", False), ("has lost", False)])
def test_a_change_goes_in_the_direction_that_is_said(said, holds):
    text = "x'' = -x, x(0) = 1, x'(0) = 0, energy E = x'^2/2 + x^2/2: with forward Euler, h = 0.1, "
    claimed, _ = claims_and_slips(f"{text}E {said} by 0.852 until t = 10.")
    assert claimed["0.852"].endswith("energy_change") == holds


def test_a_change_that_shrinks_with_the_step_size_may_be_one_that_grows():
    run = "run forward_euler x'=v, v'=-x, x(0)=1, v(0)=0, energy=v^2/2+x^2/2, h={}, t=10 : energy_change"
    text = "From h = 0.1 to h = 0.05 the growth of the energy of forward Euler shrinks by a factor of 2.632."
    asked = f"ratio({run.format(0.1)}, {run.format(0.05)})"
    assert Suggestions(text, [asked]).look_alikes([*numbers_in(text)][-1])[0].strong


@pytest.mark.parametrize(
    ("orders", "strong", "slips"),
    [
        (("1.01", "2.06", "4.06"), [True, True, True], {}),
        (("1.06", "2.06", "4.06"), [False, True, True], {"1.06": ["1.01"]}),
        (("2.06", "1.01", "4.06"), [False, False, True], {}),
    ],
)
def test_orders_in_a_list_are_of_the_methods_of_the_sentence_or_the_table_before(orders, strong, slips):
    said = (
        "y' = -2y, y(0) = 1. Errors at t = 1:\n\n| h | Euler | Heun | RK4 |\n| 0.05 | 0.0138 | 4.87e-4 | 2.45e-7 |\n\n"
    )
    said += "From h = 0.05 to h = 0.025 the observed orders are {}, {} and {}."
    claimed, found = claims_and_slips(said.format(*orders))
    assert ([claimed[x].startswith("log2") for x in orders], found) == (strong, slips)


def test_a_modulus_is_no_slip_of_its_sign():
    suggestions = Suggestions(text := "Eigenvalue -11.916, so h <= 2/11.916 = 0.168, not 11.916.", ["-6-sqrt(35)"])
    assert [bool(suggestions.slips(x)) for x in numbers_in(text) if "11" in x.text] == [False, False, True]
