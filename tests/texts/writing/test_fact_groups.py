"""Facts in groups: plain words, other names, nothing lost between the groups and the rest."""

import re
from dataclasses import replace
from fractions import Fraction

import pytest

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.families import FAMILIES
from driftproof.symbolic.additive import ADDITIVE_FACTS
from driftproof.symbolic.facts import FACTS, Facts, facts_of_further
from driftproof.symbolic.family_facts import FAMILY_FACTS, FamilyFacts
from driftproof.symbolic.linear.facts import facts_by_name
from driftproof.symbolic.linear.multistep import MULTISTEP_FACTS
from driftproof.symbolic.rosenbrock import ROSENBROCK_FACTS
from driftproof.texts.writing.fact_groups import GROUPS, grouped_facts_text


def shown(method, *, everything=False):
    return grouped_facts_text(facts_by_name(Facts(method), FACTS, FACTS), everything)


def test_every_fact_of_a_group_is_one_and_stands_in_one():
    grouped = [name for names in GROUPS.values() for name in names]
    assert len(grouped) == len(set(grouped)) > 20
    known = {"order_to_tolerance", *FACTS, *FAMILY_FACTS, *MULTISTEP_FACTS, *ROSENBROCK_FACTS, *ADDITIVE_FACTS}
    assert set(grouped) <= known
    assert [*GROUPS] == ["What it is", "Accuracy", "Stability", "Structure"]


@pytest.mark.parametrize("key", ["rk4", "velocity_verlet", "gauss2"])
def test_groups_have_plain_words_and_all_has_every_fact(key):
    brief, whole = shown(METHODS[key]), shown(METHODS[key], everything=True)
    assert [part.splitlines()[0] for part in brief.split("\n\n")[:-1]] == list(GROUPS)
    assert "order p: the error at a fixed time is O(h^p)  " in brief
    assert brief.endswith(" more facts with --all, any one with --only NAME; in Python in .json(), and as .NAME")
    assert "none" not in brief
    rest = set(FACTS) - {name for names in GROUPS.values() for name in names}
    assert all(f"  {name.replace('_', ' ')}  " in whole for name in rest)


def test_a_method_has_its_other_names_and_one_of_somebody_has_not_ours():
    assert "  also called                           RK4, Runge-Kutta, " in shown(METHODS["rk4"])
    assert "  not to be confused with               rk38" in shown(METHODS["rk4"])
    copied = shown(replace(METHODS["rk38"], key="rk4"))
    assert "also called" not in copied
    assert "  in the catalogue                      rk38\n" in copied
    assert "in the catalogue" not in shown(METHODS["rk4"]) + shown(METHODS["fehlberg45_embedded"])


def test_an_order_that_is_claimed_and_missed_is_shown_and_one_that_is_met_is_not():
    rk4 = METHODS["rk4"]
    wrong = shown(replace(rk4, b=(*rk4.b[:2], Fraction(1, 6), Fraction(1, 3))))
    assert re.search(r"\n  claimed order \(0: none\) +4\n", wrong)
    assert "claimed order" not in shown(rk4)


def test_family_has_its_sets_under_the_same_headings():
    text = grouped_facts_text(facts_by_name(FamilyFacts(FAMILIES["sdirk_order_2"]), FAMILY_FACTS, FAMILY_FACTS))
    assert "  free parameter                        gamma" in text
    assert "  A-stable: y' = λy with Re λ <= 0 stays bounded for every h > 0             [1/4, oo)" in text


def test_a_method_of_facts_only_has_the_same_headings_and_its_angle_where_there_is_one():
    found = {key: grouped_facts_text(facts_of_further(FURTHER_METHODS[key])) for key in ("bdf2", "bdf3", "ros2")}
    assert all("\n\nAccuracy\n  order p: " in text for text in found.values())
    assert [key for key, text in found.items() if "A(alpha)-stable: stable for" in text] == ["bdf3"]
    assert "  also called                             Gear 3" in found["bdf3"]
    assert "  error constant: residual of that condition, divided by sigma(1)  -1/3\n" in found["bdf2"]
    assert "  error constant: leading error of a step on y' = y                " in found["ros2"]
    assert "  W-order: order with an arbitrary matrix in place of the Jacobian  2" in found["ros2"]
