"""Markdown is read without its markup, and fences are listings."""

from __future__ import annotations

import pytest

from tests.texts.readers.reading import blocks, read, standing

READ = [
    ("---\ntitle: 7\n---\n# A *b* `x*2*y` [c](u/9) ![d](e)", "A b x*2*y c d"),
    ("is **0.5**, 2\\*3*4, a_1_b, _c_ <!-- 8 --> &minus;1 h<sup>2</sup>", "is 0.5, 2*3*4, a_1_b, c -1 h^2"),
    ("$\\frac{337}{384}$ and $$h^{-2}$$, \\$5 and 3$", "337/384 and h^{-2}, $5 and 3$"),
    ("| a | b |\n|:--|--:|\n| 1 | 2 |\n\n[r]: http://x/8\n> quoted\n- 5", "| a | b |\n| 1 | 2 |\nquoted\n5"),
    ("0 < h < 2, a<b", "0 < h < 2, a<b"),
]


@pytest.mark.parametrize(("source", "text"), READ)
def test_markdown_is_read_as_people_read_it(source: str, text: str) -> None:
    assert read("markdown", source) == text


def test_number_stands_where_the_file_has_it() -> None:
    source = "# x\n\n> *one* [two](three) **\u221242.5** and `1/2`"
    assert standing("markdown", source, "42.5").startswith("42.5")


def test_fences_are_listings_and_mathematics() -> None:
    source = "a\n```python\nb\n```\n~~~\nc\n~~~\n```{math}\nh^{2}\n```\n"
    expected = [("prose", "", "a"), ("listing", "python", "b"), ("listing", "", "c"), ("prose", "", "h^{2}")]
    assert blocks("markdown", source) == expected


@pytest.mark.parametrize("mark", [">", "> ", " "])
def test_million_marks_alone_are_read(mark: str) -> None:
    """A pattern that looked to the end of the line at each of them would take 10^12 steps: this would not end."""
    assert "7" in read("markdown", mark * (10**6 // len(mark)) + " 7")
