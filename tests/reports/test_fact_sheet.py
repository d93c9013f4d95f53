"""A sheet of facts derives what it is asked for, and no more."""

from dataclasses import replace
from fractions import Fraction as Q
from math import inf

import pytest

from driftproof import METHODS, Facts, facts, value
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.multistep import Multistep
from driftproof.reports.fact_sheet import FactSheet
from driftproof.symbolic.family_facts import FAMILY_FACTS


def test_only_what_is_asked_for_is_derived():
    asked = []
    sheet = FactSheet(lambda names: asked.append(tuple(names)) or dict.fromkeys(names or ("a", "b"), 1), ["a"])
    assert (sheet["b"], sheet.a) == (1, 1)
    assert asked == [("b",), ("a",)]
    assert (str(sheet), sheet.json()) == ("a  1", '{\n "a": 1\n}')
    assert asked == [("b",), ("a",), ("a",)]
    with pytest.raises(AttributeError):
        _ = sheet._private


def test_of_the_facts_asked_for_it_is_said_which_belong_to_the_table():
    found = facts("fehlberg12", only=("order", "stages", "symplectic")).data["reduction"]
    assert (found["irreducible_stages"], found["of_the_table"]) == (2, ["stages"])
    assert found["of_the_irreducible_method"] == ["symplectic"]
    assert "reduction" not in facts("fehlberg12", only=("order",)).data


def test_a_fact_of_rounded_coefficients_brings_what_holds_but_for_the_rounding():
    assert [*facts("dop853", only=("order",)).data] == ["order", "order_but_for_rounding"]
    assert [*facts("rk4", only=("order", "a_stable")).data] == ["order", "a_stable"]


DP5 = METHODS["dormand_prince54"]
WRONG = replace(DP5, b=(*DP5.b[:2], Q(500, 1131), *DP5.b[3:]))


def test_an_order_that_is_claimed_and_missed_comes_first_with_the_entry_that_may_be_wrong():
    entry = "b[2] = 500/1113 in place of 500/1131"
    lines = ["claimed order 5, has 0", f"with this one entry changed, order 5 is restored: {entry}"]
    for sheet in (facts(WRONG), facts(WRONG, only=["order"])):
        assert str(sheet).splitlines()[:3] == [*lines, ""]
        assert sheet.data["unreached"] == lines
    assert facts(WRONG, only=["embedded_order"]).written("tex").startswith(f"% {lines[0]}\n% {lines[1]}\n\\begin")
    pair = replace(METHODS["heun_euler21"], b_embedded=(Q(1, 2), Q(1, 4)))
    assert facts(pair).unreached == (
        "claimed embedded order 1, has 0",
        "with this one entry changed, order 1 is restored: b_embedded[0] = 3/4 in place of 1/2",
        "with this one entry changed, order 1 is restored: b_embedded[1] = 1/2 in place of 1/4",
    )
    assert facts(replace(FURTHER_METHODS["bdf3"], claimed_order=4)).unreached == ("claimed order 4, has 3",)
    unstable = facts(Multistep("m", "", 0, "", (-5, 4, 1), (2, 4, 0)), only=["zero_stable"]).unreached
    assert unstable == ("order 3, but is not zero-stable: a root is outside the unit circle",)


def test_where_no_order_is_asked_for_or_a_tolerance_is_met_no_claim_is_examined():
    rounded = [round(x, 16) for x in DP5.b]
    off = replace(DP5, b=(rounded[0] + Q(1, 10**9), *rounded[1:]))
    sheets = facts(WRONG, only=["stages"]), facts(off, order_tolerance="1e-8"), facts("sdirk_order_2")
    for sheet in (*sheets, facts("tsitouras54"), facts(WRONG, system=[[0, 1], [-1, 0]])):
        assert sheet.unreached == ()
        assert "unreached" not in sheet.data
    found = facts(off, order_tolerance="1e-10").unreached
    assert found[0].startswith("claimed order 5, has 0: a condition fails by 1.01e-9, more than its digits explain")


def test_facts_of_a_method_are_its_typed_facts():
    found = facts("trapezoid", order_tolerance="1e-3", terms=4)
    assert isinstance(found, Facts)
    assert (found.method, found.terms, found.order_to_tolerance.order) == (METHODS["trapezoid"], 4, 2)
    assert facts("trapezoid").order_to_tolerance is None
    assert "Everything else" in found.written("text", everything=True)
    assert [*facts("sdirk_order_2").shown] == [*FAMILY_FACTS]
    assert facts("rk4", system=[[0, 1], [-1, 0]]).written("text").startswith("method ")
    assert found.written("tex").startswith(r"\begin{tabular}")


def test_limits_and_angles_are_floats_where_one_is_asked_for():
    rk4, bdf3 = facts("rk4"), facts("bdf3")
    assert (float(rk4.imaginary_limit), float(rk4.real_limit)) == (8**0.5, 2.785293563405282)
    assert float(facts("backward_euler").real_limit) == float(value("real_limit backward_euler")) == inf
    assert round(float(bdf3.sector.degrees), 2) == 86.03
    assert float(facts("sdirk_order_2", at=0.5).order) == 2


@pytest.mark.parametrize("asked", [{"system": [[1]]}, {"order_tolerance": 1}])
def test_a_family_has_no_facts_on_a_system_or_within_a_tolerance(asked):
    with pytest.raises(ValueError, match="sdirk_order_2 is a family; choose one method with `at`, a value of gamma"):
        facts("sdirk_order_2", **asked)
