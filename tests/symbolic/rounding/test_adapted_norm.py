"""The norm in which a step is a rotation times a factor, and the constants that go with it."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.rounding.adapted_norm import AdaptedNorm, NoAdaptedNorm, adapted_norm, root_above
from driftproof.symbolic.rounding.step_bound import LinearBound
from driftproof.symbolic.runs import apply, exact_matrix_at
from tests.nine import NINE
from tests.symbolic.rounding.programs import IRRATIONAL, ONE_ZERO


@pytest.mark.parametrize("key", [*NINE, *IRRATIONAL])
def test_a_step_is_rho_times_an_isometry_of_its_norm_exactly_over_q_or_its_field(key):
    m = exact_matrix_at(METHODS[key], Q(0.7))
    norm = adapted_norm(m)
    form = lambda q, v: norm.qq * q * q + norm.qv * q * v + norm.vv * v * v
    for z in (ONE_ZERO, (Q(0), Q(1)), (Q(2), Q(-3))):
        assert form(*apply(m, *z)) == norm.rho_squared * form(*z) > 0
        assert norm.length(*z) ** 2 >= form(*z)
    assert max(norm.qq, norm.vv) == 1
    assert norm.rho**2 >= norm.rho_squared


def test_there_is_no_norm_where_the_step_has_a_real_direction_and_one_just_before():
    step = METHODS["symplectic_euler"]
    for h in (Q(2), Q(5, 2)):
        with pytest.raises(NoAdaptedNorm):
            adapted_norm(exact_matrix_at(step, h))
    assert adapted_norm(exact_matrix_at(step, Q(2) - Q(1, 2**50))).rho == 1
    assert adapted_norm((Q(3), Q(0), Q(0), Q(3))) == AdaptedNorm(Q(1), Q(0), Q(1), Q(9))


@settings(max_examples=200)
@given(x=st.fractions(min_value=0, max_denominator=10**6), scale=st.integers(-400, 400))
def test_a_root_is_rounded_up_by_less_than_its_last_bits(x, scale):
    x *= Q(2) ** scale
    root = root_above(x)
    assert root**2 >= x
    assert (root * (1 - Q(1, 2**190))) ** 2 <= x
    assert root_above(x * x) >= x
    assert root_above(Q(25, 4)) == Q(5, 2)
    ends = [root_above(x).denominator for x in (Q(2), Q(3, 2**300), Q(3 * 2**900), Q(1, 3))]
    assert ends == [2**200, 2**347, 1, 2**197], "as many bits as are promised, and no more"


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["symplectic_euler", "velocity_verlet", "position_verlet"])
@settings(max_examples=60)
@given(
    h=st.fractions(Q(-19, 10), Q(19, 10), max_denominator=64).filter(bool),
    e=st.lists(st.fractions(0, 4, max_denominator=16), min_size=4, max_size=4),
    z=st.tuples(st.integers(-9, 9), st.integers(-9, 9)),
    signs=st.tuples(*[st.sampled_from([1, -1])] * 2),
)
def test_the_gain_bounds_every_error_and_the_other_constants_every_state(key, h, e, z, signs):
    norm = adapted_norm(exact_matrix_at(METHODS[key], h))
    error = ((e[0], e[1]), (e[2], e[3]))
    dq, dv = LinearBound(error, (Q(0), Q(0))).of(Q(z[0]), Q(z[1]))
    length = norm.length(Q(z[0]), Q(z[1]))
    assert norm.length(signs[0] * dq, signs[1] * dv) <= norm.gain(error) * length * (1 + Q(1, 2**100))
    assert norm.length(signs[0] * dq, signs[1] * dv) <= norm.largest_of_signs(dq, dv)
    assert Q(z[0] ** 2 + z[1] ** 2) <= (norm.euclidean_per_unit * length) ** 2
    assert max(abs(z[0]), abs(z[1])) <= norm.component_per_unit * length


def test_the_gain_is_attained():
    """Not only an upper bound: for the Euclidean norm and E = ((1, 2h), (2h, 1)) it is 1 + 2h, at z = (1, 1)."""
    norm = adapted_norm(exact_matrix_at(METHODS["forward_euler"], Q(1, 4)))
    gain = norm.gain(((Q(1), Q(1, 2)), (Q(1, 2), Q(1))))
    assert Q(3, 2) <= gain <= Q(3, 2) * (1 + Q(1, 2**100))
