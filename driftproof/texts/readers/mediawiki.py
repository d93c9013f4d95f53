"""Pages of a wiki as people see them: no markup, mathematics read as TeX, tables as rows of cells."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Iterator

from driftproof.texts.readers.markdown import ENTITY, TAG, shielded, tag_pieces, unshielded
from driftproof.texts.readers.source_text import LISTING, PROSE, Block, Piece, SourceText, joined
from driftproof.texts.readers.tex import tex_prose

_LISTING = re.compile(
    r"<(?P<tag>syntaxhighlight|source|pre)\b(?P<options>[^<>]*)>(?P<body>.*?)(?:</(?P=tag)\s*>|\Z)", re.DOTALL
)
_LANGUAGE = re.compile(r"\blang\s*=\s*[\"']?(\w+)")
_KEPT = re.compile(
    r"(?P<gone><!--.*?(?:-->|\Z)|<ref\b[^<>]*/>|<ref\b[^<>]*>.*?(?:</ref\s*>|\Z)|\[\[(?:File|Image|Category):[^\[\]]*\]\])"
    r"|<(?P<tag>math|chem|nowiki|code)\b[^<>]*>(?P<text>.*?)</(?P=tag)\s*>",
    re.DOTALL | re.IGNORECASE,
)
# A template, in a text without those inside it, and those that show their last argument, or two as a fraction.
_TEMPLATE = re.compile(r"\{\{\s*(?P<name>[^{}|]{0,100}?)\s*(?P<arguments>\|[^{}]{0,2000})?\}\}")
_SHOWN = {"nowrap", "math", "mvar", "val", "nobr", "em", "strong", "big", "small", "abs", "tmath", "center", "mono"}
_FRACTIONS = {"sfrac", "frac", "fraction"}
_LINK = re.compile(r"\[\[(?:[^\[\]|]*\|)?(?P<a>[^\[\]|]*)\]\]|\[https?:[^\s\]]+\s*(?P<b>[^\]\n]*)\]")
_STRESS = re.compile("'{2,5}")
_LINE_MARK = re.compile(
    r"^(?:(?P<level>={1,6})[ \t]*(?P<a>[^\n]*?)[ \t]*(?P=level)[ \t]*$|[:;*#]+[ \t]*)", re.MULTILINE
)
WIKI_TABLE = re.compile(r"^[ \t:]*\{\|[^\n]*\n(?P<body>.*?)^[ \t]*\|\}", re.DOTALL | re.MULTILINE)
_CELL = re.compile(r"\|\||!!")
_ATTRIBUTES = re.compile(r"[^|\[\]{}]*?=[^|\[\]]*\|(?!\|)")
_SPAN = re.compile(r"\b(?P<which>col|row)span\s*=\s*[\"']?(?P<n>[1-9])\b")
# Templates inside templates: deeper than people write.
_DEEPEST = 10


def mediawiki_blocks(source: SourceText) -> list[Block]:
    """The blocks of a page of a wiki: prose without markup, and listings."""
    blocks, done = list[Block](), 0
    for match in _LISTING.finditer(source.text):
        blocks.append(Block(PROSE, _prose(source[done : match.start()])))
        language = _LANGUAGE.search(match["options"])
        blocks.append(Block(LISTING, source[slice(*match.span("body"))], language[1].lower() if language else ""))
        done = match.end()
    return [*blocks, Block(PROSE, _prose(source[done:]))]


def _prose(text: SourceText) -> SourceText:
    """A piece without listings, its markup removed."""
    pieces, done = list[SourceText](), 0
    for match in _KEPT.finditer(text.text):
        pieces.append(text[done : match.start()])
        kept = text[slice(*match.span("text"))] if match["tag"] else text[:0]
        pieces.append(shielded(tex_prose(kept) if (match["tag"] or "").lower() in ("math", "chem") else kept))
        done = match.end()
    text = joined([*pieces, text[done:]])
    for _ in range(_DEEPEST):  # from the inside out
        before = text.text
        text = text.rewritten(_TEMPLATE, _template)
        if text.text == before:
            break
    text = text.rewritten(_LINK, lambda match: [match.span("a" if match["b"] is None else "b")])
    text = text.removed(_STRESS).rewritten(WIKI_TABLE, _rows)
    text = text.rewritten(_LINE_MARK, lambda match: [match.span("a")] if match["level"] else [])
    text = text.rewritten(TAG, tag_pieces).rewritten(ENTITY, lambda match: [html.unescape(match[0])])
    return unshielded(text)


def _template(match: re.Match[str]) -> Iterable[Piece]:
    """The argument that a template shows, or nothing."""
    name, spans, at = match["name"].strip().lower(), list[tuple[int, int]](), match.start("arguments") + 1
    for argument in (match["arguments"] or "|")[1:].split("|"):
        start = at + len(re.match(r"\s*(?:[0-9]\s*=)?", argument)[0])  # type: ignore[index]
        spans.append((start, at + len(argument)))
        at += len(argument) + 1
    if name in _FRACTIONS and len(spans) > 1:
        return [spans[-2], "/", spans[-1]]
    return [spans[-1] if name != "val" else spans[0]] if name in _SHOWN and match["arguments"] else []


def _rows(table: re.Match[str]) -> Iterator[Piece]:
    """The caption, and the rows with | before each cell; a cell of several rows or columns stands in each of them."""
    above, column, at = dict[int, tuple[int, tuple[int, int]]](), 0, table.start("body")
    for line in table["body"].splitlines(keepends=True):
        start = at + len(line) - len(line.lstrip())
        at += len(line)
        said = line.strip()
        if said.startswith(("|-", "|+")):
            yield "\n"
            column = 0
            yield (start + 2, at) if said[1] == "+" else ""
        elif said[:1] in ("|", "!"):
            ends = [*(start + cell.start() for cell in _CELL.finditer(said, 1)), start + len(said)]
            begins = [start + 1, *(end + 2 for end in ends[:-1])]
            for begin, end in zip(begins, ends, strict=True):
                attributes = _ATTRIBUTES.match(table.string, begin, end)
                spans = {one["which"]: int(one["n"]) for one in _SPAN.finditer(attributes[0] if attributes else "")}
                while column in above:
                    yield from _cell(above, column)
                    column += 1
                for _ in range(spans.get("col", 1)):
                    above[column] = spans.get("row", 1), (attributes.end() if attributes else begin, end)
                    yield from _cell(above, column)
                    column += 1
        elif said:
            yield " "
            yield (start, at)
    yield "\n"


def _cell(above: dict[int, tuple[int, tuple[int, int]]], column: int) -> Iterator[Piece]:
    """A cell, which is no longer one of the rows above once it has stood in all of its rows."""
    rows, span = above.pop(column)
    if rows > 1:
        above[column] = rows - 1, span
    yield from ("| ", span, " ")
