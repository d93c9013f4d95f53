"""HTML is read as a browser shows it, cells apart and MathML in one line."""

import pytest

from driftproof.texts.readers.html import html_blocks
from driftproof.texts.readers.source_text import SourceText
from tests.texts.readers.reading import blocks, read

READ = [
    ("<p>a<script>1</script>b<style>2</style><!-- 3 -->c</p><p title='4'>d", "abc\nd"),
    ("<table><tr><td>0.090<td>&minus;0.054<td>40<tr><td>1</table>", "0.090 | -0.054 | 40\n1"),
    ("h<sup>6</sup>, q<sub>1</sub>, &frac12; &lt;b&gt;", "h^6, q_1, 1/2 <b>"),
    ("<math><mfrac><mn>337</mn><mn>384</mn></mfrac></math>", "337/384"),
    ("<math><mfrac><mrow><mi>a</mi><mo>+</mo><mn>1</mn></mrow><mn>2</mn></mfrac></math>", "(a+1)/2"),
    ("<math><msup><mi>h</mi><mn>6</mn></msup><msqrt><mn>2</mn></msqrt></math>", "h^6√(2)"),
    ("<math><mfrac><msup><mrow><mi>a</mi><mi>b</mi></mrow><mn>2</mn></msup><mn>3</mn></mfrac></math>", "ab^2/3"),
    ("<math><msqrt><mfrac><mrow><mi>a</mi><mi>b</mi></mrow><mn>2</mn></mfrac></msqrt></math>", "√((ab)/2)"),
    ("<span class='katex-html'>9<span>8<i>4</i></span><span/>7</span>6<template>5&lt;</template>", "6"),
    ("<math><msup></i><mi>h</mi></mn><mn>6</mn></i></msup></math>", "h^6"),
    ("<td>1<td>2", "1 | 2"),
    ("<b>0.090</b>40<div>a</div>b", "0.09040\na\nb"),
    ("<math><msubsup><mi>q</mi><mn>1</mn><mn>2</mn></msubsup></math>", "q_1^2"),
]


@pytest.mark.parametrize(("source", "text"), READ)
def test_html_is_read_as_people_read_it(source, text):
    assert read("html", source) == text


def test_markup_is_followed_a_hundred_levels_deep():
    assert [html_blocks(SourceText.of("<sup>" * n))[0].text.text.count("^{") for n in (99, 100, 101)] == [99, 100, 100]


def test_preformatted_text_is_a_listing_in_the_language_of_its_class():
    source = 'w<div class="highlight-python"><pre><span>x</span></pre></div><pre>y</pre>z'
    listings = [("listing", "python", "x"), ("listing", "", "y")]
    assert blocks("html", source) == [("prose", "", "w"), *listings, ("prose", "", "z")]
    assert blocks("html", "<pre>a<b>1</b> c</pre>") == [("listing", "", "a1 c")]
