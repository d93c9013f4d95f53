"""The Python listings of a text, run in an isolated process, and what they print compared with what the text shows.

This runs the code of the text with the rights of whoever asks for it: limits of time and memory are no sandbox.
"""

from __future__ import annotations

import ast
import io
import os
import re
import sys
import tempfile
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from itertools import takewhile
from time import monotonic
from typing import Any

from driftproof.support.processes import Limits, ProcessEnded, Session
from driftproof.texts.claims.checking import Finding, Span
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.source_text import LISTING, OF_OUTPUT, OUTPUT, PROSE, Block, SourceText, joined

_PYTHON = {"python", "py", "python3", "ipython", "ipython3"}

# A block with more prose before it belongs to something else.
_MOST_PROSE = 300
_MOST_LISTINGS = 200
# Lines of plain text above the words "Expected output:" that are tried for a listing's first: a parse takes a ms.
_MOST_TRIES = 60
_HEADING = re.compile(r"^[ \t]*(?:\w+ )?output:?[ \t]*$\n?", re.IGNORECASE | re.MULTILINE)
_FIRST_LINE = re.compile(
    r"^(?:(?:from|import|def|class|for|while|with|if|try)\b|@|print\(|[A-Za-z_]\w*(?:, ?\w+)* =)", re.MULTILINE
)

# Enough for NumPy and an animation of the lesson's; the output is read by people.
_MEMORY, _LARGEST_FILE, _MOST_PRINTED = 2 * 2**30, 2**26, 2**20
# What the process is given of our environment: enough to find its libraries and a language, nothing secret.
_KEPT = ("PATH", "HOME", "LANG", "LC_ALL", "TMPDIR", "SYSTEMROOT")


@dataclass(frozen=True)
class Listing:
    """A program, where it begins in the file, and what it should print; `shows` its last value too, as a cell does."""

    program: str
    origin: int
    printed: SourceText | None = None
    shows: bool = False


@dataclass(frozen=True)
class Ran:
    """What came of the listings: what is wrong, how many ran, and the spans of the text that were seen printed."""

    findings: tuple[Finding, ...]
    count: int
    spans: tuple[Span, ...]


def listings_in(document: Document) -> list[Listing]:
    """The listings in order. What one prints is in the block that follows it.

    That is what a cell of a notebook has printed; in other texts the next listing, if it is in no language and no more
    than 300 characters on. In plain text a listing is what stands above a line such as "Expected output:", as far up as
    it is Python, and what it prints are the lines below, to the next empty one.
    """
    blocks = document.blocks
    code = [i for i, block in enumerate(blocks) if block.kind == LISTING and block.language in _PYTHON]
    found = [_with_output(blocks[i].text, blocks[i + 1 :]) for i in code]
    if not found:
        found = [listing for block in blocks if block.kind == PROSE for listing in _under_headings(block.text)]
    if len(found) > _MOST_LISTINGS:
        raise ValueError(f"the text has {len(found)} listings; at most {_MOST_LISTINGS} are run")
    return found


def _with_output(program: SourceText, following: Sequence[Block]) -> Listing:
    outputs = [block.text for block in takewhile(lambda block: block.kind == OUTPUT, following)]
    if outputs:
        return Listing(program.text, program.origin(0), joined(outputs), shows=True)
    prose = [block.text.text for block in takewhile(lambda block: block.kind != LISTING, following)]
    next_one = following[len(prose)] if len(prose) < len(following) else None
    shows = next_one and next_one.language in OF_OUTPUT and sum(map(len, prose)) <= _MOST_PROSE
    return Listing(program.text, program.origin(0), next_one.text if next_one and shows else None)


def _under_headings(text: SourceText) -> Iterator[Listing]:
    done = 0
    for heading in _HEADING.finditer(text.text):
        starts = [match.start() for match in _FIRST_LINE.finditer(text.text, done, heading.start())][-_MOST_TRIES:]
        start = next((at for at in starts if _is_python(text.text[at : heading.start()])), None)
        body = re.compile(r"\n*(?P<lines>(?:[^\n]*\S[^\n]*(?:\n|\Z))+)").match(text.text, heading.end())
        if start is not None and body:
            done = body.end()
            printed = text[slice(*body.span("lines"))]
            yield Listing(text.text[start : heading.start()], text.origin(start), printed)


def _is_python(text: str) -> bool:
    with warnings.catch_warnings():  # what is odd about somebody's program is not for us to say
        warnings.simplefilter("ignore")
        try:
            return bool(ast.parse(text).body)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            return False


def run_listings(document: Document, time_limit: float = 10.0) -> Ran:
    """Every Python listing of the text run, in order, in one process, within `time_limit` seconds together."""
    found = listings_in(document)
    outcomes = _outcomes(found, time_limit) if found else []
    compared = [
        (listing, _compared(document, f"listing {number}", listing, outcome))
        for number, (listing, outcome) in enumerate(zip(found, outcomes, strict=True), 1)
    ]
    spans = (document.span(one.printed) for one, wrong in compared if one.printed is not None and not wrong)
    return Ran(tuple(wrong for _, wrong in compared if wrong), len(found), tuple(spans))


def _outcomes(found: Sequence[Listing], time_limit: float) -> list[dict[str, Any]]:
    """What each printed, and the error it ended with, None if it ended well."""
    environment = {key: os.environ[key] for key in _KEPT if key in os.environ}
    environment["OPENBLAS_NUM_THREADS"] = "1"  # each thread of it takes room that is never used
    ours = {os.path.abspath(entry) for entry in ("", *os.environ.get("PYTHONPATH", "").split(os.pathsep))}
    path = [entry for entry in sys.path if os.path.abspath(entry) not in ours]
    limits = Limits(seconds=time_limit, memory=_MEMORY, file=_LARGEST_FILE)
    outcomes: list[dict[str, Any]] = []
    with (
        tempfile.TemporaryDirectory() as folder,
        Session(f"{__name__}:run_listing", limits, environment=environment, folder=folder, path=path) as session,
    ):
        try:
            session.ask({"program": "", "shows": False})  # so that the time of its start is not the listings'
            end = monotonic() + time_limit
            for listing in found:
                request = {"program": listing.program, "shows": listing.shows}
                outcome = session.ask(request, max(0.0, end - monotonic()))
                if not (isinstance(outcome, dict) and isinstance(outcome.get("printed"), str) and "error" in outcome):
                    raise ProcessEnded("answer", "an answer that is none")
                outcomes.append(outcome)
        except ProcessEnded as ended:
            error = f"no end within {time_limit:g} s" if ended.cause == "time" else str(ended)
            outcomes += [{"printed": "", "error": error}] * (len(found) - len(outcomes))
    return outcomes


def _compared(document: Document, name: str, listing: Listing, outcome: dict[str, Any]) -> Finding | None:
    """What is wrong, if anything: an error, or the first line that differs."""
    if outcome["error"] is not None:
        error, place = " ".join(str(outcome["error"]).split()), document.position_of_origin(listing.origin)
        return Finding(name, *place, "an end without error", error, f"running this listing: {error}")
    if listing.printed is None:
        return None
    printed, shown = _lines(outcome["printed"]), _lines(listing.printed.text)
    for i in range(max(len(printed), len(shown))):
        ours, theirs = (lines[i] if i < len(lines) else "" for lines in (printed, shown))
        if ours != theirs:
            place = document.position_of_origin(_line_origin(listing.printed, i))
            return Finding(name, *place, ours, theirs, f"the listing prints {ours!r}, the text says {theirs!r}")
    return None


def _lines(text: str) -> list[str]:
    return [line.replace("\N{NO-BREAK SPACE}", " ").rstrip() for line in text.strip().splitlines()]


def _line_origin(text: SourceText, number: int) -> int:
    """Where in the file the line of this number begins, from the first that is not empty; the last for one beyond."""
    start = len(text.text) - len(text.text.lstrip())
    for _ in range(number):
        start = text.text.find("\n", start) + 1 or start
    return text.origin(min(start, max(len(text.text) - 1, 0)))


# What follows runs in the isolated process: each listing in the names that the ones before have left.
_NAMES: dict[str, Any] = {"__name__": "__main__"}


class _Paper(io.StringIO):
    """What a listing prints, up to a limit."""

    def write(self, text: str) -> int:
        """Raises MemoryError beyond the limit."""
        if self.tell() + len(text) > _MOST_PRINTED:
            raise MemoryError("it prints more than anybody reads")
        return super().write(text)


def run_listing(request: dict[str, Any]) -> dict[str, str | None]:
    """What the program of the request prints, its last value too if it `shows` that, and the error it ends with."""
    paper, error = _Paper(), None
    with redirect_stdout(paper):
        try:
            tree = ast.parse(request["program"])
            last = tree.body.pop() if request["shows"] and tree.body and isinstance(tree.body[-1], ast.Expr) else None
            exec(compile(tree, "listing", "exec", dont_inherit=True), _NAMES)
            if last is not None:
                exec(compile(ast.Interactive([last]), "listing", "single", dont_inherit=True), _NAMES)
        except SystemExit:
            pass
        except BaseException as raised:
            frames = traceback.extract_tb(raised.__traceback__)
            where = [frame.lineno for frame in frames if frame.filename == "listing"]
            line = where[0] if where else getattr(raised, "lineno", None)
            error = f"{type(raised).__name__}: {raised}"[:500] + (f" (line {line} of the listing)" if line else "")
    return {"printed": paper.getvalue(), "error": error}
