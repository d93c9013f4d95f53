"""Several roots in one field, and fractional powers: exact, with the real numbers that were meant."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.methods.formulas.expressions import parse_number
from driftproof.methods.numbers.common_field import common_field, in_one_field, rational_power
from driftproof.methods.numbers.number_field import (
    Algebraic,
    NumberField,
    UndecidedError,
    cube_root,
    integer_root,
    square_root,
)
from driftproof.methods.tableau_file import read_method
from driftproof.symbolic.facts import Facts
from tests.looping import exactly
from tests.methods.conftest import Write

# The last one's equation is not monic: 6x^3 - 18x^2 + 9x - 1 = 0.
ROOTS = [square_root(2), square_root(3), cube_root(2), square_root(8), square_root(5)]
ROOTS.append(NumberField("gamma", (-1, 9, -18, 6), Q(2, 5), Q(1, 2)).generator)
# So small that sqrt 2 plus it and less it are one ball of 64 bits.
ROOTS.append(NumberField("tiny", (-3, 0, 10**40), Q(0), Q(1)).generator)
# Of the largest degrees that are looked at, 12 by 4, and of the largest that is made; and that which is -sqrt 2.
ROOTS += [integer_root(2, 12), integer_root(2, 4), NumberField("minus", (-2, 0, 1), Q(-2), Q(-1)).generator]


@pytest.mark.parametrize(
    ("chosen", "degree"),
    [
        *(((0, 1), 4), ((0, 2), 6), ((0, 3), 2), ((0, 1, 4), 8), ((1, 2), 6), ((0, 5), 6), ((5, 0), 6), ((0, 6), 4)),
        *(((7, 8), 12), ((0, 9), 2), ((0, 0), 2)),
    ],
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


def test_common_field_is_told_by_its_equation_and_by_ends_that_are_near() -> None:
    ends = Q(3378275643, 2**30), Q(13513102575, 2**32)
    assert common_field([ROOTS[0], Q(1), ROOTS[1]]) == NumberField("(sqrt(2) + sqrt(3))", (1, 0, -10, 0, 1), *ends)
    second = common_field([ROOTS[0], ROOTS[9]])  # √2 - √2 spans nothing
    assert second is not None
    assert second.name == "(sqrt(2) + 2*minus)"
    assert common_field([Q(1)]) is None


def test_field_of_too_large_a_degree_is_refused() -> None:
    seventh = rational_power(Q(3), Q(1, 7))
    for other, reason in (
        (integer_root(2, 7), "may have degree 49; write one field"),
        (square_root(3), "field of degree 14;"),
    ):
        with pytest.raises(UndecidedError, match=reason):
            in_one_field([seventh, other])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2**(1/3)", cube_root(2)), ("8**(2/3)", Q(4)), ("(1/2)**(1/2)", square_root(2) / 2),
        ("4**(1/4)", square_root(2)), ("(4/9)**(1/2)", Q(2, 3)), ("2**(-1/3)", cube_root(4) / 2),
        ("(1/3)**(1/3)", cube_root(9) / 3), ("1**(1/2)", Q(1)), ("4096**(1/12)", Q(2)), ("32**(1/5)", Q(2)),
        ("128**(1/7)", Q(2)), ("2048**(1/11)", Q(2)),
    ],
)  # fmt: skip
def test_fractional_powers_of_rationals_are_exact(text: str, value: Q | Algebraic) -> None:
    assert parse_number(text, "x") == value


def test_expression_mixes_fields() -> None:
    found = parse_number("sqrt(2)*sqrt(3) - sqrt(6)", "x")
    assert found == 0
    fifth = parse_number("5**(1/5)", "x")
    assert fifth**5 == 5
    positive = "only a positive rational number may have a fractional exponent"
    for bad, reason in exactly(5, [
        ("(-1/2)**(1/3)", positive), ("0**(1/2)", positive), ("sqrt(2)**(1/2)", positive),
        ("2**(1/13)", "a root of degree 13; at most 12"), ("2**(1/7) + 3**(1/5)", "degree 35"),
    ]):  # fmt: skip
        with pytest.raises(ValueError, match=f"column .*: .*{reason}"):
            parse_number(bad, "x")


def test_table_over_three_square_roots_has_its_facts(write: Write) -> None:
    """Two stages of weight one half, at nodes that sum to 1: order 2, whatever roots they hold.

    The third is met only after the sums of a row have shown that there are two.
    """
    mine = write(
        'family = "runge_kutta"\nA = [["r/4", "1/4"], ["s/8", "3/4 - r/4 - s/8 + 2**(1/2)*0"]]\n'
        'b = ["1/2", "1/2"]\nb_embedded = ["sqrt(5)", "1 - sqrt(5)"]\n[roots]\nr = "sqrt(2)"\ns = "sqrt(3)"\n'
    )
    facts = Facts(read_method(mine))  # type: ignore[arg-type]
    assert facts.order == 2
    assert facts.method.field is not None
    assert facts.method.field.degree == 8
