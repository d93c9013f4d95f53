"""Templates rendered in this process, for several test files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from driftproof.texts.templates.child import Rendering
from driftproof.texts.templates.kinds import MARKDOWN, Kind

Become = Callable[..., str]


def become_in(folder: Path) -> Become:
    """become(template, kind): the text; further templates beside it as keywords, dots in their names as underscores."""

    def render(template: str, kind: Kind = MARKDOWN, style: str | None = None, **beside: str) -> str:
        (folder / "t.j2").write_text(template, encoding="utf-8", newline="")
        for name, text in beside.items():
            (folder / name.replace("_", ".")).write_text(text, encoding="utf-8")
        return Rendering(folder / "t.j2", kind, style, None).text()

    return render
