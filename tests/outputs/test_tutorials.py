"""The tutorials are true: each is run in an empty folder with the installed wheel, and says what it said."""

import re

import pytest

import driftproof
from docs.pages import COMMAND, TUTORIALS, journey
from tests.looping import exactly, some

PAGES = {path.stem: path.read_text(encoding="utf-8") for path in TUTORIALS if "```console" in path.read_text()}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", PAGES)
def test_a_tutorial_says_what_its_commands_say(name, installed, tmp_path):
    assert journey(PAGES[name], tmp_path, installed.parent) == PAGES[name], "run `make docs`"


def test_every_command_of_a_tutorial_answers():
    shown = [(name, line) for name, page in PAGES.items() for line in page.splitlines()]
    assert len([line for _, line in shown if COMMAND.match(line)]) >= 20
    assert [pair for pair in some(shown) if "Traceback" in pair[1] or "unrecognized arguments" in pair[1]] == []


def test_the_families_of_a_tableau_are_written_as_the_tutorial_says(tmp_path):
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", PAGES["method"], re.MULTILINE)
    orders = {"splitting": 2, "nystrom": 2, "collocation": 4, "multistep": 2, "rosenbrock": 2, "additive": 1}
    for family, keys in exactly(6, rows):
        (path := tmp_path / "own.toml").write_text(
            "\n".join([f'family = "{family}"', *re.findall("`(.*?=.*?)`", keys)])
        )
        assert driftproof.facts(str(path), only=["order"]).order == orders[family]


def test_a_wrong_line_is_noticed(installed, tmp_path):
    page = "This is `a.txt`:\n\n```text\none\n```\n\n```console\n$ cat a.txt\ntwo\n$ driftproof --version\n"
    page += "$ head -c 2 a.txt\n```\n"
    told = journey(page, tmp_path, installed.parent)
    assert "$ cat a.txt\none\n\n$ driftproof --version\ndriftproof " in told
    assert told.endswith("$ head -c 2 a.txt\non\n```\n")  # a line cut off does not take the fence with it
