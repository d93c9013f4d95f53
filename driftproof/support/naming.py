"""What somebody may have meant by a name that there is not."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(key: str, known: Iterable[str]) -> str:
    """ "; did you mean a or b?" with the names nearest to `key`, or "" where none is near."""
    close = get_close_matches(key, known, n=2, cutoff=0.4)
    return f"; did you mean {' or '.join(close)}?" if close else ""
