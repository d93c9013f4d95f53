"""A file is read by its ending, every character knows its place, and no file makes a reader crash or crawl."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.readers import document
from driftproof.texts.readers.document import LARGEST_DOCUMENT, READERS, document_of, read_document
from driftproof.texts.readers.numbers import numbers_in
from tests.texts.readers.reading import standing

SOURCES = {
    "plain": "one\r\ntwo  \u221242.5 and ½",
    "html": "<p>one\n<b>two</b> &amp; &#8722;42.5</p>",
    "markdown": "# x\n\n> *one* [two](three) **\u221242.5** and `1/2`",
    "tex": "% 1\none $\\frac{x}{y} \\num{-42.5}$",
    "notebook": '{\n "cells": [{"cell_type": "markdown", "source": ["a\\n", "b \\u2212 -42.5"]}]}',
}


@pytest.mark.parametrize("form", SOURCES)
def test_number_stands_where_the_file_has_it(form):
    held("markdown", "a\n```\nb c\n```\n{sub}`d e`")
    assert standing(form, SOURCES[form], "42.5").startswith("42.5")


def test_piece_of_a_block_has_its_span_also_where_a_notebook_has_outputs_before_the_code():
    cell = '{"cell_type": "code", "outputs": [{"text": ["2 ½\\n"]}], "source": ["y = 2  # 3\\n", "y * 1"]}'
    document = document_of(f'{{"cells": [{cell}, {cell}]}}', "notebook")
    spans = [document.span(block.text) for block in document.blocks]
    assert [document.text.text[slice(*span)].strip() for span in spans] == ["y = 2 # 3\ny * 1", "2 1/2"] * 2
    assert [document.text.text[slice(*span)].strip() for span in document.code] == ["y = 2", "y * 1"] * 2


@pytest.mark.parametrize(("fence", "code"), [("python", 1), ("julia", 1), ("", 0), ("text", 0), ("python\n>>> 1", 0)])
def test_code_is_a_listing_in_a_language_and_no_session(fence, code):
    document = document_of(f"```{fence}\n\n  x = 1 \n# 2\n```\n3\n", "markdown")
    assert [document.text.text[slice(*span)].strip() for span in document.code] == ["x = 1"] * code


def test_what_a_text_takes_in_from_other_files_is_named():
    tex = r"50\% of \input{one} and \include{two}, % not \input{three}"
    listing = r"\lstinputlisting[language=C]{a.c} \input{one}"
    assert document_of(f"{tex}\n{listing}", "tex").other_files == ["one", "two", "a.c"]
    markdown = "```{include} part.md\n```\n:::{literalinclude} b.py\n:::\nan {include} and ```{code}```"
    assert document_of(markdown, "markdown").other_files == ["part.md", "b.py"]


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("0,25 und 0,75, dann 12,5 %, in (1,0).", ["0.25", "0.75", "12.5", "1", "0"]),
        ("0,25 and 1,000 and -0,75", ["0.25", "1.000", "-0.75"]),
        ("0,25 and 12,5", ["0", "25", "12", "5"]),  # one is not enough
        ("from 0,1 and 0,5", ["0", "1", "0", "5"]),
        ("0,25 and 0,75 and 1,2,3", ["0.25", "0.75", "1", "2", "3"]),
        ("y[0,25] and (0,75) and 0,5", ["0", "25", "0", "75", "0", "5"]),
    ],
)
def test_a_comma_is_a_decimal_point_where_the_text_says_so_twice(text, numbers):
    found = document_of(text)
    assert [number.text for number in numbers_in(found.text.text)] == numbers
    assert all(found.position(i).column == i + 1 for i in range(len(text)))
    code = document_of(f"{text}\n\n```python\nf(1, 0,25)\n```\n", "markdown")
    assert "f(1, 0,25)" in code.text.text


def test_reader_is_chosen_by_the_ending(tmp_path):
    for name, text in (("a.md", "*b*"), ("a.html", "<i>b</i>"), ("a.TEX", "\\emph{b}"), ("a.txt", "b"), ("a", "b")):
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert read_document(tmp_path / name).text.text == "b"
    assert read_document(tmp_path / "a.md", "plain").text.text == "*b*"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfe", "not UTF-8 at byte 0"),
        (b" " * (LARGEST_DOCUMENT + 1), "too large; at most 4194304 bytes"),
        (b"{", "it is not a notebook"), (b'{"cells": 3}', 'a list "cells"'), (b"[" * 100_000, "nested too deep"),
    ],
    ids=range(5),
)  # fmt: skip
def test_file_that_is_no_text_is_refused_in_one_line(content, message, tmp_path):
    path = tmp_path / "a.ipynb"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=message) as error:
        read_document(path)
    assert "\n" not in str(error.value)


# Markup that never ends, which a reader must not look through again and again.
ENDLESS = [
    *("<!--", "<![", "</", "<a ", "<a b='", '<a b="', "<script>", "<pre>", "<sup>", "<mfrac>", "&", "$", "`", "["),
    *("![", "**", "{", "^{", "_{", "\\frac{", "\\cite[", "\\(", "\\begin{verbatim}", "```\n", "~~~", "- ", "1/"),
    *("1,", "²"),
]


def test_a_document_has_four_mebibytes_at_most_and_one_of_five_formats(tmp_path, monkeypatch):
    limits = []
    monkeypatch.setattr(document, "read_utf8", lambda path, most: limits.append(most) or "x")
    assert (read_document(tmp_path / "a").text.text, limits) == ("x", [4_194_304])
    with pytest.raises(ValueError, match="a: format: 'word' is unknown; choose one of plain, markdown"):
        read_document(tmp_path / "a", "word")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("form", sorted({*READERS} - {"notebook"}))
def test_markup_that_never_ends_is_read_to_the_end(form):
    for piece in ENDLESS:
        document = document_of(piece * (5_000 // len(piece)), form)
        numbers_in(document.text.text)


@given(st.sampled_from(sorted(READERS)), st.lists(st.sampled_from([*ENDLESS, "0.5", *" \nx}>'|"])))
def test_no_text_crashes_a_reader(form, pieces):
    held(form, "".join(pieces))


@given(st.sampled_from(sorted(READERS)), st.text())
def test_no_characters_crash_a_reader(form, source):
    held(form, source)


def held(form, source):
    """What is read has a place for every character and every number, in the order of the file."""
    try:
        document = document_of(source, form)
    except ValueError:
        assert form == "notebook"
        return
    origins = [document.text.origin(i) for i in range(len(document.text.text))]
    assert origins == sorted(origins)
    assert all(0 <= origin <= len(source) for origin in origins)
    for number in numbers_in(document.text.text):
        assert document.text.text[number.start : number.end] == number.text
        assert document.position(number.start).line <= source.count("\n") + 1
