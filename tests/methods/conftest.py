"""Files of users' methods, and how the reader refuses them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from driftproof.methods.schemes import MethodError
from driftproof.methods.tableau_file import read_method

Write = Callable[[str | bytes], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """mine.toml of this content."""

    def writing(text: str | bytes) -> Path:
        path = tmp_path / "mine.toml"
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return writing


@pytest.fixture
def refusal(write: Write) -> Callable[[str | bytes], str]:
    """The one line in which such a file is refused, less its name, with which it begins."""

    def refused(text: str | bytes) -> str:
        path = write(text)
        with pytest.raises(MethodError) as caught:
            read_method(path)
        line = str(caught.value)
        assert line.startswith(f"{path}: ")
        assert "\n" not in line
        assert len(line) < 400
        return line.removeprefix(f"{path}: ")

    return refused
