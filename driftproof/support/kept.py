"""Answers kept in files beside their questions, and taken over only for the same question, with every digit."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

from driftproof.support.files import atomic_write

# Chosen: at a few megabytes at most each, what a cache may take of a disk.
MOST_FILES = 64


class NotKept(ValueError):
    """A file has no answer to this question; the message says why, as in "cannot be read"."""


def keep(path: Path, question: Mapping[str, Any], answer: Mapping[str, Any]) -> None:
    """Write an answer and its question to a file, whole or not at all."""
    content = {"question": question, **answer}
    content["checksum"] = _checksum(content)
    with atomic_write(path) as draft:
        Path(draft).write_text(json.dumps(content, indent=1, sort_keys=True), encoding="utf-8")


def kept(path: Path, question: Mapping[str, Any]) -> Any:
    """The answer to the question in a file. Raises NotKept for another question, and for any digit that has changed."""
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        different = [key for key in question if held["question"].get(key) != question[key]]
        right = different or held.pop("checksum") == _checksum(held)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        right, different = False, []
    if not right:
        raise NotKept("cannot be read")
    if different:
        raise NotKept(f"is from another study ({', '.join(different)} differ)")
    return held


def _checksum(content: Mapping[str, Any]) -> str:
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def cached(question: Mapping[str, Any]) -> Any:
    """The answer to the question in this user's cache; None without one."""
    with suppress(NotKept, RuntimeError):
        return kept(_place(question), question)
    return None


def cache(question: Mapping[str, Any], answer: Mapping[str, Any]) -> None:
    """Keep the answer in the cache, where it can be written, and drop the oldest of more than MOST_FILES."""
    with suppress(OSError, ValueError, RuntimeError):  # a cache that is no folder, or a user without a home
        keep(path := _place(question), question, answer)
        files = sorted(path.parent.glob("[!.]*.json"), key=lambda each: each.stat().st_mtime)
        for old in files[:-MOST_FILES]:
            old.unlink(missing_ok=True)


def _place(question: Mapping[str, Any]) -> Path:
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home, "driftproof", f"{_checksum(question)[:32]}.json")
