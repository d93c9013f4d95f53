"""The base classes of answers, which print as their command does, show as HTML in a notebook, and convert to JSON."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

from driftproof.support.plain_text import Json, as_json


class Printable:
    """An answer that can be written in several forms: "text" is what its command prints, "json" is canonical."""

    def written(self, form: str) -> str:
        """The answer in this form."""
        raise NotImplementedError

    def json(self) -> str:
        """The answer as JSON: keys sorted, numbers as strings."""
        return self.written("json")

    def __str__(self) -> str:
        """The answer as its command prints it."""
        return self.written("text")

    def __repr__(self) -> str:
        """The same text as str(), so that Python's prompt shows it."""
        return str(self)

    def _repr_html_(self) -> str | None:
        return html_of(str(self))


@dataclass(frozen=True, repr=False)
class Answered(Printable):
    """An answer made of `data`, with numbers as strings: answer["h"] is the entry h; `found` holds actual numbers."""

    data: Json
    text: Callable[[Json], str]
    found: Any = None

    def __getitem__(self, name: str) -> Json:
        """The entry `name` of the data."""
        return self.data[name]

    def written(self, form: str) -> str:
        """The answer as "text" or "json"."""
        return as_json(self.data) if form == "json" else self.text(self.data)


def html_of(text: str) -> str:
    """Plain text as HTML: aligned columns become tables, a line above indented lines their heading.

    >>> html_of("  9  1\\n 10  2").replace(' style="text-align: left"', "*")
    '<div><table><tr><td>9</td><td*>1</td></tr><tr><td>10</td><td*>2</td></tr></table></div>'
    """
    blocks = (_block(block.splitlines()) for block in text.split("\n\n"))
    return f"<div>{''.join(blocks)}</div>"


def _block(lines: Sequence[str]) -> str:
    if lines[1:] and not re.search("^ |  ", lines[0]) and all(line.startswith("  ") for line in lines[1:]):
        return f"<p><b>{escape(lines[0])}</b></p>{_block([line[2:] for line in lines[1:]])}"
    if len(lines) < 2:
        return "".join(f"<p>{escape(line)}</p>" for line in lines)
    columns = range(max(map(len, lines)))
    blank = "".join(" " if all(line[i : i + 1] in ("", " ") for line in lines) else "x" for i in columns)
    spans = [match.span() for match in re.finditer(r"x+(?: x+)*", blank)]  # two blanks separate columns
    if len(spans) < 2:
        return f'<p style="white-space:pre-wrap">{escape(chr(10).join(lines))}</p>'
    left = {a for a, b in spans if all(line[a] != " " for line in lines if line[a:b].strip())}  # notebooks align right
    cell = {a: '<td style="text-align: left">' if a in left else "<td>" for a, _ in spans}
    rows = ("".join(f"{cell[a]}{escape(line[a:b].strip())}</td>" for a, b in spans) for line in lines)
    return f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"
