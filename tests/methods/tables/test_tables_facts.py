"""What the literature says of single tables beyond their order: nodes, stability functions, digits, and misprints."""

from __future__ import annotations

import dataclasses
from fractions import Fraction as Q
from typing import Any, TypeAlias

import pytest

from driftproof.methods.schemes import RungeKutta
from driftproof.methods.tables.collocation import gauss_nodes, lobatto_nodes, radau_left_nodes, radau_right_nodes
from driftproof.methods.tables.diagonally_implicit import ALEXANDER_GAMMA, CROUZEIX_GAMMA
from driftproof.methods.tables.notation import row
from driftproof.methods.tables.splittings import palindrome, verlet_composition
from driftproof.methods.tables.stabilised import chebyshev_first_order, ssprk_second_order
from driftproof.symbolic.facts import general_order
from driftproof.symbolic.trees.partitioned_trees import separable_conditions
from tests.methods.tables.entries import entry, product
from tests.symbolic.trees.residuals import residuals

Polynomial: TypeAlias = tuple[Q, ...]

NODES = {
    **{"implicit_midpoint": gauss_nodes(1), "backward_euler": radau_right_nodes(1), "trapezoid": lobatto_nodes(2)},
    **{f"gauss{s}": gauss_nodes(s) for s in (2, 3)},
    **{f"radau_ia{s}": radau_left_nodes(s) for s in (2, 3)},
    **{f"radau_iia{s}": radau_right_nodes(s) for s in (2, 3)},
    **{f"lobatto_iiia{s}": lobatto_nodes(s) for s in (3, 4)},
    **{f"lobatto_iii{letter}{s}": lobatto_nodes(s) for letter in "bc" for s in (2, 3, 4)},
}


@pytest.mark.parametrize("key", NODES)
def test_nodes_of_tableau_are_the_roots_of_its_node_polynomial(key: str) -> None:
    nodes = entry(key).c
    assert all(at(NODES[key], c) == 0 for c in nodes)
    assert len(set(nodes)) == len(NODES[key]) - 1
    assert at(NODES[key], nodes[0] + Q(1, 10**40)) != 0


def at(polynomial: Polynomial, x: Any) -> Any:
    """The value at any exact number, by Horner's rule."""
    value = x - x
    for coefficient in reversed(polynomial):
        value = value * x + coefficient
    return value


def stability_series(method: RungeKutta, order: int) -> list[Any]:
    """The coefficients 1, bᵀ1, bᵀA1, ... of R(z) in powers of z, up to the order, b the propagated row."""
    series, stages = [Q(1)], [Q(1)] * method.stages
    for _ in range(order):
        series.append(dot(method.b, stages))
        stages = [dot(given, stages) for given in method.a]
    return series


def dot(a: Any, b: Any) -> Any:
    return sum((x * y for x, y in zip(a, b, strict=True) if x and y), Q(0))


def symplectic_defects(method: Any, other: Any) -> list[Any]:
    """bᵢ âᵢⱼ + bⱼ aⱼᵢ - bᵢ bⱼ: all 0 where the pair of methods, q by one and v by the other, is symplectic."""
    s = range(method.stages)
    return [
        method.b[i] * other.a[i][j] + method.b[j] * method.a[j][i] - method.b[i] * method.b[j] for i in s for j in s
    ]


@pytest.mark.parametrize(
    ("first", "second"),
    [("trapezoid", "lobatto_iiib2"), ("lobatto_iiia3", "lobatto_iiib3"), ("lobatto_iiia4", "lobatto_iiib4")],
)
def test_lobatto_iiia_and_iiib_are_a_symplectic_pair(first: str, second: str) -> None:
    assert not any(symplectic_defects(entry(first), entry(second)))
    assert any(symplectic_defects(entry(second), entry(second)))


def shifted_chebyshev(stages: int) -> Polynomial:
    """T_s(1 + z/s²), by the recurrence of the polynomials."""
    before, now, x = (Q(1),), (Q(1), Q(1, stages**2)), (Q(1), Q(1, stages**2))
    for _ in range(stages - 1):
        twice = [2 * c for c in product(x, now)]
        before, now = now, tuple(c - (before[k] if k < len(before) else 0) for k, c in enumerate(twice))
    return now


@pytest.mark.parametrize("stages", [1, 2, 3, 10])
def test_stability_function_of_chebyshev_method_is_the_shifted_polynomial(stages: int) -> None:
    method = chebyshev_first_order(stages)
    assert tuple(stability_series(method, stages)) == shifted_chebyshev(stages)
    assert stability_series(method, stages + 2)[stages + 1 :] == [0, 0]
    assert at(shifted_chebyshev(stages), Q(-2 * stages**2)) == (-1) ** stages  # where |R| reaches 1
    assert abs(at(shifted_chebyshev(stages), Q(-2 * stages**2) - Q(1, 10**12))) > 1
    assert method.inconsistencies() == {}


@pytest.mark.parametrize("stages", [2, 3, 40])
def test_stability_function_of_ssprk2_leaves_one_where_published(stages: int) -> None:
    """R(z) = 1/s + (s-1)/s (1 + z/(s-1))^s is 1 at -2(s-1) for even s, and exceeds 1 beyond."""
    series = stability_series(ssprk_second_order(stages), stages)
    assert series == [x + (Q(1, stages) if k == 0 else 0) for k, x in enumerate(power(stages))]
    for x in (Q(-2 * (stages - 1)), Q(-2 * (stages - 1)) - Q(1, 10**12)):
        inside = (1 + x / (stages - 1)) ** stages
        assert at(tuple(series), x) == Q(1, stages) + Q(stages - 1, stages) * inside
    if stages % 2 == 0:
        assert at(tuple(series), Q(-2 * (stages - 1))) == 1
        assert at(tuple(series), Q(-2 * (stages - 1)) - Q(1, 10**12)) > 1


def power(stages: int) -> Polynomial:
    """(s-1)/s (1 + z/(s-1))^s."""
    result: Polynomial = (Q(stages - 1, stages),)
    for _ in range(stages):
        result = product(result, (Q(1), Q(1, stages - 1)))
    return result


def test_families_refuse_too_few_stages() -> None:
    with pytest.raises(ValueError, match=r"ssprk_second_order\(1\): two stages"):
        ssprk_second_order(1)
    with pytest.raises(ValueError, match=r"chebyshev_first_order\(0\): one stage"):
        chebyshev_first_order(0)
    assert [ssprk_second_order(s).key for s in (9, 10)] == ["ssprk92", "ssprk10_2"]


@pytest.mark.parametrize(
    ("value", "printed"),
    [
        (ALEXANDER_GAMMA, "0.4358665215"), (CROUZEIX_GAMMA, "1.0685790213"), (entry("sdirk2").c[0], "0.2928932188"),
        (entry("forest_ruth").parts[0][1], "0.6756035959798288170"),
        (entry("forest_ruth").parts[1][1], "1.3512071919596576340"),
        (entry("suzuki4").parts[1][1], "0.41449077179437573714"),
        (entry("mclachlan2").parts[0][1], "0.19318332750378357396"),
        (entry("mclachlan4_four_forces").parts[0][1], "0.16913927992207204518"),
        (entry("mclachlan4_four_forces").parts[2][1], "-0.29918620390405079951"),
        (entry("mclachlan4").parts[0][1], "0.089269454226475244887"),
        (entry("mclachlan4").parts[2][1], "-0.097336042636895508015"),
        (entry("mclachlan4").parts[4][1], "0.50806658841042026313"),
        (entry("mclachlan_atela2").parts[1][1], "0.7071067811865475244"),
    ],
)  # fmt: skip
def test_algebraic_coefficient_has_the_digits_that_are_in_print(value: Any, printed: str) -> None:
    half_a_unit = Q(1, 2 * 10 ** len(printed.split(".")[1]))
    assert -half_a_unit < value - Q(printed) < half_a_unit
    assert not value - Q(printed) < -half_a_unit


def test_embedded_row_as_tsitouras_prints_it_is_neither_a_row_nor_a_difference() -> None:
    """Six entries are b - b̂, whose sum would have to be -1/66 + 1/66; the seventh is printed as +1/66."""
    method = entry("tsitouras54")
    difference = [x - y for x, y in zip(method.b, method.b_embedded, strict=True)]
    assert difference[-1] == Q(-1, 66)
    assert abs(sum(difference)) < Q(1, 10**14)
    printed = [*difference[:-1], Q(1, 66)]
    assert abs(sum(printed) - Q(1, 33)) < Q(1, 10**14)
    for wrong in (printed, [x - y for x, y in zip(method.b, printed, strict=True)]):
        changed = dataclasses.replace(method, b_embedded=tuple(wrong))
        assert abs(changed.inconsistencies()["sum(b_embedded) - 1"]) > Q(1, 100)


def test_merson_and_its_name() -> None:
    """The second row has order 5 on linear problems with constant coefficients, order 3 on others."""
    pair = entry("merson45")
    second = dataclasses.replace(pair, b=pair.b_embedded)
    assert stability_series(second, 5) == [Q(1), Q(1), Q(1, 2), Q(1, 6), Q(1, 24), Q(1, 120)]
    assert stability_series(pair, 5)[5] != Q(1, 120)
    assert general_order(second).order == 3


def test_estimate_of_fehlberg78_is_blind_to_time() -> None:
    """Σ (bᵢ - b̂ᵢ) g(cᵢ) = 0 for every g, because nodes with opposite differences coincide."""
    pair = entry("fehlberg78")
    by_node: dict[Any, Any] = {}
    for c, x, y in zip(pair.c, pair.b, pair.b_embedded, strict=True):
        by_node[c] = by_node.get(c, 0) + x - y
    assert not any(by_node.values())
    assert any(x != y for x, y in zip(pair.b, pair.b_embedded, strict=True))


# Yoshida's weights to 25 digits, outermost first: Newton's method on the order conditions, from the ones in print.
RECOMPUTED = {
    "yoshida6": "0.7845136104775572638194976 0.2355732133593581336847932 -1.177679984178871006946416",
    "yoshida6_b": "1.439848167976783090930499 0.004260681870792016196083714 -2.132285222001451520705993",
    "yoshida6_c": "1.447782562399297932897897 -2.144035316305389310601302 0.001528862284249270252267239",
    "yoshida8": """0.9148442462297915667487935 0.253693336566211354146146 -1.444852236860605157694731
        -0.1582406353680501752040668 1.938139137622525986579186 -1.960610232975310807607633
        0.1027998493917964406981151""",
    "yoshida8_a": """1.042426208699704264348953 1.820206309706980069331733 0.1577399281237083213428258
        2.440027326166344063816896 -0.007169894197095332099806129 -2.446991823704245889294691
        -1.61582374150065378478794""",
}
# The largest error of a weight in print. 15 digits are printed: in Table 1, 14 of them are right, in Table 2, 12.
PRINTED_WITHIN = {
    "yoshida6": ("2.7e-15", "2.8e-15"), "yoshida6_b": ("1.1e-14", "1.2e-14"), "yoshida6_c": ("2.0e-15", "2.1e-15"),
    "yoshida8": ("2.3e-13", "2.4e-13"), "yoshida8_a": ("1.0e-12", "1.1e-12"),
}  # fmt: skip


@pytest.mark.parametrize("key", RECOMPUTED)
def test_last_digits_of_yoshidas_tables_are_wrong(key: str) -> None:
    better = row(RECOMPUTED[key])
    printed = [c for kind, c in entry(key).parts if kind == "drift"][: len(better)]
    low, high = map(Q, PRINTED_WITHIN[key])
    assert low <= max(abs(x - y) for x, y in zip(better, printed, strict=True)) <= high
    weights = palindrome((*better, 1 - 2 * sum(better, Q(0))))
    recomputed = dataclasses.replace(entry(key), parts=verlet_composition("kick", weights))
    conditions = [separable_conditions(method) for method in (recomputed, entry(key))]
    worst = [max(abs(x) for p in range(3, 6) for _, x in residuals(each, p)) for each in conditions]
    assert worst[0] < Q("1e-21")
    assert worst[1] > Q("1e-16")


def test_step_doubling_is_a_step_and_two_halves_of_rk4_extrapolated():
    def rk4(y: Q, t: Q, h: Q) -> Q:
        k1 = rate(t, y)
        k2 = rate(t + h / 2, y + h / 2 * k1)
        k3 = rate(t + h / 2, y + h / 2 * k2)
        return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(t + h, y + h * k3))

    def rate(t: Q, y: Q) -> Q:
        return t * t - y * y

    method, y, t, h = entry("rk4_doubling54"), Q(1, 3), Q(-1, 5), Q(1, 2)
    slopes: list[Q] = []
    for a, c in zip(method.a, method.c, strict=True):
        slopes.append(rate(t + c * h, y + h * sum(x * k for x, k in zip(a, slopes, strict=False))))
    whole, halves = rk4(y, t, h), rk4(rk4(y, t, h / 2), t + h / 2, h / 2)
    ends = (y + h * sum(x * k for x, k in zip(row, slopes, strict=True)) for row in (method.b, method.b_embedded))
    assert [*ends] == [halves + (halves - whole) / 15, halves] != [halves, whole]
