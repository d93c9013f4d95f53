"""Plain text: prose as it stands."""

from __future__ import annotations

from driftproof.texts.readers.blocks import PROSE, Block
from driftproof.texts.readers.mapped import Mapped


def plain_blocks(source: Mapped) -> list[Block]:
    """The whole text as one piece."""
    return [Block(PROSE, source)]
