"""Tables written as books print them become the methods that they print, and what is no table is refused."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.schemes import MethodError, RungeKutta, Splitting
from driftproof.methods.tables.notation import numbers, padded, row, splitting, square, tableaux

PAIR = """
# A remark, which is left out.
pair | A pair | 2(1) | nobody-2000, p. 1
  0 |
1/2 | 1/2
  1 | 0 0.25
    | 1 0 0
    | 0 1

root | A root | 1 | nobody-2000, p. 2
1-sqrt(2)/2 | 1-sqrt(2)/2
            | 1
"""


def test_tableaux_are_read_as_they_are_printed() -> None:
    with pytest.raises(MethodError, match="b_embedded has 2 entries"):  # only in A are zeros left out
        tableaux(PAIR)
    pair, root = tableaux(PAIR.replace("| 0 1", "| 0 1 0"), decimal=True)
    assert pair == RungeKutta(
        key="pair",
        title="A pair",
        claimed_order=2,
        source="nobody-2000, p. 1",
        c=(Q(0), Q(1, 2), Q(1)),
        a=((Q(0),) * 3, (Q(1, 2), Q(0), Q(0)), (Q(0), Q(1, 4), Q(0))),
        b=(Q(1), Q(0), Q(0)),
        b_embedded=(Q(0), Q(1), Q(0)),
        embedded_order=1,
        decimal=True,
    )
    assert (root.c, root.a, root.b_embedded) == ((1 - square_root(2) / 2,), ((1 - square_root(2) / 2,),), None)


@pytest.mark.parametrize("names", ["a | b | 1", "a | b | one | c", "a | b | 1 | c\n0 | 1 | 2"])
def test_what_is_no_tableau_is_refused(names: str) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 - by Python, in our own file: there is no user to tell
        tableaux(f"{names}\n0 |\n | 1")


def test_splitting_has_its_names_in_a_line() -> None:
    parts = (("kick", Q(1)), ("drift", Q(1)))
    assert splitting("s | Title | 1 | source", parts) == Splitting("s", "Title", 1, "source", parts)
    assert splitting("s | Title | 1 | source", parts, quadratic_kinetic=True).quadratic_kinetic


def test_rows_are_exact_and_filled_up_with_zeros() -> None:
    assert row("1/6 0.1 2.5e-1") == (Q(1, 6), Q(1, 10), Q(1, 4))
    assert row(" 1 -2/3 ") == (1, Q(-2, 3))
    assert padded((), (1,)) == ((0, 0), (1, 0))
    assert square("0\n 1/2") == padded((0,), (Q(1, 2),)) == ((0, 0), (Q(1, 2), 0))
    assert numbers(1, square_root(2)) == (Q(1), square_root(2))
