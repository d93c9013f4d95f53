"""Facts of multistep methods against books, interpolation formulas, companion matrices and plain float runs."""

from dataclasses import replace
from fractions import Fraction as Q
from math import comb, log2, radians, tan

import numpy as np
import pytest

from driftproof import METHODS, Facts, facts, significant
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.multistep import Multistep
from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.radicals import radical_form
from driftproof.symbolic.linear.multistep import MultistepFacts
from driftproof.symbolic.linear.stability_limits import INFINITY
from tests.looping import exactly, some
from tests.witnesses.multistep import adams, bdf, error_at_one, largest, roots

FIRST = {k: m for k, m in FURTHER_METHODS.items() if isinstance(m, Multistep) and m.derivative == 1}
SECOND = {k: m for k, m in FURTHER_METHODS.items() if isinstance(m, Multistep) and m.derivative == 2}
# Error constants as printed: hairer-norsett-wanner-1993, III.2 (gamma and gamma* of Adams), and -1/(k + 1) of BDF.
CONSTANTS = {
    "adams_bashforth2": "5/12", "adams_bashforth3": "3/8", "adams_bashforth4": "251/720", "adams_bashforth5": "95/288",
    "adams_bashforth6": "19087/60480", "adams_moulton2": "-1/24", "adams_moulton3": "-19/720",
    "adams_moulton4": "-3/160", "adams_moulton5": "-863/60480", "adams_moulton6": "-275/24192",
    **{f"bdf{k}": f"-1/{k + 1}" for k in range(2, 7)}, "two_step_leapfrog": "1/6", "milne_simpson": "-1/180",
    "stormer2": "1/12", "cowell2": "-1/240",
}  # fmt: skip
# hairer-wanner-1996, V.2 Table 2.1.
ANGLES = {"bdf2": "90", "bdf3": "86.03", "bdf4": "73.35", "bdf5": "51.84", "bdf6": "17.84"}
# shampine-reichelt-1997, Table 1: kappa, and the angle of A(alpha) in degrees.
NDF = {1: (Q(-37, 200), "90"), 2: (Q(-1, 9), "90"), 3: (Q(-823, 10000), "80"), 4: (Q(-415, 10000), "66")}
# (-x, 0) and (0, iy) of Adams and others, known from many books; None: all.
LIMITS = {
    "adams_bashforth2": ("1", "0"), "adams_bashforth3": ("6/11", "12*sqrt(11)/55"), "adams_bashforth4": ("3/10", None),
    "adams_moulton2": ("6", "0"), "adams_moulton3": ("3", "0"), "two_step_leapfrog": ("0", "1"),
    "milne_simpson": ("0", "sqrt(3)"),
}  # fmt: skip


BACKWARD = (-1, 1), (0, 1)


def of(key):
    return MultistepFacts(FURTHER_METHODS[key])


def one_step(key, rho, sigma):
    return MultistepFacts(Multistep(key, key, 0, "", rho, sigma))


def test_orders_and_error_constants_are_those_in_the_books():
    for key, method in some({**FIRST, **SECOND}.items()):
        assert of(key).order == method.claimed_order, key
        assert of(key).convergent
        assert not of(key).inconsistencies
    for key, printed in exactly(len(CONSTANTS), CONSTANTS.items()):
        assert of(key).error_constant == Q(printed), key


def test_facts_of_first_order_equations_are_none_of_second_order_ones():
    for key in some(SECOND):
        assert [getattr(of(key), name) for name in ("first_barrier", "a_stability", "sector", "real_limit")] == [
            None
        ] * 4


def test_what_contradicts_a_barrier_of_dahlquists_is_no_answer():
    for planted, value, name, barrier in (
        ("order", 5, "first_barrier", "order 5 is above Dahlquist's barrier 4"),
        ("order", 3, "a_stability", "second"),
        ("error_constant", Q(-4, 49), "a_stability", "second"),
    ):
        found = of("bdf2")
        found.__dict__[planted] = value
        with pytest.raises(AssertionError, match=barrier):
            getattr(found, name)


def test_the_tables_are_what_interpolation_makes():
    for k in exactly(5, range(2, 7)):
        for key, made in {
            f"adams_bashforth{k}": adams(k, implicit=False), f"adams_moulton{k}": adams(k, implicit=True),
            f"bdf{k}": bdf(k),
        }.items():  # fmt: skip
            assert (FIRST[key].rho, FIRST[key].sigma) == (made.rho, made.sigma), key
    for key, made in exactly(4, {
        "nystrom_multistep3": adams(3, implicit=False, back=2), "nystrom_multistep4": adams(4, implicit=False, back=2),
        "two_step_leapfrog": adams(2, implicit=False, back=2), "milne_simpson": adams(2, implicit=True, back=2),
    }.items()):  # fmt: skip
        assert (FIRST[key].rho, FIRST[key].sigma) == (made.rho, made.sigma), key


@pytest.mark.parametrize("key", [*FIRST, *SECOND])
def test_a_changed_coefficient_loses_the_order_and_a_run_has_it(key):
    method = FURTHER_METHODS[key]
    for j in range(method.steps + 1):
        changed = replace(method, sigma=tuple(x + Q(i == j, 1000) for i, x in enumerate(method.sigma)))
        assert MultistepFacts(changed).order == 0
    # Twice as many steps divide the error by 2^p, up to a term of order h: within a third of an order at h = 1/64.
    coarse = 16 if method.claimed_order > 5 else 32
    rate = log2(error_at_one(method, coarse) / error_at_one(method, 2 * coarse))
    assert abs(rate - method.claimed_order) < 0.75


def test_methods_of_one_step_have_the_facts_of_their_tableaux():
    for key, rho, sigma in exactly(
        3, [("forward_euler", (-1, 1), (1, 0)), ("backward_euler", (-1, 1), (0, 1)), ("trapezoid", (-2, 2), (1, 1))]
    ):
        found, known = one_step(key, rho, sigma), Facts(METHODS[key])
        for name in ("order", "a_stable", "real_limit", "imaginary_limit", "sector", "explicit"):
            expected = getattr(known, name) if name != "explicit" else METHODS[key].explicit
            assert (getattr(found, name) if name != "explicit" else found.method.explicit) == expected, (key, name)


def test_bdf_has_the_printed_angles_and_seven_steps_are_not_zero_stable():
    for key, printed in exactly(5, ANGLES.items()):
        degrees = of(key).sector.degrees.exact
        assert significant(degrees, len(printed.replace(".", ""))) == printed, key
    assert radical_form(of("bdf3").sector.tan) == "329*sqrt(35)/135"
    assert all(MultistepFacts(bdf(k)).zero_stable for k in exactly(6, range(1, 7)))
    for k in exactly(5, range(7, 12)):
        facts = MultistepFacts(bdf(k))
        assert (facts.order, facts.zero_stable, facts.convergent) == (k, False, False)
        assert max(abs(roots(bdf(k), 0))) > 1.02


def test_ndf_is_bdf_less_a_difference_and_has_the_printed_angles():
    for k, (kappa, printed) in exactly(4, NDF.items()):
        difference = [
            (-1) ** (k + 1 - j) * comb(k + 1, j) * kappa * sum(Q(1, m) for m in range(1, k + 1)) for j in range(k + 2)
        ]
        rho = [x - y for x, y in zip((0, *bdf(k).rho), difference, strict=True)]
        assert FURTHER_METHODS[f"ndf{k}"].rho == tuple(rho)
        assert significant(of(f"ndf{k}").sector.degrees.exact, 2) == printed


def test_limits_are_those_in_the_books():
    for key, (real, imaginary) in exactly(len(LIMITS), LIMITS.items()):
        assert radical_form(of(key).real_limit) == real, key
        assert imaginary in (None, radical_form(of(key).imaginary_limit)), key
    assert [radical_form(of(key).imaginary_limit) for key in ("stormer2", "cowell2")] == ["2", "sqrt(6)"]
    assert of("bdf2").imaginary_limit is of("bdf3").real_limit is INFINITY


def bounded(method, z, slack=1e-9):
    # Simple roots of size 1 are off by some 1e-15 times a condition far below 1e5 at the places where this looks.
    return largest(method, z) <= 1 + slack


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize("key", FIRST)
def test_sectors_and_limits_hold_on_companion_matrices(key):
    method, facts = FIRST[key], of(key)
    sizes = np.geomspace(1e-2, 1e3, 300)
    if facts.sector.tan is not INFINITY and float(facts.sector.tan.ball()) > 0:
        alpha = np.arctan(float(facts.sector.tan.ball()))
        inside, outside = (-sizes * np.exp(1j * (alpha + turn)) for turn in (-1e-3, 1e-3))
        assert all(bounded(method, z) for z in inside)
        assert not all(bounded(method, z) for z in outside)
    for limit, direction in ((facts.real_limit, -1), (facts.imaginary_limit, 1j)):
        end = 50.0 if limit is INFINITY else float(limit.ball())
        if end > 0:
            assert all(bounded(method, direction * x) for x in np.linspace(end / 100, 0.999 * end, 100))
        if limit is not INFINITY:
            # Where the limit is 0 the growth begins like a power of z: at 1/5 it is seen.
            assert not all(bounded(method, direction * x) for x in np.linspace(end, end + 0.2, 12)[1:])


def test_a_stability_of_theta_and_of_two_step_methods_ends_where_it_should():
    for theta in some([Q(0), Q(1, 3), Q(499, 1000), Q(1, 2), Q(501, 1000), Q(2, 3), Q(1)]):
        facts = one_step("theta", (Q(-1), Q(1)), (1 - theta, theta))
        assert facts.a_stable == (theta >= Q(1, 2))
        assert facts.a_stability.holds == (facts.sector.tan is INFINITY)
    # All two-step methods of order 2: a and b are the coefficients of the new values.
    for a, b in exactly(5, [(Q(3, 4), Q(1, 2)), (Q(1, 2), Q(1)), (Q(1), Q(2, 5)), (Q(1), Q(3, 4)), (Q(1, 3), Q(1))]):
        facts = one_step("two", (a - 1, 1 - 2 * a, a), (Q(1, 2) - a + b, Q(1, 2) + a - 2 * b, b))
        assert facts.order >= 2
        half_plane = (x * turn for x in np.geomspace(1e-2, 1e3, 200) for turn in (-1, 1j, -1 + 1j, -1 + 10j))
        assert facts.a_stable == all(bounded(facts.method, z) for z in half_plane) == (2 * b > a >= Q(1, 2)), (a, b)


def test_dahlquists_barriers_hold_for_what_is_derived():
    assert of("milne_simpson").first_barrier == (4, True)
    assert [of(key).first_barrier for key in ("bdf3", "adams_bashforth4")] == [(4, False), (4, True)]
    most = MultistepFacts(Multistep("most", "", 0, "", (-5, 4, 1), (2, 4, 0)))  # order 3, explicit, k = 2
    assert (most.order, most.zero_stable, most.first_barrier) == (3, False, (2, False))
    assert all(not MultistepFacts(m).a_stable for m in some(m for m in FIRST.values() if m.claimed_order > 2))


@pytest.mark.parametrize(
    ("method", "factor", "zero_stable", "a_stable", "limits"),
    [
        (BACKWARD, (-1, 2), True, True, "oo oo oo"),
        (BACKWARD, (-2, 1), False, False, "0 0 0"),
        (BACKWARD, (-1, 1), False, False, "oo oo oo"),  # z = 0 at ζ = 1
        (BACKWARD, (1, 1), True, True, "oo oo oo"),  # z = 2 at ζ = -1
        (((-2, 2), (1, 1)), (1, 1), True, True, "oo oo oo"),  # the trapezoidal rule; ζ = -1 is a pole
        (((-2, 2), (1, 1)), (1, 0, 1), True, False, "oo 2 oo"),  # z = 2i at ζ = i
        (((-1, 0, 1), (0, 2, 0)), (5, -6, 5), True, False, "0 4/5 0"),  # z = 4i/5 at ζ = (3 + 4i)/5
        (((2,), (1,)), (1, -2, 1), False, False, "0 0 0"),
        (((2,), (1,)), (-1, 1), True, True, "oo oo oo"),
        (((1,), (-1,)), (-1, 1), True, False, "1 oo 0"),  # z = -1 has no step
        (((2,), (-1,)), (-1, 1), True, False, "2 oo 0"),
    ],
)
def test_roots_of_a_common_factor_are_solutions_at_every_z(method, factor, zero_stable, a_stable, limits):
    rho, sigma = (tuple(map(int, np.convolve(p, factor))) for p in method)
    facts = one_step("reducible", rho, sigma)
    assert facts.common_factor.f.num == facts.common_factor.f.num.gcd(polynomial(factor))
    assert (facts.zero_stable, facts.a_stable) == (zero_stable, a_stable)
    found = facts.real_limit, facts.imaginary_limit, facts.sector.tan
    assert [x.value if x is INFINITY else radical_form(x) for x in found] == limits.split()


def test_an_inconsistent_method_says_so():
    facts = one_step("off", (-1, 1), (Q(1, 2), Q(1, 3)))
    assert facts.inconsistencies == {"rho'(1) - sigma(1)": Q(1, 6)}
    assert (facts.order, facts.order_fails, facts.convergent) == (0, (1, Q(1, 6)), False)
    assert (str(facts.rho), str(facts.sigma)) == ("-1 + zeta", "1/2 + zeta/3")
    assert one_step("none", (-1, 2), (1, -1)).error_constant is None
    assert one_step("trapezoid", (-2, 2), (1, 1)).error_constant == Q(-1, 12)
    assert one_step("backward", (-1, 1), (0, 1)).convergent
    # ρ/σ < 0 at 1 and > 0 at -1, and the other way round.
    for rho, sigma in (((-3, 1), (3, 4)), ((3, 1), (-3, 4))):
        assert radical_form(one_step("off", rho, sigma).sector.tan) == "0"


def test_a_locus_that_meets_the_negative_axis_at_an_irrational_point_leaves_no_sector():
    facts = one_step("leap", (-1, 0, 0, 0, 1), (1, 0, 0, 0, 0))  # z = ζ⁴ - 1 is -2 at arg ζ = π/4, tan²(π/8) = 3 - 2√2
    assert [radical_form(x) for x in (facts.real_limit, facts.sector.tan)] == ["2", "0"]


def test_facts_are_written_as_records():
    found = facts(FURTHER_METHODS["bdf2"]).data
    assert found["rho"] == {"num": ["1/2", "-2", "3/2"], "den": ["1"]}
    assert found["order_fails"] == {"power": 3, "residual": "-1/3"}
    assert (found["sector"], found["method"]) == ({"tan": "oo", "degrees": "90"}, "bdf2")
    assert tan(radians(86.03)) < float(of("bdf3").sector.tan.ball()) < tan(radians(86.04))
    with pytest.raises(ValueError, match="a linear multistep method, and has no symplectic; choose from"):
        facts(FURTHER_METHODS["bdf2"], only=["symplectic"]).json()


@pytest.mark.parametrize(("key", "places"), [("adams_bashforth4", 16), ("cowell2", 12)])
def test_digits_alone_keep_decimals_from_their_order(key, places):
    """The twin has a wrong digit early; an exact method has no such order, and the residuals show one that has."""
    method = FURTHER_METHODS[key]
    rounded = replace(method, sigma=tuple(round(x, places) for x in method.sigma), decimal=True)
    wrong = replace(rounded, sigma=(rounded.sigma[0] + Q(1, 10**3), *rounded.sigma[1:]))
    found = MultistepFacts(rounded).order_but_for_rounding
    assert (MultistepFacts(rounded).order, found.order) == (0, method.claimed_order)
    assert [*facts(rounded, only=["order"]).data] == ["order", "order_but_for_rounding"]
    assert MultistepFacts(replace(rounded, decimal=False)).order_but_for_rounding == found
    assert [MultistepFacts(x).order_but_for_rounding for x in (wrong, method)] == [None] * 2
