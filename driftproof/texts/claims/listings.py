"""The Python listings of a text, and what the text says that they print."""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

from driftproof.texts.readers.document import Document
from driftproof.texts.readers.source_text import LISTING, OUTPUT, PROSE, Block, SourceText, joined

PYTHON = {"python", "py", "python3", "ipython", "ipython3"}
# What the block that follows a listing is called where it shows what the listing prints.
PRINTED = {"", "text", "txt", "output", "console", "stdout", "none", "plaintext", "default"}
# A block with more prose before it belongs to something else.
MOST_PROSE = 300
MOST_LISTINGS = 200
# Of plain text: how far up from the words "Expected output:" a listing may begin.
MOST_LINES, MOST_TRIES = 400, 60

_HEADING = re.compile(r"^[ \t]*(?:\w+ )?output:?[ \t]*$\n?", re.IGNORECASE | re.MULTILINE)
_FIRST_LINE = re.compile(r"(?:(?:from|import|def|class|for|while|with|if|try)\b|@|print\(|[A-Za-z_]\w*(?:, ?\w+)* =)")


@dataclass(frozen=True)
class Listing:
    """A program, where it begins in the file, and what it should print; `shows` its last value too, as a cell does."""

    program: str
    origin: int
    printed: SourceText | None = None
    shows: bool = False


def listings(document: Document) -> list[Listing]:
    """The listings in order. What one prints is in the block that follows it.

    That is what a cell of a notebook has printed; in other texts the next listing, if it is in no language and no more
    than MOST_PROSE characters on. In plain text a listing is what stands above a line such as "Expected output:", as
    far up as it is Python, and what it prints are the lines below, to the next empty one.
    """
    blocks = document.blocks
    found = [_paired(blocks, i) for i, block in enumerate(blocks) if block.kind == LISTING and block.language in PYTHON]
    if not found:
        found = [listing for block in blocks if block.kind == PROSE for listing in _under_headings(block.text)]
    if len(found) > MOST_LISTINGS:
        raise ValueError(f"the text has {len(found)} listings; at most {MOST_LISTINGS} are run")
    return found


def _paired(blocks: tuple[Block, ...], i: int) -> Listing:
    program = blocks[i].text
    outputs, room, at = [], MOST_PROSE, i + 1
    while at < len(blocks) and blocks[at].kind == OUTPUT:
        outputs.append(blocks[at].text)
        at += 1
    if outputs:
        return Listing(program.text, program.origin(0), joined(outputs), shows=True)
    for block in blocks[i + 1 :]:
        if block.kind == LISTING:
            printed = block.text if block.language in PRINTED else None
            return Listing(program.text, program.origin(0), printed)
        room -= len(block.text.text)
        if room < 0:
            break
    return Listing(program.text, program.origin(0))


def _under_headings(text: SourceText) -> Iterator[Listing]:
    done = 0
    for heading in _HEADING.finditer(text.text):
        start = _listing_start(text.text, done, heading.start())
        if start is None:
            continue
        body = re.compile(r"\n*(?P<lines>(?:[^\n]*\S[^\n]*(?:\n|\Z))+)").match(text.text, heading.end())
        if body:
            done = body.end()
            printed = text[body.start("lines") : body.end("lines")]
            yield Listing(text.text[start : heading.start()], text.origin(start), printed)


def _listing_start(text: str, first: int, end: int) -> int | None:
    """The start of the longest Python program between `first` and `end` that ends there, None if there is none."""
    found, tries, at = None, 0, end
    for _ in range(MOST_LINES):
        if at <= first or tries >= MOST_TRIES:
            break
        at = max(text.rfind("\n", first, at - 1) + 1, first)
        if _FIRST_LINE.match(text, at):
            tries += 1
            found = at if _is_python(text[at:end]) else found
    return found


def _is_python(text: str) -> bool:
    with warnings.catch_warnings():  # what is odd about somebody's program is not for us to say
        warnings.simplefilter("ignore")
        try:
            return bool(ast.parse(text).body)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            return False
