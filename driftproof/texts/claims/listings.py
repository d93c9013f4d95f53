"""Run the Python listings of a text in a separate process and compare their output with the output that it shows.

The code runs with the rights of the caller: limits of time and memory are no sandbox.
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
from driftproof.texts.readers.source_text import LISTING, OUTPUT, OUTPUT_LANGUAGES, PROSE, Block, SourceText, joined

_PYTHON = {"python", "py", "python3", "ipython", "ipython3"}

# Output that follows a listing after more characters of prose than this belongs to something else.
_MOST_PROSE = 300
_MOST_LISTINGS = 200
# Lines above "Expected output:" that are tried as the first of a listing: each parse takes about 1 ms.
_MOST_TRIES = 60
_HEADING = re.compile(r"^[ \t]*(?:\w+ )?output:?[ \t]*$\n?", re.IGNORECASE | re.MULTILINE)
_FIRST_LINE = re.compile(
    r"^(?:(?:from|import|def|class|for|while|with|if|try)\b|@|print\(|[A-Za-z_]\w*(?:, ?\w+)* =)", re.MULTILINE
)

# Bytes of memory and of a file, enough for NumPy and an animation; characters printed, more than people read.
_MEMORY, _LARGEST_FILE, _MOST_PRINTED = 2 * 2**30, 2**26, 2**20
# The environment variables that the process inherits: enough to find libraries and a language, nothing secret.
_KEPT = ("PATH", "HOME", "LANG", "LC_ALL", "TMPDIR", "SYSTEMROOT")


@dataclass(frozen=True)
class Listing:
    """A program and its expected output; `shows` if it prints its last value, as cells do."""

    program: SourceText
    printed: SourceText | None = None
    shows: bool = False


@dataclass(frozen=True)
class Ran:
    """The outcome of running the listings: findings, the number run, and the spans of output that were reproduced."""

    findings: tuple[Finding, ...]
    count: int
    spans: tuple[Span, ...]


def listings_in(document: Document) -> list[Listing]:
    """The Python listings of the document in order, each with its expected output if the text shows any.

    In a notebook the expected output is the output of the cell; in other texts it is the next listing, if that names no
    programming language and at most 300 characters of prose come before it. In plain text a listing is the longest
    valid Python right above a line such as "Expected output:", and its output is the paragraph below that line. Raises
    ValueError for more than 200 listings.
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
        return Listing(program, joined(outputs), shows=True)
    prose = [block.text.text for block in takewhile(lambda block: block.kind != LISTING, following)]
    next_one = following[len(prose)] if len(prose) < len(following) else None
    shows = next_one and next_one.language in OUTPUT_LANGUAGES and sum(map(len, prose)) <= _MOST_PROSE
    return Listing(program, next_one.text if next_one and shows else None)


def _under_headings(text: SourceText) -> Iterator[Listing]:
    done = 0
    for heading in _HEADING.finditer(text.text):
        starts = [match.start() for match in _FIRST_LINE.finditer(text.text, done, heading.start())][-_MOST_TRIES:]
        start = next((at for at in starts if _is_python(text.text[at : heading.start()])), None)
        body = re.compile(r"\n*(?P<lines>(?:[^\n]*\S[^\n]*(?:\n|\Z))+)").match(text.text, heading.end())
        if start is not None and body:
            done = body.end()
            yield Listing(text[start : heading.start()], text[slice(*body.span("lines"))])


def _is_python(text: str) -> bool:
    with warnings.catch_warnings():  # warnings about the style of the program are not ours to report
        warnings.simplefilter("ignore")
        try:
            return bool(ast.parse(text).body)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            return False


def run_listings(document: Document, time_limit: float = 10.0) -> Ran:
    """Run every Python listing of the text, in order, in one process, within `time_limit` seconds in total."""
    found = listings_in(document)
    outcomes = _outcomes(found, time_limit) if found else []
    compared = [
        (listing, _compared(document, f"listing {number}", listing, outcome))
        for number, (listing, outcome) in enumerate(zip(found, outcomes, strict=True), 1)
    ]
    spans = (document.span(one.printed) for one, wrong in compared if one.printed is not None and not wrong)
    return Ran(tuple(wrong for _, wrong in compared if wrong), len(found), tuple(spans))


def _outcomes(found: Sequence[Listing], time_limit: float) -> list[dict[str, Any]]:
    """The output of each listing and the error that ended it, None if there was none."""
    environment = {key: os.environ[key] for key in _KEPT if key in os.environ}
    environment["OPENBLAS_NUM_THREADS"] = "1"  # each thread of OpenBLAS reserves memory that is never used
    ours = {os.path.abspath(entry) for entry in ("", *os.environ.get("PYTHONPATH", "").split(os.pathsep))}
    path = [entry for entry in sys.path if os.path.abspath(entry) not in ours]
    limits = Limits(seconds=time_limit, memory=_MEMORY, file=_LARGEST_FILE)
    outcomes: list[dict[str, Any]] = []
    with (
        tempfile.TemporaryDirectory() as folder,
        Session(f"{__name__}:run_listing", limits, environment=environment, folder=folder, path=path) as session,
    ):
        try:
            session.ask({"program": "", "shows": False})  # so that the start of the process does not count
            end = monotonic() + time_limit
            for listing in found:
                request = {"program": listing.program.text, "shows": listing.shows}
                outcome = session.ask(request, max(0.0, end - monotonic()))
                if not (isinstance(outcome, dict) and isinstance(outcome.get("printed"), str) and "error" in outcome):
                    raise ProcessEnded("answer", "an invalid answer")
                outcomes.append(outcome)
        except ProcessEnded as ended:
            error = f"not finished within {time_limit:g} s" if ended.cause == "time" else str(ended)
            outcomes += [{"printed": "", "error": error}] * (len(found) - len(outcomes))
    return outcomes


def _compared(document: Document, name: str, listing: Listing, outcome: dict[str, Any]) -> Finding | None:
    """The finding for one listing: its error, or the first line that differs; None if its output is as shown."""
    if outcome["error"] is not None:
        error, place = " ".join(str(outcome["error"]).split()), document.position_of_origin(listing.program.origin(0))
        return Finding(name, *place, "an end without error", error, f"running this listing: {error}")
    if listing.printed is None:
        return None
    printed, shown = _lines(outcome["printed"]), _lines(listing.printed.text)
    for i in range(max(len(printed), len(shown))):
        ours, theirs = (lines[i] if i < len(lines) else "" for lines in (printed, shown))
        if ours != theirs:
            place = document.position_of_origin(_line_origin(listing.printed, i))
            return Finding(name, *place, ours, theirs, f"the listing prints {ours!r}, the text has {theirs!r}")
    return None


def _lines(text: str) -> list[str]:
    return [line.replace("\N{NO-BREAK SPACE}", " ").rstrip() for line in text.strip().splitlines()]


def _line_origin(text: SourceText, number: int) -> int:
    """The offset in the file of line `number`, counted from the first non-empty one; the last line if beyond."""
    lines = text.text.lstrip()
    above = lines.rstrip().splitlines(keepends=True)[:-1][:number]
    return text.origin(len(text.text) - len(lines) + sum(map(len, above)))


# The rest runs in the separate process. All listings share this namespace, as the cells of a notebook do.
_NAMES: dict[str, Any] = {"__name__": "__main__"}


class _LimitedOutput(io.StringIO):
    def write(self, text: str) -> int:
        if self.tell() + len(text) > _MOST_PRINTED:
            raise MemoryError(f"it prints more than {_MOST_PRINTED} characters")
        return super().write(text)


def run_listing(request: dict[str, Any]) -> dict[str, str | None]:
    """Run a program: return its output, with its last value if the request says `shows`, and its error."""
    output, error = _LimitedOutput(), None
    with redirect_stdout(output):
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
    return {"printed": output.getvalue(), "error": error}
