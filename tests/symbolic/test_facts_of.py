"""The records of facts: limits as the schema has them, orders kept apart, points of the boundary, null where due."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as Q
from math import isqrt
from typing import Any

import pytest
from flint import acb, arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st

from driftproof import strategies
from driftproof.methods.catalogue import METHODS
from driftproof.methods.number_field import Algebraic
from driftproof.methods.schemes import Collocation, RungeKutta, Splitting
from driftproof.symbolic.facts import FACTS, facts_of, general_order, order_within
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from driftproof.symbolic.linear.oscillator import one_step_matrix, stability_function_of
from driftproof.symbolic.linear.phase import NoRotationError, angle_series, turning_rate
from driftproof.symbolic.linear.region import rounded_boundary
from tests.symbolic.linear.linear_examples import limit_text, value

# --- the schema


@pytest.mark.parametrize(
    ("key", "name", "wanted"),
    [
        ("forward_euler", "imaginary_limit", "0"),
        ("backward_euler", "real_limit", "oo"),
        ("gauss2", "imaginary_limit", "oo"),
        ("rk4", "ssp_coefficient", "0"),
        ("velocity_verlet", "real_limit", None),
    ],
)
def test_a_limit_that_is_none_or_always_is_a_bare_string(key: str, name: str, wanted: Any) -> None:
    assert facts_of(METHODS[key], (name,))[name] == wanted


def test_a_limit_that_is_a_number_is_a_record() -> None:
    found = facts_of(METHODS["rk4"], ("imaginary_limit", "real_limit"))
    assert found["imaginary_limit"] == {
        "exact": "2*sqrt(2)",
        "minpoly": "x**2 - 8",
        "interval": ["2", "3"],
        "decimal": "2.828427124746190097603377448419",
    }
    assert found["real_limit"]["exact"] is None
    assert found["real_limit"]["minpoly"] == "x**3 - 4*x**2 + 12*x - 24"


@pytest.mark.parametrize("key", [key for key, method in METHODS.items() if method.field])
def test_number_field_is_written_out(key: str) -> None:
    field = METHODS[key].field
    record = facts_of(METHODS[key], ("field",))["field"]
    assert field is not None
    assert record["generator"] == field.name
    assert "x**" in record["minpoly"]
    decimal, (low, high) = Q(record["decimal"]), map(Q, record["interval"])
    assert low < decimal < high
    unit = Q(1, 10**29)
    assert field.generator - unit < decimal < field.generator + unit
    assert abs(sum(c * decimal**k for k, c in enumerate(field.minimal))) < Q(1, 10**25)
    assert facts_of(METHODS["rk4"], ("field",)) == {"field": None}


# --- three answers about the order


def test_exact_order_failing_residual_and_order_to_a_tolerance_are_three_answers() -> None:
    names = ("order", "order_fails")
    tsitouras = facts_of(METHODS["tsitouras54"], names)
    assert tsitouras == {"order": 0, "order_fails": {"tree": "τ", "residual": "-17/100000000000000000"}}
    tolerances = [(Q(1, 10**12), 5), (Q(17, 10**17), 1), (Q(16, 10**17), 0), (Q(0), 0)]
    assert [order_within(METHODS["tsitouras54"], t)["order"] for t, _ in tolerances] == [p for _, p in tolerances]
    assert order_within(METHODS["tsitouras54"], Q(1, 10**12)) == {
        "tolerance": "1/1000000000000",
        "order": 5,
        "order_second_order_problems": None,
        "embedded_order": 4,
    }


@pytest.mark.parametrize("power", [8, 13])
def test_a_weight_off_in_a_far_digit_costs_the_order_and_not_the_order_to_a_tolerance(power: int) -> None:
    rk4 = METHODS["rk4"]
    assert isinstance(rk4, RungeKutta)
    off = replace(rk4, b=(rk4.b[0] + Q(1, 10**power), *rk4.b[1:]))
    assert facts_of(off, ("order",)) == {"order": 0}
    assert order_within(off, Q(1, 10**12))["order"] == (4 if power == 13 else 0)


@pytest.mark.parametrize(
    ("key", "order", "second"),
    [
        ("pefrl", 4, 4),
        ("blanes_moan_rkn6a", 4, 6),
        ("suzuki_umeno8", 8, 8),
        ("gauss9", 18, None),
        ("nystrom4", 4, None),
    ],
)
def test_order_to_a_tolerance_of_every_kind_of_method(key: str, order: int, second: int | None) -> None:
    found = order_within(METHODS[key], Q(1, 10**12))
    assert (found["order"], found["order_second_order_problems"], found["embedded_order"]) == (order, second, None)
    assert general_order(METHODS[key]).order <= order
    assert order_within(METHODS[key], Q(0))["order"] == general_order(METHODS[key]).order
    with pytest.raises(ValueError, match="tolerance -1 is below zero"):
        order_within(METHODS[key], Q(-1))


# --- monotonicity of collocation


def collocation(*nodes: Q) -> Collocation:
    polynomial = [Q(1)]
    for c in nodes:
        polynomial = [low - c * high for low, high in zip([Q(0), *polynomial], [*polynomial, Q(0)], strict=True)]
    return Collocation("given", "Given", 0, "x", tuple(polynomial))


def by_lagrange(*nodes: Q) -> RungeKutta:
    """The same method by its tableau: integrals of the Lagrange polynomials."""

    def integral(j: int, end: Q) -> Q:
        polynomial = [Q(1)]
        for i, c in enumerate(nodes):
            if i != j:
                rows = zip([Q(0), *polynomial], [*polynomial, Q(0)], strict=True)
                polynomial = [(low - c * high) / (nodes[j] - c) for low, high in rows]
        return sum((x * end ** (k + 1) / (k + 1) for k, x in enumerate(polynomial)), Q(0))

    stages = range(len(nodes))
    rows = tuple(tuple(integral(j, c) for j in stages) for c in nodes)
    return RungeKutta("given", "Given", 0, "x", rows, tuple(integral(j, Q(1)) for j in stages), nodes)


@given(st.lists(st.fractions(-1, 2, max_denominator=4), min_size=1, max_size=4, unique=True))
def test_ssp_coefficient_of_collocation_is_that_of_its_tableau(nodes: list[Q]) -> None:
    assert ssp_coefficient(collocation(*nodes)) == ssp_coefficient(by_lagrange(*nodes))


def test_collocation_methods_that_are_monotone() -> None:
    wanted = {(Q(1),): "oo", (Q(1, 2),): "2", (Q(0), Q(1)): "2", (Q(0), Q(2, 3)): "3/2", (Q(1, 3), Q(1)): "0"}
    assert {nodes: limit_text(ssp_coefficient(collocation(*nodes))) for nodes in wanted} == wanted
    every = [method for method in METHODS.values() if isinstance(method, Collocation)]
    assert {limit_text(ssp_coefficient(method)) for method in every} <= {"0", "3/2"}
    assert facts_of(METHODS["gauss4"], ("ssp_coefficient",)) == {"ssp_coefficient": "0"}


# --- phase


def splitting(kick: Q, drift: Q) -> Splitting:
    return Splitting("given", "Given", 0, "x", (("kick", kick / 2), ("drift", drift), ("kick", kick / 2)))


def phase(method: Splitting) -> dict[str, Any]:
    return facts_of(method, ("dispersion", "dispersion_series", "modified_hamiltonian"))


def test_an_inconsistent_splitting_turns_at_its_own_rate() -> None:
    short = phase(splitting(Q(10, 9), Q(1)))
    assert short["dispersion"] == {"power": 1, "coefficient": "-1 + 1/3*sqrt(10)"}
    assert short["dispersion_series"][1] == "-1 + 1/3*sqrt(10)"
    rational = phase(splitting(Q(4, 9), Q(1)))
    assert rational["dispersion"] == {"power": 1, "coefficient": "-1/3"}


def test_a_rate_too_long_to_read_is_a_number_and_has_no_series() -> None:
    found = phase(METHODS["mclachlan_atela5"])
    coefficient = found["dispersion"]["coefficient"]
    assert (found["dispersion"]["power"], coefficient["exact"], found["dispersion_series"]) == (1, None, None)
    assert found["modified_hamiltonian"]["factor_series"] is None
    rate = turning_rate(one_step_matrix(METHODS["mclachlan_atela5"]))
    assert isinstance(rate, Algebraic)
    low, high = (rate - 1).enclosure(200)
    assert low < high < 0
    assert abs(Q(coefficient["decimal"]) / low - 1) < Q(1, 10**28)
    low, high = map(Q, coefficient["interval"])
    assert low <= rate - 1 <= high
    consistent = phase(METHODS["pefrl"])
    assert consistent["dispersion_series"][3] == consistent["dispersion"]["coefficient"]


@pytest.mark.parametrize(("kick", "drift"), [(Q(-1), Q(1)), (Q(0), Q(1)), (Q(1), Q(0))])
def test_a_step_that_is_no_rotation_has_no_phase(kick: Q, drift: Q) -> None:
    method = splitting(kick, drift)
    found = phase(method)
    assert found == {"dispersion": None, "dispersion_series": None, "modified_hamiltonian": None}
    assert json.dumps(facts_of(method))
    with pytest.raises(NoRotationError, match="no positive rational"):
        angle_series(one_step_matrix(method), 4)


# --- the boundary of the stability region


def on_boundary(r: Any, point: tuple[str, str, str], places: int) -> bool:
    """Does the square of half-width 10**-places around the point hold |R| = 1 with this real part?"""
    with ctx.workprec(400):
        unit = arb(0, arb(10) ** -places)
        cosine, re, im = (arb(fmpq(*Q(part).as_integer_ratio())) for part in point)
        at_point = value(r, acb(re + unit, im + unit))
        return bool(abs(at_point).contains(1)) and bool(at_point.real.overlaps(cosine))


@pytest.mark.parametrize("key", ["rk4", "backward_euler", "gauss2", "sdirk2", "radau_iia4", "ssprk33"])
def test_rounded_points_lie_on_the_boundary_and_moved_ones_do_not(key: str) -> None:
    r = stability_function_of(METHODS[key])
    points = rounded_boundary(r, 3)
    assert len(points) >= 4
    assert all(on_boundary(r, point, 15) for point in points)
    moved = [(c, str(Q(re) + Q(1, 10**9)), im) for c, re, im in points]
    assert not all(on_boundary(r, point, 15) for point in moved)
    assert all(Q(im) >= 0 for _, _, im in points)


def test_boundary_is_given_only_when_it_is_named() -> None:
    assert "region_boundary" not in FACTS
    record = facts_of(METHODS["rk4"], ("region_boundary",))["region_boundary"]
    assert record["radius"] == "1e-15"
    assert {"cosine": "1", "re": "-2.785293563405282", "im": "0.000000000000000"} in record["points"]
    assert facts_of(METHODS["velocity_verlet"], ("region_boundary",)) == {"region_boundary": None}


@given(strategies.runge_kutta_methods(max_stages=3))
def test_limits_of_drawn_methods_are_strings_or_records(method: RungeKutta) -> None:
    found = facts_of(method, ("real_limit", "imaginary_limit", "ssp_coefficient"))
    assert all(x in ("0", "oo") or set(x) == {"exact", "minpoly", "interval", "decimal"} for x in found.values())


def test_root_of_ten_is_drawn_out_of_ninety() -> None:
    """σ² = 10/9: the reference is the integer square root."""
    rate = turning_rate(one_step_matrix(splitting(Q(10, 9), Q(1))))
    low, high = rate.enclosure(200) if isinstance(rate, Algebraic) else (rate, rate)
    root = Q(isqrt(10 * 10**100 // 9), 10**50)
    assert low - Q(1, 10**49) < root < high + Q(1, 10**49)
