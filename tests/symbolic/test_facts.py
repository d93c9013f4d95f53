"""Exact facts by name: the order apart from the linear order and the order to a tolerance, only what is asked for."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path

import pytest

import driftproof
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.facts import FACTS, ON_REQUEST, WHY_NONE, Facts, OrderWithin, general_order, order_within
from driftproof.symbolic.linear.facts import LinearFacts, fact_names, facts_by_name
from driftproof.symbolic.trees.rooted_trees import TooManyTrees, to_brackets

# The keys that the output format promises for every method.
SCHEMA = (
    "title source decimal field inconsistencies claimed_order "
    "method family stages explicit order stability_function one_step_matrix determinant energy_multiplier invariant "
    "imaginary_limit real_limit a_stable l_stable symplectic error_constant dispersion dissipation"
)


def test_every_key_that_is_promised_is_a_fact_and_has_a_sentence() -> None:
    assert set(FACTS) >= set(SCHEMA.split())
    assert set(WHY_NONE) <= {*FACTS, *ON_REQUEST}
    assert {*fact_names(LinearFacts)} - {*FACTS} == {*ON_REQUEST}
    of_facts = [getattr(Facts, name) for name in (*FACTS, *ON_REQUEST) if hasattr(Facts, name)]
    assert len(of_facts) > 35
    assert all(fact.__doc__.rstrip().endswith(".") for fact in of_facts)
    tests = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parents[1].rglob("*.py"))
    untested = [name for name in (*FACTS, *ON_REQUEST) if not re.search(rf"\b{name}\b", tests)]
    assert untested == [], "in no test, yet called DERIVED: compare it with an independent computation"


def test_a_fact_is_an_exact_object_of_a_public_class() -> None:
    facts = driftproof.Facts(METHODS["rk4"])
    limit = facts.imaginary_limit
    assert limit.minimal == (-8, 0, 1)  # x**2 - 8
    assert facts.stability_function(Q(-1)) == Q(3, 8)
    assert str(facts.energy_multiplier) == "1 - h**6/72 + h**8/576"
    assert facts.energy_multiplier(2) == Q(5, 9)
    assert facts.a_stability.witness == 9
    assert len(Facts(METHODS["forward_euler"]).modified_equation) == 16, "of 17 trees, one has 0"


def test_only_what_is_asked_for_is_derived() -> None:
    facts = Facts(METHODS["rk4"])
    assert facts_by_name(facts, ("order",), FACTS) == {"order": 4}
    assert isinstance(Facts(METHODS["gauss9"]).principal_error, TooManyTrees)
    assert {name for name in vars(facts) if not name.startswith("_")} == {"method", "terms", "order", "order_fails"}
    assert facts_by_name(facts, ("title", "method"), FACTS) == {"title": "Classical RK4", "method": METHODS["rk4"]}
    with pytest.raises(ValueError, match="unknown fact 'colour'; choose from method, title, family"):
        facts_by_name(facts, ("order", "colour"), FACTS)
    with pytest.raises(ValueError, match="unknown fact 'simplectic'; did you mean symplectic\\? choose from method"):
        facts_by_name(facts, ("simplectic",), FACTS)


def test_order_and_linear_order_are_two_facts() -> None:
    heun3 = METHODS["heun3"]
    rows = ((0, 0, 0), (Q(1, 3), 0, 0), (0, Q(1, 2), 0))
    twin = Facts(replace(heun3, key="twin", a=rows, b=(0, 0, 1), c=(0, Q(1, 3), Q(1, 2))))
    known = Facts(heun3)
    assert (twin.stability_function, twin.linear_order) == (known.stability_function, known.linear_order)
    assert (twin.order, known.order) == (2, 3)


def test_radau_is_algebraically_stable_and_trapezoid_is_not() -> None:
    radau, trapezoid = Facts(METHODS["radau_iia2"]), Facts(METHODS["trapezoid"])
    assert (radau.algebraically_stable, radau.l_stable) == (True, True)
    assert (trapezoid.algebraically_stable, trapezoid.a_stable) == (False, True)


# --- three answers about the order


def test_exact_order_failing_residual_and_order_to_a_tolerance_are_three_answers() -> None:
    tsitouras = METHODS["tsitouras54"]
    facts = Facts(tsitouras)
    assert (facts.order, to_brackets(facts.order_fails.failing_tree)) == (0, "τ")
    assert facts.order_fails.residual == Q(-17, 10**17)
    tolerances = [(Q(1, 10**12), 5), (Q(17, 10**17), 1), (Q(16, 10**17), 0), (Q(0), 0)]
    assert [order_within(tsitouras, t).order for t, _ in tolerances] == [p for _, p in tolerances]
    assert order_within(tsitouras, Q(1, 10**12)) == OrderWithin(Q(1, 10**12), 5, None, 4)


ROUNDED = sorted(key for key, method in METHODS.items() if method.decimal)
# Their order 6 is that on q'' = F(q); their claim of 4 and 5 is of quadratic kinetic energies alone.
ON_FEWER_PROBLEMS = {"blanes_moan_rkn6a": 4, "blanes_moan_rkn6b": 4, "mclachlan_atela4": 3, "mclachlan_atela5": 3}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ROUNDED)
def test_rounded_tables_have_the_order_of_their_source_but_for_rounding(key: str) -> None:
    facts = Facts(METHODS[key])
    found = facts.order_but_for_rounding
    assert found is not None
    assert facts.order < found.order == ON_FEWER_PROBLEMS.get(key, METHODS[key].claimed_order)
    assert order_within(METHODS[key], Q(found.residual) * Q(101, 100)).order >= found.order
    assert order_within(METHODS[key], Q(found.next_residual) * Q(99, 100)).order == found.order


@pytest.mark.parametrize(
    ("key", "order", "second"),
    [
        ("pefrl", 4, 4), ("blanes_moan_rkn6a", 4, 6), ("suzuki_umeno8", 8, 8), ("gauss9", 18, None),
        ("nystrom4", 4, None),
    ],
)  # fmt: skip
def test_order_to_a_tolerance_of_every_kind_of_method(key: str, order: int, second: int | None) -> None:
    found = order_within(METHODS[key], Q(1, 10**12))
    assert (found.order, found.order_second_order_problems, found.embedded_order) == (order, second, None)
    assert general_order(METHODS[key]).order <= order
    assert order_within(METHODS[key], Q(0)).order == general_order(METHODS[key]).order
    with pytest.raises(ValueError, match="tolerance -1 is negative; it must be >= 0"):
        order_within(METHODS[key], Q(-1))
