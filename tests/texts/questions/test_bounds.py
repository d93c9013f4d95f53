"""Answers about rounding: the bound holds for a float step, is as small as first order says, and is rounded up."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.texts.questions.decimals import Style
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from tests.texts.questions.steps_by_hand import BY_HAND


def test_rounding_bound_holds_for_a_float_step_and_is_rounded_up() -> None:
    h, u = 0.25, Q(1, 2**53)
    for q, v in ((1.0, 0.0), (0.3, -0.7), (1.1, 1e-9)):
        v1 = v + h * -q
        q1 = q + h * v1
        exact = BY_HAND["symplectic_euler"]((Q(q), Q(v)), Q(h))
        for name, error in (("q", abs(Q(q1) - exact[0])), ("v", abs(Q(v1) - exact[1]))):
            for sharp in ("", "sharp "):
                bound = value(f"roundoff symplectic_euler h=1/4 {sharp}from {Q(q)},{Q(v)} : {name}").exact
                assert isinstance(bound, Q)
                assert error <= bound * u
    # To first order |dq| <= u ((1 + 4h²)|q| + 3h|v|); d = u/(1 + u) and the second order leave 1e-15 of it.
    entries = {"qq": Q(5, 4), "qv": Q(3, 4), "vq": Q(1, 2), "vv": Q(1)}
    for name, first_order in entries.items():
        found = value(f"roundoff symplectic_euler h=1/4 : {name}")
        assert isinstance(found.exact, Q)
        assert abs(found.exact - first_order) < Q(1, 10**15)
        assert Q(found.digits(3)) >= found.exact
        assert found.unit == "u"


def test_growth_of_a_step_is_the_largest_size_of_its_bound() -> None:
    """c of E(h), in the Euclidean norm: at least every entry, and at most the sum of all."""
    entries = [value(f"roundoff rk4 h=1/4 : {x}").exact for x in ("qq", "qv", "vq", "vv")]
    growth = value("roundoff rk4 h=1/4 : c").exact
    assert max(entries) < growth < sum(entries)
    assert growth < value("roundoff rk4 h=1/2 : c").exact


def test_sharp_bounds_are_smaller_where_cancellation_is_seen() -> None:
    for readout in ("qq", "q"):
        plain, sharp = (value(f"roundoff symplectic_euler h=1/4 {word} : {readout}").exact for word in ("", "sharp"))
        assert isinstance(plain, Q)
        assert isinstance(sharp, Q)
        assert abs(plain - Q(5, 4)) < Q(1, 10**15)
        assert abs(sharp - 1) < Q(1, 10**15)


def test_bound_is_rounded_up_unless_another_policy_is_named() -> None:
    bound = value("roundoff rk4 h=1/3 : qq")
    assert isinstance(bound.exact, Q)
    assert bound.is_bound
    for n in range(1, 12):
        assert Q(bound.digits(n)) >= bound.exact >= Q(bound.digits(n)) - Q(10) ** (1 - n)
    assert any(bound.digits(n) != bound.digits(n, Style("half-even")) for n in range(1, 12))


def test_a_step_that_overflows_has_no_bound() -> None:
    for start in ("1.7e308,1.7e308", "0,1.7e308"):
        for readout in ("q", "v", "qq", "c"):
            with pytest.raises(QuestionError, match=r"the step may overflow .* nothing overflows for .* <= 1e307"):
                value(f"roundoff rk4 h=1/2 from {start} : {readout}")
    assert value("roundoff rk4 h=1/2 from 1e307,1e307 : v").exact is not None
