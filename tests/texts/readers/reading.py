"""What is read of a text, for the test files of all formats."""

import re

from driftproof.texts.readers.document import document_of


def read(form, source):
    """The text, without the spaces that stand before another or before the end of a line."""
    return re.sub(r" +(?=[ \n])", "", document_of(source, form).text.text)


def blocks(form, source):
    """Kind, language and text of every block that is not empty."""
    found = document_of(source, form).blocks
    return [(one.kind, one.language, one.text.text.strip()) for one in found if one.text.text.strip()]


def standing(form, source, text):
    """What stands in the file from where `text` is said to stand."""
    document = document_of(source, form)
    line, column = document.position(document.text.text.index(text))
    return source.splitlines()[line - 1][column - 1 :]
