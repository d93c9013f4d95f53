"""What every answer can do: text, the same for the prompt, JSON, and HTML that shows columns as tables."""

import pytest

from driftproof.support.results import Answered, Printable, html_of


def test_an_answer_prints_and_has_its_entries():
    found = Answered({"order": 4}, lambda data: f"order {data['order']}", 4)
    assert (str(found), repr(found), found["order"], found.found) == ("order 4", "order 4", 4, 4)
    assert found.json() == '{\n "order": 4\n}'
    assert found._repr_html_() == "<div><p>order 4</p></div>"
    with pytest.raises(NotImplementedError):
        str(Printable())


# Notebooks set it in the letters of single lines.
PRE = '<p style="white-space:pre-wrap">'
HTML = {
    "one <line>": "<p>one &lt;line&gt;</p>",
    "a  1\nbc 2": f"{PRE}a  1\nbc 2</p>",
    "a   1\nbc  2": "<table><tr><td*>a</td><td*>1</td></tr><tr><td*>bc</td><td*>2</td></tr></table>",
    "a      1\nbc  200": "<table><tr><td*>a</td><td>1</td></tr><tr><td*>bc</td><td>200</td></tr></table>",
    "Head\n  one two\n  three": f"<p><b>Head</b></p>{PRE}one two\nthree</p>",
    "H\n  a  1\n     2": "<p><b>H</b></p><table><tr><td*>a</td><td*>1</td></tr><tr><td*></td><td*>2</td></tr></table>",
    "a\n\nb": "<p>a</p><p>b</p>",
    "": "",
}


@pytest.mark.parametrize("text", HTML)
def test_columns_become_tables_aligned_as_in_the_text_and_all_else_stays(text):
    assert html_of(text) == f"<div>{HTML[text]}</div>".replace("*", ' style="text-align: left"')
