"""HTML, written out: text that can close no tag, elements, tables, and content that is folded away."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape

# Characters that HTML does not allow, but that the name of a scene may have.
_FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
# Elements of HTML without an end tag.
_VOID = {"input"}


def escaped(content: object) -> str:
    """The content as text of HTML or of an attribute: it can close no tag and no quotation mark."""
    return escape(_FORBIDDEN.sub("\ufffd", str(content)))


def element(name: str, /, *children: str, **attributes: object) -> str:
    """<name key="value">children</name>; underscores in keys become hyphens, a last one is dropped, as in class_.

    Attributes that are None are left out. Children are markup: text goes through `escaped` first.
    """
    given = {key.rstrip("_").replace("_", "-"): value for key, value in attributes.items() if value is not None}
    written = "".join(f' {key}="{escaped(value)}"' for key, value in given.items())
    return f"<{name}{written}>" if name in _VOID else f"<{name}{written}>{''.join(children)}</{name}>"


def html_table(rows: Sequence[Sequence[str]], title: str, class_: str | None = None) -> str:
    """A table with a header row, in a container that scrolls if it is too wide; the first column names the rows.

    Empty cells are covered by the cell before them.
    """
    header, *body = rows
    head = element("tr", *(element("th", escaped(cell), scope="col") for cell in header))
    return element(
        "div",
        element(
            "table",
            element("caption", escaped(title)),
            element("thead", head),
            element("tbody", *(element("tr", *_cells(row)) for row in body)),
        ),
        class_=f"scroll {class_}" if class_ else "scroll",
        tabindex=0,
        role="region",
        aria_label=title,
    )


def _cells(row: Sequence[str]) -> list[str]:
    first, *others = row
    cells = [element("th", escaped(first), scope="row")]
    for i, cell in enumerate(others):
        empty = next((k for k, later in enumerate(others[i + 1 :]) if later), len(others) - i - 1)
        if cell:
            cells.append(element("td", escaped(cell), colspan=empty + 1 if empty else None))
    return cells


def details(summary: str, content: str) -> str:
    """A summary line, under which the content is folded away until a reader opens it."""
    return element("details", element("summary", escaped(summary)), content)
