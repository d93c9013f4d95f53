"""Every command has a function of the same name and words, whose answer is what the command prints."""

import inspect
import json
import re
import shlex
from fractions import Fraction as Q
from pathlib import Path

import pytest

import driftproof
from driftproof import FAMILIES, METHODS, PRESETS, OscillatorRun, stability_function_of, stepper
from driftproof.commands.listing import COMMANDS, command_named

ROOT = Path(__file__).parents[2]
RUN = str(ROOT / "examples" / "trajectories" / "pendulum_RK45.csv")

# A command and what Python says for it, in `driftproof`'s names.
SAME = {
    "facts RK4 --only order,imaginary_limit": "facts('rk4', only='order, imaginary_limit')",
    "facts tsitouras54 --only order --order-tolerance 1e-12": "facts('Tsit5', only='order'.split(), "
    "order_tolerance='1e-12')",
    "facts sdirk_order_2 --only l_stable": "facts(FAMILIES['sdirk_order_2'], only=['l_stable'])",
    "facts sdirk_order_2 --at 1/4 --only order": "facts('sdirk_order_2', at=Q(1, 4), only=['order'])",
    "facts bdf2 --only order": "facts('bdf2', only='order')",
    "facts rk4 --system '0 1; -1 -1/10'": "facts(METHODS['rk4'], system=[[0, 1], [-1, '-1/10']])",
    "derive forward_euler --only determinant": "derive('Euler', only='determinant')",
    "step mine.toml --h 1/2": "step(Path('mine.toml'), 0.5)",
    "run rk4 --h 1/4 --t 10 --state 0,1 --digits 20": "run('rk4', '1/4', 10, state=(0, 1), digits=20)",
    "run rk4 --h 0.1 --t 1 --budget": "run('rk4', Q(1, 10), 1, budget=True)",
    "roundoff rk4 --h 1/4,1/8 --float binary32": "roundoff(METHODS['rk4'], [Q(1, 4), 0.125], float='binary32')",
    "stability": "stability()",
    "stability dahlquist_1e3 --methods rk4 --h 1/500": "stability('dahlquist_1e3', METHODS['rk4'], '1/500')",
    "scene": "scene()",
    "scene default": "scene(PRESETS['default'])",
    "scene compare --methods rk4": "scene('compare', methods='rk4')",
    "sweep default --methods rk4,heun2 --h 1/4,1/8": "sweep('default', methods=[METHODS['rk4'], 'heun2'], "
    "h=['1/4', '1/8'])",
    "value 'step rk4 h=1/2 : q'": "value('step rk4 h=1/2 : q')",
    "certify 'y1; -sin(y0)' RUN --method RK45": "certify('y1; -sin(y0)', RUN, method='RK45')",
    "check text.md --claims claims.toml": "check('text.md', 'claims.toml')",
    "diff old.json old.json": "diff('old.json', Path('old.json'))",
    "identify steps:euler": "identify('steps:euler')",
    "identify mine.toml": "identify(Path('mine.toml'))",
    "verify steps:euler --method Euler": "verify(__import__('steps').euler, 'Euler')",
}
NAMES = {
    **{name: getattr(driftproof, name) for name in driftproof.__all__},
    **{"Q": Q, "Path": Path, "FAMILIES": FAMILIES, "METHODS": METHODS, "PRESETS": PRESETS, "RUN": RUN},
}
# Commands that are no question: `methods` lists a table, `completion` is for a shell.
NO_FUNCTION = {"methods", "completion"}
# Times differ from run to run, and a page and a rendered text are files.
TESTED_ELSEWHERE = {"work-precision", "report", "render", *NO_FUNCTION}
# What a command only has because it writes to a terminal or to files, and what it calls otherwise.
OF_THE_COMMAND = {"help", "format", "all", "plot", "picture", "figure", "tolerance", "solver", "check", "list"}
OF_A_CLAIM = {"start", "examples", "largest_step", "largest_state", "extremes", "solver_tolerance"} | {
    *("step_in_binary32", "velocity_from_positions", "flush_to_zero")
}
OTHERWISE = {
    "identify": {"method", *OF_A_CLAIM},
    "verify": OF_A_CLAIM - {"examples"},
    "certify": {"function", "run", "invariant"},
    "value": {"only", "digits", "places", "rounding", "style"},
    "render": {"templates"},
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "steps.py").write_text("def euler(q, v, h):\n    return q + h * v, v - h * q\n")
    (tmp_path / "mine.toml").write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n')
    (tmp_path / "text.md").write_text("The order is 4.\n")
    (tmp_path / "claims.toml").write_text('[[claim]]\nid = "o"\nphrase = "order is {value}"\nvalue = "order rk4"\n')
    (tmp_path / "old.json").write_text('{"values": {"x": {"exact": "1", "decimal": "1"}}}')
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)


@pytest.mark.slow(keep=1)
@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("line", SAME)
def test_function_answers_what_the_command_prints(line, answer):
    words = [RUN if word == "RUN" else word for word in shlex.split(line)]
    found = eval(SAME[line], NAMES)
    shown = json.loads(answer(*words, "--format", "json"))
    told = json.loads(found.json())
    if "target" in told:  # named by where it was imported from, or by what it is called
        assert told.pop("target").rpartition(":")[2] == shown.pop("target").rpartition(":")[2]
    assert told == shown
    if "target" not in json.loads(found.json()):
        assert f"{found}\n" == answer(*words)
    assert repr(found) == str(found)
    html = found._repr_html_()
    assert (html is None) == line.startswith("derive")  # a notebook sets its TeX
    assert html is None or ("<" in html and "\n\n" not in html)


def test_every_command_is_held_or_has_its_reason():
    held = {line.split()[0] for line in SAME}
    assert held | TESTED_ELSEWHERE == set(COMMANDS)


@pytest.mark.parametrize("name", [name for name in COMMANDS if name not in NO_FUNCTION])
def test_words_are_the_same(name):
    """Each option of a command is a parameter of its function; and a function has no other needs."""
    command, function = command_named(name), getattr(driftproof, name.replace("-", "_"))
    options = {action.dest for action in command.parser("x")._actions} - OF_THE_COMMAND
    parameters = set(inspect.signature(function).parameters)
    assert options - OTHERWISE.get(name, set()) <= parameters


@pytest.mark.slow
@pytest.mark.usefixtures("folder")
def test_commands_that_were_merged_keep_their_names(answer):
    shown = answer("values", "--only", "rk4.*")
    assert shown == answer("value", "--only", "rk4.*")
    assert json.loads(shown)["values"] == driftproof.published_values("rk4.*")
    assert answer("values").startswith("{")
    assert answer("scenes") == answer("scene")
    assert answer("identify", "steps:euler", "--method", "Euler") == answer(
        "verify", "steps:euler", "--method", "Euler"
    )


REFUSED = {
    "step('rk4', 0.1)": 'h: the double 0.1 is not 0.1 exactly; write "0.1" for the decimal, or Fraction(0.1)',
    "run('rk4', '1/4', True)": "t is 'True'; give a Fraction, an int, or text such as '1/4'",
    "run('rk4', '1/4', float('inf'))": "t is 'inf'; give a Fraction",
    "run(PRESETS['default'], 1, 1)": "is not a method: give a key, a .toml file, or a method",
    "step('rk5', 1)": "unknown method 'rk5'; did you mean rk4",
    "step('rk4', 0)": "the step size h must not be 0",
    "step('rk4', 1, state='1')": "'1' is not a state",
    "roundoff('rk4', float='single')": "unknown number format 'single'; choose from binary",
    "facts('rk4', only=['ordre']).json()": "unknown fact 'ordre'",
    "facts('rk4', at=1)": "rk4 has no parameter",
    "facts('sdirk_order_2', at=0.1)": 'value: the double 0.1 is not 0.1 exactly; write "0.1"',
    "order_within(METHODS['rk4'], 1e-3)": "tolerance: the double 0.001 is not 0.001 exactly",
    "METHODS['rk5']": "unknown key 'rk5'; did you mean rk4? (123 keys are known)",
    "FAMILIES['sdirk']": "unknown key 'sdirk'",
    "check('text.md')": "text.md: No such file or directory",
}
MEANT = {
    "Facts('rk5')": "unknown method 'rk5'", "Facts(Path('mine.toml'))": "mine.toml: No such file",
    "OscillatorRun('rk4', 0.1, 1)": "h: the double 0.1 is not 0.1 exactly", "stepper(4, float)": "'4' is not a method",
    "stability_function_of('sdirk_order_2')": "one method is needed", "order_within('rk5', 0)": "unknown method 'rk5'",
}  # fmt: skip


@pytest.mark.parametrize("call", [*REFUSED, *MEANT])
def test_what_makes_no_sense_is_refused_in_one_line(call):
    with pytest.raises((ValueError, TypeError, AttributeError, KeyError)) as refused:
        eval(call, NAMES)
    assert {**REFUSED, **MEANT}[call] in str(refused.value)
    assert "\n" not in str(refused.value)


def test_functions_take_methods_as_commands_do():
    assert stability_function_of("RK4") == stability_function_of(METHODS["rk4"])
    assert OscillatorRun("Euler", "1/4", 0.5).energy == OscillatorRun(METHODS["forward_euler"], Q(1, 4), Q(1, 2)).energy
    assert stepper("heun", Q)(lambda q: -q, Q(1), Q(0), Q(1, 2)) == (Q(7, 8), Q(-1, 2))


# What reads or writes files, and how it is asked for one at PATH.
FILES = {
    ".csv": ["certify('-y0', PATH)", "assert_accurate(PATH, '-y0', 1)"],
    ".npz": ["certify('-y0', PATH)", "assert_accurate(PATH, '-y0', 1)"],
    ".toml": [
        *("read_method(PATH)", "facts(PATH)", "derive(PATH)", "roundoff(PATH)", "step(PATH, 1)", "run(PATH, 1, 1)"),
        *("identify(PATH)", "verify(min, PATH)", "assert_verified(min, PATH)", "certify('y1; -y0', RUN, method=PATH)"),
        *("certify(str(PATH), RUN)", "read_scene(PATH)", "scene(PATH)", "sweep(PATH)", "report(PATH)"),
        *("stability(PATH)", "stability('kepler', PATH)", "work_precision(PATH)", "work_precision('kepler', PATH)"),
        *("identify_solver(min, PATH)", "assert_verified_solver(min, PATH)", "scene('compare', methods=PATH)"),
        *("check(RUN, PATH)", "assert_text(RUN, PATH)"),
    ],
    ".md": ["check(PATH)", "check(PATH, init=True)"],
    ".md.j2": ["render(PATH)"],
    ".json": ["diff(PATH, 'x.json')", "diff('x.json', PATH)"],
}
FUNCTIONS = ("Facts(PATH)", "OscillatorRun(PATH, 1, 1)", "stepper(PATH, float)", "stability_function_of(PATH)")
FILES[".toml"] += [*FUNCTIONS, "order_within(PATH, 0)"]
READERS = [(suffix, call) for suffix, calls in FILES.items() for call in calls]


@pytest.mark.parametrize(("suffix", "call"), READERS, ids=lambda x: x)
def test_file_that_cannot_be_read_is_refused_in_one_line_that_names_it(suffix, call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("x.json").write_text("{}", encoding="utf-8")
    rubbish, folder, loop = (tmp_path / f"{name}{suffix}" for name in ("rubbish", "folder", "loop"))
    rubbish.write_bytes(bytes(range(255, 99, -1)))
    folder.mkdir()
    loop.symlink_to(loop)
    for path in (rubbish, folder, loop, rubbish / f"x{suffix}", tmp_path / f"none{suffix}", "9" * 300 + suffix):
        with pytest.raises(ValueError, match=re.escape(Path(path).name)) as refused:
            eval(call, {**NAMES, "PATH": path})
        assert "\n" not in str(refused.value)


WRITERS = "report('default', output=PATH)", "sweep('default', output=PATH)", "work_precision('kepler', output=PATH)"


@pytest.mark.parametrize("call", WRITERS)
def test_file_that_cannot_be_written_is_refused_in_one_line_that_names_it(call, tmp_path):
    taken, loop = tmp_path / "taken", tmp_path / "loop"
    taken.mkdir() if "work" not in call else taken.touch()
    loop.symlink_to(loop)
    for path in (taken, loop, tmp_path / ("9" * 300)):
        with pytest.raises(ValueError, match=re.escape(path.name)) as refused:
            eval(call, {**NAMES, "PATH": path})
        assert "\n" not in str(refused.value)


def test_no_function_that_takes_a_file_is_left_out():
    functions = [(name, getattr(driftproof, name)) for name in driftproof.__all__]
    said = {name: str(inspect.signature(found)) for name, found in functions if inspect.isfunction(found)}
    takes = {name for name, text in said.items() if re.search("Path|GivenProblem|GivenMethods", text)}
    asked = {call.partition("(")[0] for call in (*WRITERS, *(call for _, call in READERS))}
    assert takes <= asked
    assert len(takes) >= 17


def test_facts_are_attributes_and_entries():
    facts = driftproof.facts("rk4")
    assert (facts.order, facts["order"], facts.title) == (4, 4, "Classical RK4")
    assert driftproof.facts("sdirk_order_2").order_sets == driftproof.facts("sdirk_order_2")["order_sets"]
    with pytest.raises(AttributeError, match="unknown fact 'ordr'"):
        _ = facts.ordr
