"""Irrational coefficients: the bound is about the exact map over the number field, for one step, for N, and printed."""

from __future__ import annotations

import random
from fractions import Fraction as Q
from functools import cache

import numpy as np
import pytest
from flint import ctx
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.methods.number_field import Algebraic, cube_root, square_root
from driftproof.methods.problems import oscillator
from driftproof.methods.schemes import Splitting
from driftproof.methods.stepping import stepper
from driftproof.numeric.worst_case import Envelope
from driftproof.numeric.worst_case_search import search
from driftproof.symbolic.algebra.certified import enclose, is_less
from driftproof.symbolic.linear.oscillator import one_step_matrix
from driftproof.symbolic.rounding import number
from driftproof.symbolic.rounding.any_order import any_order_bound
from driftproof.symbolic.rounding.error_of_run import ErrorOfRun
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat
from driftproof.symbolic.rounding.irrational import GUARD_BITS, above, ends, middle_and_radius, size
from driftproof.symbolic.rounding.n_steps import HypothesisFails, run_bound
from driftproof.symbolic.rounding.number import RefusedOperation, constant
from driftproof.symbolic.rounding.own_norm import own_norm
from driftproof.symbolic.rounding.polynomials import RING, H, V, constant_term, majorant, nearly, polynomial, terms
from driftproof.symbolic.rounding.sharp import sharp_bound
from driftproof.symbolic.rounding.soft_float import soft_lift
from driftproof.symbolic.rounding.step import step_bound
from driftproof.symbolic.rounding.text import first_order_text
from driftproof.symbolic.rounding.trace import program_of
from driftproof.symbolic.runs import apply, exact_matrix_at
from tests.changes import coefficients, first_weight, moved

IRRATIONAL = [key for key, m in METHODS.items() if m.explicit and getattr(m, "field", None)]
# No dyadic number, so that h times a coefficient really rounds.
STEP = Q(0.7)
ONE_ZERO = (Q(1), Q(0))
ROOT = square_root(2)

plain_of = cache(lambda key: step_bound(METHODS[key]))
sharp_of = cache(lambda key: sharp_bound(METHODS[key], STEP))
elements = st.builds(lambda a, b: a + b * ROOT, *[st.fractions(max_denominator=10**6)] * 2)


def test_catalogue_has_explicit_irrational_methods_of_both_families_and_of_several_fields():
    assert {"gill4", "ralston4", "cooper_verner8", "yoshida4", "suzuki4", "mclachlan2"} <= set(IRRATIONAL)
    assert len({METHODS[key].field for key in IRRATIONAL}) >= 6


# --- numbers and polynomials over the field -------------------------------------------------------------------------


@given(elements, st.integers(-300, 300))
def test_ends_enclose_as_tightly_as_promised_and_a_rational_is_itself(x: Algebraic, scale: int):
    x = x * Q(2) ** scale
    low, high = ends(x)
    assert low <= x <= high
    assert (high - low) * 2**GUARD_BITS <= size(x)
    assert (low == high) == x.is_rational
    assert above(x) == high
    middle, radius = middle_and_radius(x)
    assert size(x - middle) <= radius <= (high - low) / 2


def test_a_number_that_cancels_to_almost_nothing_is_enclosed_relative_to_what_is_left():
    """(sqrt(2) - 1)^400 is 10^-153, a difference of two numbers of 153 digits."""
    left = (ROOT - 1) ** 400
    low, high = ends(left)
    assert 0 < low < left < high
    assert (high - low) * 2**GUARD_BITS <= left < Q(1, 10**153)


@given(elements, elements, elements)
def test_polynomials_over_a_field_multiply_as_their_values_do(a: Algebraic, b: Algebraic, c: Algebraic):
    h, v = Q(3, 7), Q(-5, 2)
    p, q = polynomial(a) * H + polynomial(b) * V - 2, 3 - polynomial(c) * V * H

    def value(x):
        return sum((k * h**in_h * v**in_v for (_, _, in_h, _, in_v), k in terms(x)), Q(0))

    at_p, at_q = a * h + b * v - 2, 3 - c * v * h
    assert (value(p), value(q)) == (at_p, at_q)
    assert (value(p * q), value(p - q), value(H * p), value(RING.one + p)) == (
        at_p * at_q,
        at_p - at_q,
        h * at_p,
        1 + at_p,
    )
    assert bool(p - p) is False
    assert size(at_p) <= value_at_sizes(majorant(p), h, v)
    middle, radius = nearly(p)
    assert size(at_p - value(middle)) <= value_at_sizes(radius, h, v)


def value_at_sizes(bound, h: Q, v: Q) -> Q:
    return sum((c * abs(h) ** in_h * abs(v) ** in_v for (_, _, in_h, _, in_v), c in terms(bound)), Q(0))


def test_two_fields_do_not_mix():
    with pytest.raises(TypeError, match=r"between sqrt\(2\) and 3\*\*\(1/3\)"):
        polynomial(ROOT) * polynomial(cube_root(3))


@pytest.mark.parametrize("fmt", [BINARY64, BINARY32, BINARY16], ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", IRRATIONAL)
def test_each_coefficient_is_rounded_correctly_and_owns_up_to_just_its_distance(key: str, fmt: FloatFormat):
    """fl(c) by enclosures; float(c) finds the double by bisection, another way."""
    for c in set(coefficients(METHODS[key]).values()):
        lifted = constant(c, fmt)
        if fmt == BINARY64:
            assert lifted.held == Q(float(c))
        assert constant_term(lifted.exact) == c
        error = sum(k * fmt.relative_error**in_d for (in_d, *_), k in terms(lifted.error))
        distance = size(c - lifted.held)
        assert distance <= error <= distance * (1 + 2 * fmt.u**2)
        assert error <= fmt.u * size(c)


# --- one step -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("key", IRRATIONAL)
def test_the_polynomial_of_the_program_is_the_definition_s_over_the_field(key: str):
    """Exactly: the other side runs over FLINT's polynomials, this one over SymPy's."""
    bound = plain_of(key)
    assert bound.differences(one_step_matrix(METHODS[key])) == []
    assert bound.rounds_constants
    assert bound.differences(one_step_matrix(off_by_1e_13(key))) != []


@pytest.mark.parametrize("key", ["gill4", "mclachlan2"])
def test_the_bound_of_any_order_covers_the_program_over_a_field_too(key: str):
    assert any_order_bound(METHODS[key]).covers(plain_of(key))
    assert not any_order_bound(METHODS[key]).covers(plain_of("luther6"))


def off_by_1e_13(key: str):
    return moved(METHODS[key], first_weight(METHODS[key]), Q(1, 10**13))


def error_in_balls(key: str, program, h: float, q: float, v: float):
    """|fl(step(z)) - M(h) z| with M over the number field, in Arb balls of 300 bits."""
    floats = program(oscillator, q, v, h)
    with ctx.workprec(300):
        exact = apply([enclose(x) for x in exact_matrix_at(METHODS[key], Q(h))], enclose(Q(q)), enclose(Q(v)))
        return [abs(enclose(Q(x)) - y) for x, y in zip(floats, exact, strict=True)]


@pytest.mark.parametrize("key", IRRATIONAL)
def test_no_step_of_a_search_leaves_the_bound_around_the_exact_map(key: str):
    """The search measures against rationals next to M; the worst that it finds is measured again, in balls."""
    step, bound = stepper(METHODS[key], float), plain_of(key)
    envelope = Envelope(*bound.coefficients)
    found = search(step, envelope, np.float64, (0.01, 1.0), seed=1, generations=10, population=1 << 10)
    assert found.violations == 0
    errors = error_in_balls(key, step, found.h, *found.state)
    most = bound.error_of(Q(found.h), *map(Q, found.state))
    assert all(e <= enclose(x) for e, x in zip(errors, most, strict=True))
    assert any(e > enclose(x / 2) for e, x in zip(errors, most, strict=True)), found.ratio


def drawn_states(count: int):
    draw = random.Random(3)
    return [(draw.uniform(-1, 1), draw.uniform(-1, 1)) for _ in range(count)]


@pytest.mark.parametrize("key", IRRATIONAL)
def test_the_sharper_bound_holds_around_the_exact_map_and_a_planted_error_of_1e_13_leaves_it(key: str):
    right, wrong = (stepper(method, float) for method in (METHODS[key], off_by_1e_13(key)))
    left = 0
    for q, v in drawn_states(8):
        most = [enclose(x) for x in sharp_of(key).error_of(Q(q), Q(v))]
        errors, off = (error_in_balls(key, program, float(STEP), q, v) for program in (right, wrong))
        assert all(e <= x for e, x in zip(errors, most, strict=True))
        left += any(e > x for e, x in zip(off, most, strict=True))
    assert left >= 7


@pytest.mark.parametrize("key", IRRATIONAL)
def test_the_sharper_bound_is_about_the_very_matrix_of_the_definition(key: str):
    (qq, qv), (vq, vv) = sharp_of(key).matrix
    assert (qq, qv, vq, vv) == exact_matrix_at(METHODS[key], STEP)
    assert sharp_bound(program_of(METHODS[key], BINARY64), STEP).matrix != sharp_of(key).matrix


def test_a_bound_as_held_does_not_speak_of_the_definition():
    """c = 1.0004... is held as 1, so that the program is q + h v: within 2d|h v| + d|q| of that, not of q + c h v."""
    fmt, draw = BINARY16, random.Random(1)
    c = 1 + (ROOT - 1) * 2 * fmt.u
    method = Splitting("almost_one", "One drift", 0, "none", (("drift", c),))
    as_held = lambda h: sharp_bound(program_of(method, fmt), h, fmt)
    h, left = fmt.nearest(Q(61, 32)), 0
    held, defined = as_held(h), sharp_bound(method, h, fmt)
    assert held.matrix[0][1] == h != defined.matrix[0][1] == c * h
    for _ in range(200):
        q, v = (fmt.nearest(Q(x)) for x in (draw.uniform(-1 / 4, 1 / 4), draw.uniform(1, 2)))
        lift = soft_lift(fmt)
        reached = stepper(method, lift)(oscillator, lift(q), lift(v), lift(h))[0].value
        assert abs(reached - (q + h * v)) <= held.error_of(q, v)[0]
        assert size(reached - (q + c * h * v)) <= defined.error_of(q, v)[0]
        left += size(reached - (q + c * h * v)) > held.error_of(q, v)[0]
    assert left > 0


def test_highest_powers_are_gathered_upwards_and_make_no_difference(monkeypatch: pytest.MonkeyPatch):
    coarse = FloatFormat("coarse", 3, -1, 7)
    for fmt in (BINARY64, coarse):
        short = step_bound(METHODS["forest_ruth"], fmt)
        with monkeypatch.context() as patched:
            patched.setattr(number, "MOST_D", 10**6)
            patched.setattr(number, "MOST_ETA", 10**6)
            whole = step_bound(METHODS["forest_ruth"], fmt)
        assert max(in_d for (in_d, *_), _ in terms(short.outputs[0].error)) == number.MOST_D
        assert max(in_d for (in_d, *_), _ in terms(whole.outputs[0].error)) > number.MOST_D
        pairs = zip(short.error_of(STEP, Q(1), Q(1)), whole.error_of(STEP, Q(1), Q(1)), strict=True)
        assert all(x < y <= x * (1 + 16 * fmt.u**2) for y, x in pairs)


def test_what_divides_by_an_irrational_constant_has_the_exact_quotient():
    def halved(force, q, v, h):
        return q / constant(ROOT, BINARY64), v

    (qq, _, _, _), error = step_bound(halved).entries, step_bound(halved).first_order[0][0]
    assert qq == {0: 1 / ROOT}
    distance = size(1 / ROOT - 1 / Q(float(ROOT))) / BINARY64.u
    assert size(1 / ROOT + distance - Q(str(error.coeff(1)))) < Q(1, 2**100)


def test_a_step_of_irrational_numbers_that_are_not_lifted_is_refused_with_the_place():
    with pytest.raises(RefusedOperation, match=r"multiplication with .*Algebraic and not a finite number"):
        step_bound(lambda force, q, v, h: (q * ROOT, v))
    with pytest.raises(TypeError, match=r"sqrt\(2\).* is irrational: this one-step matrix is not over Q\[h\]"):
        _ = plain_of("mclachlan_atela2").matrix


# --- N steps --------------------------------------------------------------------------------------------------------


def error_of(key: str, program, h: Q, steps: int, start) -> ErrorOfRun:
    q, v = map(float, start)
    for _ in range(steps):
        q, v = program(oscillator, q, v, float(h))
    return ErrorOfRun(exact_matrix_at(METHODS[key], h), h, steps, start, (Q(q), Q(v)))


@pytest.mark.parametrize("key", IRRATIONAL)
def test_the_step_is_rho_times_an_isometry_of_its_norm_exactly_in_the_field(key: str):
    m = exact_matrix_at(METHODS[key], STEP)
    norm = own_norm(m)
    form = lambda q, v: norm.qq * q * q + norm.qv * q * v + norm.vv * v * v
    for z in (ONE_ZERO, (Q(0), Q(1)), (Q(2), Q(-3))):
        assert form(*apply(m, *z)) == norm.rho_squared * form(*z) > 0
        assert norm.length(*z) ** 2 >= form(*z)
    assert norm.rho**2 >= norm.rho_squared


@pytest.mark.parametrize("key", IRRATIONAL)
def test_n_steps_stay_within_the_theorem_and_a_planted_error_of_1e_13_leaves_it(key: str):
    h, start, steps = Q(1, 4), (Q(1), Q(3, 8)), 40
    bound = run_bound(METHODS[key], h, steps, start).euclidean
    right = error_of(key, stepper(METHODS[key], float), h, steps, start)
    wrong = error_of(key, stepper(off_by_1e_13(key), float), h, steps, start)
    assert is_less(right.rounding, bound)
    assert is_less(bound, wrong.rounding)


def test_a_splitting_over_a_field_has_rho_one_and_ten_million_steps_cost_what_they_must():
    bound = run_bound(METHODS["yoshida4"], Q(1, 4), 10**7, ONE_ZERO)
    assert bound.norm.rho == 1
    assert 0 < bound.euclidean < 7 * 10**7 * BINARY64.u


def test_without_a_norm_there_is_no_theorem_over_a_field_either():
    with pytest.raises(HypothesisFails, match="at h = 5/2: the step has real eigenvectors"):
        run_bound(METHODS["yoshida4"], Q(5, 2), 10, ONE_ZERO)
    assert run_bound(METHODS["yoshida4"], Q(1), 10, ONE_ZERO).own > 0


# --- what is printed ------------------------------------------------------------------------------------------------


def test_printed_coefficients_are_above_the_derived_ones_and_hardly():
    bound = plain_of("mclachlan_atela2")
    printed = {x for line in first_order_text(bound) for x in line.split() if x.replace(".", "").isdigit() and "." in x}
    derived = {Q(int(c.numerator), int(c.denominator)) for row in bound.first_order for p in row for c in p.coeffs()}
    assert len(printed) >= 4
    for text in printed:
        assert any(c <= Q(text) <= c * (1 + Q(1, 10**5)) for c in derived), text
