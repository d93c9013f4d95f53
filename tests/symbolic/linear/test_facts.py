"""Facts of single methods as printed, two formulas for R, monotonicity, phase, and points of the boundary."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import reduce
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.number_field import Algebraic
from driftproof.methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT
from driftproof.symbolic.linear.a_stability import Angle
from driftproof.symbolic.linear.facts import LinearFacts
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from driftproof.symbolic.linear.oscillator import oscillator_matrix, stability_function_of
from driftproof.symbolic.linear.phase import NoRotationError, angle_error_series, leading_frequency
from driftproof.symbolic.linear.stability_function import scalar_tableau
from driftproof.symbolic.linear.stability_limits import INFINITY
from driftproof.texts.writing.records import record
from tests.methods.tables.entries import product
from tests.symbolic.linear.linear_examples import by_determinants, limit_text, record_text
from tests.witnesses.multistep import integral, lagrange

WITH_R = [key for key, method in METHODS.items() if isinstance(method, RungeKutta | Collocation)]


@pytest.mark.slow(keep=11)
@pytest.mark.parametrize("key", WITH_R)
def test_two_formulas_for_r(key: str) -> None:
    if not isinstance(METHODS[key], RungeKutta) or METHODS[key].stages < 20:
        assert by_determinants(scalar_tableau(METHODS[key])) == stability_function_of(METHODS[key])


# (key, fact): value, as printed in the sources, or derived in them.
PUBLISHED: dict[tuple[str, str], str] = {
    ("rk4", "imaginary_limit"): "2*sqrt(2)", ("kutta3", "imaginary_limit"): "sqrt(3)",
    ("ssprk33", "imaginary_limit"): "sqrt(3)", ("chebyshev10_1", "real_limit"): "200",
    ("ssprk40_2", "real_limit"): "78", ("heun2", "imaginary_limit"): "0", ("ssprk22", "ssp_coefficient"): "1",
    ("ssprk33", "ssp_coefficient"): "1", ("ssprk43", "ssp_coefficient"): "2", ("ssprk104", "ssp_coefficient"): "6",
    ("ssprk40_2", "ssp_coefficient"): "39", ("rk4", "ssp_coefficient"): "0",
    ("velocity_verlet", "imaginary_limit"): "2", ("symplectic_euler", "imaginary_limit"): "2",
    ("backward_euler", "real_limit"): "oo", ("backward_euler", "imaginary_limit"): "oo",
    ("gauss2", "imaginary_limit"): "oo", ("bogacki_shampine32", "imaginary_limit"): "sqrt(3)",
    ("merson45", "imaginary_limit"): "2*sqrt(3)",
}  # fmt: skip
# Two to five digits as papers print them.
PRINTED: dict[tuple[str, str], str] = {
    ("rk4", "real_limit"): "2.785", ("kutta3", "real_limit"): "2.512", ("dormand_prince54", "real_limit"): "3.306",
    ("fehlberg45", "real_limit"): "3.02", ("ssprk104", "real_limit"): "13.91",
    ("forest_ruth", "imaginary_limit"): "1.573", ("pefrl", "imaginary_limit"): "2.98",
}  # fmt: skip


@pytest.mark.parametrize("where", PUBLISHED)
def test_published_exact_value(where: tuple[str, str]) -> None:
    key, fact = where
    assert record_text(record(getattr(LinearFacts(METHODS[key]), fact))) == PUBLISHED[where]


@pytest.mark.parametrize("where", PRINTED)
def test_printed_digits(where: tuple[str, str]) -> None:
    key, fact = where
    assert record(getattr(LinearFacts(METHODS[key]), fact))["decimal"].startswith(PRINTED[where])


A_AND_L = {
    "gauss": (True, False), "radau_ia": (True, True), "radau_iia": (True, True), "lobatto_iiia": (True, False),
    "lobatto_iiib": (True, False), "lobatto_iiic": (True, True), "sdirk2": (True, True), "sdirk4": (True, True),
    "alexander3": (True, True), "crouzeix": (True, False), "tr_bdf2": (True, True), "trapezoid": (True, False),
    "backward_euler": (True, True),
}  # fmt: skip


@pytest.mark.parametrize("key", WITH_R)
def test_stability_of_the_classical_families(key: str) -> None:
    facts = LinearFacts(METHODS[key])
    found = (facts.a_stable, facts.l_stable)
    family = next((name for name in A_AND_L if key.startswith(name)), None)
    if family:
        assert found == A_AND_L[family]
        assert facts.sector == (INFINITY, Angle(INFINITY))
    elif facts.stability_function is not None and facts.stability_function.f.den.degree() < 1:
        assert found == (False, False)


# ---- the shape of the JSON


# What a fact is as JSON.
DESIGN: dict[str, dict[str, Any]] = {
    "rk4": {
        "energy_multiplier": {"num": ["1", "0", "0", "-1/72", "1/576"], "den": ["1"]},
        "a_stable": False, "l_stable": False, "symplectic": False,
        "error_constant": {"power": 5, "coefficient": "-1/120"},
        "dispersion": {"power": 5, "coefficient": "-1/120"}, "dissipation": {"power": 6, "coefficient": "-1/144"},
        "invariant": None, "linear_order": 4, "limit_at_infinity": "oo",
    },
    "symplectic_euler": {
        "stability_function": None, "real_limit": None, "a_stable": None, "a_stability": None, "sector": None,
        "limit_at_infinity": None, "modified_rate": None, "ssp_coefficient": None, "error_constant": None,
        "energy_multiplier": None, "invariant": {"q2": "1/2", "qv": "-h/2", "v2": "1/2"},
        "determinant": {"num": ["1"], "den": ["1"]}, "dissipation": None,
        "dispersion": {"power": 3, "coefficient": "1/24"}, "symplectic": True, "symmetric": False,
        "linearly_symmetric": False,
    },
}  # fmt: skip


@pytest.mark.parametrize("key", DESIGN)
def test_facts_are_those_of_the_design(key: str) -> None:
    facts = LinearFacts(METHODS[key])
    assert {name: record(getattr(facts, name)) for name in DESIGN[key]} == DESIGN[key]


def test_a_factor_of_the_energy_is_a_function_of_h_without_a_stability_function() -> None:
    """The explicit midpoint rule, written for q'' = F(q), multiplies it by (1 - h²/2)² + h² = 1 + h⁴/4."""
    row = lambda *entries: tuple(map(Q, entries))
    weights = {"b_position": row("1/2", 0), "b_velocity": row(0, 1)}
    midpoint = Nystrom("m", "M", 2, "", c=row(0, "1/2"), a=(row(0, 0), row(0, 0)), **weights)
    found = LinearFacts(midpoint)
    assert found.stability_function is None
    factor = found.energy_multiplier
    assert factor is not None
    assert (str(factor), factor(Q(1, 2))) == ("1 + h**4/4", Q(65, 64))


def test_a_refusal_names_a_witness() -> None:
    found = record(LinearFacts(METHODS["rk4"]).a_stability)
    assert found["margin"] == ["0", "0", "0", "1/72", "-1/576"]
    assert found["witness"] == "9"
    assert not found["holds"]


def test_modified_hamiltonian_of_symplectic_euler_as_text() -> None:
    found = record(LinearFacts(METHODS["symplectic_euler"], terms=5).modified_hamiltonian)
    assert found["factor"] == "acos(1 - h**2/2)/sqrt(1 - (1 - h**2/2)**2)"
    assert found["quadratic"] == {"q2": "1/2", "qv": "-h/2", "v2": "1/2"}
    assert found["factor_series"] == ["1", "0", "1/6", "0", "1/30"]
    assert found["valid_limit"]["exact"] == "2"


# --- monotonicity of collocation


def collocation(*nodes: Q) -> Collocation:
    return Collocation("given", "Given", 0, "x", reduce(product, [(-c, Q(1)) for c in nodes]))


def by_lagrange(*nodes: Q) -> RungeKutta:
    """The same method by its tableau: integrals of the Lagrange polynomials."""
    *rows, weights = (tuple(integral(p, end) for p in lagrange(nodes)) for end in (*nodes, Q(1)))
    return RungeKutta("given", "Given", 0, "x", tuple(rows), weights, nodes)


@given(st.lists(st.fractions(-1, 2, max_denominator=4), min_size=1, max_size=4, unique=True))
def test_ssp_coefficient_of_collocation_is_that_of_its_tableau(nodes: list[Q]) -> None:
    assert ssp_coefficient(collocation(*nodes)) == ssp_coefficient(by_lagrange(*nodes))


def test_collocation_methods_that_are_monotone() -> None:
    wanted = {(Q(1),): "oo", (Q(1, 2),): "2", (Q(0), Q(1)): "2", (Q(0), Q(2, 3)): "3/2", (Q(1, 3), Q(1)): "0"}
    assert {nodes: limit_text(ssp_coefficient(collocation(*nodes))) for nodes in wanted} == wanted
    every = [method for method in METHODS.values() if isinstance(method, Collocation)]
    assert {limit_text(ssp_coefficient(method)) for method in every} <= {"0", "3/2"}
    assert LinearFacts(METHODS["gauss4"]).ssp_coefficient == ZERO_ROOT


# --- phase


def splitting(kick: Q, drift: Q) -> Splitting:
    return Splitting("given", "Given", 0, "x", (("kick", kick / 2), ("drift", drift), ("kick", kick / 2)))


def phase(method: Splitting) -> dict[str, Any]:
    facts = LinearFacts(method)
    return {name: record(getattr(facts, name)) for name in ("dispersion", "dispersion_series", "modified_hamiltonian")}


def test_an_inconsistent_splitting_turns_at_its_own_rate() -> None:
    short = phase(splitting(Q(10, 9), Q(1)))
    assert short["dispersion"] == {"power": 1, "coefficient": "-1 + 1/3*sqrt(10)"}
    assert short["dispersion_series"][1] == "-1 + 1/3*sqrt(10)"
    rational = phase(splitting(Q(4, 9), Q(1)))
    assert rational["dispersion"] == {"power": 1, "coefficient": "-1/3"}


@pytest.mark.parametrize("square", [Q(4, 9), Q(8, 3), Q(2, 10**29), Q(10**32), Q(1, 10**32 + 1)])
def test_rate_is_the_root_of_the_kick_times_the_drift(square: Q) -> None:
    rate = leading_frequency(oscillator_matrix(splitting(square, Q(1))))
    assert rate * rate == square


def test_a_rate_too_long_to_read_is_a_number_and_has_no_series() -> None:
    found = phase(METHODS["mclachlan_atela5"])
    coefficient = found["dispersion"]["coefficient"]
    assert (found["dispersion"]["power"], coefficient["exact"], found["dispersion_series"]) == (1, None, None)
    assert found["modified_hamiltonian"]["factor_series"] is None
    rate = leading_frequency(oscillator_matrix(METHODS["mclachlan_atela5"]))
    assert isinstance(rate, Algebraic)
    low, high = (rate - 1).enclosure(200)
    assert low < high < 0
    assert abs(Q(coefficient["decimal"]) / low - 1) < Q(1, 10**28)
    low, high = map(Q, coefficient["interval"])
    assert low <= rate - 1 <= high
    consistent = phase(METHODS["pefrl"])
    assert consistent["dispersion_series"][3] == consistent["dispersion"]["coefficient"]["exact"]


@pytest.mark.parametrize(("kick", "drift"), [(Q(-1), Q(1)), (Q(0), Q(1)), (Q(1), Q(0))])
def test_a_step_that_is_no_rotation_has_no_phase(kick: Q, drift: Q) -> None:
    method = splitting(kick, drift)
    found = phase(method)
    assert found == {"dispersion": None, "dispersion_series": None, "modified_hamiltonian": None}
    with pytest.raises(NoRotationError, match="not a positive rational"):
        angle_error_series(oscillator_matrix(method), 4)
