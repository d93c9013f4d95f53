"""First integrals along a float run: quantities that the solution conserves, and how far the run drifts from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

from flint import arb

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.certificate import Drift, decimal
from driftproof.enclosure.fields.fields import enclosable, enclosed_values
from driftproof.enclosure.fields.text_fields import GivenField, field_function
from driftproof.methods.formulas.field_text import rate_of_text
from driftproof.methods.formulas.vector_fields import VectorField
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
