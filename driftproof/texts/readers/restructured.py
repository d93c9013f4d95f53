"""reStructuredText as people see it: no markup, roles and directives as what they are, tables as rows of cells."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from driftproof.texts.readers.columns import CELL
from driftproof.texts.readers.markdown import (
    CELL_OF_LIST,
    DEEPEST,
    MACHINE_DIRECTIVES,
    NO_TITLES,
    SHOWN,
    is_key,
    shielded_in_role,
    unshielded,
)
from driftproof.texts.readers.source_text import LISTING, PROSE, Block, Insertion, SourceText, joined
from driftproof.texts.readers.tex import tex_prose

# Lines that are blank or further in than the first one.
_BODY = r"(?P<{0}>(?:[ \t]*\n|(?P={1})[ \t]+[^\n]*(?:\n|\Z))*)"
_BLOCK = re.compile(
    r"^(?P<indent>[ \t]*)\.\.[ \t]+(?:\|[^|\n]{1,100}\|[ \t]+)?(?:(?P<name>[A-Za-z][\w:+-]*)::)?(?P<argument>[^\n]*)"
    + r"(?:\n|\Z)" + _BODY.format("body", "indent")
    + r"|^(?P<before>[ \t]*+)(?P<ends>[^\n]*?):(?P<colon>:)[ \t]*\n(?=[ \t]*\n)" + _BODY.format("literal", "before")
    + r"|(?P<session>^[ \t]*>>> [^\n]*(?:\n[ \t]*\S[^\n]*)*)",
    re.MULTILINE,
)  # fmt: skip
_OPTIONS = re.compile(r"(?:[ \t]*:[\w-]+:[^\n]*(?:\n|\Z))+")
_PROGRAMS = {
    *("code-block", "code", "sourcecode", "code-cell", "jupyter-execute"),
    *("plot", "ipython", "testcode", "doctest"),
}
_INLINE = re.compile(
    r"``(?P<code>[^\n]{1,500}?)``(?!`)|(?::(?P<role>[A-Za-z][\w:.+-]{0,40}):)?`(?P<text>[^`\n]{1,500}(?:\n[^`\n]{1,500})?)`"
    r"(?::(?P<after>[A-Za-z][\w:.+-]{0,40}):|__?(?!\w))?"
)
_FOOTNOTE = re.compile(r"(?<=\S)[ ]?\[(?:[0-9]+|#\w*|\*|[A-Za-z][\w.:-]*)\]_(?!\w)")
_TITLE_LINE = re.compile(r"""^(?P<sign>[=~^"'`#*+.:_<>-])(?P=sign){2,}[ \t]*$\n?""", re.MULTILINE)
_GRID_LINE = re.compile(r"^[ \t]*\+(?:[-=]+\+)+[ \t]*$\n?", re.MULTILINE)
_BORDER = re.compile(r"[ \t]*(?:={2,}|-{2,})(?: +(?:={2,}|-{2,}))+[ \t]*\n?\Z")
_COLUMN = re.compile("=+|-+")
_STRONG = re.compile(r"(?<![\w*])(\*\*?)(?=\S)(?P<a>[^*\n]{1,500}?)(?<=\S)\1(?![\w*])")
_ESCAPED = re.compile(r"\\(.)")


def restructured_blocks(source: SourceText) -> list[Block]:
    """The blocks of a reStructuredText: prose without markup, listings, and what directives show."""
    return _parts(source, 0)


def _parts(source: SourceText, depth: int) -> list[Block]:
    """The blocks of a part of the text; bodies of directives are read recursively, as deep as those of MyST."""
    blocks, done = list[Block](), 0
    for match in _BLOCK.finditer(source.text):
        end = match.start("colon") if match["colon"] else match.start()
        blocks.append(Block(PROSE, _prose(source[done:end])))
        done = match.end()
        if listing := next((name for name in ("literal", "session") if match[name]), ""):
            blocks.append(Block(LISTING, source[slice(*match.span(listing))]))
        elif match["name"]:
            blocks += _directive(source, match, depth)
        elif re.match(r"\[[^\]\n]+\] ", match["argument"]):  # a footnote; all else is a comment or a target
            shown = source[match.start("argument") + match["argument"].index("]") + 1 : match.end()]
            blocks.append(Block(PROSE, _prose(shown)))
    return [*blocks, Block(PROSE, _prose(source[done:]))]


def _directive(source: SourceText, match: re.Match[str], depth: int) -> list[Block]:
    """The blocks of a directive: mathematics, a listing, or its title and its body without options."""
    name, start = match["name"].lower(), match.start("body")
    if options := _OPTIONS.match(match["body"]):
        start += options.end()
    argument, body = source[slice(*match.span("argument"))], source[start : match.end("body")]
    if name == "math":
        return [Block(PROSE, tex_prose(argument)), Block(PROSE, tex_prose(body))]
    if name in _PROGRAMS:
        language = argument.text.strip().lower() or {"plot": "python", "testcode": "python"}.get(name, "")
        return [Block(LISTING, body, language)]
    if name in MACHINE_DIRECTIVES or name.startswith("auto") or depth == DEEPEST:
        return []
    if name == "list-table":  # "* - " begins a row, "  - " a cell
        body = body.rewritten(CELL_OF_LIST, lambda cell: ["| " if cell["row"] else " | "])
    title = [] if name in NO_TITLES else [Block(PROSE, _prose(argument))]
    return [*title, *_parts(body, depth + 1)]


def _prose(text: SourceText) -> SourceText:
    """A piece without directives, its markup removed, and the columns of its tables parted by |."""
    text = joined(_rows(text)).removed(_GRID_LINE).removed(_TITLE_LINE)
    pieces, done = list[SourceText](), 0
    for match in _INLINE.finditer(text.text):
        pieces.append(text[done : match.start()])
        done, role = match.end(), (match["role"] or match["after"] or "").lower()
        kept = text[slice(*match.span("code" if match["code"] else "text"))]
        shown = SHOWN.match(kept.text) if not match["code"] and role != "math" else None
        if shown:
            kept = kept[slice(*shown.span("a"))]
        elif is_key(role):
            kept = kept[:0]
        pieces.append(shielded_in_role(tex_prose(kept) if role == "math" else kept, role))
    text = joined([*pieces, text[done:]]).removed(_FOOTNOTE)
    text = text.rewritten(_ESCAPED, lambda match: [match.span(1)])
    return unshielded(text.rewritten(_STRONG, lambda match: [match.span("a")]))


def _rows(text: SourceText) -> Iterator[SourceText | Insertion]:
    """The lines, and those of simple tables with | before each column that their borders of = give."""
    columns, at = list[int](), 0
    for line, after in pairwise([*text.text.splitlines(keepends=True), ""]):
        if _BORDER.match(line):
            # The last border stands before an empty line.
            columns = [match.start() for match in _COLUMN.finditer(line)] if after.strip() else []
        elif columns:
            apart = [match.start() for match in CELL.finditer(line)]  # beside the borders, as writers leave them
            starts, until = apart if len(apart) == len(columns) else columns, len(line.rstrip("\n"))
            for start, end in zip(starts, [*starts[1:], until], strict=True):
                yield Insertion("| ", text.origin(min(at + start, at + len(line) - 1)))
                yield text[at + min(start, until) : at + min(end, until)]
            yield text[at + until : at + len(line)]
        else:
            yield text[at : at + len(line)]
        at += len(line)
