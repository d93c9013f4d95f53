"""What several test files ask for: the command line, and fresh interpreters."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from driftproof.cli import main
from driftproof.commands.listing import ALIASES, COMMANDS

ROOT = Path(__file__).parents[1]


@pytest.fixture(autouse=True, scope="session")
def cache_of_tests(tmp_path_factory: pytest.TempPathFactory) -> None:
    """What is enclosed is kept in a folder of this session only."""
    os.environ["XDG_CACHE_HOME"] = str(tmp_path_factory.mktemp("cache"))


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """run(*arguments): exit status, standard output and standard error of `driftproof` with these arguments."""

    def call(*arguments: str) -> tuple[int, str, str]:
        try:
            status = main(arguments)
        except SystemExit as stopped:  # argparse leaves this way
            status = int(stopped.code or 0)
        out, err = capsys.readouterr()
        return status, out, err

    return call


@pytest.fixture
def answer(run: Callable[..., tuple[int, str, str]]) -> Callable[..., str]:
    """answer(*arguments): standard output of a question that is answered, which is silent on standard error."""

    def call(*arguments: str) -> str:
        status, out, err = run(*arguments)
        assert (status, err) == (0, "")
        return out

    return call


@pytest.fixture
def refusal(run: Callable[..., tuple[int, str, str]]) -> Callable[..., str]:
    """refusal(*arguments): the one line on standard error of a question that makes no sense; exit status 2."""

    def call(*arguments: str) -> str:
        status, out, err = run(*arguments)
        assert (status, out) == (2, "")
        known = {*arguments[:1]} & {*COMMANDS, *ALIASES}
        assert err.startswith(f"driftproof {arguments[0]}: " if known else "driftproof: ")
        assert err.count("\n") == 1
        assert err.endswith("\n")
        assert len(err) < 1000
        return err

    return call


@pytest.fixture
def fresh_python() -> Callable[[str], str]:
    """fresh_python(code): what `code` prints in a new interpreter at the root; fails if it exits with an error."""

    def run(code: str) -> str:
        done = subprocess.run(
            [sys.executable, "-W", "error", "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    return run


@pytest.fixture
def modules_after(fresh_python: Callable[[str], str]) -> Callable[[str], set[str]]:
    """modules_after(code): the names in sys.modules of a new interpreter that has run `code` in silence."""
    return lambda code: set(
        fresh_python(
            f"import contextlib, io, sys\nwith contextlib.redirect_stdout(io.StringIO()):\n    {code}\n"
            "print('\\n'.join(list(sys.modules)))"
        ).splitlines()
    )
