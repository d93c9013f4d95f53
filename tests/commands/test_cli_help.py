"""The help teaches by examples that are answered; the version, and a start that loads nothing heavy."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from driftproof import __version__, cli
from driftproof.texts.values.published import VALUES_FILE

Run = Callable[..., tuple[int, str, str]]

Answer = Callable[..., str]


# What the examples of `identify` and `verify` are about.
MYLIB = {
    "integrators.py": """
def step(q, v, h):
    v = v - h / 2 * q
    q = q + h * v
    return q, v - h / 2 * q

def rk_step(f, t, y, h):
    k1 = f(t, y)
    return y + h * (k1 / 4 + 3 * f(t + 2 * h / 3, y + 2 * h / 3 * k1) / 4)
""",
    "implicit.py": """
def step(q, v, h):
    v = (v - h * q) / (1 + h * h)
    return q + h * v, v
""",
}

# What the claims of `check` are about.
CHAPTER = """5 min read. Then the state is (337/384, −23/48) after one step.
RK4 takes 40 steps of h = 0.25 and is off by 3.3×10⁻⁴ at the end.
"""


def test_commands_are_all_there() -> None:
    assert set(cli.COMMANDS) >= {"methods", "step", "run", "scenes", "scene", "values"}


@pytest.mark.parametrize("command", [(), *((name,) for name in cli.COMMANDS)], ids=" ".join)
def test_help_teaches_by_example(command: tuple[str, ...], answer: Answer) -> None:
    shown = answer(*command, "--help")
    assert f"driftproof {' '.join(command)}".strip() in shown.split("example", 1)[1]


@pytest.mark.parametrize("command", cli.COMMANDS)
def test_examples_in_the_help_are_answered(
    command: str, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    files = (("scene", "mine.toml"), ("facts", "tableau.toml"), ("render", "lesson.md.j2"), ("check", "claims.toml"))
    for of, name in files:
        (tmp_path / name).write_text(help_file(of, name), encoding="utf-8")
    (tmp_path / "chapter.md").write_text(CHAPTER, encoding="utf-8")
    for name in ("old.json", "new.json"):
        (tmp_path / name).write_bytes(VALUES_FILE.read_bytes())
    (tmp_path / "mylib").mkdir()
    for name, text in MYLIB.items():
        (tmp_path / "mylib" / name).write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    shown = [line for line in map(str.strip, help_text(command).splitlines()) if line.startswith("driftproof ")]
    assert shown
    for line in shown:
        words = shlex.split(line.split("      ")[0])[1:]
        assert run(*words)[0] == 0, line


def help_text(command: str) -> str:
    return str(cli.command_named(command).parser(f"driftproof {command}").epilog)


def help_file(command: str, name: str) -> str:
    """The file that the command's --help shows, without its remarks."""
    lines = help_text(command).split(f"{name}:\n")[1].splitlines()
    return "\n".join(line.strip().split("     ")[0] for line in lines)


def test_version_is_the_package_version(answer: Answer) -> None:
    assert answer("--version") == f"driftproof {__version__}\n"


def test_start_of_the_command_line_loads_no_heavy_library(modules_after: Callable[[str], set[str]]) -> None:
    loaded = modules_after("from driftproof.cli import main; main(['scenes'])")
    assert loaded & {"sympy", "flint", "matplotlib", "numpy", "tqdm"} == set()
