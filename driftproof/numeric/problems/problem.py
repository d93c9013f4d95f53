"""What a problem is: equations, start, interval, a reference with its evidence, and what is expected of methods."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.support.plain_text import unknown

# The kinds of evidence for a reference.
EXACT, CERTIFIED = KINDS_OF_EVIDENCE = ("exact", "certified")

# The source of a CERTIFIED reference, in which every ball determines all the digits given.
ENCLOSED = "the solution, enclosed in ball arithmetic"

# In each step of an enclosure, a few of which are as long as the solution's own times.
LOOKS = 16

# One decimal per component, as text: every digit is significant.
Digits: TypeAlias = tuple[str, ...]


@dataclass(frozen=True)
class DenseSolution:
    """The solution in doubles at any time: a polynomial in σ on each step, where σ is `low` at its begin, 1 at its end.

    `coefficients` has for each step a row for each component, from σ⁰ on.
    """

    begins: NDArray[np.float64]
    lengths: NDArray[np.float64]
    low: NDArray[np.float64]
    coefficients: NDArray[np.float64]

    def at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """A row y(t) for each time. Between two steps, where f changes, it is the end of the one before."""
        step = np.maximum(np.searchsorted(self.begins, times, side="right") - 1, 0)
        part, low = np.clip((times - self.begins[step]) / self.lengths[step], 0, 1), self.low[step]
        sigma, found = low + (1 - low) * part, np.zeros((len(times), self.coefficients.shape[1]))
        for k in reversed(range(self.coefficients.shape[2])):
            found = found * sigma[:, None] + self.coefficients[step, :, k]
        return found

    def largest(self, end: float) -> float:
        """The largest norm up to the end, beyond which the last step may go, looked for LOOKS times in each step."""
        times = (self.begins + self.lengths * np.arange(LOOKS + 1)[:, None] / LOOKS).ravel()
        return float(np.hypot.reduce(self.at(times.clip(max=end)), axis=1).max())


@dataclass(frozen=True)
class Reference:
    """y at some times: `states[i]` is y(times[i]), each component within half a unit of its last digit.

    `evidence` is EXACT (decimals of a closed form, certified) or CERTIFIED (the solution is enclosed). `source` names
    the form, or says how the solution was enclosed. `dense` has y at any time, for its size and for
    the largest error of a run: a force may have whole periods between a few equal times. `changes` are the times where
    f has a jump or a kink on the way, as far as they are known.
    """

    times: tuple[Fraction, ...]
    states: tuple[Digits, ...]
    evidence: str
    source: str
    dense: DenseSolution | None = dataclasses.field(default=None, repr=False, compare=False)
    changes: tuple[Fraction, ...] = ()

    def __post_init__(self) -> None:
        """Raise ValueError unless times rise, each with a state, and the evidence is known."""
        if not self.times or list(self.times) != sorted(set(self.times)) or len(self.times) != len(self.states):
            raise ValueError("a reference needs strictly increasing times and one state for each")
        if self.evidence not in KINDS_OF_EVIDENCE:
            raise ValueError(unknown("evidence", self.evidence, KINDS_OF_EVIDENCE))

    @cached_property
    def largest_between(self) -> float:
        """The largest norm of the dense solution up to the last of its times; 0 without one."""
        return self.dense.largest(float(self.times[-1])) if self.dense else 0.0


def reference(key: str, evidence: str, source: str) -> Reference:
    """The reference of the problem `key`, to 20 digits if it has a closed form; 0e-400 is a y of smaller size.

    Raises ValueError if digits.json has none.
    """
    if not (found := _digits().get(key)):
        where = "driftproof/numeric/problems/digits.json; a new problem has its end there"
        raise ValueError(f'{key} has no times in {where}, as in "{key}": {{"10": []}}')
    return Reference(tuple(map(Fraction, found)), tuple(map(tuple, found.values())), evidence, source)


@cache
def _digits() -> Any:
    return json.loads((Path(__file__).parent / "digits.json").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Problem:
    """y' = f(t, y), y(0) = start, up to the last time of the reference.

    `energy` is an expression in y0, y1, ... or None. The exact solution conserves it, or `energy_changes` says by how
    much it has changed it, and at which time. `second_order`: the first half of y are positions, and their rates are
    exactly the second half, so that splittings and Nyström methods apply.
    `matrix` is A if f(t, y) = A(y - c) or Ay + b(t), in which case stability is proved, and else None. `expected` maps
    a kind of method ("explicit", "a_stable", ...) to what it should do. `unknowns` are names for y0, y1, ...
    """

    key: str
    title: str
    field: VectorField
    start: tuple[Fraction, ...]
    reference: Reference
    source: str
    energy: str | None = None
    energy_changes: str = ""
    second_order: bool = False
    stiff: bool = False
    matrix: tuple[tuple[Fraction, ...], ...] | None = None
    expected: Mapping[str, str] = dataclasses.field(default_factory=dict)
    unknowns: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Raise ValueError for a start or a reference of another length than the field."""
        components = len(self.field.rates)
        given = filter(None, self.reference.states)  # () at the end of a new one, whose digits are to come
        if any(len(state) != components for state in (self.start, *given)):
            raise ValueError(f"{self.key}: {components} rates need a start and a reference of {components} components")

    @property
    def energy_note(self) -> str:
        """What the errors of an energy are that the solution does not conserve; else ""."""
        said = f"f does not conserve the energy (the solution has changed it by {self.energy_changes})"
        return f"{said}: errors are differences from that of the solution" if self.energy_changes else ""

    @property
    def t(self) -> Fraction:
        """The end of the interval."""
        return self.reference.times[-1]
