"""The kinds of text that templates render: suffixes, default style and escaping."""

from __future__ import annotations

import html
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

# Bytes of a template: more than any text that people read.
LARGEST_TEMPLATE = 10**7
_MARKUP = re.compile(r"[\\`*_\[\]<>|&]")
_FENCE = re.compile(r" {0,3}(`{3,}|~{3,})")
_ESCAPES = str.maketrans({c: rf"\{c}" for c in "_#&%${}"} | {"^": r"\^{}", "~": r"\~{}", "\\": r"\textbackslash{}"})


@dataclass(frozen=True)
class TextKind:
    """A kind of text: its name, the suffixes of its files, its default style, and how markup in words is escaped."""

    name: str
    suffixes: tuple[str, ...]
    style: str
    escape: Callable[[str], str]


def kind_of(path: Path) -> TextKind:
    """The kind of text of a file, by its suffix. Raises ValueError for other suffixes."""
    for kind in TEXT_KINDS:
        if path.suffix.lower() in kind.suffixes:
            return kind
    allowed = ", ".join(suffix for kind in TEXT_KINDS for suffix in kind.suffixes)
    raise ValueError(f"{path}: the name of the rendered file must end in one of {allowed}")


MARKDOWN = TextKind("Markdown", (".md", ".markdown", ".myst"), "plain", lambda text: _MARKUP.sub(r"\\\g<0>", text))
HTML = TextKind("HTML", (".html", ".htm"), "plain", html.escape)
LATEX = TextKind("TeX", (".tex",), "printed", lambda text: text.translate(_ESCAPES))
TEXT_KINDS = (MARKDOWN, HTML, LATEX)


def is_code(source: str, offset: int) -> bool:
    """True if the character at `offset` of a Markdown text lies in a code span or a fenced block.

    A span must lie on one line: an odd number of backticks before the character and at least one after it.
    """
    (*lines, before), fence = source[:offset].split("\n"), ""
    for line in lines:
        marks = _FENCE.match(line)
        if marks and not fence:
            fence = marks[1]
        elif marks and marks[1].startswith(fence) and not line.strip(" `~"):
            fence = ""
    after = source[offset:].partition("\n")[0]
    return bool(fence) or (before.count("`") % 2 == 1 and "`" in after)
