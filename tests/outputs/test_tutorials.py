"""The tutorials are true: each is run in an empty folder with the installed wheel, and says what it said."""

import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from docs.pages import COMMAND, TUTORIALS, journey
from tests.looping import some

ROOT = Path(__file__).parents[2]
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in TUTORIALS if "```console" in path.read_text()}


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """A virtual environment with the wheel in it; what the wheel needs comes from this one."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    subprocess.run(build, check=True, capture_output=True)
    subprocess.run([sys.executable, "-m", "venv", str(folder / "venv")], check=True)
    python = folder / "venv" / "bin" / "python"
    install = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-index", *map(str, folder.glob("*.whl"))]
    subprocess.run([python, *install], check=True, capture_output=True)
    ours = subprocess.run(
        [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
        check=True,
        capture_output=True,
        text=True,
    )
    Path(ours.stdout.strip(), "needs.pth").write_text(sysconfig.get_path("purelib"))
    return python.parent


@pytest.mark.parametrize("name", PAGES)
def test_a_tutorial_says_what_its_commands_say(name, programs, tmp_path):
    assert journey(PAGES[name], tmp_path, programs) == PAGES[name], "run `make docs`"


def test_every_command_of_a_tutorial_answers():
    shown = [(name, line) for name, page in PAGES.items() for line in page.splitlines()]
    assert len([line for _, line in shown if COMMAND.match(line)]) >= 20
    assert [pair for pair in some(shown) if "Traceback" in pair[1] or "unrecognized arguments" in pair[1]] == []


def test_a_wrong_line_is_noticed(programs, tmp_path):
    page = "This is `a.txt`:\n\n```text\none\n```\n\n```console\n$ cat a.txt\ntwo\n$ driftproof --version\n"
    page += "$ head -c 2 a.txt\n```\n"
    told = journey(page, tmp_path, programs)
    assert "$ cat a.txt\none\n\n$ driftproof --version\ndriftproof " in told
    assert told.endswith("$ head -c 2 a.txt\non\n```\n")  # a line cut off does not take the fence with it
