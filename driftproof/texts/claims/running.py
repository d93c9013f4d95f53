"""Listings run in a child process, and what they print compared with what the text says they do.

This runs the code of the text with the rights of whoever asks for it: limits of time and memory are no sandbox.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import ceil
from typing import Any

from driftproof.texts.claims import child
from driftproof.texts.claims.checking import Finding
from driftproof.texts.claims.listings import Listing, listings
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.source_text import SourceText

TIME_LIMIT = 10.0
MEMORY = 2 * 2**30
# What the child is given of our environment: enough to find its libraries and a language, nothing secret.
_KEPT = ("PATH", "HOME", "LANG", "LC_ALL", "TMPDIR", "SYSTEMROOT")


@dataclass(frozen=True)
class Ran:
    """What came of the listings: what is wrong, how many ran, and the spans of the text that were seen printed."""

    findings: tuple[Finding, ...]
    count: int
    spans: tuple[tuple[int, int], ...]


def run_listings(document: Document, time_limit: float = TIME_LIMIT) -> Ran:
    """Every Python listing of the text run, in order, in one process, within `time_limit` seconds together."""
    found = listings(document)
    outcomes = _outcomes(found, time_limit) if found else []
    findings: list[Finding] = []
    spans: list[tuple[int, int]] = []
    for number, (listing, outcome) in enumerate(zip(found, outcomes, strict=True), 1):
        wrong = _compared(document, f"listing {number}", listing, outcome)
        findings += [wrong] if wrong else []
        if not wrong and listing.printed is not None:
            ends = (listing.printed.origin(0), listing.printed.origin(len(listing.printed.text)))
            spans.append((document.text.index(ends[0]), document.text.index(ends[1])))
    return Ran(tuple(findings), len(found), tuple(spans))


def _outcomes(found: Sequence[Listing], time_limit: float) -> list[dict[str, Any]]:
    """What each printed, and the error it ended with, None if it ended well."""
    job = {
        "memory": MEMORY,
        "seconds": ceil(time_limit) + 1,
        "listings": [{"program": listing.program, "shows": listing.shows} for listing in found],
    }
    environment = {key: os.environ[key] for key in _KEPT if key in os.environ}
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as answers:
        process = subprocess.Popen(
            [sys.executable, "-I", "-X", "utf8", child.__file__],
            stdin=subprocess.PIPE,
            stdout=answers,
            stderr=subprocess.DEVNULL,
            cwd=folder,
            env={**environment, "OPENBLAS_NUM_THREADS": "1"},  # each thread of it takes room that is never used
            start_new_session=True,
        )
        end = _given(process, json.dumps(job).encode(), time_limit)
        answers.seek(0)
        lines = answers.read(child.LARGEST_FILE).decode(errors="replace").splitlines()
    read = [outcome for line in lines if (outcome := _read(line)) is not None][: len(found)]
    return read + [{"printed": "", "error": end}] * (len(found) - len(read))


def _given(process: subprocess.Popen[bytes], job: bytes, time_limit: float) -> str:
    """How the process ended that was given the job, in words."""
    try:
        with suppress(BrokenPipeError):
            process.communicate(job, timeout=time_limit)
        return f"the process ended early (status {process.wait()})"
    except subprocess.TimeoutExpired:
        return f"no end within {time_limit:g} s"
    finally:
        process.kill()
        process.wait()
        if hasattr(os, "killpg"):  # what it has started itself
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)


def _read(line: str) -> dict[str, Any] | None:
    """An outcome as the child wrote it; None for anything else that came that way."""
    with suppress(ValueError, RecursionError):
        outcome = json.loads(line)
        if isinstance(outcome, dict) and isinstance(outcome.get("printed"), str) and "error" in outcome:
            return outcome
    return None


def _compared(document: Document, name: str, listing: Listing, outcome: dict[str, Any]) -> Finding | None:
    """What is wrong, if anything: an error, or the first line that differs."""
    if outcome["error"] is not None:
        place = document.position_of_origin(listing.origin)
        error = " ".join(str(outcome["error"]).split())
        return Finding(name, place, "an end without error", error, f"running this listing: {error}")
    if listing.printed is None:
        return None
    printed, shown = _lines(outcome["printed"]), _lines(listing.printed.text)
    for i in range(max(len(printed), len(shown))):
        ours, theirs = (lines[i] if i < len(lines) else "" for lines in (printed, shown))
        if ours != theirs:
            place = document.position_of_origin(_line_origin(listing.printed, i))
            return Finding(name, place, ours, theirs, f"the listing prints {ours!r}, the text says {theirs!r}")
    return None


def _lines(text: str) -> list[str]:
    return [line.replace("\N{NO-BREAK SPACE}", " ").rstrip() for line in text.strip().splitlines()]


def _line_origin(text: SourceText, number: int) -> int:
    """Where in the file the line of this number begins, from the first that is not empty; the last for one beyond."""
    start = len(text.text) - len(text.text.lstrip())
    for _ in range(number):
        start = text.text.find("\n", start) + 1 or start
    return text.origin(min(start, max(len(text.text) - 1, 0)))
