"""First integrals along a float run: quantities that the solution conserves, and how far the run drifts from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import Any, TypeAlias

import numpy as np
from flint import arb

from driftproof.enclosure.certificate import Drift, decimal
from driftproof.enclosure.evaluations import Evaluation, Refused
from driftproof.enclosure.fields import enclosable, enclosed_values
from driftproof.enclosure.numbers import Enclosed
from driftproof.enclosure.text_fields import GivenField, field_function
from driftproof.methods.field_text import rate_of_text
from driftproof.methods.vector_fields import VectorField
from driftproof.support.plain_text import unknown

# I(y) as a function of y or as text; a name in FIRST_INTEGRALS stands for its text.
Invariant: TypeAlias = Callable[[Any], Any] | str
GivenInvariants: TypeAlias = Mapping[str, Invariant] | Sequence[str] | str

# In units in which masses, lengths and gravity are 1; y holds positions, then velocities.
FIRST_INTEGRALS = {
    "oscillator_energy": "(y0^2 + y1^2)/2",
    "pendulum_energy": "y1^2/2 - cos(y0)",
    "kepler_energy": "(y2^2 + y3^2)/2 - 1/sqrt(y0^2 + y1^2)",
    "angular_momentum": "y0*y3 - y1*y2",
    "henon_heiles_energy": "(y0^2 + y1^2 + y2^2 + y3^2)/2 + y0^2*y1 - y1^3/3",
}


def n_body_integrals(masses: Sequence[Any], dimension: int = 3, gravity: Any = 1) -> dict[str, Callable[[Any], Any]]:
    """Energy, momentum and angular momentum of bodies that attract each other; y = (all positions, all velocities).

    >>> sorted(n_body_integrals([1, 1, 1], dimension=2))
    ['angular_momentum_xy', 'energy', 'momentum_x', 'momentum_y']
    """
    n = len(masses)

    def parts(y: Any) -> tuple[list[Any], list[Any]]:
        rows = [y[i * dimension : (i + 1) * dimension] for i in range(2 * n)]
        return rows[:n], rows[n:]

    def energy(y: Any) -> Any:
        q, v = parts(y)
        total = sum(m * sum(x * x for x in row) for m, row in zip(masses, v, strict=True)) / 2
        for i, j in combinations(range(n), 2):
            distance = np.sqrt(sum((a - b) * (a - b) for a, b in zip(q[i], q[j], strict=True)))
            total = total - gravity * masses[i] * masses[j] / distance
        return total

    def momentum(axis: int) -> Callable[[Any], Any]:
        return lambda y: sum(m * row[axis] for m, row in zip(masses, parts(y)[1], strict=True))

    def angular(a: int, b: int) -> Callable[[Any], Any]:
        return lambda y: sum(m * (q[a] * v[b] - q[b] * v[a]) for m, q, v in zip(masses, *parts(y), strict=True))

    axes = "xyz"[:dimension]
    found = {"energy": energy, **{f"momentum_{x}": momentum(i) for i, x in enumerate(axes)}}
    return found | {f"angular_momentum_{axes[a]}{axes[b]}": angular(a, b) for a, b in combinations(range(dimension), 2)}


def known_invariant(name: str) -> str:
    """The text of the first integral with this name. Raises ValueError for an unknown name."""
    if name not in FIRST_INTEGRALS:
        raise ValueError(unknown("first integral", name, FIRST_INTEGRALS))
    return FIRST_INTEGRALS[name]


def invariants_of(given: GivenInvariants, f: GivenField, components: int) -> dict[str, Callable[[Any], Any]]:
    """The first integrals as functions of y, by name; texts may use the names in a field f. Raises ValueError."""
    if not isinstance(given, Mapping):
        given = {name: known_invariant(name) for name in ([given] if isinstance(given, str) else given)}
    field = f if isinstance(f, VectorField) else VectorField(("0",) * components)
    return {name: _function(name, each, field) for name, each in given.items()}


def _function(name: str, invariant: Invariant, field: VectorField) -> Callable[[Any], Any]:
    if callable(invariant):
        return enclosable(invariant)  # type: ignore[arg-type, return-value]
    own = dict(zip(field.unknowns, field.components, strict=False))
    try:
        made = field_function(field, [rate_of_text(invariant, own | {each: each for each, _ in field.parameters})])
    except ValueError as error:
        said = field.in_own_words(str(error).removeprefix("rate 0, "))
        raise ValueError(f"first integral {name}: {said}") from None
    return lambda y: made(y[0] * 0, y)[0]


def enclosed_invariant(invariant: Callable[[Any], Any], row: Sequence[arb], name: str) -> arb:
    """I(y) in balls. Raises Refused if it cannot be computed in balls."""
    evaluation = Evaluation()
    state = [Enclosed(evaluation, x) for x in row]
    found = enclosed_values(f"first integral {name}", invariant, state, evaluation)
    if len(found) != 1:
        raise Refused(f"first integral {name} returns {len(found)} numbers; it must return one")
    value: arb = found[0].value
    if not value.is_finite():
        raise Refused(f"first integral {name} is not finite on the trajectory")
    return value


def drift_of(
    name: str,
    invariant: Callable[[Any], Any],
    floats: Sequence[Sequence[float]],
    true: Sequence[Sequence[arb]],
    exact_run: Sequence[Sequence[arb]] | None,
) -> Drift:
    """I at each row minus I at the start. Raises Refused if the enclosure proves that the solution does not keep I."""
    rows = [[arb(x) for x in row] for row in floats]
    start = enclosed_invariant(invariant, rows[0], name)
    for i, row in enumerate(true):
        changed = enclosed_invariant(invariant, row, name) - start
        if not changed.contains(0):
            raise Refused(f"{name} is not conserved: at point {i} the solution has changed it by {decimal(changed)}")
    total = tuple(enclosed_invariant(invariant, row, name) - start for row in rows)
    if exact_run is None:
        return Drift(total)
    truncation = tuple(enclosed_invariant(invariant, row, name) - start for row in exact_run)
    return Drift(total, truncation, tuple(a - b for a, b in zip(total, truncation, strict=True)))
