"""The kinds of text that are rendered: how each writes a number, a word that is no markup, and a table."""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from driftproof.texts.questions.style import PLAIN, PRINTED

STYLES = {"plain": PLAIN, "printed": PRINTED}
Rows = Sequence[Sequence[str]]

_MARKDOWN = re.compile(r"[\\`*_\[\]<>|&]")
_TEX = str.maketrans({c: rf"\{c}" for c in "_#&%${}"} | {"^": r"\^{}", "~": r"\~{}", "\\": r"\textbackslash{}"})


@dataclass(frozen=True)
class Kind:
    """A kind of text: its name, the suffixes of its files, and its style where a template names none.

    `escape` writes words so that none of them is markup; `table` takes rows of cells that are written already, the
    header first.
    """

    name: str
    suffixes: tuple[str, ...]
    style: str
    escape: Callable[[str], str]
    table: Callable[[Rows], str]


def kind_of(path: Path) -> Kind:
    """The kind of text that a file of this name holds. Raises ValueError for other names."""
    for kind in KINDS:
        if path.suffix.lower() in kind.suffixes:
            return kind
    allowed = ", ".join(suffix for kind in KINDS for suffix in kind.suffixes)
    raise ValueError(f"{path}: what is rendered has a name that ends in one of {allowed}")


def _markdown_table(rows: Rows) -> str:
    header, *body = rows
    rule = ["---", *["---:"] * (len(header) - 1)]
    return "\n".join(f"| {' | '.join(row)} |" for row in (header, rule, *body))


def _html_table(rows: Rows) -> str:
    header, *body = rows
    head = "".join(f"<th>{cell}</th>" for cell in header)
    lines = (f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in body)
    return "\n".join(["<table>", f"<thead><tr>{head}</tr></thead>", "<tbody>", *lines, "</tbody>", "</table>"])


def _tex_table(rows: Rows) -> str:
    header, *body = [f"{' & '.join(row)} \\\\" for row in rows]
    columns = "l" + "r" * (len(rows[0]) - 1)
    return "\n".join([f"\\begin{{tabular}}{{{columns}}}", header, r"\hline", *body, r"\end{tabular}"])


MARKDOWN = Kind(
    "Markdown",
    (".md", ".markdown", ".myst"),
    "plain",
    lambda text: _MARKDOWN.sub(r"\\\g<0>", text),
    _markdown_table,
)
HTML = Kind("HTML", (".html", ".htm"), "plain", html.escape, _html_table)
TEX = Kind("TeX", (".tex",), "printed", lambda text: text.translate(_TEX), _tex_table)
KINDS = (MARKDOWN, HTML, TEX)


def is_code(source: str, offset: int) -> bool:
    """True if the character of a Markdown text stands in a code span or a fenced block, where nothing is escaped.

    A span is looked for on the character's own line: an odd number of backticks before it and one after it.
    """
    fence = ""
    for line in source[: source.rfind("\n", 0, offset) + 1].splitlines():
        marks = _FENCE.match(line)
        if marks and not fence:
            fence = marks[1]
        elif marks and marks[1].startswith(fence) and not line.strip(" `~"):
            fence = ""
    end = source.find("\n", offset)
    before = source[source.rfind("\n", 0, offset) + 1 : offset]
    return bool(fence) or (before.count("`") % 2 == 1 and "`" in source[offset : end if end >= 0 else None])


_FENCE = re.compile(r" {0,3}(`{3,}|~{3,})")
