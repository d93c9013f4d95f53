"""Wrong definitions: every number of every method is changed, and the table says which named check notices."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest

from methods.schemes import Method, RungeKutta, Splitting
from symbolic.one_step import H, matrix, one_step_matrix, rational
from symbolic.trees.order import order as tree_order
from tests.nine import NINE

# R(z) of the Runge-Kutta methods and the product of shears of the splittings as they stand in the books: the powers of
# h in M_qq, M_qv, M_vq, M_vv, ascending. Typed here, so that a changed definition is held against something else.
PRINTED: dict[str, list[list[Q | int]]] = {
    "forward_euler": [[1], [0, 1], [0, -1], [1]],
    "symplectic_euler": [[1, 0, -1], [0, 1], [0, -1], [1]],
    "symplectic_euler_position_first": [[1], [0, 1], [0, -1], [1, 0, -1]],
    "velocity_verlet": [[1, 0, Q(-1, 2)], [0, 1], [0, -1, 0, Q(1, 4)], [1, 0, Q(-1, 2)]],
    "position_verlet": [[1, 0, Q(-1, 2)], [0, 1, 0, Q(-1, 4)], [0, -1], [1, 0, Q(-1, 2)]],
}
PRINTED["heun2"] = PRINTED["midpoint2"] = [[1, 0, Q(-1, 2)], [0, 1], [0, -1], [1, 0, Q(-1, 2)]]
PRINTED["rk4"] = PRINTED["rk38"] = [
    [1, 0, Q(-1, 2), 0, Q(1, 24)],
    [0, 1, 0, Q(-1, 6)],
    [0, -1, 0, Q(1, 6)],
    [1, 0, Q(-1, 2), 0, Q(1, 24)],
]


def printed_matrix(method: Method) -> bool:
    entries = [sum(rational(Q(c)) * H**k for k, c in enumerate(entry)) for entry in PRINTED[method.key]]
    return bool(one_step_matrix(method) == matrix([entries[:2], entries[2:]]))


def sums(method: Method) -> bool:
    """Σb = 1 and c = row sums; or kicks and drifts each adding to 1."""
    return method.inconsistencies() == {}


def explicit(method: Method) -> bool:
    return isinstance(method, Splitting) or method.explicit


def order(method: Method) -> bool:
    if isinstance(method, RungeKutta):
        return tree_order(method).order == method.claimed_order
    drifted = crossed = Q(0)
    for kind, c in method.parts:
        drifted, crossed = (drifted + c, crossed) if kind == "drift" else (drifted, crossed + c * drifted)
    return sums(method) and (crossed == Q(1, 2)) == (method.claimed_order == 2)


DEFINITION_CHECKS: dict[str, Callable[[Method], bool]] = {
    "explicit": explicit,
    "sums": sums,
    "order": order,
    "printed matrix": printed_matrix,
}


def definition_caught_by(method: Method) -> set[str]:
    """The checks that fail. A step of an implicit method cannot be run, so its matrix is not asked for."""
    asked = DEFINITION_CHECKS if explicit(method) else {"explicit": explicit, "sums": sums, "order": order}
    return {name for name, holds in asked.items() if not holds(method)}


def coefficients(method: Method) -> dict[str, Q]:
    """Every number of the definition by place, zeros included."""
    if isinstance(method, Splitting):
        return {f"parts[{i}]": c for i, (_, c) in enumerate(method.parts)}
    s = range(method.stages)
    places = {f"a[{i}][{j}]": method.a[i][j] for i in s for j in s}
    return places | {f"b[{i}]": method.b[i] for i in s} | {f"c[{i}]": method.c[i] for i in s}


def with_coefficients(method: Method, changed: dict[str, Q]) -> Method:
    numbers = coefficients(method) | changed
    if isinstance(method, Splitting):
        return replace(method, parts=tuple((kind, numbers[f"parts[{i}]"]) for i, (kind, _) in enumerate(method.parts)))
    s = range(method.stages)
    return replace(
        method,
        a=tuple(tuple(numbers[f"a[{i}][{j}]"] for j in s) for i in s),
        b=tuple(numbers[f"b[{i}]"] for i in s),
        c=tuple(numbers[f"c[{i}]"] for i in s),
    )


def always_caught_by(place: str) -> set[str]:
    """By the kind of coefficient, what notices whatever is done to it. Other checks may notice too."""
    i, j = (int(x) for x in place[2:-1].split("][")) if place[0] == "a" else (1, 0)
    return {"sums"} | ({"explicit"} if j >= i else set())


CHANGES: dict[str, Callable[[Q], Q]] = {
    "plus 1/24": lambda c: c + Q(1, 24),
    "plus 1e-30": lambda c: c + Q(1, 10**30),
    "minus 1e-30": lambda c: c - Q(1, 10**30),
    "sign flipped": lambda c: -c,
    "dropped": lambda c: Q(0),
}


def perturbed() -> Iterator[Any]:
    for key, method in NINE.items():
        for place, c in coefficients(method).items():
            for change, to in CHANGES.items():
                if to(c) != c:
                    yield pytest.param(method, place, to(c), id=f"{key} {place} {change}")


@pytest.mark.parametrize(("method", "place", "value"), list(perturbed()))
def test_changed_coefficient_is_caught_by_the_sums(method: Method, place: str, value: Q) -> None:
    caught = definition_caught_by(with_coefficients(method, {place: value}))
    assert always_caught_by(place) <= caught
    if place[0] in "bp":  # a weight, a kick, a drift: the order and the printed matrix notice on their own
        assert caught == {"sums", "order", "printed matrix"}


@pytest.mark.parametrize("key", NINE)
def test_catalogue_as_it_is_passes_every_check(key: str) -> None:
    assert definition_caught_by(NINE[key]) == set()


def compensated() -> Iterator[Any]:
    """Two numbers changed so that every sum is kept: the mistake that the sums cannot see."""
    tiny = Q(1, 10**30)
    for key, method in NINE.items():
        if isinstance(method, Splitting):
            kinds = [kind for kind, _ in method.parts]
            pairs = [(i, j) for i in range(len(kinds)) for j in range(i) if kinds[i] == kinds[j]]
            names = [(f"parts[{i}]", f"parts[{j}]") for i, j in pairs]
        else:
            s = range(method.stages)
            names = [(f"b[{i}]", f"b[{j}]") for i in s for j in range(i)]
            names += [(f"a[{i}][0]", f"a[{i}][{j}]") for i in s for j in range(1, i)]
            names += [(f"a[{i}][0]", f"c[{i}]") for i in s if i > 0]
        for first, second in names:
            numbers = coefficients(method)
            back = tiny if second[0] == "c" else -tiny
            changed = {first: numbers[first] + tiny, second: numbers[second] + back}
            yield pytest.param(with_coefficients(method, changed), id=f"{key} {first} {second}")


@pytest.mark.parametrize("method", list(compensated()))
def test_compensated_change_is_caught_by_the_order_or_the_printed_matrix(method: Method) -> None:
    caught = definition_caught_by(method)
    assert "sums" not in caught
    assert caught >= {"order"} if method.claimed_order > 1 else caught >= {"printed matrix"}


def test_compensated_changes_are_planted_in_every_method_that_has_room() -> None:
    planted = {param.values[0].key for param in compensated()}
    assert planted == {"velocity_verlet", "position_verlet", "heun2", "midpoint2", "rk4", "rk38"}


@pytest.mark.parametrize("key", [key for key, method in NINE.items() if isinstance(method, Splitting)])
def test_kicks_and_drifts_exchanged_are_caught_by_the_printed_matrix(key: str) -> None:
    method = NINE[key]
    other = {"kick": "drift", "drift": "kick"}
    swapped = replace(method, parts=tuple((other[kind], c) for kind, c in method.parts))
    assert "printed matrix" in definition_caught_by(swapped)


@pytest.mark.parametrize("key", ["symplectic_euler", "symplectic_euler_position_first"])
def test_update_order_swapped_is_caught_by_the_printed_matrix_alone(key: str) -> None:
    method = NINE[key]
    assert definition_caught_by(replace(method, parts=method.parts[::-1])) == {"printed matrix"}


@pytest.mark.parametrize("key", NINE)
def test_wrong_claimed_order_is_caught_by_the_order(key: str) -> None:
    method = NINE[key]
    # A consistent splitting has order 1 at least, so a claim of 0 is not asked about.
    for wrong in {max(method.claimed_order - 1, 1), method.claimed_order + 1} - {method.claimed_order}:
        assert "order" in definition_caught_by(replace(method, claimed_order=wrong))
