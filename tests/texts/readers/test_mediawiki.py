"""Pages of a wiki are read as people see them, their tables as rows."""

import pytest

from tests.texts.readers.reading import blocks, read, standing

TABLE = """The first two steps<ref name="b">Butcher, p. 3</ref> at ''t'' = 1:
{| class="wikitable"
|+ ''Two'' steps
! scope="col" | <math>t</math> !! [[Euler method|Euler]]
! RK4<!-- 7 -->
|- style="x"
| 0.2 || {{val|0.8}} || 0.829
|-
| 0.4
|
| align="right" | 1.214
|}
"""


@pytest.mark.parametrize(
    ("source", "text"),
    [
        (TABLE, "The first two steps at t = 1:\nTwo steps\n| t | Euler | RK4\n| 0.2 | 0.8 | 0.829\n| 0.4 | | 1.214"),
        ("== Order ==\n: <math>h = \\tfrac12</math>\n* '''RK4'''", "Order\nh = 1/2\nRK4"),
        ("{{nowrap|8.3 %}}, {{math|{{mvar|h}} {{=}} 1}} {{sfrac|1|2}}{{cite book|year=1987}}", "8.3 %, h 1 1/2"),
        ("[https://x.org/8 a page], h<sup>2</sup> &minus; 1 [[File:A.png|300px]]", "a page, h^2 - 1"),
        ('{|\n! a !! b\n|-\n| rowspan="2" | 1 || 2\n|-\n| 3\n|}', "| a | b\n| 1 | 2\n| 1 | 3"),
        ('{|\n! colspan="2" | a !! b\n|-\n| 1 || 2 || 3\n|}', "| a | a | b\n| 1 | 2 | 3"),
    ],
)
def test_a_page_of_a_wiki_is_read_without_markup(source, text):
    assert read("mediawiki", source) == text


def test_a_number_has_its_place_in_the_file_and_a_listing_its_language():
    assert standing("mediawiki", TABLE, "0.829").startswith("0.829")
    assert blocks("mediawiki", '<syntaxhighlight lang="Python">x = 1</syntaxhighlight>') == [
        ("listing", "python", "x = 1")
    ]
    assert read("plain", TABLE) == read("mediawiki", TABLE)
    assert "{|" in read("plain", "a {| b")
