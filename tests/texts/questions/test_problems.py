"""Runs on problems and on y' = λy are those of Fractions and of floats; constants, exponents and counts of steps."""

import math
import sys
from fractions import Fraction as Q
from pathlib import Path

import mpmath
import numpy as np
import pytest

from driftproof.enclosure.solution.solutions import enclose_solution
from driftproof.texts.questions import problems
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from tests.texts.questions.refusals import require_refusal

MINE = """
rates = ["y1", "-g * sin(y0)"]
start = ["1/2", "0"]
end = "2"
parameters.g = "9.81"
"""


def by_hand(steps, h, start=0.5):
    """Heun's method on the pendulum of MINE, in floats."""
    f = lambda y: np.array([y[1], -9.81 * math.sin(y[0])])
    y = np.array([start, 0.0])
    for _ in range(steps):
        k = f(y)
        y = y + h / 2 * (k + f(y + h * k))
    return y


def test_run_on_a_problem_of_a_file_is_that_of_a_float_program(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(MINE, encoding="utf-8")
    q, v = (float(value(f"run heun2 problem=mine.toml h=1/16 16 steps : y{i}").digits(17)) for i in (0, 1))
    assert abs(by_hand(16, 1 / 16) - [q, v]).max() < 1e-13  # 16 steps of some ten roundings of numbers below 2
    fine = by_hand(4096, 1 / 4096)  # off by about 1e-6: 9.81 h**2
    assert abs(float(value("exact problem=mine.toml t=1 : y0").digits(17)) - fine[0]) < 1e-5
    error = value("run heun2 problem=mine.toml h=1/16 t=1 : state_error").digits(4)
    assert float(error) == pytest.approx(np.hypot(*(by_hand(16, 1 / 16) - fine)), rel=1e-3)
    assert value("run heun2 problem=mine.toml h=1/16 t=1 : steps").exact == 16
    few, many = (value("exact problem=mine.toml t=1 : y0").digits(n) for n in (30, 40))
    assert many.startswith(few[:29])


@pytest.mark.parametrize("key", ["rk4", "backward_euler", "gauss2", "heun2"])
def test_run_on_decay_is_the_power_of_the_stability_function(key):
    power = f"(stability_function {key} z=-1/2) ** 4"
    for readout, same in (("y", power), ("state_error", f"abs({power} - exp(-2))"), ("exact.y", "exp(-2)")):
        for decay in ("lambda=-2", "y'=-2y, y(0)=1,"):
            assert value(f"run {key} {decay} h=1/4 t=1 : {readout}").digits(20) == value(same).digits(20)
        assert isinstance(value(f"run {key} lambda=-2 h=1/4 t=1 : y").exact, Q)


def test_what_is_not_y_lambda_y_or_has_irrational_factors_is_enclosed():
    for question, digits in (
        ("run backward_euler y'=-2y+1, y(0)=1, h=1/2, t=1 : y", "0.6250000000"),  # (1 + 1/4) / 2
        ("run backward_euler y'=-2y-y^2, y(0)=1, h=1/2, t=1/2 : y", "0.4494897428"),  # sqrt(6) - 2
        ("run sdirk2 lambda=-1 h=1/2 t=1/2 : y", "0.6032634801"),
        ("run backward_euler x'=-2x, y'=0*x, x(0)=1, y(0)=0, h=1/2, t=1 : x", "0.2500000000"),
    ):
        found = value(question)
        assert (found.digits(10), found.exact_text) == (digits, None), question


ENERGY = """\
parameters = {k = 0.5}
start = [1, 2]
energy = "y1^2/2 + k*y0^2/2"
end = 1
"""


def test_energy_of_a_problem_and_its_change_are_those_of_the_states(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("rates.toml").write_text(f"{ENERGY}rates = ['y1', '-k*y0']", encoding="utf-8")
    Path("code.toml").write_text(f"{ENERGY}function = 'spring_of_a_question:spring'", encoding="utf-8")
    Path("spring_of_a_question.py").write_text("def spring(t, y, k): return [y[1], -k * y[0]]", encoding="utf-8")
    monkeypatch.setattr("sys.path", [*sys.path])
    y, h = (Q(1), Q(2)), Q(1, 4)
    for _ in range(3):
        y = y[0] + h * y[1], y[1] - h * y[0] / 2
    energy = y[1] ** 2 / 2 + y[0] ** 2 / 4
    turn = "run heun2 x'=v, v'=-x, x(0)=1, v(0)=0, energy=x^2/2 - v, h=1/2"  # sin t - sin²t/2, to 3/2 down
    changes = [value(f"{turn} N={n} : energy_change").digits(9) for n in range(1, 13)]
    assert value(f"{turn} N=12 : largest_energy_change").digits(9) == min(changes, key=float) != changes[-1]
    for name in ("rates", "code"):
        run = f"run forward_euler problem={name}.toml h=1/4 N=3"
        assert value(f"{run} : energy").exact == energy
        assert value(f"{run} : energy_change").exact == energy - (2 + Q(1, 4))
        assert value(f"{run} : relative_energy_change").exact == energy / (2 + Q(1, 4)) - 1
        assert value(f"run rk4 problem={name}.toml h=1/4 N=3 from 0,1 : energy").exact != energy
        assert value(f"exact problem={name}.toml t=0 : energy").exact == 2 + Q(1, 4)
    swing = "x'=v, v'=-sin(x), x(0)=1.2, v(0)=0, energy=v^2/2 - cos(x)"
    assert {value(f"exact {swing}, t={t} : energy").digits(12) for t in (0, 2)} == {value("-cos(1.2)").digits(12)}
    with pytest.raises(ValueError, match="the energy of the start is 0"):
        value("run rk4 y'=-y, y(0)=1, energy=y-1, h=1/4 t=1 : relative_energy_change")
    require_refusal("run rk4 rates=(-y0) from 1 h=1/4 t=1 : energy", 40, "'energy' is not a readout of run")


def test_the_other_row_of_a_pair_and_the_estimate_are_those_of_the_first_step():
    """On y' = -3y the rows of Bogacki and Shampine are R(z) = 1 + z + z²/2 + z³/6 and 1 + z + z²/2 + 3z³/16 + z⁴/48."""
    z = Q(-3, 5)
    first, other = 1 + z + z**2 / 2 + z**3 / 6, 1 + z + z**2 / 2 + 3 * z**3 / 16 + z**4 / 48
    for run in ("step bogacki_shampine32 y'=-3y, y(0)=2, h=0.2", "run bogacki_shampine32 y'=-3y, y(0)=2, h=0.2, t=1"):
        assert value(f"{run} : embedded.y").exact == 2 * other
        assert value(f"{run} : estimate.y").exact == 2 * (first - other)
    swing = "step dormand_prince54 x'=v, v'=-sin(x), x(0)=1.2, v(0)=0, h=0.2"
    parts = f"({swing} : x) - ({swing} : embedded.x)"
    assert value(parts).digits(9) == value(f"{swing} : estimate.x").digits(9)
    require_refusal("step rk4 y'=-y, y(0)=1, h=0.1 : estimate.y", 33, "'estimate.y' is not a readout of step")


def test_parameters_of_a_file_may_be_changed_and_no_others(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for g in ("9.81", "1.62"):
        Path(f"g{g[0]}.toml").write_text(MINE.replace("9.81", g), encoding="utf-8")
    asked = "run heun2 problem={}.toml {} h=1/4 t=1 : y1"
    there, other = (value(asked.format(name, "")).digits(20) for name in ("g1", "g9"))
    assert value(asked.format("g9", "g=1.62")).digits(20) == there != other
    with pytest.raises(QuestionError, match=r"g9\.toml: unknown parameter 'k'; choose from g"):
        value(asked.format("g9", "k=1"))
    with pytest.raises(QuestionError, match="'g' is not a setting"):
        value("run heun2 problem=pendulum g=1 h=1/4 t=1 : y1")


@pytest.mark.parametrize("method", ["RK4", "Crank-Nicolson"])
def test_method_may_follow_the_equations(method):
    rest = "h=0.1, t=1 : y"
    asked = f"y'=-y, y(0)=1, {method}, {rest}", f"{method}, y'=-y, y(0)=1, {rest}"
    assert len({value(each).digits(20) for each in asked}) == 1
    with pytest.raises(QuestionError, match="unexpected ','"):
        value(f"{method}, y'=-y, y(0)=1, heun2, {rest}")


def test_energy_of_equations_stands_beside_them():
    equations, run = "q'=p, p'=-k*q, q(0)=1, p(0)=2", "h=1/4, N=3 : energy_change"
    found = value(f"run forward_euler {equations}, energy=p^2/2 + k*q^2/2, k=1/2, {run}")
    written = "rates=(y1, -y0/2) from 1,2 energy=y1^2/2 + y0^2/4"
    assert found.exact == value(f"run forward_euler {written} h=1/4 N=3 : energy_change").exact
    assert found.exact != value(f"run forward_euler {equations}, energy=p^2/2 + q^2/2, k=1/2, {run}").exact
    turned = value(f"step rk4 {equations}, k=1, energy=pi*q, h=1/2 : energy")
    assert float(turned.digits(15)) == pytest.approx(
        math.pi * float(value(f"step rk4 {equations}, k=1, h=1/2 : q").exact)
    )
    for head in ("step rk4 h=1 energy=q : q", "order rk4 energy=q", "step rk4 problem=pendulum energy=y0 h=1 : energy"):
        require_refusal(head, head.index("energy=") + 8, "energy goes with equations")
    twice = "step rk4 y'=-y, y(0)=1, energy=y, energy=y, h=1 : energy"
    require_refusal(twice, twice.rindex("energy=") + 1, "'energy' is given twice")


def test_energy_with_a_function_is_enclosed_where_the_states_are_rational(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    predators = "rates = \"x' = x - x*y, y' = x*y - y\"\nstart = {x = 2, y = 1}\n"
    Path("mine.toml").write_text(f"{predators}energy = 'x - log(x) + y - log(y)'", encoding="utf-8")
    x, y = Q(2), Q(1) + Q(1, 8)  # x' = 0 and y' = 1 at the start
    assert value("step forward_euler problem=mine.toml h=1/8 : y").exact == y
    found = value("step forward_euler problem=mine.toml h=1/8 : energy_change")
    assert found.exact_text is None
    assert float(found.digits(15)) == pytest.approx(float(y) - math.log(y) - 1, rel=1e-13)
    assert float(value("step forward_euler problem=mine.toml h=1/8 : energy").digits(15)) == pytest.approx(
        float(x + y) - math.log(x) - math.log(y), rel=1e-13
    )


def test_rates_that_are_written_out_are_those_of_the_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(MINE, encoding="utf-8")
    for readout in ("y1", "exact.y1", "slope.y1", "k2.y1", "state_error", "largest_error"):
        asked = f"h=1/16 t=1 : {readout}"
        written = value(f"run heun2 rates=(y1, -9.81*sin(y0)) from 1/2,0 {asked}").digits(30)
        assert written == value(f"run heun2 problem=mine.toml {asked}").digits(30), readout


def test_rational_runs_are_fractions_and_others_balls_around_the_same_numbers():
    """y' = t + y, y(0) = 1, by Heun's method, by hand; with a root that is 0 the same run is in balls."""
    y, t, h = Q(1), Q(0), Q(1, 4)
    for _ in range(4):
        k1 = t + y
        k2 = t + h + y + h * k1
        y, t = y + h / 2 * (k1 + k2), t + h
    for rates, exact in (("t + y0", True), ("t + y0 + 0*sqrt(y0)", False)):
        run = f"run heun2 rates=({rates}) from 1 h=1/4 t=1"
        for readout, by_hand in {"y0": y, "slope.y0": t + y, "k1.y0": Q(1), "k2.y0": Q(3, 2)}.items():
            found = value(f"{run} : {readout}")
            assert found.exact == by_hand if exact else found.digits(20) == value(str(by_hand)).digits(20), readout
    assert value("run heun2 rates=(y0^2) from 1 h=1/64 2 steps : y0").evidence == "DERIVED"
    assert value("run heun2 rates=(y0^2) from 1 h=1/64 40 steps : y0").evidence == "CERTIFIED"  # too long for fractions
    assert value("run gauss2 rates=(t*y0) from 1 h=1/4 t=1 : y0").evidence == "CERTIFIED"


@pytest.mark.parametrize("start", [1, 1 / 3])
def test_largest_error_is_that_of_the_worst_step(start):
    run = f"rates=(-y0) from {Q(start).limit_denominator(9)} h=1/8"
    errors = [float(value(f"run forward_euler {run} N={n} : state_error").digits(12)) for n in range(1, 17)]
    largest = float(value(f"run forward_euler {run} N=16 : largest_error").digits(12))
    assert largest == max(errors) > 2 * errors[0]
    assert largest == pytest.approx(start * max(abs((7 / 8) ** n - math.exp(-n / 8)) for n in range(17)), rel=1e-11)


def test_a_run_whose_balls_grow_over_a_pole_is_made_in_more_bits():
    """Each step is y -> 4 y (1 - y), y = sin^2 of an angle that doubles; balls of 64 bits reach 0 in some 64 steps."""
    found = value("run forward_euler rates=(3*y0^2/y0 - 4*y0^2) from 1/3 h=1 80 steps : y0")
    with mpmath.workdps(60):
        y = mpmath.sin(2**80 * mpmath.asin(mpmath.sqrt(mpmath.mpf(1) / 3))) ** 2
    assert found.digits(12) == mpmath.nstr(y, 12)
    with pytest.raises(QuestionError, match="may be 0"):
        value("run forward_euler rates=(-y0/(2*y0*y0^(1/2))) from 1/4 h=1/2 80 steps : y0").digits(3)


def test_start_of_the_question_goes_before_that_of_the_problem():
    at_rest = value("run rk4 problem=pendulum from 0,0 h=1/4 t=1 : y0")
    assert at_rest.digits(3) != value("run rk4 problem=pendulum h=1/4 t=1 : y0").digits(3)
    assert value("exact rates=(y0) from 3 t=0 : y0").digits(3) == "3.00"
    assert value("exact rates=(-y0) from 1 t=1 : y0").digits(300)[:20] == "0.367879441171442321"
    with pytest.raises(QuestionError, match=r"not decided with 1024 bits: 0, which no .*, or below 1e-30[5-9] in size"):
        value("run rk4 x'=v, v'=0*x, x(0)=0, v(0)=1, h=1/4 t=1 : relative_error").digits(3)
    with pytest.raises(QuestionError, match="not decided with 1024 bits: too many digits, or a tie"):
        value("exact rates=(-y0) from 1 t=1 : y0").digits(400)


def test_start_may_be_irrational():
    for start, x in (("pi/4", math.pi / 4), ("-2 * pi / 3", -2 * math.pi / 3), ("sqrt(3 + 1)/8", 1 / 4)):
        asked = f"run heun2 q'=v, v'=-9.81 sin(q), q(0)={start}, v(0)=0, h=1/16, t=1"
        y = by_hand(16, 1 / 16, x)
        assert abs(float(value(f"{asked} : q").digits(17)) - y[0]) < 1e-13
        tuples = f"run heun2 rates=(y1, -9.81*sin(y0)) from ({start}, 0) h=1/16 t=1 : y1"
        assert abs(float(value(tuples).digits(17)) - y[1]) < 1e-13
    assert value("exact y'=-y, y(0)=sqrt(2), t=1 : y").digits(12) == value("sqrt(2) * exp(-1)").digits(12)
    assert value("1 + run heun2 y'=-y, y(0)=1, h=1, t=1 : y").exact == Q(3, 2), "a sum after the question is its own"


def test_runs_and_solutions_are_enclosed_once(monkeypatch):
    solved = list[list[Q]]()

    def counted(f, start, times, bits):
        solved.append([*times])
        return enclose_solution(f, start, times, bits)

    monkeypatch.setattr(problems, "enclose_solution", counted)
    for h in ("1/7", "1/14"):
        for key in ("heun2", "rk4"):
            for readout in ("exact.y", "state_error", "relative_error"):
                value(f"run {key} y'=-y-y^3/7, y(0)=1, h={h}, t=1 : {readout}").digits(8)
    assert solved == [[0, 1]]
    longer, shorter = (value(f"run rk4 y'=-y-y^3/7, y(0)=1, h=1/14, N={n} : y").digits(12) for n in (15, 3))
    assert longer != shorter
    assert solved == [[0, 1]]


def test_states_are_fractions_up_to_4096_bits():
    """Numerators and denominators of both components: 2047 + 1 + 2047 + 1 bits, and one more."""
    for power, evidence in ((2046, "DERIVED"), (2047, "CERTIFIED")):
        run = f"run rk4 rates=(0*y0, 0*y1) from {2**2046},{2**power} h=1 t=1"
        assert value(f"{run} : y0").evidence == evidence


# Question -> the beginning of its decimal, to the digits that a float has surely.
KNOWN = {
    "pi": math.pi, "e": math.e, "2*pi/3": 2 * math.pi / 3, "exp(-1/4)": math.exp(-0.25), "exp(-1)": math.exp(-1),
    "pi**(1/3)": math.pi ** (1 / 3), "sqrt(pi)": math.pi**0.5, "pi**(2/5)": math.pi**0.4,
    "ln(2)": math.log(2), "ln(exp(2))": 2.0, "cos(pi/3)": 0.5, "(17/16)**1000": (17 / 16) ** 1000,
    "run rk4 h=1/1000 1000 steps : steps": 1000.0, "run rk4 problem=pendulum h=1e-5 t=1 : steps": 100000.0,
    "evaluations of RK4 y'=-2y, y(0)=1, h=0.1, t=1": 40.0,
    "run backward_euler y'=-y y(0)=1 h=1 t=1 : y": 0.5, "exact rates=(0*y0, 0*y1) from (1, pi) t=1 : y1": math.pi,
}  # fmt: skip


KICKED = "run velocity_verlet x''=-x, y''=-4*y, x(0)=3, y(0)=0, x'(0)=0, y'(0)=4, h=1/4, t=1 : "
# A question in the words of a text -> the same of first order, with numbers, in the order of kicks and drifts.
SAME = {
    "RK4 θ'' = -c θ' - g/L*sin(θ), θ(0)=1, θ'(0)=0, c=0.2, g=9.81, L=2, h=0.1, t=1 : θ'":
        "run rk4 rates=(y1, -1/5*y1 - 981/200*sin(y0)) from 1,0 h=0.1 t=1 : y1",
    "rk4 x''(t) = -k*x, x(0)=1, x′(0)=1/2, k=4, h=1/4, t=1 : x": "run rk4 rates=(y1,-4*y0) from 1,1/2 h=1/4 t=1 : y0",
    "rk4 y'=-βy y(0)=1 β=2 h=1/4 t=1 : error": "run rk4 lambda=-2 h=1/4 t=1 : state_error",
    "y(1) of Heun for dy/dx = x - 2x*y, y(0)=1, h=1/4": "run heun2 rates=(t - 2*t*y0) from 1 h=1/4 t=1 : y0",
    "run heun2 y'(x)=x + cos(y), y(0)=1, h=1/4, x=1 : y": "run heun2 rates=(t + cos(y0)) from 1 h=1/4 t=1 : y0",
    "rk4 e'=-p, p'=x*exp(-e), e(0)=1, p(0)=0, h=1 t=2 : e": "run rk4 rates=(-y1, t*exp(-y0)) from 1,0 h=1 t=2 : y0",
    "rk4 rates=(-k*y0) from 1 k=2 h=1/4 t=1 : y0": "run rk4 lambda=-2 h=1/4 t=1 : y",
    "velocity_verlet x'=u, u'=-x, y'=w, w'=-4*y, x(0)=3, u(0)=0, y(0)=0, w(0)=4, h=1/4, t=1 : w":
        "run velocity_verlet rates=(y2, y3, -y0, -4*y1) from 3,0,0,4 h=1/4 t=1 : y3",
    f"{KICKED}error.x": "abs((run velocity_verlet h=1/4 t=1 from 3,0 : q) - 3*cos(1))",
    f"{KICKED}position_error": f"sqrt(({KICKED}error.x)**2 + ({KICKED}error.y)**2)",
}  # fmt: skip


@pytest.mark.parametrize("question", SAME)
def test_question_in_the_words_of_a_text_is_the_one_in_those_of_the_grammar(question):
    assert value(question).digits(20) == value(SAME[question]).digits(20)


@pytest.mark.parametrize("question", KNOWN)
def test_constants_functions_powers_and_counts_of_steps(question):
    assert float(value(question).digits(12)) == pytest.approx(KNOWN[question], rel=1e-11)


def test_power_too_long_to_write_out_is_enclosed():
    assert value("(17/16)**1000").exact == Q(17, 16) ** 1000
    huge = value("(17/16)**100000")
    assert (huge.evidence, huge.digits(3)) == ("CERTIFIED", "7.83e2632")
    assert value("(-1)**999999").digits(2) == "-1.0"


REFUSED = [
    ("run rk4 problem=nope h=1/4 t=1 : y0", 17, "unknown problem 'nope'"),
    ("run rk4 problem=pendulum h=1/3 t=1/2 : y0", 17, "does not divide"),
    ("run rk4 problem=pendulum h=1/4 t=1 from 1 : y0", 17, "the start has 1 entries, required: 2"),
    ("run rk4 rates=(y0) h=1/4 t=1 : y0", 16, "the start has 0 entries, required: 1"),
    ("run rk4 rates=(y0) from 1 lambda=1 h=1/4 t=1 : y0", 27, "run does not take lambda here"),
    ("run rk4 rates=y0 from 1 h=1/4 t=1 : y0", 15, "in brackets, separated by commas, as in (y1, -sin(y0))"),
    ("run rk4 rates=(y0 from 1 h=1/4 t=1 : y0", 15, "a bracket is not closed"),
    ("run rk4 rates=(y0 2) from 1 h=1/4 t=1 : y0", 16, "column 4: unexpected '2'"),
    ("run rk4 rates=(y0, z) from 1,1 h=1/4 t=1 : y0", 16, "'z' is not allowed"),
    ("run gauss2 rates=(y0) from 1 h=1/4 t=1 : k1.y0", 42, "not a readout of run; the readouts are y0"),
    ("run heun2 rates=(y0) from 1 h=1/4 t=1 : k0.y0", 41, "not a readout of run; the readouts are y0"),
    ("run heun2 rates=(y0) from 1 h=1/4 t=1 : k3.y0", 41, "not a readout of run; the readouts are y0"),
    ("exact rates=(y0) from 1 t=1 : state_error", 31, "not a readout of exact; the readouts are y0"),
    ("order rk4 rates=(y0)", 18, "takes no problem"),
    ("run rk4 problem=pendulum rates=(y0) h=1/4 t=1 : y0", 17, "give only one of them"),
    ("run rk4 problem=pendulum h=1/4 t=1 : y", 38, "not a readout of run; the readouts are y0, y1"),
    ("run rk4 problem=pendulum h=1/100001 t=1 : y0", 17, "100001 steps; on a problem at most 100000 are allowed"),
    ("run rk4 rates=(y0) from 3 h=1 t=0 : y0", 16, "h = 1 does not divide t = 0: t / h = 0"),
    ("run velocity_verlet problem=kaps h=1/4 t=1 : y0", 29, "second-order"),
    ("run velocity_verlet lambda=-1 h=1/4 t=1 : y", 21, "a second-order system has as many velocities"),
    ("2**999999", 1, "the power is too long to write out: more than 262144 bits"),
    ("ln(0)", 1, "only a positive number has a logarithm"),
    ("exact problem=pendulum h=1 t=1 : y0", 24, "does not take h here"),
    ("run gauss2 y'=-y y(0)=1 h=1/10 t=1 : evaluations", 38, "gauss2 is implicit"),
]


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_what_has_no_answer_is_refused_at_its_column(question, column, reason):
    require_refusal(question, column, reason)


@pytest.mark.parametrize(
    ("question", "exact"),
    [
        ("run ab2 started=Euler y'=-y, y(0)=1, h=1/10, N=2 : y", Q(163, 200)),
        ("run AB2 with started=rk4, lambda=-1 h=1/10 N=1000 : steps", 1000),
        ("run adams_bashforth3 started=forward_euler h=1/10 N=3 : q", Q(193, 200)),  # the oscillator
        ("step two_step_leapfrog started=heun2 h=1/2 N=2 : q", Q(1) + 2 * Q(1, 2) * Q(-1, 2)),
    ],
)
def test_multistep_method_runs_with_what_starts_it(question, exact):
    assert value(question).exact == exact


def test_bdf2_started_by_backward_euler_is_its_recurrence():
    y = [Q(1), Q(10, 11)]
    for _ in range(9):
        y.append((4 * y[-1] - y[-2]) / (3 + Q(2, 10)))
    question = "run bdf2 started={} y'=-y, y(0)=1, h=1/10, t=1 : y"
    assert float(value(question.format("backward_euler")).digits(15)) == pytest.approx(float(y[-1]), rel=1e-14)
    assert value(question.format("rk4")).digits(9) != value(question.format("backward_euler")).digits(9)


def test_multistep_method_started_exactly_shows_its_order():
    """The ratio of the errors at h and h/2 tends to 2 to the power of the order."""
    for key, order in (("ab2", 2), ("ab4", 4), ("bdf3", 3)):
        run = f"run {key} started=exact y'=y(1-y), y(0)=1/2, t=2 h={{}} : error"
        ratio = value(f"ratio({run.format('1/40')}, {run.format('1/80')})").digits(5)
        assert abs(math.log2(float(ratio)) - order) < 0.2, key


@pytest.mark.parametrize(
    ("question", "column", "said"),
    [
        ("run ab2 h=1/10 t=1 : q", 5, "needs 1 more value than the start: say started=rk4"),
        (
            "run ab3 y'=-y, y(0)=1, h=1/10, t=1 : y",
            5,
            "ask for example: run ab3 y'=-y, y(0)=1, h=1/10, t=1 started=rk4 : y",
        ),
        ("run rk4 started=Euler h=1/10 t=1 : q", 17, "is for multistep methods"),
        ("run stormer2 started=Euler h=1/10 t=1 : q", 22, "gives positions only"),
        ("run ab2 started=ab3 h=1/10 N=2 : q", 17, "is a linear multistep method"),
        ("run ab3 started=Euler h=1/10 N=2 : q", 1, "2 steps: adams_bashforth3 makes"),
        ("run ab2 started=verlet h=1/10 t=1 : q", 17, "may mean velocity_verlet"),
        ("run ab2 started=velocity_verlet y'=-y, y(0)=1, h=1/10, t=1 : y", 36, "second-order"),
        ("order started=rk4 ab2", 15, "takes no started= here"),
        ("run ab2 started=rk4 started=rk4 h=1/10 t=1 : q", 21, "given twice"),
    ],
)
def test_multistep_method_without_a_start_or_with_a_wrong_one_is_refused(question, column, said):
    require_refusal(question, column, said)
