"""A sheet of facts derives what it is asked for, and no more."""

from math import inf

import pytest

from driftproof import METHODS, Facts, facts, value
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
