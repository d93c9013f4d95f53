"""Facts of a one-step matrix: its entries, determinant, energy, linear order, and how it differs from a method's."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.numeric.steppers import rk4, symplectic_euler
from tests.blackbox.matching.linear_fits import VARIANTS, fit, like_rk4


def test_order_0_is_said_of_a_position_that_moves_by_half():
    lines = fit(VARIANTS[-1][0]).lines
    assert "order 0: the position moves by 0.5 h v" in lines
    assert "linear order 0" in lines


def test_what_no_method_explains_is_recovered_with_the_system_that_it_follows():
    def drag_in_the_kick(q, v, h):
        v = v + h * (-q - 0.25 * v)
        return q + h * v, v

    found = fit(drag_in_the_kick)
    assert found.best is None
    assert (found.damping, found.facts.determinant) == (Q(1, 4), "1 - h/4")
    assert "small steps follow q' = v, v' = -q - 0.25 v" in found.lines
    assert fit(lambda force, q, v, h: rk4(force, *symplectic_euler(force, q, v, h / 2), h / 2)).facts.linear_order == 1


def test_facts_of_a_method_are_those_of_its_exact_matrix():
    found = fit(lambda force, q, v, h: rk4(force, q, v, h))
    assert found.facts.entries[:2] == ("1 - h**2/2 + h**4/24", "h - h**3/6")
    assert found.facts.determinant == found.facts.energy_multiplier == "1 - h**6/72 + h**8/576"
    assert found.facts.linear_order == 4


def test_a_wrong_weight_is_read_as_the_fraction_that_it_is():
    found = fit(like_rk4(1 / 23))
    assert found.best is None
    assert found.nearest.methods[0] == "rk4"
    assert found.nearest.differences == ("h^4 coefficient of M_qq is 1/23, rk4 has 1/24",)
    assert found.facts.entries[0] == "1 - h**2/2 + h**4/23"
    assert found.facts.determinant == "1 + h**4/552 - 49*h**6/3312 + h**8/552"
    assert found.facts.energy_multiplier is None
    assert found.facts.linear_order == 3


def test_a_weight_off_by_1e_10_is_read_as_a_decimal_with_its_error():
    found = fit(like_rk4(1 / 24 + 1e-10))
    (difference,) = found.nearest.differences
    assert difference.startswith("h^4 coefficient of M_qq is 0.041666666766")
    assert difference.endswith("rk4 has 1/24")
    assert found.facts is None
