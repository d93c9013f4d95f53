"""Several roots in one field, and fractional powers: exact, with the real numbers that were meant."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.methods.common_field import common_field, in_one_field, rational_power
from driftproof.methods.expressions import parse_number
from driftproof.methods.number_field import Algebraic, NumberField, UndecidedError, cube_root, square_root
from driftproof.methods.tableau_file import read_method
from driftproof.symbolic.facts import Facts
from tests.methods.conftest import Write

# The last one's equation is not monic: 6x^3 - 18x^2 + 9x - 1 = 0.
ROOTS = [square_root(2), square_root(3), cube_root(2), square_root(8), square_root(5)]
ROOTS.append(NumberField("gamma", (-1, 9, -18, 6), Q(2, 5), Q(1, 2)).generator)
# So small that sqrt 2 plus it and less it are one ball of 64 bits.
ROOTS.append(NumberField("tiny", (-3, 0, 10**40), Q(0), Q(1)).generator)


@pytest.mark.parametrize(
    ("chosen", "degree"),
    [((0, 1), 4), ((0, 2), 6), ((0, 3), 2), ((0, 1, 4), 8), ((1, 2), 6), ((0, 5), 6), ((5, 0), 6), ((0, 6), 4)],
)
def test_roots_of_several_fields_keep_their_values_and_their_equations(chosen: tuple[int, ...], degree: int) -> None:
    values = [ROOTS[k] for k in chosen]
    lifted = in_one_field([*values, Q(1, 3)])
    field = common_field(values)
    assert field is not None
    assert field.degree == degree
    assert lifted[-1] == Q(1, 3)
    for before, after in zip(values, lifted, strict=False):
        assert isinstance(after, Algebraic)
        assert after.field == field
        assert sum(c * after**k for k, c in enumerate(before.field.minimal)) == 0
        assert abs(float(after) - float(before)) < 1e-15


def test_field_of_too_large_a_degree_is_refused() -> None:
    with pytest.raises(UndecidedError, match=r"degree 14|degree 21|degree 49|may have degree"):
        in_one_field([NumberField("a", (-2, *[0] * 6, 1), Q(1), Q(2)).generator, rational_power(Q(3), Q(1, 11))])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2**(1/3)", cube_root(2)),
        ("8**(2/3)", Q(4)),
        ("(1/2)**(1/2)", square_root(2) / 2),
        ("4**(1/4)", square_root(2)),
        ("2**(-1/3)", cube_root(4) / 2),
        ("128**(1/7)", Q(2)),
        ("2048**(1/11)", Q(2)),
    ],
)
def test_fractional_powers_of_rationals_are_exact(text: str, value: Q | Algebraic) -> None:
    assert parse_number(text, "x") == value


def test_expression_mixes_fields() -> None:
    found = parse_number("sqrt(2)*sqrt(3) - sqrt(6)", "x")
    assert found == 0
    fifth = parse_number("5**(1/5)", "x")
    assert fifth**5 == 5
    for bad in ("(-2)**(1/3)", "sqrt(2)**(1/2)", "2**(1/13)", "2**(1/7) + 3**(1/5)"):
        with pytest.raises(ValueError, match="column"):
            parse_number(bad, "x")


def test_table_over_two_square_roots_has_its_facts(write: Write) -> None:
    """Two stages of weight one half, at nodes that sum to 1: order 2, whatever roots they hold."""
    mine = write(
        'family = "runge_kutta"\nA = [["r/4", "1/4"], ["s/8", "3/4 - r/4 - s/8 + 2**(1/2)*0"]]\n'
        'b = ["1/2", "1/2"]\n[roots]\nr = "sqrt(2)"\ns = "sqrt(3)"\n'
    )
    facts = Facts(read_method(mine))  # type: ignore[arg-type]
    assert facts.order == 2
    assert facts.method.field is not None
    assert facts.method.field.degree == 4
    assert facts.a_stable in (True, False)
