"""Jupyter notebooks: Markdown cells, code and its output, each character with its place in the file."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator

from driftproof.texts.readers.html import html_blocks
from driftproof.texts.readers.markdown import markdown_blocks
from driftproof.texts.readers.source_text import LISTING, OUTPUT, Block, SourceText, joined

_TOKEN = re.compile(r'"(?P<string>(?:[^"\\]++|\\.)*+)"|(?P<open>[\[{])|(?P<close>[\]}])|(?P<comma>,)|(?P<colon>:)')
_ESCAPE = re.compile(r"\\(?:u[dD][89abAB]\w\w\\u\w{4}|u\w{4}|.)")
# A line of a JSON string, with the escape that ends it.
_LINE = re.compile(r"(?:[^\\]|\\[^n])++(?:\\n)?|\\n")
_LONE_SURROGATE = re.compile("[\ud800-\udfff]")
# The keys of a cell that hold text; pictures are ignored.
_READ = ("cell_type", "source", "text", "text/plain", "text/html")
Key = str | int


def notebook_blocks(source: SourceText) -> list[Block]:
    """The blocks of the cells in order. Raises ValueError, with one line, if the source is not a notebook."""
    language = _checked(source.text)
    cells: dict[int, dict[tuple[Key, ...], list[SourceText]]] = {}
    for path, string in _strings(source):
        if len(path) > 2 and path[0] == "cells" and isinstance(path[1], int):
            last = path[:-1] if isinstance(path[-1], int) else path  # without the number of the line
            if last[-1] in _READ:
                cells.setdefault(path[1], {}).setdefault(last[2:], []).append(_decoded(string))
    blocks: list[Block] = []
    for cell in cells.values():
        kind, code = joined(cell.get(("cell_type",), [])).text, joined(cell.get(("source",), []))
        blocks += [Block(LISTING, code, language), *_outputs(cell)] if kind == "code" else []
        blocks += markdown_blocks(code) if kind == "markdown" else []
    return blocks


def lines_of_cells(source: str) -> list[tuple[int, str]]:
    """The lines of all cells and outputs of a notebook: where each begins in the file, and which line of which cell."""
    found, lines = list[tuple[int, str]](), Counter[tuple[Key, ...]]()
    for path, string in _strings(SourceText.of(source)):
        of = path[:-1] if isinstance(path[-1], int) else path
        if len(of) > 2 and of[0] == "cells" and isinstance(of[1], int) and of[-1] in _READ[1:]:
            for line in _LINE.finditer(string.text):
                lines[of] += 1
                of_output = " of its output" * (of[2] == "outputs")
                found.append((string.origin(line.start()), f"cell {of[1] + 1}, line {lines[of]}{of_output}"))
    return sorted(found)


def _checked(text: str) -> str:
    """Check that the text is a notebook, else raise ValueError; return the language of its code, by default Python."""
    try:
        content = json.loads(text)
    except RecursionError:
        raise ValueError("it is nested too deeply for a notebook") from None
    except ValueError as error:
        raise ValueError(f"it is not a notebook: {error}") from None
    if not isinstance(content, dict) or not isinstance(content.get("cells"), list):
        raise ValueError('it is not a notebook: a notebook is a JSON object with a list "cells" (nbformat 4)')
    metadata = content.get("metadata")
    for place, key in (("language_info", "name"), ("kernelspec", "language")):
        info = metadata.get(place) if isinstance(metadata, dict) else None
        if isinstance(info, dict) and isinstance(info.get(key), str):
            return str(info[key]).lower()
    return "python"


def _strings(source: SourceText) -> Iterator[tuple[tuple[Key, ...], SourceText]]:
    """Every string value of a valid JSON text, escapes not decoded, after the path of keys and indices to it."""
    path: list[Key] = []
    pending: SourceText | None = None  # a string that is a key if a colon follows
    for match in _TOKEN.finditer(source.text):
        if match["colon"] and pending is not None:
            path[-1] = _decoded(pending).text
            pending = None
        if pending is not None:
            yield tuple(path), pending
            pending = None
        if match["string"] is not None:
            pending = source[match.start("string") : match.end("string")]
        elif match["open"]:
            path.append(0 if match["open"] == "[" else "")
        elif match["close"]:
            path.pop()
        elif match["comma"] and isinstance(path[-1], int):
            path[-1] += 1


def _decoded(string: SourceText) -> SourceText:
    """A JSON string with its escapes decoded; half of a surrogate pair becomes U+FFFD."""
    return string.rewritten(_ESCAPE, lambda match: [_LONE_SURROGATE.sub("\ufffd", json.loads(f'"{match[0]}"'))])


def _outputs(cell: dict[tuple[Key, ...], list[SourceText]]) -> Iterator[Block]:
    """The printed output and the results of a cell; results as plain text if available, else as HTML."""
    shown = {path[1] for path in cell if path[0] == "outputs" and path[-1] == "text/plain"}
    for path, strings in cell.items():
        if path[0] != "outputs":
            continue
        if path[2:] == ("text",) or path[2:] == ("data", "text/plain"):
            yield Block(OUTPUT, joined(strings))
        elif path[2:] == ("data", "text/html") and path[1] not in shown:
            yield from html_blocks(joined(strings))
