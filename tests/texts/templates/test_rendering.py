"""`driftproof render`: files written whole or not at all, --check with a diff, and bounds on memory and time."""

import json
import sys
from pathlib import Path

import pytest

from driftproof.commands.arguments import BAD_INPUT, REFUTED
from driftproof.support.processes import Limits, ProcessEnded
from driftproof.texts.templates import rendering


@pytest.fixture
def lesson(tmp_path, monkeypatch):
    """lesson.md.j2 in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = Path("lesson.md.j2")
    path.write_text('q = {{ value("rk4.first_step.q") | digits(6) }}\nv\n', encoding="utf-8")
    return path


@pytest.mark.slow
def test_check_passes_what_was_rendered_and_shows_what_was_changed(lesson, run):
    status, out, _ = run("render", "lesson.md.j2", "--check")
    assert status == REFUTED
    assert out.startswith("--- lesson.md (does not exist)\n+++ lesson.md as lesson.md.j2 renders it\n")
    assert run("render", "lesson.md.j2") == (0, "lesson.md: 1 value\n", "")
    assert run("render", "lesson.md.j2", "--check") == (0, "lesson.md is up to date with lesson.md.j2\n", "")
    text = Path("lesson.md").read_text(encoding="utf-8")
    assert text == "q = 0.877604\nv\n"
    found = rendering.RenderedText(text, 1, lesson, Path("lesson.md"))
    assert json.loads(found.written("json")) == {"output": "lesson.md", "values": 1, "text": text}
    for place, character in enumerate(text):
        if character.isdigit():
            changed = text[:place] + str((int(character) + 1) % 10) + text[place + 1 :]
            assert rendering.RenderedText(changed, 1, lesson, Path("lesson.md")).difference()
    Path("lesson.md").write_text("q = 0.877614\nv", encoding="utf-8")
    out = "--- lesson.md\n+++ lesson.md as lesson.md.j2 renders it\n@@ -1,2 +1,2 @@\n-q = 0.877614\n-v\n"
    out += "\\ no end of line\n+q = 0.877604\n+v\n"
    assert run("render", "lesson.md.j2", "--check") == (REFUTED, out, "")
    for lines in (2, 0):
        assert run("render", "lesson.md.j2") == (0, f"lesson.md: 1 value, {lines} of its lines changed\n", "")


def test_template_runs_no_code_that_a_problem_names(lesson, run):
    Path("mine.toml").write_text('function = "os:abort"\nstart = ["1"]\n', encoding="utf-8")
    lesson.write_text("{{ value('step rk4 problem=mine.toml h=1 : y0') }}", encoding="utf-8")
    status, _, told = run("render", "lesson.md.j2")
    assert (status, "function 'os:abort' is Python code, which templates do not run" in told) == (BAD_INPUT, True)


def test_nothing_is_written_where_a_template_has_a_problem(lesson, run):
    Path("lesson.md").write_text("before", encoding="utf-8")
    Path("good.md.j2").write_text("x", encoding="utf-8")
    lesson.write_text("{{ nope }}", encoding="utf-8")
    status, out, err = run("render", "good.md.j2", "lesson.md.j2")
    assert (status, out) == (BAD_INPUT, "")
    assert err == "driftproof render: lesson.md.j2, line 1, column 4: 'nope' is undefined\n"
    assert sorted(path.name for path in Path().iterdir()) == ["good.md.j2", "lesson.md", "lesson.md.j2"]
    assert Path("lesson.md").read_text(encoding="utf-8") == "before"


@pytest.mark.slow
def test_ends_of_lines_are_those_of_the_template(lesson, run):
    lesson.write_bytes(b"a\r\n{{ value('order rk4') }}\n\r\n")
    assert run("render", "lesson.md.j2", "-o", "out.md")[0] == 0
    written = Path("out.md").read_bytes()
    assert written.count(b"\r\n") == written.count(b"\n") == 3
    assert run("render", "lesson.md.j2", "-o", "out.md", "--check")[0] == 0


def test_a_template_of_returns_alone_has_line_feeds(lesson, run):
    lesson.write_bytes(b"a\rb\r")
    assert run("render", "lesson.md.j2", "-o", "out.md")[0] == 0
    assert Path("out.md").read_bytes() == b"a\nb\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("lesson.md.j2", "-o", "lesson.txt"), "lesson.txt: the name of the rendered file must end in one of .md"),
        (("lesson.md.j2", "a.md.j2", "-o", "b.md"), "one by one"),
        (("link.md", "-o", "lesson.md"), "templates or outputs already"),
        (("latin.md.j2",), "not UTF-8 at byte 1"),
        (("lesson.md.j2", "--style", "fancy"), "invalid choice: 'fancy'"),
        (("folder.md.j2",), "folder.md.j2: Is a directory"),
    ],
)
def test_bad_arguments_are_one_line(arguments, message, lesson, run):
    Path("latin.md.j2").write_bytes(b"a\xe9")
    Path("link.md").write_text("x", encoding="utf-8")
    Path("folder.md.j2").mkdir()
    if arguments[0] == "link.md":
        Path("lesson.md").symlink_to("link.md")
    status, out, err = run("render", *arguments)
    assert (status, out, err.count("\n")) == (BAD_INPUT, "", 1)
    assert message in err


@pytest.mark.slow
def test_memory_and_time_of_a_template_are_bounded(lesson, monkeypatch):
    monkeypatch.setattr(rendering, "RENDERING_MEMORY", 6 * 10**8)
    lesson.write_text("{% set n = namespace(s='aaaa') %}{% for i in range(60) %}{% set n.s = n.s ~ n.s %}{% endfor %}")
    with pytest.raises(
        ValueError, match=r"lesson.md.j2, line 1, column \d+: the template needs more memory than is allowed"
    ):
        rendering.render(lesson, Path("lesson.md"))
    loops = [f"{{% for {name} in range(9999) %}}" for name in "abc"]
    lesson.write_text("".join(loops) + "{% endfor %}" * 3)
    with pytest.raises(ValueError, match=r"lesson.md.j2: not rendered within 0.5 s; a loop or a question takes"):
        rendering.render(lesson, Path("lesson.md"), time_limit=0.5)


def test_process_that_dies_or_writes_too_much_is_reported_in_one_line(lesson, monkeypatch):
    monkeypatch.setattr(rendering, "LONGEST_RENDERED", 1000)
    lesson.write_text("{% for i in range(2000) %}x{% endfor %}")
    with pytest.raises(ValueError, match=r"^lesson\.md\.j2: an answer of more than 1000 bytes$"):
        rendering.render(lesson, Path("lesson.md"))

    def dies(*_):
        raise ProcessEnded("signal", "the process ended (signal 11, SIGSEGV)")

    monkeypatch.setattr(rendering, "ask_once", dies)
    with pytest.raises(ValueError, match=r"^lesson\.md\.j2: the process ended \(signal 11, SIGSEGV\)$"):
        rendering.render(lesson, Path("lesson.md"))


def test_without_jinja_one_line_says_what_to_install(lesson, run, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    status, out, err = run("render", "lesson.md.j2")
    assert (status, out, "pip install 'driftproof[text]'" in err) == (BAD_INPUT, "", True)


def test_a_template_has_two_minutes_two_gigabytes_and_ten_million_characters(tmp_path, monkeypatch):
    given = []
    answer = {"text": "", "asked": 0}
    monkeypatch.setattr(rendering, "ask_once", lambda what, order, limits: given.append(limits) or answer)
    (tmp_path / "a.md.j2").touch()
    rendering.render(tmp_path / "a.md.j2")
    assert given == [Limits(seconds=120, memory=2_000_000_000, answer=10_000_000)]
