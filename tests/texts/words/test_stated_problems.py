"""The problems that a text states are read out of it, with methods, step sizes and times; not what it leaves open."""

import re

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.document import document_of
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.words.stated_problems import equations_in, stated_problems


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
        (
            "x' = ω, ω' = -x from (1, 2). Then E(0) = 3 and E' = -0.2 ω^2; t = 1",
            "x'=omega, omega'=-x, x(0)=1, omega(0)=2",
        ),
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


def test_an_energy_of_velocities_is_that_of_a_problem_of_second_order():
    text = "x'' = -x/r, r = √(x^2 + 1), x(0) = 1, x'(0) = 0; the energy E = x'^2/2 + r. RK4 with h = 0.1 to t = 1"
    assert any("energy=dx^2/2 + (sqrt(x^2 + 1))" in one for one in stated(text))


def test_a_parameter_with_several_values_states_a_problem_for_each():
    text = "y' = -k y with h = 0.1, y(0) = 1. Euler to t = 1: for k = 2 (h = 0.2) 0.08; for k = 3, 0.01; for k = 2, 0.1"
    assert [re.findall(r"y'=(\S+ y),", one) for one in stated(text) if one.startswith("exact")] == [["-2 y"], ["-3 y"]]
    for same in (text.replace("k = 3", "y = 3"), text.replace("k = 3", "k = 2"), text.replace("-k y", "-2y")):
        assert len([one for one in stated(same) if one.startswith("exact")]) == 1, same


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
    for said in (text, text.replace("ω^2", "v^2").replace("with ω = θ'", "which ends with v = -0.0654")):
        energies = [one for one in stated(said) if "energy=" in one]
        assert len(energies) == 3
        assert ["energy=dtheta^2/2 - cos(theta), " in one for one in energies] == [True] * 3


def test_an_equation_ends_before_a_method_and_is_no_system_with_that_of_another_sentence():
    text = "On y' = -50y Euler's method is unstable. Near 1 it is z' = -z."
    assert [text[slice(*span)] for span in equations_in(text)] == ["y' = -50y ", "z' = -z"]
    assert [one.rates for one in stated_problems(text)] == [{"y": "-50y"}, {"z": "-z"}]
