"""A user's problem from a file: its digits are enclosed, and those of our own problems come out the same."""

import json
import math
import re
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx
from mpmath import atan, cos, exp, log, mpf, nstr, sin, sqrt, workdps

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.problem_tables import problem_table
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.field_text import field_of_text
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import CERTIFIED, EXACT
from driftproof.numeric.reference_errors import decimal_energy, is_oscillator, largest_state_size
from driftproof.numeric.steps.engine import runner
from driftproof.reports import user_problem
from driftproof.reports.pages import report
from driftproof.reports.scene_view import readout_rows
from driftproof.reports.stability import stability
from driftproof.reports.studies import work_precision
from driftproof.reports.sweeps import sweep
from driftproof.reports.user_problem import MOST_PROVED, enclosed_reference, matrix_in, problem_given
from driftproof.support import kept
from driftproof.symbolic.algebra.certified import Uncertified, enclose
from tests.looping import exactly

WRITTEN = """
title = "A pendulum of 1 m"
rates = ["y1", "-g * sin(y0)"]
start = ["1/2", 0]
end = 0.5
energy = "y1^2/2 - g * cos(y0)"
parameters.g = 9.81
"""


def differing(ours, stored):
    """Digits that do not speak of one number: each is right to half a unit of its last place."""
    pairs = [pair for rows in zip(ours.states, stored.states, strict=True) for pair in zip(*rows, strict=True)]
    half = lambda text: Fraction(10) ** int(Decimal(text).as_tuple().exponent) / 2
    return [b for a, b in pairs if abs(Fraction(a) - Fraction(b)) > half(a) + half(b)]


def first(reference, count):
    return replace(reference, times=reference.times[:count], states=reference.states[:count])


def test_reference_of_a_file_is_enclosed(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(WRITTEN)
    problem = problem_given(str(path))
    assert (problem.title, problem.second_order, problem.start) == ("A pendulum of 1 m", True, (Fraction(1, 2), 0))
    assert problem.field.parameters == (("g", Fraction("9.81")),)
    assert problem.energy == "((y1 * y1) / 2) - (g * cos(y0))"
    found = problem.reference
    assert (found.evidence, len(found.times), found.times[-1]) == (CERTIFIED, 10, Fraction(1, 2))
    # A quarter of the period 2 pi sqrt(1/9.81) (1 + 1/64 + ...) = 2.038 s is at 0.5095: theta is small and positive.
    assert 0 < Decimal(found.states[-1][0]) < Decimal("0.02")
    assert {len(Decimal(text).as_tuple().digits) for text in found.states[-1]} == {20}


@pytest.mark.parametrize(("rates", "start", "end", "largest"), [
    (["3*y"], ["1"], "1", math.exp(3)), (["t^3"], ["0"], "1", 0.25), (["y1", "0"], ["0", "1"], "1", math.sqrt(2)),
    (["y1", "-9.81"], ["0", "20"], "4", 20.387359836901122),
])  # fmt: skip
def test_the_largest_norm_is_that_up_to_the_end_and_not_of_the_last_step_of_an_enclosure(rates, start, end, largest):
    found = problem_given({"rates": rates, "start": start, "end": end})
    assert largest_state_size(found) == pytest.approx(largest, rel=1e-3)


def swing(t, y, g=1.0):
    return [y[1], -g * np.sin(y[0])]


def test_a_problem_may_be_a_dict_with_a_function_of_python(tmp_path):
    path, own = tmp_path / "mine.toml", {"start": (0.5, 0), "end": 0.5, "parameters": {"g": 9.5}, "title": "x" * 200}
    path.write_text('rates = ["y1", "-g * sin(y0)"]\nstart = [0.5, 0]\nend = 0.5\nparameters.g = 9.5')
    energy = {"energy": "y1^2/2 - g * cos(y0)"}
    found = [problem_given(own | energy | {"function": swing}), problem_given(str(path))]
    assert differing(*(each.reference for each in found)) == []
    assert (found[0].key, found[0].start, found[0].t) == ("swing", found[1].start, found[1].t)
    assert decimal_energy(found[0], [0, 1]) == -9
    assert problem_given(own | {"rates": ["y1", "-g * sin(y0)"], "start": np.array([0.5, 0])}).key == "own"
    with pytest.raises(ValueError, match=r"as well: \{'function': swing, 'start': \[1, 0\], 'end': 10\}"):
        problem_given(swing)
    with pytest.raises(ValueError, match=r"f takes \(y, t\), but is called with the time first"):
        problem_given(own | {"function": lambda y, t, g: [y[1], -g * y[0]]})


@pytest.mark.parametrize("key", ["harmonic_oscillator", "pendulum", "henon_heiles"])
def test_stored_digits_come_out_and_a_wrong_one_is_noticed(key):
    problem = problem_given(problem_given(key))
    assert problem is PROBLEMS[key]
    stored = first(problem.reference, 1)
    found = enclosed_reference(problem.field, problem.start, stored.times)
    assert differing(found, stored) == []
    (row,) = stored.states
    planted = replace(stored, states=((f"{row[0][:-1]}{(int(row[0][-1]) + 5) % 10}", *row[1:]),))
    assert len(differing(found, planted)) == 1


@pytest.mark.long
@pytest.mark.parametrize("key", [key for key, problem in PROBLEMS.items() if problem.reference.evidence == EXACT])
def test_all_digits_of_closed_forms_come_out(key):
    problem = PROBLEMS[key]
    found = enclosed_reference(problem.field, problem.start, problem.reference.times)
    assert differing(found, problem.reference) == []


def test_component_that_stays_at_zero_has_a_zero_with_its_place():
    found = enclosed_reference(field_of_text("y1; 0; y0 - y0"), [Fraction(0)] * 3, [Fraction(1)])
    assert [Decimal(text) == 0 for text in found.states[0]] == [True] * 3
    assert all(int(Decimal(text).as_tuple().exponent) <= -20 for text in exactly(3, found.states[0]))


@pytest.mark.slow
def test_component_that_dies_out_has_the_digits_that_are_certain():
    """y1 = exp(-60 t) beside y0 = 1 + t: 20 digits of 1e-26 and less are not certain with 128 bits, and not needed."""
    found = enclosed_reference(field_of_text("1; -60*y1"), [Fraction(1), Fraction(1)], [Fraction(1), Fraction(20)])
    assert (found.source.split(", ")[1], found.states[1][0]) == ("128 bits", "21.000000000000000000")
    for t, row in exactly(2, zip(found.times, found.states, strict=True)):
        unit = Fraction(10) ** int(Decimal(row[1]).as_tuple().exponent)
        with ctx.workprec(4000):
            assert abs(arb(row[1]) - (-60 * arb(t.numerator)).exp()) <= arb(unit.numerator) / unit.denominator / 2
        assert unit < Fraction(1, 10**30)
    assert 1 < len(Decimal(found.states[0][1]).as_tuple().digits) < 20
    for ball, largest in (("1.23456e-10 +/- 1e-16", "1"), ("1.23456e-25 +/- 1e-29", "1e-20"), ("0 +/- 6e-21", "1")):
        with pytest.raises(Uncertified):
            user_problem._digits(arb(ball), arb(largest))
    assert [user_problem._digits(arb(x), arb(1)) for x in ("0 +/- 4e-21", "1.2e-31 +/- 1e-32")] == ["0e-20", "1e-31"]


def test_function_stands_in_the_place_of_rates(tmp_path, monkeypatch):
    (tmp_path / "own_model.py").write_text("import math\ndef f(t, y):\n    return [y[1], -0.1 * math.sin(y[0])]\n")
    (tmp_path / "mine.toml").write_text('function = "own_model:f"\nstart = [1, 0]\nend = 1\n')
    monkeypatch.syspath_prepend(tmp_path)
    problem = problem_given(str(tmp_path / "mine.toml"))
    # -0.1 is the double: another problem than with 1/10, by 5.6e-18 of it.
    assert dict(problem.field.parameters) == {"double_0": Fraction(-0.1)}
    text = enclosed_reference(field_of_text("y1; -0.1*sin(y0)"), problem.start, problem.reference.times)
    assert differing(problem.reference, text) != []
    assert all(
        abs(Decimal(a) - Decimal(b)) < Decimal("1e-17")
        for a, b in exactly(2, zip(problem.reference.states[-1], text.states[-1], strict=True))
    )


def test_parameters_of_a_function_are_its_keywords(tmp_path, monkeypatch):
    (tmp_path / "keyed_model.py").write_text(
        "import math\ndef f(t, y, g=1.0, c=0.0):\n    return [y[1], -g*y[0] - c]\n"
    )
    file = tmp_path / "mine.toml"
    file.write_text('function = "keyed_model:f"\nstart = [1, 0]\nend = 1\nparameters.g = "9/4"\nparameters.c = 0.5\n')
    monkeypatch.syspath_prepend(tmp_path)
    found = problem_given(str(file))
    text = enclosed_reference(field_of_text("y1; -9/4*y0 - 1/2"), found.start, found.reference.times)
    assert differing(found.reference, text) == []
    file.write_text(file.read_text().replace("parameters.c", "parameters.k"))
    with pytest.raises(Refused, match="unexpected keyword argument 'k'"):
        problem_given(str(file))
    turning = {"function": lambda t, y, f, w: [w], "start": [0], "end": 1, "parameters": {"f": "1/5", "w": "2*pi*f"}}
    (found,) = dict(problem_given(turning).field.parameters).values()
    assert found == Fraction(2 * math.pi / 5)
    turning["parameters"] = {"w": "2*pi*f", "f": "1/5"}
    with pytest.raises(ValueError, match=r"parameters.w is '2\*pi\*f'; write a number, or an expression in pi$"):
        problem_given(turning)


def test_bits_are_added_until_the_digits_are_settled_and_no_more_often_than_so(monkeypatch):
    asked = field_of_text("-y0"), [Fraction(1)], [Fraction(1)]
    right = enclosed_reference(*asked)
    monkeypatch.setattr(user_problem, "BITS_AT_FIRST", 32)
    found = enclosed_reference(*asked)
    assert found.states == right.states == (("0.36787944117144232160",),)
    assert found.source.endswith(", 108 bits")
    monkeypatch.setattr(user_problem, "ENCLOSED_DIGITS", 400)
    with pytest.raises(Refused, match="the solution cannot be enclosed to 400 digits with 162 bits"):
        enclosed_reference(*asked)
    tried = []

    def stuck(f, start, times, bits, pieces):
        tried.append(bits)
        raise Refused(f"stuck with {bits} bits", Fraction(1) if bits < 72 else None)

    monkeypatch.setattr(user_problem, "enclose_solution", stuck)
    for attempts, last in ((2, 48), (5, 72)):  # with 72 bits the refusal says that more lead no further
        monkeypatch.setattr(user_problem, "_MOST_ATTEMPTS", attempts)
        with pytest.raises(Refused, match=f"stuck with {last} bits"):
            enclosed_reference(*asked)
    assert tried == [32, 48, 32, 48, 72]


LINEAR = {
    "y1; -2*y0 - y1/10": [[0, 1], [-2, Fraction(-1, 10)]],
    "-(y0 + 2*y1)*3/7; -y1 + 1 - 1": [[Fraction(-3, 7), Fraction(-6, 7)], [0, -1]],
    "-y0 + 1": [[-1]], "y1; -y0 - y1/5 + 1": [[0, 1], [-1, Fraction(-1, 5)]], "0; 2 - y1": [[0, 0], [0, -1]],
    "1": None, "y1; 1 - y1": None, "1; -y1": None, "-y0*t": None,
    "-y0*y0": None, "-sin(y0)": None, "-y0*sin(1)": None, "-pi*y0": [[Fraction(-math.pi)]],
    "y0": None, "y1; 0": None, "-y0*y0/y0": None, "abs(t - 1)": None, "y0 + sin(t)": None,
    "y1; heaviside(1/3 - t) - 4*y0": [[0, 1], [-4, 0]], "exp(t) - sqrt(2)*floor(t) - y0": [[-1]],
    "-heaviside(1 - t)*y0": None, "max(t, y0) - 2*y0": None,
}  # fmt: skip


@pytest.mark.parametrize("rates", LINEAR)
def test_matrix_is_read_from_linear_rates_of_which_no_solution_grows(rates):
    wanted = LINEAR[rates]
    assert matrix_in(field_of_text(rates)) == (wanted and tuple(map(tuple, wanted)))


@pytest.mark.slow
def test_affine_problem_has_the_proofs_of_its_linear_part_and_runs_of_its_own():
    """A control loop to set point 1, and springs about 10^9/4; no phase is measured about c."""
    loop = {"rates": ["y1", "-9*y0 - 3*y1 + 4*y2 + 8", "1 - y0"], "start": [0, 0, 0], "end": 10}
    (found,) = stability(loop, ["rk4"])["methods"]
    assert found["limit"]["decimal"].startswith("0.95544134673006630535991")
    assert float(found["seen"]["bounded"]) == pytest.approx(0.9554413467300663, rel=1e-12)
    assert [run["lost"] for run in found["runs"]] == [True, False, False]
    springs = {"start": [0, 0], "end": 10}
    moved = [springs | {"rates": ["y1", rate]} for rate in ("-4*y0", "10^9 - 4*y0", "sign(5 - t) - 4*y0")]
    told = [stability(each, ["rk4", "velocity_verlet", "implicit_midpoint"]) for each in moved]
    for a, b, c in exactly(3, zip(*(each["methods"] for each in told), strict=True)):
        for key in ("limit", "attained", "seen"):
            assert a[key] == b[key] == c[key]
    assert ["Proved of the difference of two solutions" in str(each) for each in told] == [False, False, True]
    asked = {"-y0": True, "1 - y0": False, "sin(t) - y0": False}
    assert {rate: is_oscillator(problem_given(springs | {"rates": ["y1", rate]})) for rate in asked} == asked


@pytest.mark.slow
def test_own_linear_problem_has_the_same_proofs_as_ours():
    rows = PROBLEMS["heat_equation"].matrix
    rates = [" + ".join(f"({x})*y{j}" for j, x in enumerate(row)) for row in rows]
    assert matrix_in(field_of_text(rates)) == rows
    own = stability({"rates": ["y1", "-1000000*y0"], "start": [1, 0], "end": 1}, ["rk4", "velocity_verlet"], h="1/1000")
    ours = stability("stiff_oscillator", ["rk4", "velocity_verlet"], h="1/1000")
    for a, b in exactly(2, zip(own["methods"], ours["methods"], strict=True)):
        assert [a[key] for key in ("limit", "attained", "seen")] == [b[key] for key in ("limit", "attained", "seen")]
    twenty_one = "; ".join(f"-y{i}" for i in range(MOST_PROVED + 1))
    assert matrix_in(field_of_text(twenty_one)) is None
    assert matrix_in(field_of_text(twenty_one.rpartition(";")[0])) is not None


def test_an_end_and_a_start_may_be_irrational_and_runs_take_the_nearest_doubles():
    """The solution of q'' = -q from them is enclosed at that double; for `value` the start is pi/4 to all digits."""
    given = {"rates": {"q": "v", "v": "-q"}, "start": {"q": "pi/4", "v": "sqrt(2)"}, "end": "2*pi"}
    found = problem_given(given)
    assert (found.t, found.start) == (Fraction(2 * math.pi), (Fraction(math.pi / 4), Fraction(math.sqrt(2))))
    said = "own, with end = 6.283185307179586, start.q = 0.7853981633974483, start.v = 1.4142135623730951"
    assert found.title == f"{said}, nearest doubles"
    with workdps(30):
        q, v, t = map(mpf, (math.pi / 4, math.sqrt(2), 2 * math.pi))
        assert found.reference.states[-1][0] == nstr(q * cos(t) + v * sin(t), 20)
    with ctx.workprec(100):
        assert (enclose(problem_table(given).start[0]) - arb.pi() / 4).abs_upper() < 1e-28


REFUSED = {
    'rates = ["y0"]\nstart = [0]': "end is missing; write a number",
    'start = [0]\nend = 1\nfunction = "nowhere"': "'nowhere' names no function",
    'rates = ["y0"]\nstart = ["nan"]\nend = 1': r'start\[0\] is .nan.; write a number such as "1/3", 0\.1 or "2\*pi"$',
    'rates = ["y0"]\nstart = [0]\nend = "-pi"': "end is -.*; it must be above 0",
    'rates = ["-k*y0"]\nstart = [1]\nend = 1\nparameters.k = "2*c"\nparameters.c = 3': r"parameters\.k: c has to stand",
    'rates = ["-k*y0"]\nstart = [1]\nend = 1\nparameters.k = "2*c"': "parameters.k: '.*c' is a name",
    'rates = ["sqrt(y0)"]\nstart = [0]\nend = 1': "f takes the root of a number that may be 0",
    'rates = ["0", "y1/y0"]\nstart = [0, 1]\nend = 1': r": rates\[1\] = 'y1/y0' is not finite near t = 0$",
    'rates.v = "-v/x"\nrates.x = "v"\nstart.x = 0\nstart.v = 1\nend = 1': r": rates\.v = '-v/x' is not finite near t",
    'rates = ["y0^2"]\nstart = [1]\nend = 2': "not smooth, near t = 1; give the problem an end before it$",
    'rates = ["y0"]\nend = -1\nstart = [1]': "end is -1; it must be above 0",
    f'rates = ["y0"]\nend = 1\nstart = [1]\ntitle = "{"x" * 201}"': "title is .*; write a line of text of 1 to 200 ",
}


@pytest.mark.parametrize("text", REFUSED)
def test_file_of_another_form_is_refused_in_one_line(text, tmp_path):
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises((ValueError, Refused), match=REFUSED[text]) as caught:
        problem_given(str(tmp_path / "mine.toml"))
    assert "\n" not in str(caught.value)
    assert str(caught.value).count("mine.toml: ") == 1


def test_pole_before_the_end_is_refused(tmp_path):
    (tmp_path / "mine.toml").write_text('rates = ["1 + y0^2"]\nstart = [0]\nend = 2\n')
    with pytest.raises(Refused, match=r"f or the solution has a pole, or f is not smooth, near t = 1\.57"):
        problem_given(str(tmp_path / "mine.toml"))


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(
    ("energy", "change"),
    [
        *(("y0^2", "-0.7080734183 at t = 1"), ("y0^2 + y1^2*(1 + 1/10^9)", r"7\.08\d+e-10 at t = 1")),
        *(("y0^2 + y1^2 + 1/(y0 - 1)", None), ("log(y1) + y0^2", None), ("9.81*y0^2 + 9.81*y1^2", None)),
    ],
)
def test_an_energy_that_f_does_not_conserve_is_told(energy, change):
    """One of q'' = -q that is wrong, or nearly right; one without a value at the start is believed."""
    found = problem_given({"rates": ["y1", "-y0"], "start": [1, 0], "end": 10, "energy": energy})
    assert found.energy is not None
    assert re.fullmatch(change or "", found.energy_changes)
    assert ("does not conserve the energy" in found.energy_note) is (change is not None)


def test_an_energy_that_dies_out_is_compared_with_that_of_the_solution():
    """x = e^(-t/10) (cos wt + sin wt/(10 w)), w^2 = 99/100, loses all but an eighth of its energy."""
    spring = {"rates": ["y1", "-y0 - y1/5"], "start": [1, 0], "end": 10, "energy": "(y0^2 + y1^2)/2"}
    (answered,) = sweep(spring, methods="rk4", h="1/8").found
    path, step = [(1.0, 0.0)], runner(METHODS["rk4"], field_of_text("y1; -y0 - y1/5"))
    while len(path) <= 80:
        path.append(step(path[-1], 1 / 8, 0, 1))
    with workdps(30):
        w = sqrt(mpf(99) / 100)
        waves = [(exp(-t / 10), cos(w * t), sin(w * t)) for t in (mpf(n) / 8 for n in range(81))]
        true = [(a * (c + s / (10 * w)), -a * s / w) for a, c, s in waves]
        off = [(mpf(x) ** 2 + mpf(v) ** 2 - a * a - b * b) / 2 for (x, v), (a, b) in zip(path, true, strict=True)]
        apart = [math.hypot(x - a, v - b) for (x, v), (a, b) in zip(path, true, strict=True)]
    found = answered.found
    assert found["largest_error"] == pytest.approx(max(apart), rel=1e-9)
    assert found["largest_error"] > 1.05 * found["state_error"]
    assert found["energy_error"] == pytest.approx(float(off[-1]), rel=1e-9)
    assert found["largest_energy_error"] == pytest.approx(float(max(off, key=abs)), rel=1e-9)
    assert abs(found["largest_energy_error"]) > 1.5 * abs(found["energy_error"])
    told = str(work_precision(spring, "rk4", time_limit=1e-4))
    assert "f does not conserve the energy (the solution has changed it by -0." in told


def test_what_has_been_enclosed_for_long_is_not_enclosed_again(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    spring = {"rates": ["y1", "-w^2*y0 + y0*abs(t - 1/2)"], "start": [1, 0], "end": 1, "parameters": {"w": "2*pi"}}
    problem_given(spring)
    assert [*tmp_path.iterdir()] == [], "twin: what takes no time is not kept"
    monkeypatch.setattr(user_problem, "LONG", 0.0)
    first = problem_given(spring)
    (path,) = tmp_path.glob("driftproof/*.json")
    with monkeypatch.context() as patched:
        patched.setattr(user_problem, "enclose_solution", lambda *_: pytest.fail("enclosed again"))
        again = problem_given(spring)
    assert (again, repr(again)) == (first, repr(first))
    assert len(again.reference.changes) == 1
    times = np.linspace(0, 1, 50)
    assert (again.reference.dense.at(times) == first.reference.dense.at(times)).all()
    for changed in ({"end": 2}, {"start": [1, 1]}, {"parameters": {"w": "2*pi + 1"}}):
        assert problem_given(spring | changed).reference.states != first.reference.states
    right, held = path.read_text(), json.loads(path.read_text())
    states = [[f"-{x}" for x in row] for row in held["states"]]
    answer = {name: x for name, x in held.items() if name not in ("question", "checksum")}
    kept.keep(path, held["question"], answer | {"states": states})  # whole, but not of one solution
    assert problem_given(spring) == first
    path.write_text(right.replace('"1/2"', '"1/3"'))
    assert problem_given(spring) == first


def test_parameters_are_replaced_by_name(tmp_path, answer, refusal):
    path = tmp_path / "mine.toml"
    path.write_text(WRITTEN)
    moon = problem_given(str(path), {"g": "1.62"})
    assert moon.field.parameters == (("g", Fraction("1.62")),)
    assert moon.title == "A pendulum of 1 m with g = 1.62"
    assert problem_given(str(path)).field.parameters == (("g", Fraction("9.81")),)
    spring = {"function": lambda t, y, k=1.0: [y[1], -k * y[0]], "start": [1, 0], "end": 1}
    assert problem_given(spring, [("k", 4)]).field != problem_given(spring).field
    out = answer("stability", str(path), "--methods", "rk4", "--parameters", "g=1.62")
    assert out.startswith("A pendulum of 1 m with g = 1.62\n")
    for given, words in [(str(path), "unknown parameter 'k'; choose from g"), ("pendulum", "has none to change")]:
        with pytest.raises(ValueError, match=words):
            problem_given(given, {"k": 2})
    assert "'g' is not NAME=VALUE, such as mu=5" in refusal("stability", str(path), "--parameters", "g")


def test_doubles_of_a_function_conserve_the_energy_that_is_written_exactly():
    """9.81 is a double in f and 981/100 in the energy, which changes by 3e-17 of it; with 9.82 by more."""
    swing = lambda t, y: [y[1], -9.81 * math.sin(y[0])]
    own = {"function": swing, "start": [1, 0], "end": 5, "energy": "y1^2/2 - 9.81*cos(y0) + 0*tan(y0)"}
    assert problem_given(own).energy is not None
    assert problem_given(own).energy_changes == ""
    assert problem_given(own | {"energy": "y1^2/2 - 9.82*cos(y0)"}).energy_changes


def test_pi_of_a_file_is_itself_in_the_reference_and_a_double_in_runs(tmp_path):
    """x'' = -w^2 x with w = 2 pi: at t = 1/2 it is at -1, at rest, and its energy is 2 pi^2."""
    path = tmp_path / "spring.toml"
    path.write_text(
        'end = 0.5\nrates.x = "v"\nrates.v = "-w^2*x"\nstart.v = 0\nstart.x = 1\nparameters.w = "2*pi"\n'
        'energy = "v^2/2 + w^2*x^2/2"\n'
    )
    problem = problem_given(str(path))
    x, v = problem.reference.states[-1]
    assert Decimal(x) == -1
    assert abs(Decimal(v)) < Decimal("1e-19")
    assert decimal_energy(problem, problem.start) == pytest.approx(Decimal(str(2 * math.pi**2)))
    made = METHODS["rk4"]
    ended = runner(made, problem.field)((1.0, 0.0), 1 / 128, 0, 64)
    assert ended == pytest.approx((-1, 0), abs=1e-5)  # (2 pi)^5 h^4 t / 120 is 1e-7 a component
    assert "x′ = v" in report(problem, methods=[made]).html
    assert readout_rows({"final_state": (1.0, 0.5)}, problem) == [["Numerical (x, v)", "(1.00000, 0.500000)"]]


def test_doubles_of_a_function_stand_on_the_page_as_they_were_written_and_long_rates_are_cut():
    neuron = lambda t, y: [y[0] - y[0] ** 3 / 3 - y[1] + 0.3125, (y[0] + 0.7 - 0.5 * y[1]) / 12.5]
    own = {
        "function": neuron,
        "start": [-1, 1],
        "end": 1,
        "title": "A neuron with a title that is long enough for a page",
    }
    page = report(own, methods=["forward_euler", "symplectic_euler"]).html
    assert "double_0 = 5/16" in page
    assert " = 0.7" in page
    assert "3152519739159347" not in page
    (refused,) = stability(own, ["symplectic_euler"])["methods"]
    assert len(refused["refused"]) < 150


def dosed(rate, share):
    """c' = 5 for the first `share` of every 12 hours, less rate c: what is left of each dose at t = 36."""
    rate = Decimal(rate)
    one = 5 / rate * (1 - (-rate * 12 * share).exp())
    return [sum(one * (-rate * (36 - 12 * k - 12 * share)).exp() for k in range(3))]


def slid(friction):
    """x'' = -x - friction sign(x'), from (1, 1/4): two parts of circles around -friction and friction, until 3/2."""
    with workdps(40):
        c = mpf(friction)
        turn = mpf(1) / 4 / (1 + c)
        first, radius = atan(turn), sqrt((1 + c) ** 2 + mpf(1) / 16) - 2 * c
        return [nstr(c + radius * cos(mpf(3) / 2 - first), 30), nstr(-radius * sin(mpf(3) / 2 - first), 30)]


def rubbed(v):
    """y'' = -1000y' - 1000y - 5 sign(y'), from (1, v) with v >= 0: motions around -1/200 and 1/200, until 2."""
    with workdps(40):
        r, s = -500 + sqrt(mpf(249000)), -500 - sqrt(mpf(249000))
        first, other = lambda d, v: v - s * d, lambda d, v: v - r * d
        d = mpf(201) / 200
        turn = log(s * other(d, v) / (r * first(d, v))) / (r - s)
        top = (first(d, v) * exp(r * turn) - other(d, v) * exp(s * turn)) / (r - s) - mpf(1) / 100
        a, b = first(top, 0) * exp(r * (2 - turn)), other(top, 0) * exp(s * (2 - turn))
        return [nstr(mpf(1) / 200 + (a - b) / (r - s), 30), nstr((r * a - s * b) / (r - s), 30)]


def infusion(t, y, rate):
    return [(5.0 if t % 12 < 3 else 0.0) - rate * y[0]]


STIFF_FRICTION = {"rates": ["y1", "-1000*y1 - 1000*y0 - 5*sign(y1)"], "end": 2}
KINKED = {
    "doses as text": ({"rates": {"c": "5*heaviside(3 - mod(t, 12)) - k*c"}, "start": {"c": 0}, "end": 36,
                       "parameters": {"k": "0.3"}}, dosed("0.3", Decimal("0.25"))),
    "doses as code": ({"function": infusion, "start": [0], "end": 36, "parameters": {"rate": 0.3}},
                      dosed(0.3, Decimal("0.25"))),
    "modulus of the time": ({"rates": ["abs(t - 1/3)"], "start": [0], "end": 1}, [Decimal(5) / 18]),
    "stiff, with a kink at sqrt(2)": ({"rates": ["-1000000*(y0 - max(0, t^2 - 2))"], "start": [1], "end": 3},
                                      ["6.999994000002"]),
    "stiff, with a jump at rest at 0": (STIFF_FRICTION | {"start": [1, 0]}, rubbed(0)),
    "stiff, with a jump on the way": (STIFF_FRICTION | {"start": [1, 1]}, rubbed(1)),
    "friction as text": ({"rates": ["y1", "-y0 - 0.2*sign(y1)"], "start": [1, "1/4"], "end": "3/2"}, slid("0.2")),
    "friction as code": ({"function": lambda t, y: [y[1], -y[0] - 0.2 * np.sign(y[1])], "start": [1, 0.25],
                          "end": "3/2"}, slid(0.2)),
}  # fmt: skip


@pytest.mark.parametrize("name", KINKED)
def test_a_problem_with_kinks_and_jumps_is_enclosed_as_its_closed_form_says(name):
    given, wanted = KINKED[name]
    problem = problem_given(given)
    for found, true in exactly(len(wanted), zip(problem.reference.states[-1], wanted, strict=True)):
        assert abs(Decimal(found) - Decimal(str(true))) < Decimal("1e-19"), name


@pytest.mark.parametrize("rate", ["floor(y0)", "sign(y0)", "max(y0, 1) - max(y0, 1)"])
def test_a_rate_without_slopes_that_jumps_is_not_linear(rate):
    assert matrix_in(field_of_text([rate])) is None
    assert matrix_in(field_of_text(["3 - y0"])) == ((-1,),)
