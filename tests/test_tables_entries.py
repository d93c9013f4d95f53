"""Every entry of the tables: exact, in one field, cited, consistent or known not to be, and not there twice."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from fractions import Fraction as Q
from pathlib import Path
from typing import Any

import pytest

from methods.catalogue import METHODS
from methods.number_field import Algebraic, square_root
from methods.schemes import Collocation, Method, MethodError, Nystrom, RungeKutta, Splitting
from methods.stepping import stepper
from methods.tables.notation import numbers, padded, places, row, square
from methods.tables.splittings import alternating, palindrome, verlet_composition
from tests.tables_orders import ALL, FILES, as_nystrom, by_key, entry, of_type

ROOT = Path(__file__).parents[1]


def coefficients(method: Method) -> list[Any]:
    """Every exact number of the definition."""
    if isinstance(method, Splitting):
        return [c for _, c in method.parts]
    if isinstance(method, Collocation):
        return list(method.node_polynomial)
    rows = [x for given in method.a for x in given]
    if isinstance(method, Nystrom):
        return [*rows, *method.c, *method.b_position, *method.b_velocity]
    return [*rows, *method.b, *method.c, *(method.b_embedded or ())]


def test_tables_hold_sixty_methods_and_more_with_different_keys() -> None:
    assert len(ALL) == len({method.key for method in ALL}) >= 60
    known = {method.key: method for method in ALL}
    assert all(METHODS[key] == known[key] for key in known.keys() & METHODS.keys())


@pytest.mark.parametrize("method", ALL, ids=by_key)
def test_entry_is_exact_and_in_one_field(method: Method) -> None:
    values = coefficients(method)
    assert all(type(x) is Q or (type(x) is Algebraic and not x.is_rational) for x in values)
    assert {x.field for x in values if isinstance(x, Algebraic)} == ({method.field} if method.field else set())


@pytest.mark.parametrize("method", ALL, ids=by_key)
def test_entry_says_where_it_comes_from(method: Method) -> None:
    source = re.fullmatch(r"([a-z-]+-\d{4}), \S.*", method.source)
    assert source
    assert f"{{{source[1]}," in (ROOT / "references.bib").read_text(encoding="utf-8")
    assert re.fullmatch(r"[a-z][a-z0-9_]*", method.key)
    assert method.title == method.title.strip() != ""
    assert method.claimed_order >= 1


def definition(method: Method) -> Any:
    if isinstance(method, Splitting):
        return method.parts
    if isinstance(method, Collocation):
        return method.node_polynomial
    rows = method.b_embedded if isinstance(method, RungeKutta) else method.b_position
    return method.a, rows, method.b if isinstance(method, RungeKutta) else method.b_velocity


def test_no_two_entries_are_the_same_method() -> None:
    assert len({definition(method) for method in ALL}) == len(ALL) - 1
    first, second = METHODS["heun2"], entry("ssprk22")  # the one method that is here under its second name
    assert definition(first) == definition(second)


# The printed nodes of Lobatto IIIB are not the row sums of its A.
KNOWN_INCONSISTENT = {"lobatto_iiib2": {"c[0] - sum(a[0])": Q(-1, 2), "c[1] - sum(a[1])": Q(1, 2)}}
# Bounds, decimal places, of the residuals of rounded tables: more than that is no rounding.
ROUNDED = {
    "prince_dormand87": 16,
    "tsitouras54": 14,
    "dop853": 27,
    "dop853_third": 27,
    "kahan_li6": 25,
    "suzuki_umeno8": 25,
    "mclachlan_atela3": 18,
    "mclachlan_atela5": 18,
}


@pytest.mark.parametrize("method", ALL, ids=by_key)
def test_entry_is_consistent_or_known_not_to_be(method: Method) -> None:
    residuals = method.inconsistencies()
    if method.key in ROUNDED:
        assert method.decimal
        assert residuals
        assert all(0 < abs(x) < Q(1, 10 ** ROUNDED[method.key]) for x in residuals.values())
    else:
        assert residuals == KNOWN_INCONSISTENT.get(method.key, {})


def test_weights_of_prince_and_dormand_as_printed_add_to_less_than_one() -> None:
    short = -entry("prince_dormand87").inconsistencies()["sum(b) - 1"]
    assert Q("3.6853146e-18") < short < Q("3.6853147e-18")


def perturbed(method: Method, place: int, by: Q) -> Method:
    """The method with one coefficient changed, places counted as in `coefficients`."""
    values = coefficients(method)
    values[place] += by
    if isinstance(method, Splitting):
        kinds = [kind for kind, _ in method.parts]
        return dataclasses.replace(method, parts=tuple(zip(kinds, values, strict=True)))
    if isinstance(method, Collocation):
        return dataclasses.replace(method, node_polynomial=tuple(values))
    s = method.stages
    rows, rest = tuple(tuple(values[i * s : (i + 1) * s]) for i in range(s)), values[s * s :]
    lists = [tuple(rest[i : i + s]) for i in range(0, len(rest), s)]
    names = ("c", "b_position", "b_velocity") if isinstance(method, Nystrom) else ("b", "c", "b_embedded")
    return dataclasses.replace(method, a=rows, **dict(zip(names, lists, strict=False)))


@pytest.mark.parametrize("method", [m for m in ALL if not isinstance(m, Collocation)], ids=by_key)
def test_inconsistencies_notice_each_coefficient_that_is_changed(method: Method) -> None:
    tiny = Q(1, 10**40)
    # Every entry of A and c is in a row sum and every weight in a sum, so each change moves one residual by `tiny`.
    known, values = method.inconsistencies(), coefficients(method)
    for place in [i for i, value in enumerate(values) if value][:: 1 + len(values) // 500]:
        assert perturbed(method, place, tiny).inconsistencies() != known, place


@pytest.mark.parametrize("method", of_type(RungeKutta), ids=by_key)
def test_family_of_tableau_is_as_its_file_says(method: RungeKutta) -> None:
    implicit = method in (*FILES["implicit"], *FILES["diagonally_implicit"])
    assert method.explicit is not implicit
    diagonal = all(x == 0 for i, given in enumerate(method.a) for x in given[i + 1 :])
    assert diagonal or method not in FILES["diagonally_implicit"]


@pytest.mark.parametrize("method", [m for m in ALL if isinstance(m, Collocation)], ids=by_key)
def test_collocation_method_has_no_explicit_step(method: Collocation) -> None:
    with pytest.raises(MethodError, match=f"{method.key} is implicit"):
        stepper(method, lambda c: c)


def written_out(method: Nystrom, force: Callable[[Q], Q], q: Q, v: Q, h: Q) -> tuple[Q, Q]:
    """The definition of a Nyström method, in the order of its formula; not how the stepper does it."""
    k: list[Q] = []
    for i in range(method.stages):
        k.append(force(q + method.c[i] * h * v + sum(h**2 * method.a[i][j] * k[j] for j in range(i))))
    pairs = list(zip(method.b_position, method.b_velocity, k, strict=True))
    return q + h * v + sum(h**2 * x * f for x, _, f in pairs), v + sum(h * y * f for _, y, f in pairs)


@pytest.mark.parametrize("method", of_type(Nystrom), ids=by_key)
def test_step_of_nystrom_method_is_its_definition(method: Nystrom) -> None:
    state, force = (Q(1, 3), Q(-2, 5), Q(1, 7)), lambda q: 1 - 3 * q**2 + q**3
    assert stepper(method, lambda c: c)(force, *state) == written_out(method, force, *state)
    swapped = dataclasses.replace(method, b_position=method.b_position[::-1])
    assert stepper(method, lambda c: c)(force, *state) != written_out(swapped, force, *state)


@pytest.mark.parametrize("key", ["ruth3", "pefrl", "mclachlan_atela4", "yoshida4", "blanes_moan_rkn4"])
def test_splitting_is_the_nystrom_method_of_its_kicks(key: str) -> None:
    method, state = entry(key), (Q(1, 3), Q(-2, 5), Q(1, 7))
    assert isinstance(method, Splitting)
    step, same = stepper(method, lambda c: c), stepper(as_nystrom(method), lambda c: c)
    assert step(lambda q: q**2 - 1, *state) == same(lambda q: q**2 - 1, *state)
    assert step(lambda q: q**2 - 1, *state) != same(lambda q: q**2, *state)


NAMED = {"key": "mine", "title": "Mine", "claimed_order": 1, "source": "me"}
ROOT_3, ROOT_2 = square_root(3), square_root(2)
WRONG: list[tuple[Callable[[], Any], str]] = [
    (
        lambda: RungeKutta(**NAMED, a=((ROOT_3,),), b=(ROOT_2,), c=(0,)),
        "mine: coefficients lie in the fields of sqrt(2) and sqrt(3); write all of them in one field",
    ),
    (
        lambda: Splitting(**NAMED, parts=(("kick", ROOT_3), ("drift", ROOT_2))),
        "mine: coefficients lie in the fields of sqrt(2) and sqrt(3); write all of them in one field",
    ),
    (
        lambda: RungeKutta(**NAMED, a=((0,),), b=(1,), c=(0,), b_embedded=(1,)),
        "mine: b_embedded and embedded_order come together",
    ),
    (
        lambda: RungeKutta(**NAMED, a=((0,),), b=(1,), c=(0,), b_embedded=(1, 0), embedded_order=1),
        "mine: b_embedded has 2 entries, b has 1; they must agree",
    ),
    (
        lambda: RungeKutta(**NAMED, a=((0,),), b=(1,), c=(0,), b_embedded=(0.5,), embedded_order=1),
        "mine: b_embedded[0] is 0.5 (float); coefficients are exact: write an int or a Fraction",
    ),
    (
        lambda: Nystrom(**NAMED, c=(0,), a=((0, 0),), b_position=(1,), b_velocity=(1,)),
        "mine: a[0] has 2 entries, b_velocity has 1; they must agree",
    ),
    (
        lambda: Nystrom(**NAMED, c=(0,), a=((0,),), b_position=(1, 2), b_velocity=(1,)),
        "mine: b_position has 2 entries, b_velocity has 1; they must agree",
    ),
    (
        lambda: Nystrom(**NAMED, c=(), a=(), b_position=(), b_velocity=()),
        "mine: b_velocity is empty; a method has at least one stage",
    ),
    (
        lambda: Collocation(**NAMED, node_polynomial=(1,)),
        "mine: node_polynomial is constant; a method has at least one node",
    ),
    (
        lambda: Collocation(**NAMED, node_polynomial=(1, 0, 1)),
        "mine: node_polynomial has a complex or a multiple root; nodes are real, distinct",
    ),
    (
        lambda: Collocation(**NAMED, node_polynomial=(1, -2, 1)),
        "mine: node_polynomial has a complex or a multiple root; nodes are real, distinct",
    ),
    (
        lambda: Collocation(**NAMED, node_polynomial=(ROOT_3, 1)),
        "mine: node_polynomial has irrational coefficients; rational ones are needed",
    ),
]


@pytest.mark.parametrize(("build", "message"), WRONG, ids=range(len(WRONG)))
def test_malformed_definition_is_refused_in_one_line(build: Callable[[], Any], message: str) -> None:
    with pytest.raises(MethodError) as caught:
        build()
    assert str(caught.value) == message


def test_rational_element_of_a_field_becomes_a_fraction() -> None:
    method = RungeKutta(**NAMED, a=((ROOT_3 - ROOT_3,),), b=(ROOT_3 * ROOT_3 / 3,), c=(0,))
    assert (method.a, method.b, method.field) == (((Q(0),),), (Q(1),), None)
    assert type(method.a[0][0]) is type(method.b[0]) is Q
    assert method.explicit
    assert method.inconsistencies() == {}


def test_residual_of_an_irrational_tableau_is_exact() -> None:
    method = RungeKutta(**NAMED, a=((ROOT_3,),), b=(ROOT_3,), c=(0,))
    assert method.inconsistencies() == {"sum(b) - 1": ROOT_3 - 1, "c[0] - sum(a[0])": -ROOT_3}


def test_node_polynomial_is_made_monic() -> None:
    method = Collocation(**NAMED, node_polynomial=(Q(-1), Q(2), Q(0)))
    assert method.node_polynomial == (Q(-1, 2), Q(1))
    assert (method.stages, method.explicit, method.decimal, method.field) == (1, False, False, None)


def test_notation_fills_rows_with_zeros() -> None:
    assert square("1/2\n 1 0.25") == ((Q(1, 2), Q(0)), (Q(1), Q(1, 4)))
    assert padded((), (1,)) == ((Q(0), Q(0)), (Q(1), Q(0)))
    assert numbers(1, ROOT_3) == (Q(1), ROOT_3)
    assert places(3, k2="1e-1") == (Q(0), Q(1, 10), Q(0))
    assert row(" 1 -2/3 ") == (Q(1), Q(-2, 3))


def test_compositions_join_neighbouring_halves() -> None:
    assert palindrome((Q(1), Q(2))) == (Q(1), Q(2), Q(1))
    assert alternating("drift", (Q(1), Q(2))) == (("drift", Q(1)), ("kick", Q(2)))
    assert verlet_composition("kick", (Q(1),)) == METHODS["velocity_verlet"].parts
    assert verlet_composition("drift", (Q(1),)) == METHODS["position_verlet"].parts
    two = verlet_composition("kick", (Q(1, 3), Q(2, 3)))
    assert two == alternating("kick", (Q(1, 6), Q(1, 3), Q(1, 2), Q(2, 3), Q(1, 3)))
