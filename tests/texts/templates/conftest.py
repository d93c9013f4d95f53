"""Templates rendered in this process."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from driftproof.texts.templates.template import Template
from driftproof.texts.templates.text_kinds import MARKDOWN, TextKind


@pytest.fixture
def become(tmp_path: Path) -> Callable[..., str]:
    """become(template, kind): the text; further templates beside it as keywords, dots in their names as underscores."""

    def render(template: str, kind: TextKind = MARKDOWN, style: str | None = None, **beside: str) -> str:
        (tmp_path / "t.j2").write_text(template, encoding="utf-8", newline="")
        for name, text in beside.items():
            (tmp_path / name.replace("_", ".")).write_text(text, encoding="utf-8")
        return Template(tmp_path / "t.j2", kind, style, None).text()

    return render
