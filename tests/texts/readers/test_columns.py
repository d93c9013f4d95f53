"""Columns that spaces part are read as a table, and nothing else is."""

import pytest

from tests.texts.readers.reading import blocks, read


@pytest.mark.parametrize(
    ("text", "parted"),
    [
        (" h     Euler   RK4\n 0.5   1    -\n 0.25  1/3  2", "| h | Euler | RK4\n| 0.5 | 1 | -\n| 0.25 | 1/3 | 2"),
        ("h\tforward Euler\n----  ----\n0.5\t1e-3\nThe end", "| h | forward Euler\n| 0.5 | 1e-3\nThe end"),
        ("a  b\n\n0.5  0.42", "a b\n0.5 0.42"),  # no heads above it
        ("h  Euler  RK4\n0.5        0.42", "h Euler RK4\n0.5 0.42"),
        ("h     e     ratio\n0.5   0.42\n0.25  0.20  2.1", "| h | e | ratio\n| 0.5 | 0.42\n| 0.25 | 0.20 | 2.1"),
        ("     a    b\nh         \n0.5  1  NaN", "| h | a | b\n| 0.5 | 1 | NaN"),
        ("   a    b\n0  1  2.5", "| | a | b\n| 0 | 1 | 2.5"),
        ("    a    b\n0  1  2.5", "a b\n0 1 2.5"),  # heads elsewhere
        ("One.  Two 3.\nThen.  It is 0.5", "One. Two 3.\nThen. It is 0.5"),
        ("| a  b |\n| 1  2 |", "| a b |\n| 1 2 |"),
    ],
)  # fmt: skip
def test_rows_of_numbers_below_as_many_heads_are_a_table(text, parted):
    assert read("plain", text) == parted


def test_printed_output_is_a_table_and_a_program_is_none():
    source = "```\nh   y\n0.5  2\n```\n```python\nh = [\n 1,  2,\n 3,  4]\n```"
    assert read("markdown", source) == "| h | y\n| 0.5 | 2\nh = [\n1, 2,\n3, 4]"
    assert [kind for kind, *_ in blocks("markdown", source)] == ["listing", "listing"]
