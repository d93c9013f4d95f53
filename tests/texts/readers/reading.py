"""What is read of a text, for the test files of all formats."""

from __future__ import annotations

import re

from driftproof.texts.readers.document import document_of


def read(form: str, source: str) -> str:
    """The text, without the spaces that stand before another or before the end of a line."""
    return re.sub(r" +(?=[ \n])", "", document_of(source, form).text.text)


def blocks(form: str, source: str) -> list[tuple[str, str, str]]:
    """Kind, language and text of every block that is not empty."""
    found = document_of(source, form).blocks
    return [(one.kind, one.language, one.text.text.strip()) for one in found if one.text.text.strip()]


def standing(form: str, source: str, text: str) -> str:
    """What stands in the file from where `text` is said to stand."""
    document = document_of(source, form)
    line, column = document.position(document.text.text.index(text))
    return source.splitlines()[line - 1][column - 1 :]
