"""The slopes of a system that is given for a step: what it takes, by name or by place, and what it returns."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import cycle
from typing import Any

import numpy as np

from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.stepper.calling_conventions import (
    MASSES,
    STATE,
    TIME,
    parameters_of,
    required_names,
    role_of,
)
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import imported
from driftproof.blackbox.stepper.states.forms_by_values import as_complex, as_reals

# What parameters of a step are set to: other than 1 and unlike each other, and products of them exact.
_VALUES = tuple(n / 16 for n in (20, 14, 22, 13, 18, 23, 15, 19, 17, 21))


@dataclass(frozen=True)
class GivenSlopes:
    """A system as a function, and its arguments: the time if it takes one, the state, and parameters of the step.

    If it is `by_parts`, y holds the parts of a complex state, which the system takes. `beside` are numbers of the step
    that the system does not take. `parts` are the places of what it takes by name of a state that a start gives; its
    slopes may leave these out, if the step keeps them as they are.
    """

    function: Callable[..., Any]
    plain: Sequence[str]
    values: Mapping[str, Any]
    by_parts: bool = False
    beside: Mapping[str, Any] = field(default_factory=dict)
    parts: Mapping[str, int | slice] = field(default_factory=dict)

    @classmethod
    def of(cls, system: Callable[..., Any] | str, subject: ForeignStepper) -> GivenSlopes:
        """The system, with a value for each parameter of the step that it takes by name: those of defaults are kept."""
        function, kept = imported(system, "system"), _defaults(subject)
        masses = subject.form.masses
        names = parameters_of(function) or ()
        taken = [each for each in names if each in {**kept, **subject.parameters}]
        parts = {each: x for each, x in subject.form.later.items() if each in names}
        if all(each in {*taken, *parts} or role_of(each, (TIME,)) for each in names):  # its y is the whole state
            parts = {}
        plain = [each for each in required_names(function) or ("t", "y") if each not in taken and each not in parts]
        if len(plain) == 2 and role_of(plain[0], (STATE,)) and not role_of(plain[1], (STATE, TIME)):
            raise BadInput(f"the system given takes {plain[1]}, which is no parameter of the step")
        values = zip((each for each in taken if each not in kept), cycle(_VALUES))
        held = {each: kept[each] for each in taken if each in kept}
        beside = {} if {*MASSES} & {*held} or masses is None else {"the masses of its bodies": masses}
        return cls(function, plain, {**held, **dict(values)}, subject.form.by_parts, beside, parts)

    @property
    def words(self) -> str:
        """The values in words; "" if it takes no parameters."""
        shown = {**self.beside, **self.values}
        texts = (f"{name} = {', '.join(f'{each:g}' for each in np.ravel(x))}" for name, x in shown.items())
        return f" with {'; '.join(texts)}" if shown else ""

    def halved(self, subject: ForeignStepper) -> GivenSlopes:
        """The same system with half of each value that is not a default."""
        kept = _defaults(subject)
        return replace(self, values={name: x if name in kept else x / 2 for name, x in self.values.items()})

    def on(self, subject: ForeignStepper) -> ForeignStepper:
        """The step with these values."""
        return subject.with_parameters({name: x for name, x in self.values.items() if name in subject.parameters})

    def rates(self, t: float, y: Sequence[float]) -> list[float]:
        """The slopes. Raises ArithmeticError where it has none, and BadInput if they are not as many as the numbers."""
        state: Any = as_complex(y) if self.by_parts else np.array(y, float)
        others, first = {name: state[place] for name, place in self.parts.items()}, np.full(len(y), True)
        for place in self.parts.values():
            first[place] = False
        state = state[first] if others else state
        given = [t, state] if len(self.plain) > 1 else [state]
        if len(given) == 2 and role_of(self.plain[1], (TIME,)) and not role_of(self.plain[0], (TIME,)):
            given.reverse()
        try:
            named = dict(zip(self.plain, given, strict=True)) if self.values or others else {}
            slopes = self.function(*([] if named else given), **named, **self.values, **others)
            parts = as_reals(slopes) if self.by_parts else slopes
            several = parts if isinstance(parts, tuple | list) else [parts]
            found = np.concatenate([np.ravel(np.asarray(each, float)) for each in several])
            if others and found.size == first.sum():
                found = np.bincount(np.flatnonzero(first), found, len(y))  # and no slopes of what the step keeps
        except Exception as error:
            raise ArithmeticError(f"the system given raises {type(error).__name__}: {error}") from None
        if found.size != len(y):
            raise BadInput(f"the system given has {found.size} slopes where a step has {len(y)} numbers")
        if not np.isfinite(found).all():
            raise ArithmeticError("the system given is not finite there")
        return [float(x) for x in found]

    def at(self, y: Array) -> Array:
        """The slopes of a state at the time 0."""
        return np.array(self.rates(0.0, y.tolist()))

    def slopes(self, states: Sequence[tuple[float, ...]]) -> dict[tuple[float, ...], Array]:
        """The slopes at the states at which there are some. Raises BadInput if these are less than two."""
        slopes, why = dict[tuple[float, ...], Array](), ""
        for y in states:
            try:
                slopes[y] = self.at(np.array(y))
            except ArithmeticError as error:
                why = str(error)
        if len(slopes) < 2:
            raise BadInput(why)
        return slopes


def _defaults(subject: ForeignStepper) -> dict[str, Any]:
    """The numbers that are defaults of the step's parameters, and the masses of bodies, under each of their names."""
    given = parameters_of(subject.form.step or subject.function) or {}
    masses = dict.fromkeys(MASSES, subject.form.masses)  # of bodies that attract each other
    known = {name: x for name, x in masses.items() if x is not None}
    return {**known, **{name: x.default for name, x in given.items() if isinstance(x.default, int | float)}}
