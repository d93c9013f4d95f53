"""`driftproof render` and `check`: options that contradict each other, and texts that are not there, in one line."""

import pytest

REFUSED = {
    ("render", "none.md.j2"): "none.md.j2: No such file or directory",
    ("render", "a.html"): "a.html: the name does not end in .j2; name the output with -o",
    ("render", "a.md", "-o", "a.md"): "a.md is already a template or an output here; name another with -o",
    ("render", "a.md.j2", "b.md.j2", "-o", "c.md"): "--output names one file, and there are several templates",
    ("render", "a.md.j2", "a.md.j2"): "a.md is already a template or an output here; name another with -o",
    ("check", "none.md"): "where there are none yet, draft them with: driftproof check none.md --init > claims.toml",
    ("check", "none.md", "--init"): "none.md: No such file or directory",
    ("check", "none.md", "--init", "--claims", "x.toml"): "not allowed with argument --init",
    ("check", "none.md", "--init", "--run"): "--init drafts claims; --run, --coverage and --format need --claims",
    ("check", "none.md", "--claims", "none.toml"): "none.toml: No such file or directory",
    ("check", "none.md", "--claims", "README.md"): "README.md: not TOML",
    ("check", "..", "--init"): "Is a directory",
    ("check", "README.md", "--claims", "c.toml", "--time-limit", "0"): "is no time limit",
    ("check", "README.md", "--claims", "c.toml", "--format", "xml"): "invalid choice",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)


def test_numbers_are_rendered_then_drafted_as_claims_that_hold(answer, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.md.j2").write_text('q = {{ value("rk4.first_step.q") | digits(6) }}\n', encoding="utf-8")
    assert answer("render", "a.md.j2") == "a.md: 1 values\n"
    assert answer("render", "a.md.j2", "--check") == "a.md is what a.md.j2 renders\n"
    (tmp_path / "claims.toml").write_text(answer("check", "a.md", "--init"), encoding="utf-8")
    assert answer("check", "a.md", "--claims", "claims.toml")
    (tmp_path / "a.md").write_text("q = 0.877614\n", encoding="utf-8")
    assert run("render", "a.md.j2", "--check")[0] == run("check", "a.md", "--claims", "claims.toml")[0] == 1
