"""The child's side of running listings: limits first, then each program in turn, in one set of names.

Run as a file of its own, by an interpreter that imports nothing of ours.
"""

from __future__ import annotations

import ast
import io
import json
import os
import sys
import traceback
from contextlib import redirect_stdout, suppress
from typing import Any

LARGEST_FILE = 2**26
MOST_PRINTED = 2**20


class _Paper(io.StringIO):
    """What a listing prints, up to a limit."""

    def write(self, text: str) -> int:
        """Raises MemoryError beyond the limit."""
        if self.tell() + len(text) > MOST_PRINTED:
            raise MemoryError("it prints more than anybody reads")
        return super().write(text)


def _limit(memory: int, seconds: int) -> None:
    """Bound address space, processor time and the size of files, where the system knows how."""
    with suppress(ImportError):
        import resource

        for what, most in (
            (resource.RLIMIT_AS, memory),
            (resource.RLIMIT_CPU, seconds),
            (resource.RLIMIT_FSIZE, LARGEST_FILE),
            (resource.RLIMIT_CORE, 0),
        ):
            _, hard = resource.getrlimit(what)
            resource.setrlimit(what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _run(program: str, shows: bool, names: dict[str, Any]) -> None:
    """The program; what its last expression is, too, if it `shows` that."""
    tree = ast.parse(program)
    last = tree.body.pop() if shows and tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "listing", "exec"), names)
    if last is not None:
        exec(compile(ast.Interactive([last]), "listing", "single"), names)


def _outcome(program: str, shows: bool, names: dict[str, Any]) -> dict[str, str | None]:
    paper, error = _Paper(), None
    with redirect_stdout(paper):
        try:
            _run(program, shows, names)
        except SystemExit:
            pass
        except BaseException as raised:
            where = [
                frame.lineno for frame in traceback.extract_tb(raised.__traceback__) if frame.filename == "listing"
            ]
            line = where[0] if where else getattr(raised, "lineno", None)
            error = f"{type(raised).__name__}: {raised}"[:500] + (f" (line {line} of the listing)" if line else "")
    return {"printed": paper.getvalue(), "error": error}


def main() -> None:
    """Run the listings of the job on standard input; one line of JSON each on standard output."""
    job = json.load(sys.stdin)
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nowhere, descriptor)
    _limit(job["memory"], job["seconds"])
    names: dict[str, Any] = {"__name__": "__main__"}
    for listing in job["listings"]:
        json.dump(_outcome(listing["program"], listing["shows"], names), answers)
        answers.write("\n")
        answers.flush()


if __name__ == "__main__":
    main()
