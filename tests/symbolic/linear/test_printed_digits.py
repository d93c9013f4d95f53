"""Stability within printed digits: of tables by Kvaerno's kind, whose R(oo) is 1e-10 and was meant to be 0."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from math import isqrt
from pathlib import Path

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.methods.tables.collocation import radau_iia
from driftproof.reports.fact_sheet import facts
from driftproof.symbolic.facts import Facts
from driftproof.symbolic.linear.printed_digits import imaginary_limit_within_digits, stability_within_digits
from driftproof.texts.questions.evaluate import value
from driftproof.texts.writing.facts import fact_tex, fact_text


def esdirk(gamma: str, *rows: str) -> RungeKutta:
    """A stiffly accurate table with an explicit first stage, its rows left of the diagonal as they are printed."""
    left = [[], *(row.split() for row in rows)]
    size = len(left)
    full = [[*row, *([gamma] if row else ["0"])] for row in left]
    a = tuple(tuple(Q(x) for x in [*row, *["0"] * size][:size]) for row in full)
    return RungeKutta("mine", "mine", 3, "", a, a[-1], tuple(sum(row) for row in a), decimal=True)


# Kvaerno's ESDIRK 3/2 with four stages: gamma is a root of 6x³ - 18x² + 9x - 1.
LAST_ROWS = ("0.490563388419108 0.073570090080892", "0.308809969973036 1.490563388254106 -1.235239879727145")
SHORT, LONG = (esdirk(g, g, *LAST_ROWS) for g in ("0.4358665215", "0.435866521508459"))


# ESDIRK5(4)7L[2]SA2 (kennedy-carpenter-2019), left of the diagonal: ratios for numbers of 26 digits.
KENNEDY_CARPENTER = (
    "23/125",
    "791020047304/3561426431547 " * 2,
    "-158159076358/11257294102345 " * 2 + "-85517644447/5003708988389",
    "-1653327111580/4048416487981 " * 2 + "1514767744496/9099671765375 14283835447591/12247432691556",
    "-4540011970825/8418487046959 " * 2 + "-1790937573418/7393406387169 10819093665085/7266595846747"
    " 4109463131231/7386972500302",
    "-188593204321/4778616380481 " * 2 + "2809310203510/10304234040467 1021729336898/2364210264653"
    " 870612361811/2470410392208 -1307970675534/8059683598661",
)


def test_ratios_that_round_irrational_numbers_are_judged_within_their_rounding() -> None:
    table = replace(esdirk("23/125", *KENNEDY_CARPENTER), decimal=False, claimed_order=0)
    facts = Facts(table)
    assert (facts.order, facts.a_stable, facts.l_stable) == (0, False, False), "as written, exactly"
    assert facts.order_but_for_rounding == (5, "1.28e-26", "2.61e-3")
    found = facts.stability_within_digits
    assert found is not None
    assert (found.i_stable, found.a_stable, found.l_stable) == (True, True, True)
    assert found == (True, True, True, "0", "1.01e-19")


def test_wrong_ratio_is_no_rounding() -> None:
    """The twin: a digit wrong in the middle of one entry."""
    rows = [row.replace("1021729336898", "1021729436898") for row in KENNEDY_CARPENTER]
    facts = Facts(replace(esdirk("23/125", *rows), decimal=True, claimed_order=0))
    assert facts.order_but_for_rounding is None
    found = facts.stability_within_digits
    assert found is not None
    assert not found.l_stable


def test_table_of_higher_order_than_is_looked_for_is_judged_within_its_digits() -> None:
    """Radau IIA with seven stages has order 13; the twin has one wrong digit in the middle of a weight."""
    a, b, _ = radau_iia(7).tableau(200)
    rows = tuple(tuple(round(x, 16) for x in row) for row in a)
    weights = [round(x, 16) for x in b]
    wrong = [x + Q(i == 3, 10**8) for i, x in enumerate(weights)]
    printed, misprinted = (
        Facts(RungeKutta("mine", "mine", 0, "", rows, tuple(each), tuple(map(sum, rows)))) for each in (weights, wrong)
    )
    assert (printed.l_stable, printed.order_but_for_rounding) == (False, (13, "1.32e-16", None))
    found = printed.stability_within_digits
    assert found is not None
    assert (found.i_stable, found.a_stable, found.l_stable) == (True, True, True)
    assert misprinted.stability_within_digits is None


def test_table_that_is_l_stable_but_for_its_rounding_is_so_within_its_digits() -> None:
    assert (Facts(SHORT).a_stable, Facts(SHORT).l_stable) == (False, False), "as written, exactly"
    found = Facts(SHORT).stability_within_digits
    assert found is not None
    assert found == (True, True, True, "5.57e-11", "2.30e-8")
    text = fact_text(found)
    assert "l_stable: yes" in text
    assert f"limit_at_infinity: 5.57e-11, digits_allow: {found.digits_allow}" in text
    assert "5.57" in fact_tex(found)
    assert facts(SHORT, only=["stability_within_digits"]).data["stability_within_digits"] == found._asdict()


def test_four_hundred_digits_are_judged_by_all_of_them() -> None:
    """Of gamma = 1 - sqrt(2)/2, a root of x² - 2x + 1/2: R(oo) is that over x²."""
    gamma = 1 - Q(isqrt(2 * 10**800 // 4), 10**400)
    a = ((gamma, Q(0)), (1 - 2 * gamma, gamma))
    found = stability_within_digits(RungeKutta("m", "m", 2, "", a, (Q(1, 2),) * 2, (gamma, 1 - gamma), decimal=True))
    assert found is not None
    assert found.l_stable
    assert Q(found.limit_at_infinity) < Q(found.digits_allow) < Q(1, 10**397)


def test_digits_that_exclude_r_of_zero_at_infinity_say_so() -> None:
    """With a longer gamma, the other entries are not those that belong to it: R(oo) is out of reach of the digits."""
    found = Facts(LONG).stability_within_digits
    assert found is not None
    assert found == (True, True, False, "1.08e-10", "1.09e-10")
    mixed = esdirk("1/4", "1/4", "1/3 0.0735", "0.0013 3/7 -1.2352")
    assert stability_within_digits(mixed) == (False, False, False, "-3.43e0", "3.54e0")


@pytest.mark.parametrize("entry", ["0.2", "0.43586652"])
def test_half_units_bound_what_any_table_with_the_same_digits_does(entry: str) -> None:
    """Ends of the half units, tried one entry at a time and all together, keep |R(oo)| within what is allowed."""
    table = esdirk(entry, entry, "0.49056339 0.07357009", "0.30880997 1.49056339 -1.23523988")
    found = stability_within_digits(table)
    assert found is not None
    half = Q(1, 2 * 10**8)
    seen = []
    for signs in [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, 0, -1), (1, 1, 1), (1, -1, 1), (-1, -1, -1)]:
        rows = [list(row) for row in table.a]
        for (i, j), sign in zip([(2, 0), (3, 1), (3, 2)], signs, strict=True):
            rows[i][j] += sign * half
        a = tuple(map(tuple, rows))
        moved = replace(table, a=a, b=a[-1])
        limit = Facts(moved).limit_at_infinity
        assert isinstance(limit, Q)
        seen.append(abs(limit))
        assert seen[-1] <= Q(found.digits_allow)
    assert len(seen) == 7
    allowed = ("-6.97e0", "6.97e0") if entry == "0.2" else ("-1.67e-8", "6.84e-6")
    assert found == (*[entry != "0.2"] * 3, *allowed)


def test_provable_growth_is_excluded_by_the_digits_and_exact_tables_have_no_digits() -> None:
    unstable = esdirk("0.10000001", "0.10000001", "0.49056339 0.07357009", "0.30880997 1.49056339 -1.23523988")
    found = stability_within_digits(unstable)
    assert found is not None
    assert (found.i_stable, found.a_stable, found.l_stable) == (False, False, False)
    assert Facts(METHODS["sdirk4"]).stability_within_digits is None
    explicit = RungeKutta("e", "e", 1, "", ((Q(0),),), (Q(1),), (Q(0),), decimal=True)
    assert stability_within_digits(explicit) is None
    rows = ((Q(0), Q(0)), (Q(0), Q("0.25")))
    growing = RungeKutta("g", "g", 1, "", rows, (Q(1, 2), Q(1, 2)), (Q(0), Q("0.25")), decimal=True)
    assert stability_within_digits(growing) is None, "R has no limit"
    one_stage = RungeKutta("o", "o", 1, "", ((Q("0.501"),),), (Q(1),), (Q("0.501"),), decimal=True)
    assert stability_within_digits(one_stage) == (True, True, False, "-9.96e-1", "9.99e-1")  # 0.4995/0.5005


def test_unused_stages_and_exact_short_decimals_do_not_widen_the_balls() -> None:
    """0.25 beside entries of 15 digits is a quarter; a stage that nothing uses changes nothing."""
    backward = RungeKutta(
        "b", "b", 1, "", ((Q(1), Q(0)), (Q("0.123456789012345"), Q("0.25"))), (Q(1), Q(0)), (Q(1),) * 2
    )
    found = stability_within_digits(replace(backward, decimal=True))
    assert found is not None
    assert found.l_stable
    assert found.limit_at_infinity == found.digits_allow == "0"


def explicit(b: str, *rows: str) -> RungeKutta:
    """An explicit table as it is printed, its rows left of the diagonal."""
    a = tuple(tuple(Q(x) for x in [*row.split(), *["0"] * 9][: len(rows) + 1]) for row in ("", *rows))
    return RungeKutta("mine", "mine", 4, "", a, tuple(map(Q, b.split())), tuple(map(sum, a)), decimal=True)


# SSPRK(5,4) of spiteri-ruuth-2002, whose weights sum to 1 + 1e-15.
SSP_54 = (
    "0.146811876084787 0.248482909444976 0.104258830331981 0.274438900901351 0.226007483236906",
    "0.39175222657189",
    "0.217669096261169 0.368410593050371",
    "0.082692086657811 0.139958502191895 0.251891774271694",
    "0.067966283637115 0.115034698504632 0.207034898597386 0.544974750228521",
)


def test_explicit_table_keeps_its_imaginary_limit_within_its_digits() -> None:
    """Its own R is 1 + z + ... + z⁴/24 + 0.00447771830307612 z⁵, where 1e-15 is as good as 0."""
    found = Facts(table := explicit(*SSP_54))
    assert (float(found.imaginary_limit), found.imaginary_limit_within_digits) == (0.0, "3.2784")
    size = lambda y: abs(1 + 1j * y - y**2 / 2 - 1j * y**3 / 6 + y**4 / 24 + 0.00447771830307612j * y**5)
    assert max(size(k / 1000) for k in range(100, 3278)) < 1 < size(3.2785)
    assert [*facts(table, only=["imaginary_limit"]).data] == ["imaginary_limit", "imaginary_limit_within_digits"]


def test_limit_that_is_not_lost_to_rounding_is_no_other() -> None:
    """The twins: a wrong digit, a method whose limit is 0 in truth, one whose rounding stays inside, exact ones."""
    wrong = explicit(SSP_54[0].replace("0.1468118", "0.1468128"), *SSP_54[1:])
    heun = explicit("0.499999999999999 0.500000000000001", "1.00000000000001")
    inside = explicit("0.16666666 0.33333333 0.33333333 0.16666666", "0.5", "0 0.5", "0 0 1")
    assert [Facts(x).imaginary_limit_within_digits for x in (wrong, heun, inside, METHODS["rk4"])] == [None] * 4
    assert imaginary_limit_within_digits(SHORT) is None
    assert Facts(replace(explicit(*SSP_54), decimal=False)).imaginary_limit_within_digits == "3.2784", "as they show"


def test_question_of_a_limit_that_has_one_within_the_digits_says_so(tmp_path: Path) -> None:
    rows = ", ".join(f"[{', '.join(map(str, map(float, row)))}]" for row in explicit(*SSP_54).a)
    path = tmp_path / "mine.toml"
    lines = ('family = "runge_kutta"', "decimal = true", f"A = [{rows}]", f"b = [{SSP_54[0].replace(' ', ', ')}]")
    path.write_text("\n".join(lines), encoding="utf-8")
    assert str(value(f"imaginary_limit {path}")).endswith(
        "rounded; imaginary_limit_within_digits ignores the rounding)"
    )
    assert str(value("imaginary_limit tsitouras54")).endswith("(DERIVED; with the coefficients as rounded)")
