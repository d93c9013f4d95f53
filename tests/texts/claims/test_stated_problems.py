"""The problems that a text states are read out of it, with methods, step sizes and times; not what it leaves open."""

import re

import pytest

from driftproof.texts.claims.known_values import questions_in
from driftproof.texts.claims.stated_problems import equations_in, stated_questions
from driftproof.texts.claims.suggestions import Suggestions
from driftproof.texts.readers.document import document_of
from driftproof.texts.readers.numbers import numbers_in
from tests.looping import some


def stated(text, form="plain"):
    suggestions = Suggestions(document_of(text, form).text.text)
    return suggestions.values.stated


def equations(text, form="plain"):
    """What the question for the solution says of the problem."""
    return [one.removeprefix("exact ").partition(", t=")[0] for one in stated(text, form) if one.startswith("exact")]


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("y' = -2ty with y(0) = 1 until t = 1", "y'=-2t*y, y(0)=1"),
        ("y'(t) = t √y(t), y(0) = 1, t = 1", "y'=t sqrt(y), y(0)=1"),
        ("p' = r p (1 - p/K), p(0) = 1. Here r = 0.5 and K = 10; t = 1", "p'=0.5 p*(1 - p/10), p(0)=1"),
        ("x' = v, v' = -4x, at rest, x(0) = 1, for h in (0.1, 0.05); t = 1", "x'=v, v'=-4x, x(0)=1, v(0)=0"),
        ("(dy/dt = cos t - y) y(0) = 1/2, and t = 1", "y'=cos(t) - y, y(0)=1/2"),
        ("y'(t) = -k y, where k = -0.3; y_0 = 2. At t = 1", "y'=-(-0.3) y, y(0)=2"),
        ("y' = -y — a decay — where y = 2 at first. At t = 1", "y'=-y, y(0)=2"),
        (f"x' = v{' + 0 v' * 14}, v' = -x from (1, 0) to t = 2", f"x'=v{' + 0 v' * 14}, v'=-x, x(0)=1, v(0)=0"),
        (
            "x' = v, v' = -x/r^3, r = √(x^2 + 1), x(0) = 1, v(0) = 0, t = 1",
            "x'=v, v'=-x/(sqrt(x^2 + 1))^3, x(0)=1, v(0)=0",
        ),
        ("θ' = ω, ω' = -9.81·sin θ, from rest at θ(0) = π/4, to t = 1", None),
        (
            "θ'' = -g/L sin θ - cθ', c = 0.2, g/L = 9.81, θ(0) = 1, θ'(0) = 1/2, t = 1",
            "theta'=dtheta, dtheta'=-9.81 sin(theta) - 0.2 dtheta, theta(0)=1, dtheta(0)=1/2",
        ),
        ("d^2x/dt^2 = -βx, β = 2, x(0) = 1 from rest; t = 1", "x'=dx, dx'=-2 x, x(0)=1, dx(0)=0"),
        ("θ' = ω, ω' = -θ, θ(0) = 1, θ'(0) = 2; t = 1", "theta'=omega, omega'=-theta, theta(0)=1, omega(0)=2"),
        ("x'' = -x/(x^2 + 1)^{3/2}, x(0) = 1, x'(0) = 0; t = 1", "x'=dx, dx'=-x/(x^2 + 1)^(3/2), x(0)=1, dx(0)=0"),
        ("u' | = u(1 - v), | u(0) | = 2,\nv' | = u, | v(0) | = 1. t = 1", "u'=u*(1 - v), v'=u, u(0)=2, v(0)=1"),
        ("y' = x + 2xy, y(0) = 1, to x = 1", "y'=t + 2t*y, y(0)=1"),
        ("dy/dx = x - y, y(0) = 1, at x = 1", "y'=t - y, y(0)=1"),
        ("x' = y, y' = -x, x(0) = y(0) = 1, to t = 1", "x'=y, y'=-x, x(0)=1, y(0)=1"),
        ("x' = 1 + x^2 y, y' = -x^2 y, (x, y) = (1, 2), t = 1", "x'=1 + x^2*y, y'=-x^2*y, x(0)=1, y(0)=2"),
        ("x'' = -4x - 0.4x', x(0) = 1, x'(0) = 0; t = 1", "x'=dx, dx'=-4x - 0.4dx, x(0)=1, dx(0)=0"),
        ("y'' + 4y = 0, y(0) = 1, y'(0) = 0; t = 1", "y'=dy, dy'=-(4y) + 0, y(0)=1, dy(0)=0"),
        (
            "(d^2 u)/(dt^2) + 0.3du/dt - u + u^3 = 0, u(0) = 1.5, u'(0) = 0, t = 3",
            "u'=du, du'=-(0.3du - u + u^3) + 0, u(0)=1.5, du(0)=0",
        ),
        ("z' = x - βz, x' = z from (1, 2). Here β = 8/3. t = 1", "z'=x - (8/3) z, x'=z, z(0)=1, x(0)=2"),
        ("x' = v and v' = -x start from (1, -1/2); t = 2", "x'=v, v'=-x, x(0)=1, v(0)=-1/2"),
        ("y' = y e^{-t}, y(0) = 1. At t = 1", "y'=y exp(-t), y(0)=1"),
        ("x' = 2/3 x - 4/3 x y, y' = x, x(0) = 1, y(0) = 1, t = 1", "x'=(2/3) x - (4/3) x y, y'=x, x(0)=1, y(0)=1"),
        ("x' = v, v' = -x, x(0) = 1/2, v(0) = sqrt(3)/2, to t = 1", "x'=v, v'=-x, x(0)=1/2, v(0)=sqrt(3)/2"),
        ("x' = v, v' = -x, x(0) = 1/√2, v(0) = -2 sqrt(3/2), t = 1", "x'=v, v'=-x, x(0)=1/sqrt(2), v(0)=-2*sqrt(3/2)"),
        ("x'' = -x, x(0) = 1, x'(0) = 0. Then x_1' = -0.1 and x_1 = 0.99, at t = 1", "x'=dx, dx'=-x, x(0)=1, dx(0)=0"),
        ("sin' = cos, t' = 1 and y' = -y, y(0) = 1. At t = 1", "y'=-y, y(0)=1"),
        ("y' = -y/K cos t, K = 3, y(0) = 1. At t = 1", "y'=-(y/3) cos(t), y(0)=1"),
        ("x'' = -k/m x, k = 3, m = 2, x(0) = 1, x'(0) = 0, t = 1", "x'=dx, dx'=-(3/2) x, x(0)=1, dx(0)=0"),
        ("m x'' = -k x, k = 3, m = 2, x(0) = 1, x'(0) = 0, t = 1", "x'=dx, dx'=(-3 x)/(2), x(0)=1, dx(0)=0"),
        ("In a 2 y'' + y = 0, y(0) = 1, y'(0) = 0, t = 1", "y'=dy, dy'=(-(y) + 0)/(2), y(0)=1, dy(0)=0"),
        ("x'' + kx = 0, k = 3, x(0) = 1, x'(0) = 0, t = 1", "x'=dx, dx'=-(3*x) + 0, x(0)=1, dx(0)=0"),
        ("2m dy/dt = -y by a, m = 2, y(0) = 1, t = 1", "y'=(-y)/(2*2), y(0)=1"),
        ("x y' = 2y, y(0) = 1, t = 1", "y'=(2y)/(t), y(0)=1"),
        ("t = 1 as h = 0.1 y' = -y, y(0) = 1", "y'=-y, y(0)=1"),
        (
            "x'' = μ (1 - x^2) x' - x, μ = 2, x(0) = 1, x'(0) = 0, t = 1",
            "x'=dx, dx'=2 (1 - x^2) dx - x, x(0)=1, dx(0)=0",
        ),
        ("y' = y (1 - y/10) from y(0) = 1 (a start) to t = 1", "y'=y*(1 - y/10), y(0)=1"),
        ("y' = -y (see below), y(0) = 1; t = 1", "y'=-y, y(0)=1"),
        ("(1) x' = v, (2) v' = -x, x(0) = 1, v(0) = 0, t = 1", "x'=v, v'=-x, x(0)=1, v(0)=0"),
        (
            "x'' = -x/r, y'' = -y/r, r = √(x^2 + y^2), from x = 1, x' = 0, y = 2 and y' = 3. t = 1",
            "x'=dx, dx'=-x/(sqrt(x^2 + y^2)), y'=dy, dy'=-y/(sqrt(x^2 + y^2)), x(0)=1, dx(0)=0, y(0)=2, dy(0)=3",
        ),
        (
            "N_1' = -λ_1 N_1, N_2' = λ_1 N_1 - N_2, λ_1 = 2, N_1(0) = 9 and N_2(0) = 0, t = 1",
            "N_1'=-2 N_1, N_2'=2 N_1 - N_2, N_1(0)=9, N_2(0)=0",
        ),
        ("A y' = -y, y(0) = 1. t = 1", "y'=-y, y(0)=1"),
        ("| - y' = -y, y(0) = 1. t = 1", "y'=-y, y(0)=1"),
        (r"$\tau y' = -y$, $\tau = 0.5$, $y(0) = 1$, $t = 1$", "y'=(-y)/(0.5), y(0)=1"),
        (
            r"$m\ddot{x} + 2\zeta\omega_0\dot{x} = -g\sin x$, $\zeta=0.1$, $\omega_0 = 3$, $m = 2$, $g=9$, "
            "$x(0) = 1$, at rest, $t = 1$",
            "x'=dx, dx'=(-(2*0.1 *3 dx) + -9 sin(x))/(2), x(0)=1, dx(0)=0",
        ),
    ],
)
def test_equations_and_starts_are_read_as_texts_have_them(text, read):
    read = read or "theta'=omega, omega'=-9.81*sin(theta), theta(0)=pi/4, omega(0)=0"
    assert equations(text, "tex" if "$" in text else "plain") == [read]


@pytest.mark.parametrize(
    "text",
    [
        "y' = -y for h = (0.1), and t = 1",  # no start
        "from' = -from, from(0) = 1, and t = 1",
        *("y' = -k y, y(0) = 1, and t = 1", "y' = 2.5 k y, y(0) = 1, and t = 1"),  # k is not said
        "y' = 2 - a-b y, y(0) = 1, and t = 1",
        "y'' = -y, y(0) = 1, and t = 1",  # y'(0) is not said
        *("y' = f(t, y), y(0) = 1, and t = 1", "y' = -tanh y, y(0) = 1, and t = 1"),
        "y' = -y, y(0) = 1",  # no time
        "y' = y (1 - y/K), y(0) = 1, and t = 1",  # no beginning of it
        "nothing of the kind, t = 1",
        *("c x' + m x'' = -x, c = m = 1, x(0) = 1, x'(0) = 0, t = 1", "m x'' = -x, x(0) = 1, x'(0) = 0, t = 1"),
    ],
)
def test_what_the_text_leaves_open_is_no_problem(text):
    assert stated(text) == []


@pytest.mark.parametrize("rate", ["-\\lvert y\\rvert", "-\\sqrt[3]{y}", "-\\lfloor y\\rfloor", "-\\ell y", "\\nabla y"])
def test_what_no_rate_may_have_is_not_left_out_of_one(rate):
    assert equations(f"$y' = {rate}$, $y(0) = 1$, and $t = 1$", "tex") == []


def test_tex_and_two_problems_are_read_each_with_its_own_numbers():
    text = r"""\[ y' = -50\,(y - \cos t), \qquad y(0) = 0, \] Euler, $h = 0.1$, $t = 1$.
    \[ \frac{dx}{dt} = \frac{x}{2}, \quad x(0) = \sqrt{2} \] By Heun's method with $h = 1/8$ and $h=1/4$, to $t = 3$."""
    assert equations(text, "tex") == ["y'=-50 (y - cos(t)), y(0)=0", "x'=x/2, x(0)=sqrt(2)"]
    runs = [one for one in stated(text, "tex") if one.startswith("run")]
    assert [(one.split()[1], "h={0.1}" in one) for one in runs] == [
        ("{forward_euler}", True),
        *[("{heun2}", False)] * 2,
    ]


def test_the_rate_of_an_equation_is_no_step_size():
    (_, run) = stated("dP/dt = 0.8 P, P(0) = 1: Euler takes h = 0.5 to t = 2.")
    assert "h={0.5}, t={2}" in run
    assert "h={0.8}" in stated("P' = P, P(0) = 1: Euler takes dt = 0.8 to t = 1.6.")[-1]


def test_methods_sizes_times_and_what_is_read_are_those_of_the_text():
    text = """A problem. y' = -y, y(0) = 1: Euler, the explicit midpoint method and RK4 with steps of 0.1 and 0.05.
| t | y | relative error |
| 0.5 | 0.59 | 2 % |
| 1.0 | 0.35 | 5 % |
The slopes k_1 = -1 and so on; 1/2 divides the error by 2. 40 evaluations. One step."""
    found = {one: chosen for asked in stated(text) for one, chosen in questions_in(asked).items()}
    assert {c[0] for one, c in some(found.items(), 40) if one.startswith("run")} == {
        "forward_euler",
        "midpoint2",
        "rk4",
    }
    for part in ("h=0.1, t=0.5 : error", "h=0.05, t=1 : relative_error", "h=0.05, t=0.05 : y", "evaluations"):
        assert any(part in one for one in found), part
    assert {one[-4:] for one in found if one.startswith("step")} == {"k1.y", "k2.y", "k3.y", "k4.y"}
    assert sum(one.startswith("ratio(run rk4 y'=-y, y(0)=1, h=0.1,") for one in found) == 3  # at 1/10, 1/2 and 1
    assert not [one for one in found if "h=0.1, t=0.05" in one], "h must divide t"
    for told, before in ((" relative", "h = 0.5. With "), ("", "(h = 0.5; it is odd) "), ("%", "")):
        asked = " ".join(stated(f"{before}h = 0.1 RK4 on y' = -y, y(0) = 1 has the{told} error 3e-7 at t = 1"))
        assert ("relative_error" in asked) == bool(told)
        assert re.findall("h={(.*?)}", asked) == ["0.1"], "of the sentence in which the equation stands"

    for said, times in (("h = 0.1 has y_3 = 0.729", "t={0.3}"), ("h = 0.1 has y(2) = 0.122", "t={2}")):
        assert f", {times} : " in stated(f"y' = -y, y(0) = 1: Euler with {said}")[0]
    for said in ("10 steps to t = 2", "10 steps with h = 0.2", "ten steps with Δt = 0.2"):
        assert ", h={0.2}, t={2} : " in stated(f"y' = -y, y(0) = 1: Euler takes {said}")[-1]
    for counts, times in (((0, 1, 2, 3), "0.1,0.2,0.3,1"), ((10, 20), "1")):  # numbers of steps, and of runs
        rows = "".join(f"| {n} | 0.5 |\n" for n in counts)
        asked = stated(f"y' = -y, y(0) = 1: Euler with h = 0.1 to t = 1.\n| n | y_n |\n{rows}")
        assert f", t={{{times}}} : " in asked[0]
    for who, sizes, longest in (
        ("Euler", "0.0003 to t = 9", ["0.0003"]),
        ("Euler", "0.00029 to t = 8.7", ["0.00029"]),
        ("Euler", "0.00029 to t = 8.70029", []),
        ("Euler and RK4", "0.001 to t = 15.001", []),
        ("Euler", "0.001, 0.002 and 0.0005 to t = 10", ["0.002", "0.001"]),
    ):
        asked = " ".join(stated(f"y' = -y, y(0) = 1: {who} with h = {sizes}"))
        assert re.findall(r"run .*? h={(.*?)}", asked) == longest, "30000 steps in all"
    assert [len(stated(f"y' = -y, y(0) = 1, t = 1.{'1' * n}")) for n in (17, 18)] == [1, 0]
    for said, count in (("explicit methods", 1), ("methods", 2), ("explicit and implicit methods", 2)):
        *_, run = stated(f"y' = -y, y(0) = 1 by {said} of midpoint type to t = 1 with h = 0.1")
        assert run.partition("}")[0].count(",") == count - 1, run


def test_an_energy_of_velocities_is_that_of_a_problem_of_second_order():
    text = "x'' = -x/r, r = √(x^2 + 1), x(0) = 1, x'(0) = 0; the energy E = x'^2/2 + r. RK4 with h = 0.1 to t = 1"
    assert any("energy=dx^2/2 + (sqrt(x^2 + 1))" in one for one in stated(text))


def test_a_parameter_with_several_values_states_a_problem_for_each():
    text = "y' = -k y with h = 0.1, y(0) = 1. Euler to t = 1: for k = 2 (h = 0.2) 0.08; for k = 3, 0.01; for k = 2, 0.1"
    assert [re.findall(r"y'=(\S+ y),", one) for one in stated(text) if one.startswith("exact")] == [["-2 y"], ["-3 y"]]
    for same in (text.replace("k = 3", "y = 3"), text.replace("k = 3", "k = 2"), text.replace("-k y", "-2y")):
        assert len([one for one in stated(same) if one.startswith("exact")]) == 1, same


def test_a_draft_works_out_the_numbers_of_a_stated_problem_and_names_the_slips():
    text = """Heun's method on y' = y - t^2 + 1, y(0) = 0.5, with h = 0.2.

| t | y | error |
| 0.4 | 1.20692 | 0.00717 |
| 2.0 | 5.23305 | 0.0742 |
"""
    suggestions = Suggestions(text)
    found = {x.text: (suggestions.look_alikes(x), suggestions.slips(x)) for x in numbers_in(text)}
    run = "run heun2 y'=y - t^2 + 1, y(0)=0.5, h=0.2, t="
    for number, question in {"1.20692": "0.4 : y", "0.00717": "0.4 : error", "5.23305": "2 : y"}.items():
        (alike, *_), slips = found[number]
        assert (alike.question, alike.strong, slips) == (run + question, True, {})
    assert found["0.0742"][1] == {f"{run}2 : error": "0.0724"}
    assert not any(x.strong for x in found["0.0742"][0])


TWO_ROWS = """On y' = -y, y(0) = 1 to t = 1:
|     | Euler |  | Heun |  |
| h | y | error | y | error |
| 0.1 | 0.348678 | 0.0192 | 0.368541 | 6.61e-4 |
| 0.2 | 0.327680 | 0.0402 | 0.370740 | 2.86e-3 |
"""


def test_a_head_of_two_rows_has_the_methods_above_and_what_is_read_below():
    suggestions = Suggestions(TWO_ROWS)
    for text, question in {"0.370740": "heun2 y'=-y, y(0)=1, h=0.2, t=1 : y", "0.0402": "forward_euler"}.items():
        number = next(x for x in numbers_in(TWO_ROWS) if x.text == text)
        assert suggestions.look_alikes(number)[0].question.startswith(f"run {question}")
        assert suggestions.tables.column_of(number) == ("heun" if question.endswith("y") else "error")
    corner = Suggestions(TWO_ROWS.replace("| h |", "| 5 |"))  # twin: no second row of heads, so no head but the first
    assert {corner.tables.column_of(x) for x in numbers_in(TWO_ROWS) if x.text in ("0.1", "0.2")} == {""}


BY_COUNTS = """Error at t = 2 for y' = -2*t*y, y(0) = 1:
| N | Euler | RK4 |
| 10 | 1.28e-2 | 1.42e-4 |
| 20 | 6.29e-3 | 6.81e-6 |
| 40 | 3.10e-3 | 3.73e-7 |
"""
BY_HEADS = """Error at t = 2 for y' = -2*t*y, y(0) = 1:
| Method | h = 0.2 | h = 0.1 | h = 0.05 |
| Euler | 1.28e-2 | 6.29e-3 | 3.10e-3 |
| Heun | 6.93e-3 | 1.26e-3 | 2.75e-4 |
| RK4 | 1.42e-4 | 6.81e-6 | 3.73e-7 |
"""


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("table", [BY_COUNTS, BY_HEADS])
def test_counts_of_steps_and_heads_of_columns_give_the_step_size_and_the_line_above_what_is_read(table):
    suggestions, read = Suggestions(table), [x for x in numbers_in(table) if "e-" in x.text]
    alike = {x.text: suggestions.look_alikes(x)[0] for x in read}
    assert all(one.strong and one.question.endswith(" : error") for one in alike.values())
    for text, question in {"1.42e-4": "rk4 {}, h=0.2,", "6.29e-3": "forward_euler {}, h=0.1,"}.items():
        assert question.format("y'=-2*t*y, y(0)=1") in alike[text].question
        exchanged = text[:2] + text[3] + text[2] + text[4:]
        wrong = table.replace(text, exchanged)
        slip = next(x for x in numbers_in(wrong) if x.text == exchanged)
        assert Suggestions(wrong).slips(slip) == {alike[text].question: text}


ENERGIES = """H(p, q) = p^2/2 - cos(q), q' = p, p' = -sin(q), q(0) = 1, p(0) = 0. Energy error at t = 10:
| h | Euler | RK4 |
| 0.1 | 5.397e-01 | {0}4.607e-07 |
| 0.05 | 2.324e-01 | {0}1.444e-08 |
"""


@pytest.mark.parametrize(("sign", "asked"), [("-", "run rk4"), ("", "abs(run rk4")])
def test_energies_of_a_stated_problem_are_those_that_the_text_defines(sign, asked):
    text = ENERGIES.format(sign)
    suggestions, equations = Suggestions(text), "q'=p, p'=-sin(q), q(0)=1, p(0)=0, energy=p^2/2 - cos(q), "
    for number, question in {"5.397e-01": "run forward_euler", f"{sign}1.444e-08": asked}.items():
        alike = suggestions.look_alikes(next(x for x in numbers_in(text) if x.text == number))[0]
        assert alike.strong
        assert alike.question.startswith(f"{question} {equations}")
    for other in (text.replace("H(p, q) =", "m(p, q) ="), text.replace("p^2/2 - cos(q)", "g^2/2", 1)):
        assert "energy=" not in " ".join(stated(other)), other


def test_a_question_is_asked_once():
    text = "y' = -y, y(0) = 1, h = 0.1, t = 1, Euler. Again y' = -y, y(0) = 1, h = 0.1, t = 1."
    asked = stated_questions(text, lambda number: "")
    assert len(asked) == len({*asked}) == 2
    assert len(stated("y' = -y, y(0) = 1, t = 1. " * 4 + "x' = x, x(0) = 1, t = 1.")) == 2
    other = "y' = -y, y(0) = 1, t = 1. x' = y, y' = -x from (1, 0) to t = 2."
    assert equations(other) == ["y'=-y, y(0)=1", "x'=y, y'=-x, x(0)=1, y(0)=0"]


def test_equations_that_stand_again_have_the_numbers_of_both_places_and_their_first_start_if_no_other():
    first = "y' = -y, y(0) = 1, by Euler with h = 0.1 to t = 1. "
    for again, read in {
        "y' = -y with h = 0.5 to t = 2.": ("y(0)=1", "h={0.5}, t={2}"),
        "Once more y' = -y, y(0) = 3, with h = 0.5 to t = 2.": ("y(0)=3", "h={0.5}, t={2}"),
    }.items():
        runs = [one for one in stated(first + again) if one.startswith("run")]
        for one, (start, steps) in zip(runs, (("y(0)=1", "h={0.1}, t={1}"), read), strict=True):
            assert f"y'=-y, {start}, {steps} : " in one
    assert stated("y' = -y with h = 0.5 to t = 2. And again y' = -y with h = 0.1.") == []


@pytest.mark.parametrize(
    ("said", "started"),
    [
        ("The first step is one of RK4.", ["rk4"]),
        ("It is started with Heun's method; RK4 is for comparison.", ["heun2"]),
        ("We compare with RK4.", ["exact", "forward_euler", "heun2", "rk4"]),
        ("The first value is exact: we start from the exact solution. RK4 comes later.", ["exact"]),
    ],
)
def test_multistep_method_is_started_as_the_text_says_or_in_all_usual_ways(said, started):
    found = stated(f"y' = -y, y(0) = 1, by AB2 with h = 0.1. {said} At t = 1")
    runs = [one for one in found if "{adams_bashforth2}" in one]
    assert sorted({re.search(r"started=(\w+)", one)[1] for one in runs}) == started


def test_method_that_starts_another_one_is_not_that_of_the_numbers():
    text = (
        "y' = y (1 - y), y(0) = 0.5, with AB2 and h = 0.1; the first step is taken with RK4. At t = 2 we get y = {}, "
        "where the exact solution is 0.88080."
    )
    right, wrong = (Suggestions(text.format(x)) for x in ("0.88092", "0.88192"))
    (number,) = (x for x in numbers_in(right.text) if x.text == "0.88092")
    assert right.look_alikes(number)[0].strong
    assert not right.slips(number)
    assert " started=rk4 " in right.look_alikes(number)[0].question
    (number,) = (x for x in numbers_in(wrong.text) if x.text == "0.88192")
    assert [*wrong.slips(number).values()] == ["0.88092"]


@pytest.mark.parametrize(
    ("said", "energy"),
    [
        ("E = 1/2 L^2 x'^2 + gL(1 - cos x), L = 0.5, g = 9.81", "(1/2) *0.5^2*dx^2 + 9.81*0.5(1 - cos(x))"),
        ("The energy 1/2 x'^2 + 2x^2 is 2 at first", "(1/2) dx^2 + 2x^2"),
        ("The quantity V = 0.1 x - 0.4 ln x is conserved", "0.1 x - 0.4 ln(x)"),
        ("The quantity V = 0.1 x - 0.4 ln x is printed", None),
        ("The energy of x is 2", None),
    ],
)
def test_energy_is_what_the_text_calls_so_or_conserved(said, energy):
    asked = stated(f"x'' = -4x, x(0) = 1, x'(0) = 0, RK4 with h = 0.1 to t = 1. {said}.")
    assert {found[1] for one in asked if (found := re.search(r"energy=(.*?), h=", one))} == ({energy} - {None})


def test_a_velocity_that_is_computed_is_no_equation():
    for zero, count in (("0", 2), ("0.777", 1), ("0.0", 2)):
        assert len([*equations_in(f"x'' = -4x with x' = {zero}")]) == count, zero


def test_an_equation_in_passing_does_not_end_what_is_said_of_the_problem():
    aside = "For y' = -λ y Euler is stable if h λ is at most 2."
    asked = [stated(f"y' = -3 (y - t), y(0) = 1. {said} With h = 0.1 RK4 has y = 1 at t = 1.") for said in (aside, "")]
    assert [one for one in asked[0] if "rk4" in one] == [
        one.replace("{rk4}", "{forward_euler,rk4}") for one in asked[1][1:]
    ]
    other = aside.replace("Euler", "y(0) = 2: Euler")
    assert not [
        one
        for one in stated(f"y' = -3 (y - t), y(0) = 1. {other} λ = 2 and RK4 with h = 0.1 at t = 1")
        if "-3" in one and "run" in one
    ]


def test_an_energy_in_another_name_of_the_derivative_is_that_of_the_problem():
    text = "θ'' = -sin(θ), θ(0) = 1.2, θ'(0) = 0. E = ω^2/2 - cos(θ), with ω = θ'. RK4 with h = 0.1 to t = 1."
    energies = [one for one in stated(text) if "energy=" in one]
    assert len(energies) == 2
    assert all("energy=dtheta^2/2 - cos(theta), h=" in one for one in energies)


@pytest.mark.parametrize(
    ("said", "sizes"),
    [
        ("h = 0.1", {"0.1"}),
        ("h in {0.1}, and steps of 0.2", {"0.2"}),
        ("y_1 = y_0 + h(3/2 f_0 - 1/2 f_1) and h = 0.1", {"0.1"}),
        ("h = 2√(u/M), smallest at h = 3 √u, or h = 4·x, or h = 5 f_n; step size 0.1", {"0.1"}),
        ("h = 0.1. RK4 allows h = 0.1393, Euler only up to h = 0.05", {"0.1"}),
    ],
)
def test_a_factor_of_a_formula_and_a_limit_are_no_step_sizes(said, sizes):
    asked = stated(f"y' = -2ty, y(0) = 1 to t = 60 with RK4, {said}.")
    assert {found[1] for one in asked if (found := re.search(r"h={(.*?)}", one))} == sizes


def test_the_steps_of_multistep_methods_are_no_counts_of_steps():
    asked = stated(
        "y' = -2ty, y(0) = 1, h = 0.1. Methods of two, three and four steps, none of more than six steps: t = 1"
    )
    assert [one for one in asked if one.startswith("exact")] == ["exact y'=-2t*y, y(0)=1, t={1} : {y}"]
