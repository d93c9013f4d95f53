"""reStructuredText is read without its markup; directives are prose, listings, or for the machine."""

import pytest

from tests.texts.readers.reading import blocks, read

READ = [
    ("Title *a*\n=========\n\nis **0.5**, 2\\*3*4, a_1_b and ``x*2``", "Title a\nis 0.5, 2*3*4, a_1_b and x*2"),
    (":math:`\\frac{337}{384}`, `h^{-2}`:math: and `plain`", "337/384, h^{-2} and plain"),
    (":ref:`fig-1`, :ref:`the 3 <fig-1>`, :cite:t:`hairer1993` :sup:`4`", ", the 3, ^4"),
    ("`page <http://x/8>`_, `a 5`_", "page, a 5"),
    ("h\\ :sub:`0`, as in [7]_ and [#f]_.", "h _0, as in and."),
    (".. _sec-1:\n\nb\n\n.. a comment 7\n   which goes on 8\n\nc\n\n.. [1] A note 2.", "b\nc\nA note 2."),
    (".. math::\n   :label: e-1\n\n   y &= \\frac{1}{4}\n\n.. math:: h = 2\n", "y | = 1/4\nh = 2"),
    (
        "=====  ======\nh      y\n=====  ======\n0.1    -2\n0.05   4\n=====  ======\n\nx = 3",
        "| h | y\n| 0.1 | -2\n| 0.05 | 4\nx = 3",
    ),
    ("===  ==\nh    r\n===  ==\n0.1\n0.2  4\n===  ==", "| h | r\n| 0.1|\n| 0.2 | 4"),  # a cell is empty
    ("+---+----+\n| h | y  |\n+===+====+\n| 1 | -2 |\n+---+----+", "| h | y |\n| 1 | -2 |"),
    (".. list-table:: T 3\n   :widths: 1\n\n   * - h\n     - y\n   * - 0.1\n     - -2\n", "T 3\n| h | y\n| 0.1 | -2"),
    ("a :unknown:`0.5` b ``c`` `d` *e*", "a 0.5 b c d e"),
]  # fmt: skip


@pytest.mark.parametrize(("source", "text"), READ)
def test_restructured_text_is_read_as_people_read_it(source, text):
    assert read("rst", source) == text


def test_directives_and_what_stands_after_two_colons_are_prose_listings_or_for_the_machine():
    source = (
        ".. note:: Of 2\n   :class: x-1\n\n   is 3\n\n   .. code-block:: python\n\n      x = 1\n\n   so\n"
        ".. figure:: a-1.png\n   :width: 400\n\n   Caption 5\n\n.. toctree::\n\n   7\n\n"
        "It prints::\n\n   0.25\n\nand\n\n"
        ">>> y\n0.5\n\n.. autofunction:: f9\n\n.. plot::\n\n   z\n"
    )
    assert blocks("rst", source) == [
        ("prose", "", "Of 2"), ("prose", "", "is 3"), ("listing", "python", "x = 1"), ("prose", "", "so"),
        ("prose", "", "Caption 5"), ("prose", "", "It prints:"), ("listing", "", "0.25"), ("prose", "", "and"),
        ("listing", "", ">>> y\n0.5"), ("listing", "python", "z"),
    ]  # fmt: skip


def test_directives_are_read_eight_levels_deep():
    for deep, found in ((8, "x 5"), (9, "")):
        source = "".join(f"{'   ' * i}.. note::\n\n" for i in range(deep)) + "   " * deep + "x 5\n"
        assert read("rst", source) == found, deep


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("mark", ["`", ".. ", " ", "=", "* ", ":a:"])
def test_many_marks_alone_are_read(mark):
    """A pattern that looked to the end of the text at each of them would not end."""
    assert "7" in read("rst", mark * (10**5 // len(mark)) + "\n\n7")
