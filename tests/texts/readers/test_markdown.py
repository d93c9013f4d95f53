"""Markdown is read without its markup, and fences are listings."""

import pytest

from tests.texts.readers.reading import blocks, read

READ = [
    ("---\ntitle: 7\n---\n# A *b* `x*2*y` [c](u/9) ![d](e)", "A b x*2*y c d"),
    ("is **0.5**, 2\\*3*4, a_1_b, _c_ <!-- 8 --> &minus;1 h<sup>2</sup>", "is 0.5, 2*3*4, a_1_b, c -1 h^2"),
    ("$\\frac{337}{384}$ and $$h^{-2}$$, \\$5 and 3$", "337/384 and h^{-2}, $5 and 3$"),
    ("| a | b |\n|:--|--:|\n| 1 | 2 |\n\n[r]: http://x/8\n> quoted\n- 5", "| a | b |\n| 1 | 2 |\nquoted\n5"),
    ("0 < h < 2, a<b", "0 < h < 2, a<b"),
    ("It is 3.[^1] So[^two]\n\n[^1]: At 4 it is 5.\n[^two]: 6\n\n[r^7]: u/8", "It is 3. So\nAt 4 it is 5.\n6"),
    (
        "```{list-table} T 3\n:header-rows: 1\n\n* - h\n  - y\n* - 0.1\n  - -2\n* -\n  - 4\n```",
        "T 3\n| h | y\n| 0.1 | -2\n| | 4",
    ),
    ("a<br>b <i>c</i> `\\frac{1}{2}` {math}`\\frac{1}{2}`", "a\nb c \\frac{1}{2} 1/2"),
    ("{ref}`fig-1`, {ref}`the 3 <fig-1>`, {cite:p}`hairer1993` {eq}`e-2` {sup}`4` {kbd}`5`", ", the 3, ^4 5"),
    ('(sec-1)=\n# A\n% todo 2\nb {{ x7 }}\n+++ {"a": 7}\n$$c = 1$$ (eq-8)', "A\nb\nc = 1"),
    ("{math:numref}`e-3` {glue:text}`x:.3f` {eval}`2+2` {nb-download}`n7.ipynb`.\n:::{grid} 2\n4\n:::", ".\n4"),
    ("\\begin{align*}\ny &= \\frac{1}{4} \\label{eq:8} \\\\\n\\end{align*}", "y | = 1/4"),
    ("$\\newcommand{\\half}{\\frac{1}{2}}\\def\\o#1{O(h^{#1})}\\half$ $\\o{4}$", "1/2 O(h^4)"),
]


@pytest.mark.parametrize(("source", "text"), READ)
def test_markdown_is_read_as_people_read_it(source, text):
    assert read("markdown", source) == text


def test_directives_are_prose_listings_or_for_the_machine():
    inner = "````{note} Of 2\n:class: x-1\nis 3\n```{code-cell} ipython3\n:tags: [t-1]\nx\n```\n````\n"
    figure = "```{figure} a-1.png\n---\nwidth: 400px\n---\nCaption 5\n```\n"
    rest = ":::{prf:theorem} T\n6\n:::\n```{toctree}\n7\n```\n```{math}\n:label: e-1\nh\n```\n```{python}\ny\n```"
    assert blocks("markdown", inner + figure + rest) == [
        ("prose", "", "Of 2"), ("prose", "", "is 3"), ("listing", "ipython3", "x"), ("prose", "", "Caption 5"),
        ("prose", "", "T"), ("prose", "", "6"), ("prose", "", "h"), ("listing", "python", "y"),
    ]  # fmt: skip


def test_directives_are_read_eight_levels_deep():
    for deep, kinds in ((8, {"prose"}), (9, {"listing"})):
        ends = ["`" * (deep + 3 - i) for i in range(deep)]
        source = "\n".join([*(f"{end}{{note}}" for end in ends), "x 5", *reversed(ends)])
        assert {kind for kind, *_ in blocks("markdown", source)} == kinds, deep


def test_fences_are_listings_and_mathematics():
    source = "a\n```python\nb\n```\n~~~\nc\n~~~\n```math {#eq-8}\nh^{2}\n```\n"
    expected = [("prose", "", "a"), ("listing", "python", "b"), ("listing", "", "c"), ("prose", "", "h^{2}")]
    assert blocks("markdown", source) == expected


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("mark", [">", "> ", " "])
def test_million_marks_alone_are_read(mark):
    """A pattern that looked to the end of the line at each of them would take 10^12 steps: this would not end."""
    assert "7" in read("markdown", mark * (10**6 // len(mark)) + " 7")
