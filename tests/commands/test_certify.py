"""`driftproof certify`: a function, a file, and the error with exit statuses as of `verify`; refusals in one line."""

import json
import sys
from pathlib import Path

import pytest

from tests.looping import exactly

RUN = str(Path(__file__).parents[2] / "examples" / "trajectories" / "pendulum_RK45.csv")
TEXT = "y1; -sin(y0)"
MINE = """
import numpy as np
def pendulum(t, y):
    return np.array([y[1], -np.sin(y[0])])
def driven(t, y, force):
    return force(y)
def lost(t, y):
    return {}["nothing"]
"""
PROBLEM = 'rates = ["y1", "-g * sin(y0)"]\n[parameters]\ng = "1"\n'


@pytest.fixture
def own(tmp_path, monkeypatch):
    (tmp_path / "certified_model.py").write_text(MINE)
    (tmp_path / "pendulum.toml").write_text(PROBLEM)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield tmp_path
    sys.modules.pop("certified_model", None)


@pytest.mark.parametrize("function", ["certified_model:pendulum", "pendulum.toml", TEXT, "x' = v, v' = -sin(x)"])
def test_error_is_that_of_the_file_however_f_is_given(function, own, answer):
    shown = answer("certify", function, RUN).splitlines()
    named = "v" if "v'" in function else "1"
    assert shown[0] == f"largest error 9.299099764e-7, proved: component {named} at t = 4, point 19 of 0 to 19"
    assert shown[1].startswith("6 correct digits at every point")


def test_tolerance_decides_the_status(run, own):
    status, out, err = run("certify", TEXT, RUN, "--tolerance", "1e-6", "--method", "RK45", "--figure", "error.svg")
    assert (status, err) == (0, "")
    assert out.splitlines()[1].startswith("  there 9.299099764e-7 = truncation 9.299099762e-7 + rounding ")
    assert out.splitlines()[-2:] == ["within the tolerance 1e-06", "wrote error.svg"]
    assert (own / "error.svg").read_text(encoding="utf-8").startswith("<svg")
    status, out, err = run("certify", TEXT, RUN, "--tolerance", "9e-7")
    assert (status, out.splitlines()[-1], err) == (1, "BEYOND the tolerance 9e-07", "")


def test_a_run_that_is_not_of_the_method_has_its_total_error_and_status_one(run):
    for method, wanted in exactly(3, {"rk4": 1, "gauss2": 1, "Radau": 3}.items()):
        status, out, err = run("certify", TEXT, RUN, "--method", method, "--tolerance", "1e-6")
        assert (status, out.splitlines()[-1], err) == (wanted, "within the tolerance 1e-06", "")
        assert "\nnot split: y[" in out
        assert ("stopped Newton's method early" in out) == (wanted == 3)


def test_json_is_canonical(answer):
    text = answer("certify", TEXT, RUN, "--method", "RK45", "--tolerance", "1", "--format", "json")
    record = json.loads(text)
    assert (record["within"], record["tolerance"], record["split"]["steps"]) == (True, "1.0", 19)
    assert record["largest_error"]["t"] == "4.0"
    assert json.dumps(record, indent=1, sort_keys=True, ensure_ascii=False) + "\n" == text


@pytest.mark.slow
def test_step_of_a_thinned_run_is_exact_or_hexadecimal(own, answer):
    rows = "0,0x1p+1,0\n8,0x1.f1b40ccdb6f88p+0,0x1.4854851809a22p-2\n"
    (own / "thin.csv").write_text(rows)
    shown = answer("certify", TEXT, "thin.csv", "--method", "rk4", "--h", "0x1p-9")
    assert "truncation 3.819972968e-13 + rounding" in shown


def test_drifts_of_first_integrals_are_shown(answer):
    words = ("--invariant", "E=y1^2/2 - cos(y0)", "--invariant", "pendulum_energy", "--method", "RK45")
    shown = answer("certify", TEXT, RUN, *words).splitlines()
    drifts = [line.partition(": largest drift ") for line in shown if "drift" in line]
    assert [name for name, _, _ in drifts] == ["E", "pendulum_energy"]
    assert drifts[0][2] == drifts[1][2]
    assert " = truncation " in drifts[0][2]


def test_first_integral_is_written_in_the_names_of_the_text(answer):
    shown = answer("certify", "x' = v, v' = -sin(x)", RUN, "--invariant", "E=v^2/2 - cos(x)")
    assert "\nE: largest drift " in shown


BAD = {
    ("x' = v, v' = -sin(x)", RUN, "--invariant", "E=q"): "E: 'q': 'q' is not allowed; write + - * / with t, x, v",
    ("certified_model.pendulum", RUN): "for a function write certified_model:pendulum",
    (TEXT, RUN, "--invariant", "energy"): "unknown first integral 'energy'; choose from osc",
    (TEXT, RUN, "--invariant", "E=y1^"): "first integral E: ",
    ("y1; -sinn(y0)", RUN): "'-sinn(y0)', column 3: the functions are sin, cos",
    ("certified_model:nothing", RUN): "cannot be imported: AttributeError",
    ("certified_model:driven", RUN): "f must take (t, y) and return numbers: TypeError: driven() missing 1 required",
    ("certified_model:driven", RUN, "--parameters", "q=3"): "unexpected keyword argument 'q'; its parameters are force",
    ("a b:c", RUN): "'a b:c' names no function; write package.module:function",
    (TEXT, RUN, "--h", "0x1..8"): "'0x1..8' is not a number",
    (TEXT, RUN, "--h", "1/8"): "h has no effect without method",
    ("y0", RUN): "f has 1 components, but the trajectory has 2",
    (TEXT, RUN, "--method", "rk5"): "unknown method 'rk5'",
    (TEXT, RUN, "--tolerance", "0"): "the tolerance must be a number above 0",
    (TEXT, RUN, "--figure", "error.png"): "must be a .svg file",
}  # fmt: skip


@pytest.mark.parametrize("words", BAD, ids=range(len(BAD)))
def test_bad_input_is_one_line(words, own, refusal):
    assert BAD[words] in refusal("certify", *words)


REFUSED = {
    ("certified_model:lost", RUN): "f fails in floats at t = 0.0, on 2 components: KeyError: 'nothing'",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_proved_is_one_line_and_status_three(words, own, run):
    status, out, err = run("certify", *words)
    assert (status, out, err.count("\n")) == (3, "", 1)
    assert REFUSED[words] in err
