"""Helpers that start fresh interpreters."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


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
