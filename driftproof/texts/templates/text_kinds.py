"""The kinds of text that templates render: suffixes, default style, escaping and tables."""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

CellRows: TypeAlias = Sequence[Sequence[str]]

# Bytes of a template: more than any text that people read.
LARGEST_TEMPLATE = 10**7
_MARKUP = re.compile(r"[\\`*_\[\]<>|&]")
_FENCE = re.compile(r" {0,3}(`{3,}|~{3,})")
_ESCAPES = str.maketrans({c: rf"\{c}" for c in "_#&%${}"} | {"^": r"\^{}", "~": r"\~{}", "\\": r"\textbackslash{}"})


@dataclass(frozen=True)
class TextKind:
    """A kind of text: its name, the suffixes of its files, and its default style.

    `escape` escapes the markup in words; `table` formats rows of cells that are escaped already, the header first.
    """

    name: str
    suffixes: tuple[str, ...]
    style: str
    escape: Callable[[str], str]
    table: Callable[[CellRows], str]


def kind_of(path: Path) -> TextKind:
    """The kind of text of a file, by its suffix. Raises ValueError for other suffixes."""
    for kind in TEXT_KINDS:
        if path.suffix.lower() in kind.suffixes:
            return kind
    allowed = ", ".join(suffix for kind in TEXT_KINDS for suffix in kind.suffixes)
    raise ValueError(f"{path}: the name of the rendered file must end in one of {allowed}")


def _markdown_table(rows: CellRows) -> str:
    header, *body = rows
    rule = ["---", *("---:" for _ in header[1:])]
    return "\n".join(f"| {' | '.join(row)} |" for row in (header, rule, *body))


def _html_table(rows: CellRows) -> str:
    head = "".join(f"<th>{cell}</th>" for cell in rows[0])
    lines = (f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows[1:])
    return "\n".join(["<table>", f"<thead><tr>{head}</tr></thead>", "<tbody>", *lines, "</tbody>", "</table>"])


def _tex_table(rows: CellRows) -> str:
    header, *body = [f"{' & '.join(row)} \\\\" for row in rows]
    columns = "l" + "r" * len(rows[0][1:])
    return "\n".join([f"\\begin{{tabular}}{{{columns}}}", header, r"\hline", *body, r"\end{tabular}"])


MARKDOWN = TextKind(
    "Markdown", (".md", ".markdown", ".myst"), "plain", lambda text: _MARKUP.sub(r"\\\g<0>", text), _markdown_table
)
HTML = TextKind("HTML", (".html", ".htm"), "plain", html.escape, _html_table)
LATEX = TextKind("TeX", (".tex",), "printed", lambda text: text.translate(_ESCAPES), _tex_table)
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
