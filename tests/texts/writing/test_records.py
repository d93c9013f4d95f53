"""The records of facts: limits as the schema has them, number fields, points of the boundary, null where due."""

import json
from dataclasses import replace
from fractions import Fraction as Q

import pytest
from hypothesis import given

from driftproof import strategies
from driftproof.methods.catalogue import METHODS
from driftproof.methods.families import FAMILIES
from driftproof.reports.fact_sheet import facts
from driftproof.symbolic.facts import FACTS, Facts
from driftproof.symbolic.family_facts import FAMILY_FACTS
from driftproof.symbolic.linear.families import Interval
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError
from driftproof.symbolic.linear.systems import EigenvalueLimit, SystemFacts
from driftproof.texts.writing.records import record
from tests.looping import exactly
from tests.symbolic.linear.family_examples import THETA


@pytest.mark.parametrize(
    ("key", "name", "wanted"),
    [
        ("forward_euler", "imaginary_limit", "0"), ("backward_euler", "real_limit", "oo"),
        ("gauss2", "imaginary_limit", "oo"), ("rk4", "ssp_coefficient", "0"), ("velocity_verlet", "real_limit", None),
    ],
)  # fmt: skip
def test_a_limit_that_is_none_or_always_is_a_bare_string(key, name, wanted):
    assert facts(METHODS[key], only=(name,)).data[name] == wanted


def test_what_has_no_end_is_infinite():
    ends = {"low_closed": False, "high_closed": False}
    assert record(Interval(None, None, False, False)) == {"low": "-oo", "high": "oo", **ends}
    assumed = facts("forward_euler", only=["simplifying_assumptions"]).data["simplifying_assumptions"]
    assert assumed == {"B": 1, "C": "oo", "D": 0}


def test_a_limit_that_is_a_number_is_a_record():
    found = facts(METHODS["rk4"], only=("imaginary_limit", "real_limit")).data
    assert found["imaginary_limit"] == {
        "exact": "2*sqrt(2)", "minpoly": "x**2 - 8", "interval": ["2", "3"],
        "decimal": "2.828427124746190097603377448419",
    }  # fmt: skip
    assert found["real_limit"]["exact"] is None
    assert found["real_limit"]["minpoly"] == "x**3 - 4*x**2 + 12*x - 24"


@pytest.mark.parametrize("key", [key for key, method in METHODS.items() if method.field])
def test_number_field_is_written_out(key):
    field = METHODS[key].field
    record = facts(METHODS[key], only=("field",)).data["field"]
    assert record["generator"] == field.name
    assert "x**" in record["minpoly"]
    decimal, (low, high) = Q(record["decimal"]), map(Q, record["interval"])
    assert low < decimal < high
    unit = Q(1, 10**29)
    assert field.generator - unit < decimal < field.generator + unit
    assert abs(sum(c * decimal**k for k, c in enumerate(field.minimal))) < Q(1, 10**25)
    assert facts(METHODS["rk4"], only=("field",)).data == {"field": None}


@pytest.mark.parametrize(("key", "limit"), [("chebyshev10_1", "200"), ("ssprk40_2", "78")])
def test_real_limits_where_sampling_goes_wrong(key, limit):
    assert facts(METHODS[key], only=("real_limit",)).data["real_limit"]["exact"] == limit


def test_boundary_is_given_only_when_it_is_named():
    assert "region_boundary" not in FACTS
    record = facts(METHODS["rk4"], only=("region_boundary",)).data["region_boundary"]
    assert record["radius"] == "1e-15"
    assert {"cosine": "1", "re": "-2.785293563405282", "im": "0.000000000000000"} in record["points"]
    assert facts(METHODS["velocity_verlet"], only=("region_boundary",)).data == {"region_boundary": None}


@pytest.mark.slow
@given(strategies.runge_kutta_methods(max_stages=3))
def test_limits_of_drawn_methods_are_strings_or_records(method):
    found = facts(method, only=("real_limit", "imaginary_limit", "ssp_coefficient")).data
    for x in exactly(3, [x for name, x in found.items() if name != "reduction"]):
        assert x in ("0", "oo") or set(x) == {"exact", "minpoly", "interval", "decimal"}


def test_every_fact_of_a_family_is_json_and_the_same_every_time():
    for key, each in {**FAMILIES, "theta": THETA}.items():
        found = facts(each).data
        assert list(found) == list(FAMILY_FACTS), key
        assert json.loads(json.dumps(found)) == found == facts(each).data
    with pytest.raises(ValueError, match="unknown fact 'colour'; choose from method"):
        facts(THETA, only=("colour",)).json()


def test_an_eigenvalue_has_its_limit_and_whether_that_is_attained_or_neither():
    """Forward Euler multiplies z' = -z by 1 - h: its powers are bounded at h = 2, too, but not with a Jordan block."""
    for system, block, attained in (("-1 0; 0 -1", 1, True), ("-1 1; 0 -1", 2, False)):
        (found,) = facts("forward_euler", system=system).data["eigenvalues"]
        value, limit = found.pop("value"), found.pop("limit")
        assert (value["exact"], limit["exact"]) == ("-1", "2")
        assert found == {"multiplicity": 2, "largest_block": block, "attained": attained}
    for system, exact in (("-1 -2; 2 -1", "-1 + 2*I"), ("0 -1; 2 0", "sqrt(2)*I")):
        (found,) = facts("forward_euler", system=system).data["eigenvalues"]
        assert found["value"]["exact"] == exact
    (bound,) = SystemFacts(METHODS["forward_euler"], [[Q(-1)]]).bounds
    undecided = record(EigenvalueLimit(bound.eigenvalue, UndecidedLimitError("why")))
    assert (undecided["limit"], undecided["attained"]) == ({"refused": "why"}, None)


def test_coefficients_of_thousands_of_trees_are_counted_and_not_listed():
    """Those of Gauss with six stages took 700 kB, with seven 5 MB; what is measured by them stays."""
    found, short = (facts(key, only=["principal_error"]).data["principal_error"] for key in ("gauss6", "gauss5"))
    assert found["coefficients"] == "of 12486 trees, too many to list; Facts(method).principal_error has them"
    assert found["squared_norm"] == "89604046740749/2355414106012061154379038720000"
    assert len(short["coefficients"]) == 1842


def test_2000_trees_are_read_and_no_more():
    error = Facts(METHODS["rk4"]).principal_error
    for count in (2000, 2001):
        found = record(replace(error, errors=error.errors[:1] * count))
        assert isinstance(found["coefficients"], dict) is (count == 2000)
