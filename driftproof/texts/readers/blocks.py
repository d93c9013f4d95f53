"""What a reader finds in a file: its text in pieces, each prose, a listing, or what a listing prints."""

from __future__ import annotations

from dataclasses import dataclass

from driftproof.texts.readers.mapped import Mapped

PROSE, LISTING, OUTPUT = "prose", "listing", "output"


@dataclass(frozen=True)
class Block:
    """A piece of a text: its kind, and of a listing its language as the text names it ("" where it names none)."""

    kind: str
    text: Mapped
    language: str = ""
