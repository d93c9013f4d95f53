"""Claims of orders: those of every catalogue entry hold, those of a wrong table do not, whatever its family."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.multistep import Multistep
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.symbolic.claimed_orders import restoring_entries, unreached_orders
from tests.looping import some


def said(method, tolerance=None):
    return [str(found) for found in unreached_orders(method, tolerance)]


# Yoshida's last digits are wrong (docs/differences.md), but the table says that it is rounded.
@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("catalogue", [METHODS, FURTHER_METHODS], ids=["of one state", "of facts"])
def test_every_order_of_the_catalogue_is_reached(catalogue):
    assert [said(method) for _, method in some(catalogue.items(), 20)] == [[]] * len(catalogue)


OFF = Q(1, 100)
WRONG = {
    "runge_kutta": (replace(METHODS["rk4"], b=(Q(1, 6), Q(1, 3), Q(1, 3), Q(1, 7))), ["claimed order 4, has 0"]),
    "embedded": (
        replace(METHODS["heun_euler21"], b_embedded=(Q(1, 2) + OFF, Q(1, 2))), ["claimed embedded order 1, has 0"],
    ),
    "splitting": (
        replace(METHODS["velocity_verlet"], parts=(("kick", Q(1, 2)), ("drift", 1), ("kick", Q(1, 3)))),
        ["claimed order 2, has 0"],
    ),
    "nystrom": (replace(METHODS["nystrom4"], claimed_order=5), ["claimed order 5, has 4"]),
    "collocation": (replace(METHODS["gauss9"], claimed_order=19), ["claimed order 19, has 18"]),
    "multistep": (replace(FURTHER_METHODS["bdf3"], sigma=(0, 0, 0, Q(6, 5))), ["claimed order 3, has 0"]),
    "rosenbrock": (replace(FURTHER_METHODS["ros2"], claimed_order=3), ["claimed order 3, has 2"]),
    "additive": (
        replace(FURTHER_METHODS["ars443"], b_explicit=(*FURTHER_METHODS["ars443"].b_explicit[:-1], OFF)),
        ["claimed order 3, has 0"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("family", WRONG)
def test_an_order_that_is_claimed_and_missed_is_named(family):
    method, lines = WRONG[family]
    assert said(method) == lines


PAIR, BDF2 = METHODS["bogacki_shampine32"], FURTHER_METHODS["bdf2"]
NEWEST_FIRST = "rho and sigma may stand newest first; they go from the oldest value to the new one"
TURNED = {
    "claimed order 3, has 2; b and b_embedded may be exchanged": replace(PAIR, b=PAIR.b_embedded, b_embedded=PAIR.b),
    f"claimed order 2, has 0; {NEWEST_FIRST}": replace(BDF2, rho=BDF2.rho[::-1], sigma=BDF2.sigma[::-1]),
    # Exchanged, these claims would not hold either.
    "claimed order 4, has 2": replace(PAIR, b=PAIR.b_embedded, b_embedded=PAIR.b, claimed_order=4),
    "claimed order 3, has 0": replace(BDF2, rho=BDF2.rho[::-1], sigma=BDF2.sigma[::-1], claimed_order=3),
}


@pytest.mark.parametrize("line", TURNED)
def test_rows_in_each_others_place_are_named_if_that_restores_the_claims(line):
    assert said(TURNED[line]) == [line]


def test_what_claims_nothing_or_less_than_it_has_misses_nothing():
    assert said(replace(METHODS["rk4"], claimed_order=0)) == said(replace(METHODS["rk4"], claimed_order=3)) == []


def rounded(places, **change):
    method, row = METHODS["rk4"], lambda numbers: tuple(round(x, places) for x in numbers)
    return replace(method, b=row(method.b), **change)


ADVICE = "decimal = true says that its coefficients are rounded, which explains that"
# Methods with one wrong digit, and what they have: integers and halves, halves of one digit, exchanged digits.
MISPRINTED = {
    "order 3 of Heun": (replace(METHODS["heun2"], claimed_order=3), 2),
    "weights of 1.1": (replace(METHODS["heun2"], b=(Q("0.5"), Q("0.6"))), 0),
    "order 4 of Verlet": (replace(METHODS["velocity_verlet"], claimed_order=4), 2),
    "drifts of 1.1": (
        replace(METHODS["position_verlet"], parts=(("drift", Q("0.6")), ("kick", 1), ("drift", Q("0.5")))),
        0,
    ),
    "ROS2": (
        Rosenbrock(
            "m",
            "m",
            2,
            "",
            ((0, 0), (1, 0)),
            ((Q("1.70710678"), 0), (Q("-3.41241356"), Q("1.70710678"))),
            (Q("0.5"), Q("0.5")),
        ),
        1,
    ),
}


@pytest.mark.parametrize("wrong", MISPRINTED)
@pytest.mark.parametrize("decimal", [False, True])
def test_a_claim_beyond_the_digits_is_missed_also_by_a_table_that_says_it_is_rounded(wrong, decimal):
    method, has = MISPRINTED[wrong]
    assert [found.order for found in unreached_orders(replace(method, decimal=decimal))] == [has]


def test_the_last_but_one_digit_of_sixteen_and_the_fourth_of_eight_are_told_from_rounding():
    """Each condition is judged by the rounding of the entries that it has, also where they are many and unequal."""
    right = METHODS["pefrl"]
    for i, (kind, x) in enumerate(right.parts):
        parts = (*right.parts[:i], (kind, x + Q(1, 10**11)), *right.parts[i + 1 :])
        assert [found.order for found in unreached_orders(replace(right, parts=parts))] == [0]
    gamma, twice = "1.70710678", "-3.41421356"
    rows = ((0, 0), (1, 0)), ((Q(gamma), 0), (Q(twice), Q(gamma)))
    assert said(Rosenbrock("m", "ROS2", 2, "", *rows, (Q(1, 2), Q(1, 2)), decimal=True)) == []


@pytest.mark.parametrize("decimal", [False, True])
def test_rounding_alone_breaks_no_claim(decimal):
    assert said(rounded(12, decimal=decimal)) == []
    assert said(rounded(12, decimal=decimal, claimed_order=5)) == ["claimed order 5, has 4"]


def test_a_table_of_four_digits_that_says_so_is_not_accused():
    """Its residuals of 3e-5 do not jump to those of 8e-3; the twins say nothing of rounding, or miss by more."""
    table = rounded(4, decimal=True)
    assert said(table) == []
    assert said(replace(table, decimal=False)) == [f"claimed order 4, has 2; {ADVICE}"]
    assert said(replace(table, b=(table.b[0] + Q(1, 5), *table.b[1:]))) == ["claimed order 4, has 0"]


def test_a_mistake_in_the_middle_of_the_digits_is_no_rounding():
    """Residuals of 1e-6 would be a rounding of six digits, and these are twelve, whatever the table says."""
    table = rounded(12)
    wrong = replace(table, b=(table.b[0] + Q(1, 10**6), *table.b[1:]))
    line = "claimed order 4, has 0: a condition fails by 1.00e-6, more than its digits explain"
    lines = [f"{line}; `facts --order-tolerance 1e-3` allows that"]
    assert said(wrong) == said(replace(wrong, decimal=True)) == lines
    assert said(wrong, Q(1, 10**5)) == []
    assert said(wrong, Q(1, 10**7)) == said(wrong)


def test_a_splitting_may_claim_its_order_on_second_order_problems():
    """Authors of such methods do, and files cannot say so; rounded ones, too."""
    method = METHODS["blanes_moan_rkn6a"]
    assert said(replace(method, quadratic_kinetic=False)) == []
    assert said(replace(method, claimed_order=8))[0].startswith("claimed order 8, has ")


def test_tables_of_a_higher_order_than_is_tried_are_judged_by_their_first_residual():
    a, b, _ = METHODS["gauss9"].tableau(200)
    rows = tuple(tuple(round(x, 20) for x in row) for row in a)
    table = replace(
        METHODS["gauss2"], a=rows, b=tuple(round(x, 20) for x in b), c=tuple(map(sum, rows)), claimed_order=18
    )
    assert said(table) == []
    assert said(replace(table, b=(table.b[0] + OFF, *table.b[1:]))) == ["claimed order 18, has 0"]


def test_a_multistep_method_that_is_not_zero_stable_has_no_order_to_claim():
    """Rounding of rho, which moves the root 1 out of the unit circle, is not what makes it so."""
    wrong = Multistep("m", "m", 3, "", (-5, 4, 1), (2, 4, 0))
    why = "3, but is not zero-stable: a root is outside the unit circle"
    assert (said(wrong), said(replace(wrong, claimed_order=0))) == ([f"claimed order 3, has {why}"], [f"order {why}"])
    bdf3 = [round(x / Q(11, 6), 12) for x in (Q(-1, 3), Q(3, 2), -3, Q(11, 6))]
    table = Multistep("m", "m", 3, "", tuple(bdf3), (0, 0, 0, round(Q(6, 11), 12)), decimal=True)
    assert said(table) == said(replace(table, rho=(bdf3[0] - Q(1, 10**12), *bdf3[1:]))) == []


AB3, ROS2, ARS = FURTHER_METHODS["adams_bashforth3"], FURTHER_METHODS["ros2"], FURTHER_METHODS["ars443"]
# For each family a method with one entry changed, and what restores it.
ONE_WRONG = {
    "multistep": (replace(AB3, sigma=(*AB3.sigma[:2], Q(25, 12), 0)), f"sigma[2] = {AB3.sigma[2]} in place of 25/12"),
    "nystrom": (
        replace(METHODS["nystrom4"], b_position=(Q(1, 6), Q(1, 6), 0)), "b_position[1] = 1/3 in place of 1/6",
    ),
    "splitting": (
        replace(METHODS["velocity_verlet"], parts=(("kick", Q(1, 2)), ("drift", 1), ("kick", Q(1, 3)))),
        "parts[2] = 1/2 in place of 1/3",
    ),
    "rosenbrock": (replace(ROS2, b=(Q(1, 2), Q(1, 3))), "b[1] = 1/2 in place of 1/3"),
    "additive": (
        replace(ARS, b_implicit=(0, Q(3, 2), Q(-3, 2), Q(1, 3), Q(1, 2))), "b_implicit[3] = 1/2 in place of 1/3",
    ),
}  # fmt: skip


@pytest.mark.parametrize("family", ONE_WRONG)
def test_the_one_entry_that_restores_an_order_is_named_in_every_family(family):
    """With a second entry wrong there is none."""
    method, what = ONE_WRONG[family]
    line = f"with this one entry changed, order {method.claimed_order} is restored: {what}"
    assert line in restoring_entries(method, method.claimed_order)
    name = {"multistep": "rho", "nystrom": "b_velocity", "splitting": "parts", "additive": "b_explicit"}.get(
        family, "b"
    )
    row = list(getattr(method, name))
    row[0] = ("kick", Q(1, 7)) if family == "splitting" else Q(1, 7)
    assert line not in restoring_entries(replace(method, **{name: tuple(row)}), method.claimed_order)
