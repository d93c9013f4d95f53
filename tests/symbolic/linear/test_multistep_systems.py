"""Multistep methods on y' = Ay: verdicts, limits and factors beside the roots of the recurrence in floats."""

import random
from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.multistep import Multistep
from driftproof.methods.tables.multistep import ENTRIES
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.linear.multistep_systems import MultistepSystemFacts
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError
from driftproof.symbolic.linear.stability_limits import ALWAYS, INFINITY, NEVER
from tests.looping import exactly
from tests.symbolic.linear.linear_examples import parse_system
from tests.witnesses.multistep import largest

MULTISTEP = {method.key: method for method in ENTRIES if method.derivative == 1}
# Roots of the recurrence in floats are off by far less for simple roots of these sizes (chosen).
NEAR = 1e-6
# One Jordan block each: of -1, of ±i, and of -1 ± i.
BLOCK, PAIRS = "-1 1; 0 -1", "0 1 1 0; -1 0 0 1; 0 0 0 1; 0 0 -1 0"
DAMPED_PAIRS = "-1 1 1 0; -1 -1 0 1; 0 0 -1 1; 0 0 -1 -1"


def facts(key, text):
    return MultistepSystemFacts(MULTISTEP[key], parse_system(text))


@pytest.mark.parametrize("key", MULTISTEP)
def test_bounded_is_what_the_roots_in_floats_say_and_factors_are_their_sizes(key):
    random.seed(key)
    decided = 0
    for _ in range(12):
        rows = [[Q(random.randint(-6, 3)) for _ in range(2)] for _ in range(2)]
        found, h = MultistepSystemFacts(MULTISTEP[key], rows), Q(random.randint(1, 40), 64)
        values = np.linalg.eigvals(np.array(rows, float))
        radius = max(largest(MULTISTEP[key], float(h) * z) for z in values)
        if abs(radius - 1) > NEAR and abs(values[0] - values[1]) > NEAR:
            decided += 1
            assert found.bounded_at(h) is bool(radius < 1), (rows, h)
            sizes = sorted(largest(MULTISTEP[key], float(h) * z) for z in values)
            factors = sorted(float(enclose(found.factor_at(e, h))) for e, _ in found.bounds)
            assert factors == pytest.approx(sizes[-len(factors) :])  # a conjugate pair is one
            assert float(enclose(found.stiffest_factor(h))) == pytest.approx(
                max(largest(MULTISTEP[key], float(h) * z) for z in values if abs(z) > max(abs(values)) - NEAR)
            )
    assert decided > 5


@pytest.mark.parametrize(
    ("key", "text", "limit", "attained"),
    [
        *(("adams_bashforth2", "-1000", Q(1, 1000), True), ("adams_moulton2", "-3 0; 0 -2", Q(2), True)),
        *(("two_step_leapfrog", "0 1; -4 0", Q(1, 2), False), ("adams_bashforth2", "0 1; -1 0", Q(0), None)),
        *(("bdf2", "0 1; -9 -3", None, None), ("bdf3", "-1 10; -10 -1", None, None), ("bdf4", "-7", None, None)),
        *(("adams_bashforth3", "0 0; 0 0", None, None), ("adams_bashforth2", "0 1; 0 0", Q(0), None)),
        *(("bdf2", "1", Q(0), None), ("milne_simpson", "-1", Q(0), None)),
        *(("bdf2", BLOCK, None, None), ("milne_simpson", BLOCK, Q(0), None)),
        *(("bdf3", DAMPED_PAIRS, None, None), ("bdf2", DAMPED_PAIRS, None, None)),
        ("adams_bashforth2", PAIRS, Q(0), None),
    ],
)
def test_limits_are_those_of_the_literature(key, text, limit, attained):
    found = facts(key, text).step_limit
    assert found == (ALWAYS if limit is None else NEVER) or (found.limit.rational, found.attained) == (limit, attained)
    assert (found == ALWAYS) is (limit is None)
    assert (found == NEVER) is (limit == 0)


def test_an_irrational_limit_is_decided_where_its_square_is_rational():
    """ρ² + y²σ² of three steps of Adams and Bashforth has its first pair of roots on the circle at y² = 144/275."""
    found = facts("adams_bashforth3", "0 1; -1 0").step_limit
    assert (found.limit.minimal, found.attained) == ((-144, 0, 275), True)


@pytest.mark.parametrize(
    ("key", "text", "what"),
    [
        ("bdf3", "-1 20; -20 -1", "outside every sector"),
        ("bdf2", PAIRS, "a Jordan block of an undamped"),
        ("bdf4", BLOCK, "a Jordan block of a real eigenvalue"),
    ],
)
def test_a_limit_that_is_not_decided_says_why_but_a_step_is_decided(key, text, what):
    found = facts(key, text)
    with pytest.raises(UndecidedLimitError, match=what):
        assert found.step_limit
    assert found.bounded_at(Q(1, 100))
    assert found.bounded_at(Q(1, 20)) is (key != "bdf3")  # h(-1 ± 20i) lies outside the region of bdf3


def test_roots_on_the_circle_are_a_factor_of_exactly_one_but_for_a_jordan_block():
    leapfrog = facts("two_step_leapfrog", "0 1; -1 0")
    assert leapfrog.stiffest_factor(Q(1, 3)) == leapfrog.stiffest_factor(Q(1)) == 1
    assert leapfrog.bounded_at(Q(1, 3)) is not leapfrog.bounded_at(Q(1))  # i is a double root
    assert not facts("two_step_leapfrog", "0 1 1 0; -1 0 0 1; 0 0 0 1; 0 0 -1 0").bounded_at(Q(1, 3))
    assert not facts("adams_bashforth2", "-1 1; 0 -1").bounded_at(Q(1))  # a simple root -1, twice
    assert not facts("adams_bashforth2", "0 1; 0 0").bounded_at(Q(1, 3))
    assert facts("adams_bashforth2", "-1 1; 0 -1").bounded_at(Q(1, 3))


def test_a_step_without_a_new_value_is_not_bounded():
    """Of BDF2, 3/2 y = hλy + ...: at hλ = 3/2 nothing is left of the newest value."""
    assert not facts("bdf2", "3").bounded_at(Q(1, 2))
    assert facts("bdf2", "3").bounded_at(Q(2))


def test_a_common_factor_is_not_looked_past():
    double = Multistep("double", "", 1, "", rho=(1, -2, 1), sigma=(-1, 1, 0))  # forward Euler, times ζ - 1
    found = MultistepSystemFacts(double, [[Q(-1)]])
    for ask in (lambda: found.step_limit, lambda: found.bounded_at(Q(1))):
        with pytest.raises(UndecidedLimitError, match="common factor"):
            ask()


@pytest.mark.parametrize("rate", [-1, 1])
def test_what_is_not_zero_stable_has_no_limit_and_what_is_not_consistent_none_that_is_decided(rate):
    growing = Multistep("growing", "", 1, "", rho=(2, -3, 1), sigma=(-1, 0, 0))  # ζ = 2 for every h that tends to 0
    assert MultistepSystemFacts(growing, [[Q(rate)]]).step_limit == NEVER
    assert MultistepSystemFacts(growing, [[Q(0)]]).step_limit == NEVER
    backward = Multistep("backward", "", 0, "", rho=(-1, 1), sigma=(-1, 0))  # ζ = 1 - hλ
    with pytest.raises(UndecidedLimitError, match="not consistent"):
        assert MultistepSystemFacts(backward, [[Q(rate)]]).step_limit
    assert MultistepSystemFacts(backward, [[Q(rate)]]).bounded_at(Q(1)) is (rate == 1)


def test_at_infinity_the_roots_are_those_of_sigma():
    sizes = {key: facts(key, "-1").at_infinity() for key in MULTISTEP}
    assert [key for key, size in sizes.items() if size == 0] == [k for k in MULTISTEP if k.startswith(("bdf", "ndf"))]
    assert [key for key, size in sizes.items() if size == INFINITY] == [k for k, m in MULTISTEP.items() if m.explicit]
    for key, size in exactly(6, [each for each in sizes.items() if callable(each[1])]):
        assert float(enclose(size)) == pytest.approx(max(abs(np.roots([float(x) for x in MULTISTEP[key].sigma[::-1]]))))
