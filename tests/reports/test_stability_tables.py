"""Limits in a table: how many digits they have, and what stands beside them."""

import pytest

from driftproof.reports.stability_tables import _seen_text, _short, limit_text


@pytest.mark.parametrize(
    ("exact", "decimal", "shown"),
    [
        *(("1" * 24, "7.50", f"{'1' * 24} = 7.5"), ("1" * 25, "7.50", "7.5"), ("20", "20.000", "20")),
        *((None, "0.1234567891", "0.1234567891"), (None, "0.12345678912", "0.1234567891..."), (None, "200", "200")),
    ],
)
def test_a_limit_has_twelve_characters_at_most_beside_an_exact_one_of_24(exact, decimal, shown):
    assert limit_text({"limit": {"exact": exact, "decimal": decimal}, "attained": False}) == f"h < {shown}"


def test_where_growth_is_seen_has_ten_digits_and_an_end_of_the_search_four():
    seen = [("0.12345678912", "0.2"), ("0.0", "0.123456"), ("1.23456", "inf")]
    shown = ["up to 0.1234567891", "growth at 0.1235, the smallest tried", "up to 1.235, the largest tried"]
    assert [_seen_text({"bounded": low, "grows": high}) for low, high in seen] == shown
    hidden = [_seen_text({"bounded": low, "grows": "1.5"}, in_blocks=True) for low in ("0.0", "1.25")]
    assert [each.partition(":")[0] for each in hidden] == ["not seen", "up to 1.250000000"]
    assert _seen_text({"bounded": "2171.78", "grows": "2180"}, by_rounding=True) == "up to 2172, where rounding grows"


def test_a_long_fraction_is_a_decimal_and_a_short_one_stands_as_it_is():
    assert [_short(x) for x in (None, "-1/3", "1" * 25 + "/" + "3" * 25)] == [None, "-1/3", "0.333333"]
