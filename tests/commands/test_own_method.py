"""A TOML tableau of a user's own works wherever a key does, and is never taken for the method whose key it has."""

import json
import re

import pytest

from tests.looping import exactly

KUTTA3 = """
family = "runge_kutta"
title = "Mine"
claimed_order = 3
A = [[0, 0, 0], ["1/2", 0, 0], [-1, 2, 0]]
b = ["1/6", "2/3", "1/6"]
"""
SCENE = """
selected = "mine.toml"
h = "1/4"
t = 1
methods = ["Euler", "mine.toml"]
readouts = ["final_state", "evaluations"]
panels = ["table", "position", "phase_plane", "work_precision", "stability"]
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(KUTTA3)
    (tmp_path / "scene.toml").write_text(SCENE)
    return tmp_path


ASKED = {
    "step": (["step", "mine.toml", "--h", "1/2"], "exactly 7/8"),
    "run": (["run", "mine.toml", "--h", "1/4", "--t", "1", "--budget"], "proved bound"),
    "roundoff": (["roundoff", "mine.toml"], "generic step, binary64"),
    "facts": (["facts", "mine.toml", "--only", "order"], "3"),
    "derive": (["derive", "mine.toml"], "k_2"),
    "value": (["value", "step mine.toml h=1/2 : q"], "7/8"),
    "scene": (["scene", "scene.toml"], "Mine"),
    "sweep": (["sweep", "scene.toml", "--h", "1/2", "--methods", "mine.toml,rk4"], "mine.toml"),
    "stability": (["stability", "dahlquist_1e3", "--methods", "mine.toml"], "mine"),
    "work-precision": (["work-precision", "--methods", "mine.toml", "--time-limit", "0.0001"], "mine"),
    "report": (["report", "scene.toml", "-o", "page.html"], "page.html"),
}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("asked", ASKED)
def test_a_command_takes_it(asked, answer):
    words, shown = ASKED[asked]
    assert shown in answer(*words)


@pytest.mark.parametrize("form", ["text", "json", "tex"])
def test_an_order_that_is_claimed_and_missed_is_status_1_where_it_is_shown(form, folder, run):
    assert run("facts", "mine.toml", "--format", form)[0] == 0
    (folder / "mine.toml").write_text(KUTTA3.replace("2/3", "3/2"))
    for words, status in ((("--only", "order"), 1), ((), 1), (("--only", "stages"), 0)):
        found = run("facts", "mine.toml", "--format", form, *words)
        assert (found[0], found[2]) == (status, "")
        assert ("claimed order 3, has 0" in found[1]) == bool(status)


# Tables that have facts and are verified, and make no exact runs; and a family.
FURTHER_METHODS = {
    "rosenbrock": 'alpha = [[0, 0], [1, 0]]\ngamma = [["1/2", 0], [-1, "1/2"]]\nb = ["1/2", "1/2"]',
    "additive": "A_explicit = [[0, 0], [1, 0]]\nb_explicit = [1, 0]\nA_implicit = [[0, 0], [0, 1]]\nb_implicit=[0, 1]",
    "multistep": 'rho = [0, -1, 1]\nsigma = ["-1/2", "3/2", 0]',
    "runge_kutta": 'parameter = "theta"\nA = [[0, 0], ["1 - theta", "theta"]]\nb = ["1 - theta", "theta"]',
}
REFUSED = [words for name, (words, _) in ASKED.items() if name != "facts"] + [
    ["facts", "mine.toml", "--plot", "picture.svg"],
    ["value", "run mine.toml problem=kepler h=1/2 t=1 : state_error"],
    ["scene", "default", "--methods", "mine.toml"],
    ["sweep", "default", "--methods", "mine.toml"],
    ["report", "kepler", "--methods", "mine.toml", "-o", "page.html"],
    ["certify", "y1; -y0", "run.csv", "--method", "mine.toml"],
    ["check", "text.md", "--claims", "claims.toml"],
]


@pytest.mark.parametrize("family", FURTHER_METHODS)
def test_where_a_table_makes_no_runs_a_line_says_what_works_and_nothing_is_written(family, folder, answer, refusal):
    (folder / "mine.toml").write_text(f'family = "{family}"\n{FURTHER_METHODS[family]}\n')
    (folder / "run.csv").write_text("t,y0,y1\n0,1,0\n0.5,0.9,-0.5\n")
    (folder / "text.md").write_text("One step leads to 0.875.\n")
    (folder / "claims.toml").write_text(
        '[[claim]]\nid = "q"\nvalue = "step mine.toml h=1/2 : q"\nphrase = "to {value}"'
    )
    given = {path.name for path in folder.iterdir()}
    assert answer("facts", "mine.toml", "--only", "order")
    in_floats = [words for words in REFUSED if words[0] in ("stability", "work-precision") or "kepler" in words]
    for words in exactly(3, in_floats) if family in ("rosenbrock", "multistep") else ():
        assert answer(*words)
    (folder / "page.html").unlink(missing_ok=True)
    for words in exactly(14, (words for words in REFUSED if words not in in_floats)):
        told = refusal(*words)
        assert re.search("`driftproof facts`|with at and a value of theta|'mine.toml at 1/2'|say started=rk4", told)
    assert {path.name for path in folder.iterdir()} == given


def test_page_and_text_show_it(folder, answer):
    answer("report", "scene.toml", "-o", "page.html")
    page = (folder / "page.html").read_text()
    assert "<h3>Mine</h3>" in page
    assert "mine-toml" in page
    (folder / "text.md").write_text("One step leads to 0.875.\n")
    (folder / "claims.toml").write_text(
        '[[claim]]\nid = "q"\nvalue = "step mine.toml h=1/2 : q"\nphrase = "to {value}"\n'
    )
    assert "1 claim" in answer("check", "text.md", "--claims", "claims.toml")


def test_a_name_with_blanks_is_quoted_in_questions_of_templates_and_drafts(folder, answer):
    (folder / "my (1).toml").write_text(KUTTA3)
    (folder / "text.md.j2").write_text("""{{ value("step 'my (1).toml' h=1/2 : v") | places(3) }}\n""")
    answer("render", "text.md.j2")
    draft = answer("check", "text.md", "--init", "--ask", "step {heun2,'my (1).toml'} h=1/2 : {q,v}")
    assert """value = "step 'my (1).toml' h=1/2 : v\"""" in draft
    (folder / "claims.toml").write_text(draft)
    assert "1 claim" in answer("check", "text.md", "--claims", "claims.toml")


EDITED = {"mine.toml": ("1/6", "1/7"), "problem.toml": ("y1^2/2 + y0^2/2", "y1^2 + y0^2")}


@pytest.mark.parametrize("edited", EDITED)
def test_a_sweep_goes_on_only_with_the_same_table_and_problem_in_the_files_that_it_names(
    edited, folder, answer, refusal
):
    (folder / "problem.toml").write_text('rates = ["y1", "-y0"]\nstart = [1, 0]\nend = 1\nenergy = "y1^2/2 + y0^2/2"\n')
    scene = SCENE.partition("panels")[0].replace('["final_state", "evaluations"]', '["energy_change"]')
    (folder / "scene.toml").write_text(f'{scene}problem = "problem.toml"\n')
    asked = ["sweep", "scene.toml", "--h", "1/2", "-o", "kept.jsonl"]
    assert answer(*asked) == answer(*asked)
    (folder / edited).write_text((folder / edited).read_text().replace(*EDITED[edited]))
    assert "kept.jsonl belongs to another sweep; name another file, or delete it" in refusal(*asked)


def test_a_file_that_is_named_as_a_method_of_ours_is_another_method(folder, answer):
    """With the weights of rk4 in another place, so that the hand-written step would be wrong."""
    wrong = KUTTA3.replace('"1/6", "2/3", "1/6"', '"1/6", "1/3", "1/2"')
    (folder / "rk4.toml").write_text(wrong)
    shown = json.loads(answer("roundoff", "rk4.toml", "--format", "json"))
    assert shown["program"] == "generic"
    run = answer("run", "rk4.toml", "--h", "1/4", "--t", "1", "--budget", "--format", "json")
    rounding = float(json.loads(run)["budget"]["rounding"]["decimal"])
    assert rounding < 1e-14
