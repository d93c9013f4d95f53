"""What a reader sees of a bound."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.steppers import forward_euler, rk4
from driftproof.symbolic.rounding.formats import BINARY16
from driftproof.symbolic.rounding.polynomials import terms
from driftproof.symbolic.rounding.step_bound import step_bound
from driftproof.symbolic.rounding.text import first_order_text, format_text, full_text


def test_a_reader_sees_the_formula():
    assert first_order_text(step_bound(rk4)) == [
        "|dq| <= u ((1 + 23/6 h**2 + 5/12 h**4) |q| + (37/6 h + 3/2 h**3) |v|)",
        "|dv| <= u ((37/6 h + 3/2 h**3) |q| + (1 + 23/6 h**2 + 5/12 h**4) |v|)",
    ]
    assert full_text(step_bound(forward_euler)) == [
        "|dq|: d (|q| + 2 h |v|)", "|dq|: d**2 (h |v|)", "|dq|: eta (1/2)", "|dq|: eta d (1/2)",
        "|dv|: d (2 h |q| + |v|)", "|dv|: d**2 (h |q|)", "|dv|: eta (1/2)", "|dv|: eta d (1/2)",
    ]  # fmt: skip
    first_powers = {p: full_text(step_bound(forward_euler), p)[2::2] for p in ((1, 1), (1, 0), (2, 0))}
    assert first_powers == {
        (1, 1): ["|dq|: eta d (1/2)", "|dv|: eta (1/2)", "and 2 lines with higher powers of d"],
        (1, 0): ["and 6 lines with higher powers of d or eta"],
        (2, 0): ["|dv|: d (2 h |q| + |v|)", "and 4 lines with higher powers of d or eta"],
    }
    assert full_text(step_bound(rk4))[-1] == "and 30 lines with higher powers of d"
    assert len(full_text(step_bound(rk4), powers=None)) == len(full_text(step_bound(rk4))) - 1 + 30
    assert format_text(step_bound(rk4, BINARY16)) == "binary16: u = 2**-11, d = u/(1 + u), eta = 2**-24"


def test_printed_coefficients_are_above_the_derived_ones_and_hardly():
    bound = step_bound(METHODS["mclachlan_atela2"])
    printed = {x for line in first_order_text(bound) for x in line.split() if x.replace(".", "").isdigit() and "." in x}
    derived = {c for row in bound.first_order for p in row for _, c in terms(p)}
    assert len(printed) >= 4
    for text in printed:
        assert any(c <= Q(text) <= c * (1 + Q(1, 10**5)) for c in derived), text
