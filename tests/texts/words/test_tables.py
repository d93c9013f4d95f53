"""A number of a table stands under the heads of its column, in every way in which tables are written."""

import pytest

from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.words.tables import Address, TextTables


def heads(text):
    tables = TextTables(text)
    return {number.text: tables.column_of(number) for number in numbers_in(text) if number.label is None}


@pytest.mark.parametrize(
    "text",
    [
        "| t | Heun |\n| 0.5 | 1.125 |",
        "|t|Heun|\n|0.5|1.125|",
        "{| class=a\n|+ of t\n! ''t'' !! Heun\n|-\n| 0.5 || 1.125",
        "| | Heun |\n| t | |\n| 0.5 | 1.125 |",
        "| t | Heun |\n" + "| - | - |\n" * 300 + "| 0.5 | 1.125 |",
        "{see below}\n| t | Heun |\n| 0.5 | 1.125 |",
    ],
)
def test_the_head_of_a_column_is_above_it(text):
    assert heads(text) == {"0.5": "t", "1.125": "heun"}


def test_a_setting_before_numbers_of_the_first_row_is_that_of_their_columns():
    text = "| t | 0 | 1 |\n|---|---|---|\n| y(t) | 1.5 | 2.5 |"
    assert heads(text) == {"0": "t", "1": "t", "1.5": "t = 0", "2.5": "t = 1"}
    assert heads(text.replace("t |", "y |"))["2.5"] == "1"
    assert heads("| |\n| 1 |") == {"1": ""}


def test_the_bars_of_an_absolute_value_are_no_cells_and_a_caption_with_them_is_no_head():
    caption = "Errors |y_N - y(2)| for h = 0.1, and more"
    assert heads(f"{caption}\nMethod | y\nHeun | 1.125") == {"0.1": "", "1.125": "y"}
    assert heads(f"{caption}\n| Method | y |\n| Heun | 1.125 |")["1.125"] == "y"


def test_no_number_outside_a_table_has_a_head_nor_one_below_the_end_of_a_table():
    assert heads("Heun\n0.5") == {"0.5": ""}
    assert heads("| Heun |\nIt is\n| 0.5 |") == {"0.5": ""}


ROWS = """| method | h | e | y |
|---|---|---|---|
| RK4 | 0.1 | 7.1 | 2.1 |
| RK4 | 0.2 | 7.2 | 2.2 |
| Heun | 0.1 | 7.3 | 2.3 |"""


@pytest.mark.parametrize(("number", "row"), [("2.1", "RK4 | 0.1"), ("2.2", "RK4 | 0.2"), ("2.3", "Heun")])
def test_a_number_has_an_address_that_no_other_row_has(number, row):
    tables, numbers = TextTables(ROWS), [x for x in numbers_in(ROWS) if x.label is None]
    (found,) = [tables.address(x) for x in numbers if x.text == number]
    assert found == Address(row, "y")
    assert [x.text for x in numbers if tables.stands_at(found, x.start)] == [number]
    assert tables.stands_at(Address(row.lower()), ROWS.index(number))
    assert not tables.stands_at(found, 0)


def test_cells_of_a_row_have_their_places_in_the_text():
    text = "| t | Heun |\n| 0.5 | 1.125 |"
    tables, (number, _) = TextTables(text), numbers_in(text)
    cells = [cell for cell in tables.row_of(number) if cell.head]
    assert [(cell.head, cell.text, text[cell.start : cell.end].strip(" |")) for cell in cells] == [
        ("t", "0.5", "0.5"),
        ("heun", "1.125", "1.125"),
    ]
    assert tables.row_of(number) is tables.row_of(number), "found once"


def test_heads_of_a_setting_right_below_numbers_begin_another_table():
    text = "| h | error |\n| 0.1 | 0.5 |\n| h | order |\n| 0.1 | 2.0 |\n| 0.2 | 2.1 |"
    tables, numbers = TextTables(text), numbers_in(text)
    assert [tables.column_of(x) for x in numbers] == ["h", "error", "h", "order", "h", "order"]
    assert [tables.column_place(x)[0] for x in numbers] == [0, 0, 28, 28, 28, 28]
