"""Tables line up, JSON is canonical, floats are short and say when they are not zero, near names are suggested."""

import pytest

from driftproof.support.plain_text import as_json, counted, did_you_mean, short, table, unknown, with_digits


def test_table_aligns_columns_and_ends_no_line_with_blanks():
    assert table([["a", "long"], ["bbb", "1"]], right=[1]) == "a    long\nbbb     1"
    assert table([["a", "b"], ["ccc", ""]]) == "a    b\nccc"


def test_json_is_canonical():
    assert as_json({"b": ["τ"], "a": None}) == '{\n "a": null,\n "b": [\n  "τ"\n ]\n}'


@pytest.mark.parametrize(
    ("x", "digits", "text"),
    [(0.5, 3, "0.500"), (1.5e-7, 2, "1.5e-7"), (1234.0, 4, "1234"), (1e-4, 1, "0.0001"), (12345.0, 2, "1.2e4")],
)
def test_digits_are_significant_and_zeros_among_them(x, digits, text):
    assert with_digits(x, digits) == text


@pytest.mark.parametrize(
    ("x", "text"),
    [
        (0.0, "0.000"), (2.3903, "2.390"), (-0.001, "-0.001"), (9.99e-4, "1.0e-3"), (1e9, "1.0e9"),
        (1e9 - 1, f"{10**9 - 1}.000"),
    ],
)  # fmt: skip
def test_short_numbers_are_as_the_lesson_shows_them_and_never_a_zero_that_is_none(x, text):
    assert short(x) == text


def test_near_names_are_suggested():
    known = ("rk4", "rk38", "rk2", "gauss2")
    assert did_you_mean("rk5", known) == "; did you mean rk4 or rk2?"
    assert did_you_mean("gauss", known) == "; did you mean gauss2?"
    near = "; did you mean rk4 or rk2? choose from rk4, rk38, rk2, gauss2"
    assert unknown("method", "rk5", known) == f"unknown method 'rk5'{near}"
    assert unknown("method", "zzz", known) == "unknown method 'zzz'; choose from rk4, rk38, rk2, gauss2"
    assert unknown("method", "z" * 61, known, "a list") == f"unknown method {'z' * 57 + '...'!r} (a list)"
    assert [counted(n, "step") for n in (0, 1, 2)] == ["0 steps", "1 step", "2 steps"]
    assert did_you_mean("zzz", known) == did_you_mean("energy", ["kepler_energy"]) == ""
