"""Texts are read as people read them, every character knows its place, and no file makes a reader crash or crawl."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.readers.canonical import canonical_spelling
from driftproof.texts.readers.document import LARGEST_DOCUMENT, READERS, document_of, read_document
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.readers.source_text import LISTING, OUTPUT, Insertion, SourceText, joined

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

# form, what stands in the file, what is read
READ = [
    ("plain", "q\u2032 = \u22120.5\u00a0and\t\n  ½(q²\u2009+\u2009v²), vₙ₊₁", "q' = -0.5 and\n1/2(q^2 + v^2), v_{n+1}"),
    ("plain", "3.3×10⁻⁴, 10^12, h^{6}, 1½, 5\u202f651, \u0663\u0664", "3.3×10^{-4}, 10^{12}, h^6, 1 1/2, 5,651, 34"),
    ("plain", "\ufeffa\u200bb\u00ad 1⁄2 kick\u2011drift", "ab 1/2 kick-drift"),
    ("markdown", "---\ntitle: 7\n---\n# A *b* `x*2*y` [c](u/9) ![d](e)", "A b x*2*y c d"),
    ("markdown", "is **0.5**, 2\\*3*4, a_1_b, _c_ <!-- 8 --> &minus;1 h<sup>2</sup>", "is 0.5, 2*3*4, a_1_b, c -1 h^2"),
    ("markdown", "$\\frac{337}{384}$ and $$h^{-2}$$, \\$5 and 3$", "337/384 and h^{-2}, $5 and 3$"),
    (
        "markdown",
        "| a | b |\n|:--|--:|\n| 1 | 2 |\n\n[r]: http://x/8\n> quoted\n- 5",
        "| a | b |\n| 1 | 2 |\nquoted\n5",
    ),
    ("markdown", "0 < h < 2, a<b", "0 < h < 2, a<b"),
    ("html", "<p>a<script>1</script>b<style>2</style><!-- 3 -->c</p><p title='4'>d", "abc\nd"),
    ("html", "<table><tr><td>0.090<td>&minus;0.054<td>40</table>", "0.090 | -0.054 | 40"),
    ("html", "h<sup>6</sup>, q<sub>1</sub>, &frac12; &lt;b&gt;", "h^6, q_1, 1/2 <b>"),
    ("html", "<math><mfrac><mn>337</mn><mn>384</mn></mfrac></math>", "337/384"),
    ("html", "<math><mfrac><mrow><mi>a</mi><mo>+</mo><mn>1</mn></mrow><mn>2</mn></mfrac></math>", "(a+1)/2"),
    ("html", "<math><msup><mi>h</mi><mn>6</mn></msup><msqrt><mn>2</mn></msqrt></math>", "h^6√(2)"),
    ("html", "<span class='katex-html'>9<span>8</span>7</span>6<template>5</template>", "6"),
    ("html", "<math><msubsup><mi>q</mi><mn>1</mn><mn>2</mn></msubsup></math>", "q_1^2"),
    ("tex", "a % 5\nb\\% \\label{eq:1}\\cite{x2} \\emph{c} \\num{0.5}~d", "a b% c 0.5 d"),
    ("tex", "$\\frac{337}{384}$, $\\tfrac12$, $\\frac{h^2}{2}$", "337/384, 1/2, (h^2)/2"),
    ("tex", "$2\\sqrt{2}$ $3.3\\times 10^{-4}$ $1\\,000$ $q_{n+1}$", "2√2 3.3×10^{-4} 1,000 q_{n+1}"),
    ("tex", "\\begin{tabular}{lr} a & 0.5 \\\\ b & 1 \\end{tabular}", "a | 0.5\nb | 1"),
    ("notebook", json.dumps(NOTEBOOK), "The error is 0.33\nafter h^6/72 é-\nprint(1/4)\n0.25\n0.5\n7.5"),
]


@pytest.mark.parametrize(("form", "source", "text"), READ)
def test_text_is_read_as_people_read_it(form: str, source: str, text: str) -> None:
    assert " ".join(document_of(source, form).text.text.split(" ")) == text or (
        document_of(source, form).text.text.replace("  ", " ").replace(" \n", "\n") == text
    )


def test_reading_a_number_wrongly_would_be_noticed() -> None:
    assert (
        document_of("<td>0.090<td>40", "html").text.text != document_of("<b>0.090</b>40", "html").text.text == "0.09040"
    )


@pytest.mark.parametrize(
    ("form", "source"),
    [
        ("plain", "one\r\ntwo  \u221242.5 and ½"),
        ("markdown", "# x\n\n> *one* [two](three) **\u221242.5** and `1/2`"),
        ("html", "<p>one\n<b>two</b> &amp; &#8722;42.5</p>"),
        ("tex", "% 1\none $\\frac{x}{y} \\num{-42.5}$"),
        (
            "notebook",
            json.dumps({"cells": [{"cell_type": "markdown", "source": ["a\n", "b \\u2212 -42.5"]}]}, indent=1),
        ),
    ],
)
def test_place_is_where_the_number_stands_in_the_file(form: str, source: str) -> None:
    document = document_of(source, form)
    line, column = document.position(document.text.text.index("42.5"))
    assert source.splitlines()[line - 1][column - 1 :].startswith("42.5")


def test_listings_and_outputs_are_told_from_prose() -> None:
    markdown = document_of("a\n```python\nb\n```\n~~~\nc\n~~~\n```{math}\nh^{2}\n```\n", "markdown")
    assert [
        (block.kind, block.language, block.text.text.strip()) for block in markdown.blocks if block.text.text.strip()
    ] == [
        ("prose", "", "a"),
        (LISTING, "python", "b"),
        (LISTING, "", "c"),
        ("prose", "", "h^{2}"),
    ]
    tex = document_of("\\begin{lstlisting}[language=Python]\nx\n\\end{lstlisting}", "tex")
    assert [(b.kind, b.language) for b in tex.blocks if b.text.text.strip()] == [(LISTING, "python")]
    html = document_of('<div class="highlight-python"><pre><span>x</span></pre></div><pre>y</pre>', "html")
    assert [(b.kind, b.language) for b in html.blocks if b.text.text.strip()] == [(LISTING, "python"), (LISTING, "")]
    notebook = document_of(json.dumps(NOTEBOOK), "notebook")
    assert [block.kind for block in notebook.blocks].count(OUTPUT) == 2


def test_reader_is_chosen_by_the_ending(tmp_path: Path) -> None:
    for name, text in (("a.md", "*b*"), ("a.html", "<i>b</i>"), ("a.TEX", "\\emph{b}"), ("a.txt", "b"), ("a", "b")):
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert read_document(tmp_path / name).text.text == "b"
    assert read_document(tmp_path / "a.md", "plain").text.text == "*b*"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfe", "byte 0 is not UTF-8 text"),
        (b" " * (LARGEST_DOCUMENT + 1), "at most 4194304 bytes"),
        (b"{", "it is no notebook"),
        (b'{"cells": 3}', 'a list "cells"'),
        (b"[" * 100_000, "nested too deep"),
    ],
    ids=range(5),
)
def test_file_that_is_no_text_is_refused_in_one_line(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "a.ipynb"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=message) as error:
        read_document(path)
    assert "\n" not in str(error.value)


# Markup that never ends, which a reader must not look through again and again.
ENDLESS = [
    "<!--",
    "<a ",
    "</",
    "<![",
    "<a b='",
    '<a b="',
    "&",
    "$",
    "`",
    "[",
    "![",
    "**",
    "\\frac{",
    "\\cite[",
    "{",
    "^{",
]
ENDLESS += [
    "\\begin{verbatim}",
    "```\n",
    "~~~",
    "<script>",
    "<pre>",
    "<sup>",
    "<mfrac>",
    "1/",
    "1,",
    "²",
    "_{",
    "\\(",
    "- ",
]


@pytest.mark.parametrize("form", sorted({*READERS} - {"notebook"}))
def test_markup_that_never_ends_is_read_to_the_end(form: str) -> None:
    for piece in ENDLESS:
        document = document_of(piece * (5_000 // len(piece)), form)
        numbers_in(document.text.text)


@given(
    st.sampled_from(sorted(READERS)), st.lists(st.sampled_from([*ENDLESS, "0.5", " ", "\n", "x", "}", ">", "'", "|"]))
)
def test_no_text_crashes_a_reader(form: str, pieces: list[str]) -> None:
    held(form, "".join(pieces))


@given(st.sampled_from(sorted(READERS)), st.text())
def test_no_characters_crash_a_reader(form: str, source: str) -> None:
    held(form, source)


json_values = st.none() | st.integers() | st.text(max_size=5) | st.lists(st.text(max_size=5), max_size=3)
outputs = st.lists(
    st.dictionaries(st.sampled_from(["data", "text", "text/plain"]), json_values, max_size=2), max_size=2
)


@given(
    st.lists(st.dictionaries(st.sampled_from(["cell_type", "source", "outputs"]), json_values | outputs), max_size=3)
)
def test_no_notebook_crashes_its_reader(cells: list[dict[str, object]]) -> None:
    held("notebook", json.dumps({"cells": cells}))


def held(form: str, source: str) -> None:
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


@given(st.text(alphabet="0123456789 ,.-−½⁰¹²₁ab\n\u00a0"))
def test_canonical_spelling_is_its_own(text: str) -> None:
    once = canonical_spelling(SourceText.of(text)).text
    assert canonical_spelling(SourceText.of(once)).text == once


def test_pieces_keep_their_places_when_they_are_cut_and_joined() -> None:
    source = SourceText.of("abcdef")
    text = joined([source[4:6], Insertion("-", 3), source[0:2]])
    assert (text.text, [text.origin(i) for i in range(5)]) == ("ef-ab", [4, 5, 3, 0, 1])
    assert [source[2:5].origin(i) for i in range(4)] == [2, 3, 4, 5]
    assert source[1:4].index(3) == 2
