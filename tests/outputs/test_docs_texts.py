"""docs/texts.md is true: run in an empty folder, in order, as it stands."""

import re
import shlex
from pathlib import Path

import pytest

from driftproof.cli import main
from driftproof.texts.templates.template import Template
from driftproof.texts.templates.text_kinds import MARKDOWN
from tests.looping import exactly

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "texts.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)


@pytest.fixture
def printed(tmp_path, monkeypatch, capsys):
    """printed(command): what a command of the page prints in an empty folder, or writes where it says > FILE."""
    monkeypatch.chdir(tmp_path)

    def run(command):
        words, _, target = command.partition(" > ")
        err, (program, *arguments) = "", shlex.split(words)
        if program == "driftproof":
            assert main(arguments) in (0, 1)
            out, err = capsys.readouterr()
        else:
            programs = {
                "cat": Path.read_text,
                "sed": lambda _: sed(*arguments),
                "tail": lambda path: tail(path, arguments),
            }
            out = programs[program](Path(arguments[-1]))
        if target:
            Path(target).write_text(out, encoding="utf-8")
        return err if target else err + out

    return run


def tail(path, arguments):
    """tail -N FILE."""
    return "".join(path.read_text(encoding="utf-8").splitlines(keepends=True)[int(arguments[0]) :])


def sed(option, command, file):
    """sed -i s/OLD/NEW/ FILE."""
    assert option == "-i"
    _, old, new, _ = command.split("/")
    text = Path(file).read_text(encoding="utf-8")
    assert text.count(old) == 1
    Path(file).write_text(text.replace(old, new), encoding="utf-8")
    return ""


def sessions(page):
    """(command, output) of every console block."""
    blocks = [text for kind, text in BLOCK.findall(page) if kind == "console"]
    return [match for text in blocks for match in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", text, re.MULTILINE)]


@pytest.mark.slow
def test_page_shows_what_its_commands_print(printed, tmp_path):
    template = next(text for kind, text in BLOCK.findall(PAGE) if kind == "jinja")
    (tmp_path / "lesson.md.j2").write_text(template, encoding="utf-8")
    for name, content in exactly(6, re.findall(r"`(\w+[.]\w+)`[^`\n]*:\n\n```\w+\n(.*?)```", PAGE, re.DOTALL)):
        (tmp_path / name).write_text(content, encoding="utf-8")
    for command, shown in exactly(23, sessions(PAGE)):
        assert printed(command) == shown, command


def rendered(template, folder):
    (folder / "page.md.j2").write_text(template, encoding="utf-8")
    return Template(folder / "page.md.j2", MARKDOWN, None, None).text()


def test_filters_do_what_the_table_of_the_page_says(tmp_path):
    rows = re.findall(r"^\| `(\{\{.*?\}\})` \| (.*?) \|", PAGE, re.MULTILINE)
    assert len(rows) == 7
    for asked, shown in rows:
        assert rendered(asked.replace(r"\|", "|"), tmp_path) == shown.strip("`"), asked


def test_table_of_methods_is_as_the_page_shows_it(tmp_path):
    _, template = [text for kind, text in BLOCK.findall(PAGE) if kind == "jinja"]
    shown = next(text for kind, text in BLOCK.findall(PAGE) if kind == "markdown")
    assert rendered(template, tmp_path) == shown


def test_hooks_are_commands_that_the_page_names():
    hooks = (ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
    names = re.findall(r"^- id: (.*)$", hooks, re.MULTILINE)
    assert [f"driftproof {entry}" for entry in re.findall(r"^  entry: driftproof (.*)$", hooks, re.MULTILINE)] == [
        "driftproof render --check",
        "driftproof check",
    ]
    assert all(f"      - id: {name}\n" in PAGE for name in names)
    dependencies = re.findall(r"^  additional_dependencies: (\S+)", hooks, re.MULTILINE)
    assert dependencies == ["&same", "*same"], "or pre-commit makes two environments"
