"""The tables of docs/differences.md, computed from the catalogue, from what is in print and from peers' answers."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction as Q
from functools import cache
from pathlib import Path
from typing import Any

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method, Nystrom, RungeKutta, Splitting
from driftproof.reports.fact_sheet import facts
from driftproof.symbolic.algebra.certified import scientific
from driftproof.symbolic.trees.elementary_weights import TableauStages
from driftproof.symbolic.trees.order_conditions import OrderFact, RungeKuttaConditions, order, order_of
from driftproof.symbolic.trees.partitioned_trees import nystrom_conditions, separable_conditions
from driftproof.symbolic.trees.rooted_trees import to_brackets

HERE = Path(__file__).parent
Rows = list[list[str]]


@dataclass(frozen=True)
class Claim:
    """An order that a source claims of a method or of its embedded row, and what is so.

    `conditions` are those of the class of problems for which it is claimed.
    """

    name: str
    order: int
    found: OrderFact[Any]
    conditions: Callable[[], Any]


def claims(method: Method) -> Iterator[Claim]:
    """The order claimed for the method, and the one for its embedded row."""
    if isinstance(method, Splitting | Nystrom):
        on_second_order = isinstance(method, Nystrom) or method.quadratic_kinetic
        alternating = nystrom_conditions(method) if on_second_order else separable_conditions(method)
        yield Claim(method.key, method.claimed_order, order_of(alternating), lambda: alternating)
        return
    made = _tree_conditions(method.a, method.b) if isinstance(method, RungeKutta) else None
    yield Claim(method.key, method.claimed_order, order_of(made) if made else order(method), lambda: made)
    if isinstance(method, RungeKutta) and method.embedded_order is not None:
        embedded = _tree_conditions(method.a, method.b_embedded)
        yield Claim(f"{method.key}, embedded row", method.embedded_order, order_of(embedded), lambda: embedded)


@cache
def _tree_conditions(a: Any, b: Any) -> RungeKuttaConditions:
    """Once for methods that differ only in their embedded rows."""
    return RungeKuttaConditions(TableauStages(a, b))


def all_claims() -> list[Claim]:
    """Every order claimed in the catalogue."""
    return [claim for method in METHODS.values() for claim in claims(method)]


def largest(conditions: Any, first: int, last: int) -> str:
    """The largest |Φ - 1/γ| of the trees with `first` to `last` vertices, two digits."""
    sizes = [abs(conditions.scalars.exact(x)) for n in range(first, last + 1) for _, x in conditions.residuals(n)]
    return scientific(max(sizes), 2) if any(sizes) else "0"


def orders() -> Rows:
    """The claims that the printed coefficients do not meet exactly."""
    rows = [["method", "claimed", "found", "first condition that fails", "largest up to the claim", "beyond it"]]
    for claim in all_claims():
        if claim.found.order != claim.order:
            failing = f"{to_brackets(claim.found.failing_tree)}: {scientific(claim.found.residual, 2)}"
            made, beyond = claim.conditions(), claim.order + 1
            sizes = (largest(made, 1, claim.order), largest(made, beyond, beyond))
            rows.append([f"`{claim.name}`", str(claim.order), str(claim.found.order), failing, *sizes])
    return rows


def order_count() -> Rows:
    """How many claims there are, and how many of them hold exactly."""
    made = all_claims()
    met = sum(claim.order == claim.found.order for claim in made)
    return [["orders claimed", "met exactly", "not"], [str(len(made)), str(met), str(len(made) - met)]]


def quadratic() -> Rows:
    """The splittings whose claimed order is one on q'' = F(q), and what becomes of it on separable Hamiltonians."""
    rows = [["method", "claimed", "largest on q'' = F(q)", "largest on every T(p) + V(q)"]]
    for method in METHODS.values():
        if isinstance(method, Splitting) and method.quadratic_kinetic:
            on = (nystrom_conditions(method), separable_conditions(method))
            sizes = (largest(conditions, 1, method.claimed_order) for conditions in on)
            rows.append([f"`{method.key}`", str(method.claimed_order), *sizes])
    return rows


def statements() -> list[dict[str, Any]]:
    """What is in print of stability: docs/published.toml, one statement on some methods each."""
    return tomllib.loads((HERE / "published.toml").read_text(encoding="utf-8"))["statement"]


def found(key: str, fact: str, *, embedded: bool = False) -> Any:
    """Our value of a fact; of the method that propagates the embedded row, if asked."""
    method = METHODS[key]
    if embedded and isinstance(method, RungeKutta) and method.b_embedded is not None:
        method = replace(method, b=method.b_embedded, b_embedded=None, embedded_order=None)
    return facts(method, only=[fact]).data[fact]


def agrees(says: Any, value: Any) -> bool:
    """Whether our value is what is in print; of a decimal, in all the digits that are printed."""
    if isinstance(value, dict):
        places = len(str(says).partition(".")[2])
        return Q(math.floor(Q(value["decimal"]) * 10**places + Q(1, 2)), 10**places) == Q(str(says))
    return bool(says == value)


def in_words(value: Any) -> str:
    """A fact, or what is in print of one."""
    if isinstance(value, dict):
        return in_words(value["exact"]) if value["exact"] and len(value["exact"]) < 12 else f"{value['decimal'][:12]}"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return {"oo": "all of it", None: "none"}.get(value, str(value))


def published() -> Rows:
    """Every statement: who says what of which methods, and whether it is so of each of them."""
    rows = [["source", "of", "says", "of these methods", "found"]]
    for s in statements():
        row = s.get("embedded", False)
        wrong = [key for key in s["methods"] if not agrees(s["says"], found(key, s["fact"], embedded=row))]
        verdict = "same" if not wrong else f"**not of {', '.join(wrong)}: {in_words(found(wrong[0], s['fact']))}**"
        fact = s["fact"].replace("_", " ") + (", embedded row" if row else "")
        rows.append([s["source"], fact, in_words(s["says"]), ", ".join(s["methods"]), verdict])
    return rows


def peers() -> dict[str, Any]:
    """What the peers answered in the last run of the benchmarks."""
    return json.loads((HERE / "peers.json").read_text(encoding="utf-8"))


def peer_counts() -> Rows:
    """How often a peer and we answered the same, and how often not."""
    rows = [["peer", "fact", "same", "not the same", "no answer"]]
    for name, peer in peers().items():
        for fact, seen in peer["facts"].items():
            counts = (str(seen["agree"]), str(len(seen["differs"])), str(len(seen["silent"])))
            rows.append([f"{name} {peer['version']}", fact.replace("_", " "), *counts])
    return rows


def peer_differences() -> Rows:
    """Every answer of a peer that is not ours."""
    rows = [["peer", "fact", "method", "the peer", "found"]]
    for name, peer in peers().items():
        for fact, seen in peer["facts"].items():
            for key, said in seen["differs"].items():
                rows.append([name, fact.replace("_", " "), f"`{key}`", said, in_words(found(key, fact))])
    return rows


def peer_own() -> Rows:
    """What a peer says of a method that it makes itself."""
    rows = [["peer", "expression", "answer"]]
    for name, peer in peers().items():
        rows += [[f"{name} {peer['version']}", f"`{expression}`", said] for expression, said in peer["own"].items()]
    return rows


TABLES: dict[str, Callable[[Any], Rows]] = {
    table.__name__: lambda _, table=table: table()  # type: ignore[misc]
    for table in (orders, order_count, quadratic, published, peer_counts, peer_differences, peer_own)
}
