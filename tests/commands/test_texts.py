"""`driftproof render` and `check`: options that contradict each other, and texts that are not there, in one line."""

import json

import pytest

from driftproof import check

REFUSED = {
    ("render", "a.html"): "a.html: the name does not end in .j2; name the output with -o",
    ("render", "a.md", "-o", "a.md"): "a.md is one of the templates or outputs already; name another with -o",
    ("render", "a.md.j2", "b.md.j2", "-o", "c.md"): "--output takes a single template",
    ("render", "a.md.j2", "a.md.j2"): "a.md is one of the templates or outputs already; name another with -o",
    ("check", "docs"): "no text in docs has a claims file; that of chapter.md would be chapter.md.claims.toml",
    ("check", "a.md", "b.md", "--claims", "c.toml"): "--init and --claims take one text",
    ("check", "none.md", "--init", "--ask", "-cos(1.5)"): "none.md: No such file or directory",  # no option -c
    ("check", "none.md", "--init", "--claims", "x.toml"): "not allowed with argument --init",
    ("check", "none.md", "--time-limit", "5"): "--time-limit has no effect without --run",
    ("check", "none.md", "--init", "--run"): "--run, --coverage and --format have no effect with --init",
    ("check", "none.md", "--claims", "none.toml"): "none.toml: No such file or directory",
    ("check", "none.md", "--claims", "README.md"): "README.md: not TOML",
    ("check", "..", "--init"): "--init and --claims take one text",
    ("check", "README.md", "--claims", "c.toml", "--time-limit", "0"): "the time limit must be a number above 0",
    ("check", "README.md", "--claims", "c.toml", "--format", "xml"): "invalid choice",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)


@pytest.mark.slow
def test_numbers_are_rendered_then_drafted_as_claims_that_hold(answer, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.md.j2").write_text('RK4: q = {{ value("rk4.first_step.q") | digits(6) }}\n', encoding="utf-8")
    assert answer("render", "a.md.j2") == "a.md: 1 value\n"
    assert answer("render", "a.md.j2", "--check") == "a.md is up to date with a.md.j2\n"
    (tmp_path / "claims.toml").write_text(answer("check", "a.md", "--init"), encoding="utf-8")
    assert answer("check", "a.md", "--claims", "claims.toml")
    (tmp_path / "a.md").write_text("RK4: q = 0.877614\n", encoding="utf-8")
    assert run("render", "a.md.j2", "--check")[0] == run("check", "a.md", "--claims", "claims.toml")[0] == 1


def test_texts_with_claims_beside_them_are_held_in_one_call(answer, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a.md", "part/b.tex"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("RK4 needs h at most 2.828.\n", encoding="utf-8")
        (tmp_path / f"{name}.claims.toml").write_text(answer("check", name, "--init"), encoding="utf-8")
    (tmp_path / "none.md").write_text("7\n", encoding="utf-8")
    held = answer("check", ".")
    assert [line for line in held.splitlines() if "claim" in line] == [
        "a.md: 1 claim, all hold",
        "part/b.tex: 1 claim, all hold",
    ]
    assert answer("check", "a.md", "part") == held
    assert check("a.md").passed
    (tmp_path / "part" / "b.tex").write_text("RK4 needs h at most 2.829.\n", encoding="utf-8")
    status, out, _ = run("check", ".", "--format", "json")
    assert (status, [report["passed"] for report in json.loads(out)]) == (1, [True, False])
    (tmp_path / "a.md.claims.toml").write_text('claim = [{ id = "a", phrase = "{value}", value = "order rk44" }]')
    status, out, _ = run("check", ".")
    assert (status, out.count("1 refuted")) == (2, 1)
    assert "not checked: a.md.claims.toml: claim 'a': 'order rk44', column 7: unknown method 'rk44'" in out
    first, second = json.loads(run("check", ".", "--format", "json")[1])
    assert (first["error"][:17], len(second["findings"])) == ("a.md.claims.toml:", 1)
    assert "::error file=a.md::a.md.claims.toml: claim 'a'" in run("check", ".", "--format", "github")[1]
    assert "driftproof check: a.md.claims.toml: claim 'a'" in run("check", "a.md")[2]


FILES = {
    "rk.toml": 'family = "runge_kutta"\nA = [[0, 0], ["1/2", 0]]\nb = [0, 1]',
    "docs/rk.toml": 'family = "runge_kutta"\nA = [[0]]\nb = [1]',
    "docs/y.toml": 'rates = ["-y0"]\nstart = [1]',
    "docs/a.md": "The order is 1, and y is 1/2.",
    "docs/a.md.claims.toml": """claim = [{ id = "a", phrase = "The order is {value}", value = "order rk.toml" },
        { id = "b", phrase = "y is {value}", value = "run rk.toml problem=y.toml h=1/2 N=1 : y0", exact = true }]""",
    "docs/t.md.j2": '{{ value("order rk.toml") }}',
    "alone/t.md.j2": '{{ value("order rk.toml") }}',
}


def test_files_that_a_text_names_are_looked_for_beside_it_and_then_in_the_working_directory(
    answer, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    assert "2 claims, all hold" in answer("check", ".")
    assert "2 claims, all hold" in answer("check", "docs/a.md", "--claims", "docs/a.md.claims.toml")
    for folder, order in (("docs", "1"), ("alone", "2")):
        answer("render", f"{folder}/t.md.j2")
        assert (tmp_path / folder / "t.md").read_text() == order
