"""Notebooks are read cell by cell, code with what it printed, every character at its place in the JSON."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.claims.listings import listings_in
from driftproof.texts.readers.document import document_of
from driftproof.texts.readers.source_text import LISTING
from tests.texts.readers.reading import blocks, read
from tests.texts.readers.test_document import held

NOTEBOOK = {
    "cells": [
        {"cell_type": "markdown", "source": ["The error is **0.33**\n", "after $h^{6}/72$ é\u2212"]},
        {
            "cell_type": "code",
            "source": "print(1/4)",
            "outputs": [
                {"output_type": "stream", "name": "stdout", "text": ["0.25\n"]},
                {"output_type": "execute_result", "data": {"text/plain": ["0.5"], "text/html": ["<b>9</b>"]}},
                {"output_type": "display_data", "data": {"text/html": "<b>7.5</b>"}},
            ],
        },
        {"cell_type": "raw", "source": "3.5"},
    ],
    "metadata": {"language_info": {"name": "python"}},
}


def test_notebook_is_read_as_people_read_it():
    text = "The error is 0.33\nafter h^6/72 é-\nprint(1/4)\n0.25\n0.5\n7.5"
    assert read("notebook", json.dumps(NOTEBOOK)) == text
    assert [kind for kind, *_ in blocks("notebook", json.dumps(NOTEBOOK))].count("output") == 2


def test_a_place_is_named_by_its_cell_and_the_line_there():
    """A string of a cell may hold several lines, or one."""
    document = document_of(
        json.dumps({"cells": [*NOTEBOOK["cells"], {"cell_type": "markdown", "source": "a\n\\nu\n9"}]}), "notebook"
    )
    at = {x: document.place(document.text.text.index(x)) for x in ("0.33", "72", "1/4", "0.25", "9")}
    assert [*at.values()] == [
        *("cell 1, line 1", "cell 1, line 2", "cell 2, line 1", "cell 2, line 1 of its output", "cell 4, line 3")
    ]
    assert document.shown(1, document.source.index("72")) == at["72"]


def test_what_notes_of_programs_say_is_not_read():
    note = {"a": {"text": "7", "cell_type": "markdown", "source": "8"}}
    cells = [{**cell, "metadata": note, "attachments": note} for cell in NOTEBOOK["cells"]]
    noted = {**NOTEBOOK, "cells": ["9", *cells], "metadata": NOTEBOOK["metadata"] | note}
    assert read("notebook", json.dumps(noted)) == read("notebook", json.dumps(NOTEBOOK))


LANGUAGES = [
    ({"language_info": {"name": "Julia"}}, "julia"),
    ({"language_info": {"name": "R"}, "kernelspec": {"language": "python"}}, "r"),
    ({"kernelspec": {"name": "ir", "language": "R"}}, "r"),
    ({"language_info": {"name": None}, "kernelspec": {"language": "Octave"}}, "octave"),
    ({"language_info": {"name": "python"}}, "python"),
    *(({"language_info": info, "kernelspec": info}, "python") for info in (None, [], {}, {"name": 3, "language": 3})),
    *((metadata, "python") for metadata in (None, [], {})),
]


@pytest.mark.parametrize(("metadata", "language"), LANGUAGES)
def test_code_is_in_the_language_that_the_notebook_names(metadata, language):
    """What is not Python is no listing that could be run."""
    text = json.dumps({**NOTEBOOK, "metadata": metadata})
    assert [(kind, spoken) for kind, spoken, _ in blocks("notebook", text) if kind == LISTING] == [(LISTING, language)]
    assert len(listings_in(document_of(text, "notebook"))) == (language == "python")


leaves = st.none() | st.integers() | st.text(max_size=5) | st.lists(st.text(max_size=5), max_size=3)
outputs = st.lists(st.dictionaries(st.sampled_from(["data", "text", "text/plain"]), leaves, max_size=2), max_size=2)


@given(st.lists(st.dictionaries(st.sampled_from(["cell_type", "source", "outputs"]), leaves | outputs), max_size=3))
def test_no_notebook_crashes_its_reader(cells):
    held("notebook", json.dumps({"cells": cells}))
