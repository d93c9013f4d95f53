"""HTML that is written out: text closes nothing, attributes keep their order, cells reach over empty ones."""

import re

from hypothesis import given
from hypothesis import strategies as st

from driftproof.reports.page.markup import element, escaped, html_table


@given(st.text())
def test_text_opens_and_closes_nothing(content):
    shown = escaped(content)
    assert not set(shown) & set("<>\"'\x00\x0b\x7f")
    assert not re.search(r"&(?!amp;|lt;|gt;|quot;|#x27;)", shown)


def test_element_writes_attributes_in_order_and_drops_none():
    assert element("a", "b", class_="c d", data_x=1, hidden=None) == '<a class="c d" data-x="1">b</a>'
    assert element("a", title='"<') == '<a title="&quot;&lt;"></a>'


def test_cell_reaches_over_the_empty_ones_after_it():
    markup = html_table([["a", "b", "c", "d"], ["x", "stopped", "", ""], ["y", "1", "2", "3"]], "t")
    assert '<th scope="row">x</th><td colspan="3">stopped</td></tr>' in markup
    assert '<th scope="row">y</th><td>1</td><td>2</td><td>3</td></tr>' in markup
