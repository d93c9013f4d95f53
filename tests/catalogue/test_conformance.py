"""What every method of the catalogue must pass: its entry, every arithmetic, every witness, every control.

A method added to methods/tables is asked all of this. What its entry says is asked of EVERY method; what our machinery
makes of entries, of REPRESENTATIVES of each path through it, and in a thorough run of all. What is held against what is
in the modules that are imported here from `tests`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from fractions import Fraction as Q
from math import factorial
from pathlib import Path
from typing import Any

import pytest
from flint import arb

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.number_field import Algebraic
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Collocation, Method, MethodError, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.algebra.rational_functions import taylor
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT
from driftproof.symbolic.facts import FACTS, Facts, general_order
from driftproof.symbolic.linear.facts import facts_by_name
from driftproof.symbolic.linear.oscillator import area_factor, is_matrix_symmetric, oscillator_matrix
from driftproof.symbolic.linear.reduced_tableau import is_symmetric, is_symplectic, reduced, stages_of
from driftproof.symbolic.linear.stability_limits import INFINITY
from driftproof.symbolic.trees.algebraic_stability import quadratic_matrix
from driftproof.symbolic.trees.modified_equation import method_series, modified_equation
from driftproof.symbolic.trees.order_conditions import order_to_tolerance
from driftproof.symbolic.trees.partitioned_trees import embedded_conditions, embedded_order
from driftproof.texts.writing.facts import facts_tex, facts_text
from driftproof.texts.writing.records import record
from tests import changes
from tests.catalogue.conformance import ARITHMETICS
from tests.catalogue.measured_orders import differences, order_in_balls, order_on_series, program_is_its_definition
from tests.catalogue.representatives import THOROUGH, by_path, path_of, representatives
from tests.changes import NOTICES, coefficients, compensated, first_weight, moved, must_notice
from tests.claims import KNOWN_INCONSISTENT, NEARLY, ROUNDED, ROUNDED_SUMS, by_trees, claimed, conditions
from tests.looping import some
from tests.methods.tables.entries import DECIMAL, by_key, of_type
from tests.witnesses.b_series import symmetric_to_order, symplectic_to_order
from tests.witnesses.witness_limits import EPSILON, is_where_growth_begins, limits_with_growth
from tests.witnesses.witness_steps import as_function, witness_matrix

EVERY = pytest.mark.parametrize("key", METHODS)
CHOSEN = {key: METHODS[key] for key in representatives()}
REPRESENTATIVES = pytest.mark.parametrize("key", CHOSEN)
BIBLIOGRAPHY = (Path(__file__).parents[2] / "references.bib").read_text(encoding="utf-8")
TINY = Q(1, 10**14)


# --- the entry --------------------------------------------------------------------------------------------------------


@EVERY
def test_entry_is_exact_in_one_field_and_says_where_it_comes_from(key: str) -> None:
    method = METHODS[key]
    values = coefficients(method).values()
    assert all(type(x) is Q or (type(x) is Algebraic and not x.is_rational) for x in values)
    assert {x.field for x in values if isinstance(x, Algebraic)} == ({method.field} if method.field else set())
    source = re.fullmatch(r"([a-z-]+-\d{4}), \S.*", method.source)
    assert source
    assert f"{{{source[1]}," in BIBLIOGRAPHY
    assert re.fullmatch(r"[a-z][a-z0-9_]*", key)
    assert (method.key, method.title) == (key, method.title.strip() or None)
    assert method.claimed_order >= 1
    assert method.decimal is (key in ROUNDED)


@EVERY
def test_entry_is_consistent_or_known_not_to_be(key: str) -> None:
    residuals = METHODS[key].inconsistencies()
    if key in ROUNDED_SUMS:
        assert residuals
        assert all(0 < abs(x) < Q(1, 10 ** ROUNDED_SUMS[key]) for x in residuals.values())
    else:
        assert residuals == KNOWN_INCONSISTENT.get(key, {})


@pytest.mark.slow(keep=3)
@REPRESENTATIVES
def test_every_fact_is_answered_as_json_as_text_and_as_tex(key: str) -> None:
    facts = facts_by_name(Facts(METHODS[key]), FACTS, FACTS)
    found = record(facts)
    assert list(found) == list(FACTS)
    assert json.loads(json.dumps(found)) == found
    for form in (facts_text, facts_tex):
        assert key in form(facts).replace("\\_", "_")


# --- arithmetics ------------------------------------------------------------------------------------------------------

# A rounding bound takes time with the square of the program's length.
BOUNDED = {"float64": 20, "float32": 8, "float16": 8, "error-bounding numbers": 8}
# In eleven bits its errors of second order, of products of large weights, exceed the state.
VAGUE = {("yoshida8_a", "float16")}


def length(method: Method) -> int:
    return len(method.parts) // 2 if isinstance(method, Splitting) else method.stages


def meetings() -> Iterator[Any]:
    for name, arithmetic in ARITHMETICS.items():
        for key, method in CHOSEN.items():
            if arithmetic.suits(method):
                slow = length(method) > BOUNDED.get(name, length(method))
                yield pytest.param(key, name, marks=pytest.mark.long if slow else (), id=f"{key}-{name}")


@pytest.mark.slow(keep=9)
@pytest.mark.parametrize(("key", "name"), list(meetings()))
def test_step_in_each_arithmetic_is_the_one_step_matrix_and_another_step_is_not(key: str, name: str) -> None:
    method, arithmetic = METHODS[key], ARITHMETICS[name]
    assert arithmetic.meets(method, method)
    off = moved(method, first_weight(method), arithmetic.notices)
    assert (key, name) in VAGUE or not arithmetic.meets(off, method)


@EVERY
def test_no_method_meets_fewer_arithmetics_than_there_are_for_its_kind(key: str) -> None:
    method = METHODS[key]
    met = {name for name, arithmetic in ARITHMETICS.items() if arithmetic.suits(method)}
    implicit = {"Fraction", "number field", "functions of h", "balls"}
    wanted = set(ARITHMETICS) - {"functions of h"} if method.explicit else implicit
    assert met == wanted - ({"Fraction", "SymPy's polynomials"} if method.field else set())
    assert len(met) >= (8 if method.explicit else 3)


@pytest.mark.parametrize("key", [key for key, method in METHODS.items() if not method.explicit])
def test_implicit_method_has_no_explicit_step(key: str) -> None:
    with pytest.raises(MethodError, match=f"{key} is implicit"):
        stepper(METHODS[key], lambda c: c)


# --- witnesses of the one-step matrix ---------------------------------------------------------------------------------


@REPRESENTATIVES
def test_one_step_matrix_solves_the_stage_equations_or_is_the_product_of_shears(key: str) -> None:
    method = METHODS[key]
    matrix = oscillator_matrix(method)
    assert witness_matrix(method) == matrix
    off = moved(method, first_weight(method), Q(1, 10**30))
    assert oscillator_matrix(off) == witness_matrix(off) != matrix


@EVERY
def test_one_step_matrix_agrees_with_the_exact_flow_up_to_the_claimed_order(key: str) -> None:
    """It may well agree further: order on linear problems is not order."""
    method, tolerance = METHODS[key], Q(1, 10**12) if key in DECIMAL else Q(0)
    assert distance_from_rotation(method) <= tolerance
    assert distance_from_rotation(moved(method, first_weight(method), Q(1, 10**6))) > tolerance


def distance_from_rotation(method: Method) -> Any:
    """The largest difference between coefficients of M(h) and of exp(hJ), up to the claimed order."""
    terms = range(method.claimed_order + 1)
    cosine, sine = ([Q((-1) ** (k // 2), factorial(k)) if k % 2 == odd else Q(0) for k in terms] for odd in (0, 1))
    entries = [taylor(entry, len(terms)) for row in oscillator_matrix(method) for entry in row]
    exact_entries = (cosine, sine, [-x for x in sine], cosine)
    found = [exact(x) - y for a, b in zip(entries, exact_entries, strict=True) for x, y in zip(a, b, strict=True)]
    return max(*found, *(-x for x in found))


@REPRESENTATIVES
def test_growth_begins_at_the_stability_limits_in_balls(key: str) -> None:
    for limit, growth in some(limits_with_growth(METHODS[key])):
        assert is_where_growth_begins(limit, growth)
        if limit not in (INFINITY, ZERO_ROOT):
            assert not is_where_growth_begins(limit, growth, moved=1 + 2 * EPSILON)
            assert not is_where_growth_begins(limit, growth, moved=1 - 2 * EPSILON)


@EVERY
def test_symplectic_method_keeps_area_and_symmetric_one_undoes_itself_on_the_oscillator(key: str) -> None:
    method = METHODS[key]
    matrix = oscillator_matrix(method)
    assert not is_symplectic(method) or area_factor(matrix) == as_function(Q(1))
    assert not is_symmetric(method) or is_matrix_symmetric(matrix)


@pytest.mark.parametrize("key", [key for key, m in CHOSEN.items() if isinstance(m, RungeKutta | Collocation)])
def test_structure_by_coefficients_is_structure_by_trees(key: str) -> None:
    """B-series two orders beyond p know nothing of coefficient conditions; for many stages, Mᵢⱼ = 0 of the tableau."""
    method: Any = METHODS[key]
    form = reduced(stages_of(method)) if isinstance(method, RungeKutta) else method
    assert is_symplectic(method) == (not any(x for row in quadratic_matrix(form) for x in row))
    if method.claimed_order <= 8 and method.stages <= 14 and not method.decimal:
        series = method_series(method, method.claimed_order + 2)
        assert is_symplectic(method) == (symplectic_to_order(series) == series.order)
        assert is_symmetric(method) == (symmetric_to_order(modified_equation(method, series.order)) == series.order)


# --- witnesses of the order -------------------------------------------------------------------------------------------


@pytest.mark.slow(keep=17)
@EVERY
def test_claimed_order_is_the_order_by_trees(key: str) -> None:
    """Exactly; of a rounded table to its last digits, while taken exactly it is of a lower order."""
    method, facts = METHODS[key], by_trees(METHODS[key])
    assert all(fact.residual != 0 for fact in facts.values())
    if not method.decimal:
        assert {problem: fact.order for problem, fact in facts.items()} == claimed(method)
        return
    assert all(facts[problem].order < order for problem, order in claimed(method).items())
    last = ROUNDED[key]
    assert {name: order_to_tolerance(found, last) for name, found in conditions(method).items()} == claimed(method)
    off = moved(method, first_weight(method), 3 * last)
    assert {order_to_tolerance(found, last) for found in conditions(off).values()} == {0}


@REPRESENTATIVES
def test_order_is_measured_on_series_of_nonlinear_problems(key: str) -> None:
    """Step and solution part where trees say, exactly; of a rounded table they do so visibly where it is claimed."""
    method = METHODS[key]
    facts = by_trees(method)
    for problem, order in some(claimed(method).items()):
        found = differences(method, problem, order + 3)
        assert order_on_series(found) == facts[problem].order
        assert all(x < arb(scalar(NEARLY)) for x in found[: order + 1])
        assert found[order + 1] > arb(scalar(NEARLY))
        off = moved(method, first_weight(method), TINY)
        assert order_on_series(differences(off, problem, order + 1)) < order


@pytest.mark.parametrize("key", [key for key, method in CHOSEN.items() if method.explicit])
def test_step_on_a_nonlinear_force_is_the_definition_written_out(key: str) -> None:
    method = METHODS[key]
    assert program_is_its_definition(method, method)
    assert not program_is_its_definition(moved(method, first_weight(method), TINY), method)


@pytest.mark.parametrize("key", [key for key, method in METHODS.items() if method.explicit])
def test_order_of_the_program_is_measured_in_balls(key: str) -> None:
    method = METHODS[key]
    assert order_in_balls(method) == general_order(method).order
    assert order_in_balls(moved(method, first_weight(method), TINY)) == 0


@pytest.mark.parametrize("method", [m for m in of_type(RungeKutta) if m.b_embedded is not None], ids=by_key)
def test_second_row_has_its_claimed_order_by_trees_and_on_series(method: RungeKutta) -> None:
    second, fact = embedded_conditions(method), embedded_order(method)
    assert second is not None
    assert fact is not None
    by_trees = order_to_tolerance(second, ROUNDED[method.key]) if method.decimal else fact.order
    assert by_trees == method.embedded_order
    row = changes.second_row(method)
    assert general_order(row) == fact
    assert order_on_series(differences(row, "general", fact.order + 2)) == fact.order


# --- controls ---------------------------------------------------------------------------------------------------------


def sample(method: Method, places: list[Any]) -> list[Any]:
    """All of them; of the one table with more than 1000, every seventh."""
    return places[:: 7 if len(coefficients(method)) > 1000 else 1]


@pytest.mark.slow(keep=12)
@REPRESENTATIVES
def test_each_coefficient_off_by_1e_14_is_noticed_zeros_included(key: str) -> None:
    """An entry of A on or above the diagonal makes an explicit method implicit, which says all."""
    method = METHODS[key]
    before = {name: notice(method) for name, notice in NOTICES.items()}
    for place in some(sample(method, list(coefficients(method)))):
        off = moved(method, place, TINY)
        if off.explicit is method.explicit:
            found = {name: NOTICES[name](off) != before[name] for name in must_notice(method, place)}
            assert set(found.values()) == {True}, (place, found)


@REPRESENTATIVES
def test_two_coefficients_changed_so_that_no_sum_shows_it_are_noticed(key: str) -> None:
    method = METHODS[key]
    notices = [NOTICES[name] for name in ("order", "one-step matrix", "second row")]
    before = [notice(method) for notice in notices]
    pairs = sample(method, list(compensated(method, TINY)))
    if not pairs:
        pytest.skip("no sum of its coefficients has two members")
    for pair, off in some(pairs):
        noticed = any(notice(off) != fact for notice, fact in zip(notices, before, strict=True))
        assert noticed or changes.is_the_same_in_disguise(off, method), pair


def test_every_path_is_represented_and_every_kind_of_method_is_among_those_asked() -> None:
    paths = by_path(METHODS.values())
    assert {path_of(METHODS[key]) for key in CHOSEN} == set(paths)
    assert len(CHOSEN) == len(METHODS) if THOROUGH else len(paths) < len(CHOSEN) <= 2 * len(paths) + 1
    assert {type(method) for method in METHODS.values()} == {RungeKutta, Splitting, Nystrom, Collocation}
    assert {type(method) for method in METHODS.values() if method.decimal} == {RungeKutta, Splitting}
    assert {name for _, name in ((p.values[0], p.values[1]) for p in meetings())} == set(ARITHMETICS)
    assert len(METHODS) >= 100
