"""A foreign stepper as the probes see it: called with floats, logged, and read back as floats."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from math import inf
from typing import TypeAlias

import numpy as np

from driftproof.blackbox.findings import NotANumber, UnsupportedCall, WrongShape
from driftproof.blackbox.stepper.calling_conventions import (
    BESIDES,
    CARRIED,
    FIELD,
    FORCE,
    FUNCTION,
    GRID,
    MAP,
    POSITION,
    STATE,
    STEP,
    TIME,
    UNIT_PARAMETERS,
    VELOCITY,
    reading_of,
    word_of,
)
from driftproof.blackbox.stepper.foreign_code import CallLog, FieldFunction, ForeignCode, size_of
from driftproof.blackbox.stepper.fresh_copies import fresh_copy
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, SCALARS, AnyNumber, ArrayAdapter, Foreign
from driftproof.blackbox.stepper.states.state_forms import BATCH, columns_of
from driftproof.blackbox.stepper.states.step_forms import StepForm
from driftproof.methods.programs.stepping import oscillator

# A force on numbers of the adapter.
ForceFunction: TypeAlias = Callable[[AnyNumber], AnyNumber]
# A force of the time, positions and velocities.
DraggedForce: TypeAlias = Callable[[AnyNumber, list[AnyNumber], list[AnyNumber]], Sequence[AnyNumber]]
# A number farther than this from a position of 1, a velocity of 3/4 and a time of 0, in a step of 1/4, is none of them.
_UNLIKE, _MOST_ASKED = 0.3, 4


@dataclass(eq=False)
class ForeignStepper(ForeignCode):
    """A foreign stepper with its steps of given systems, in numbers of its adapter, which are floats as a rule."""

    def fresh(self, steps: int = 1) -> ForeignStepper:
        """A copy without memory, for runs of `steps` steps. Raises UnsupportedCall if the code cannot be copied."""
        copied = None if self.pristine is None else fresh_copy(self.pristine)
        if copied is None:
            raise UnsupportedCall("no copy of it can be made that remembers nothing")
        log = CallLog(works_in_place=self.log.works_in_place, layout=self.log.layout)
        return replace(self, function=copied, convention=self.convention.of_steps(steps), log=log)

    def with_copies(self) -> ForeignStepper:
        """The same stepper, of which a fresh copy makes each step. Raises UnsupportedCall if it cannot be copied."""
        self.fresh()
        return replace(self, function=lambda *given, **named: self.fresh().function(*given, **named), anew=True)

    def step(self, q: AnyNumber, v: AnyNumber, h: AnyNumber, t: float = 0.0) -> tuple[AnyNumber, AnyNumber]:
        """One step of its built-in system from t, or of the oscillator if it takes a force or a right-hand side."""
        if self.convention.kind == MAP:
            return self._map(q, v, h, t)
        return self.step_with(oscillator, q, v, h)

    def step_with(self, force: ForceFunction, q: AnyNumber, v: AnyNumber, h: AnyNumber) -> tuple[AnyNumber, AnyNumber]:
        """One step of q' = v, v' = force(q). Raises UnsupportedCall if the system is built in."""
        q1, v1 = self.step_forced(lambda t, x: [force(*x)], self.adapter.number(0.0), [q], [v], h)
        return q1, v1

    def step_forced(
        self,
        force: FieldFunction,
        t: AnyNumber,
        q: Sequence[AnyNumber],
        v: Sequence[AnyNumber],
        h: AnyNumber,
        *,
        interleaved: bool = False,
    ) -> list[AnyNumber]:
        """One step of q' = v, v' = force(t, q): the new positions, then the new velocities.

        The state of a right-hand side is [q..., v...], or [q, v, q, v, ...] if `interleaved`. The stepper may ask for
        the force at fewer positions at a time. Raises UnsupportedCall if the system is built in, or of one number.
        """
        if self.single:
            raise UnsupportedCall("it takes one number, but q'' = -q needs two")
        if self.convention.kind == FORCE:
            return self._forced(lambda at, x, velocity: force(at, x), t, q, v, h)
        places = [*range(0, 2 * len(q), 2), *range(1, 2 * len(q), 2)] if interleaved else [*range(2 * len(q))]

        def as_code(numbers: Sequence[AnyNumber]) -> list[AnyNumber]:
            return [numbers[places.index(i)] for i in range(len(numbers))]

        def rate(at: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            state = [y[i] for i in places]
            return as_code([*state[len(q) :], *force(at, state[: len(q)])])

        stepped = self.step_field(rate, t, as_code([*q, *v]), h)
        return [stepped[i] for i in places]

    def step_dragged(
        self, force: DraggedForce, t: AnyNumber, q: Sequence[AnyNumber], v: Sequence[AnyNumber], h: AnyNumber
    ) -> list[AnyNumber]:
        """One step of q' = v, v' = force(t, q, v). Raises UnsupportedCall if its force is given no velocity."""
        if not self.gives_velocities:
            raise UnsupportedCall("its force receives no velocity")
        return self._forced(force, t, q, v, h)

    @property
    def form(self) -> StepForm:
        """What is known of its function, if that stands for a step written otherwise."""
        return StepForm.of(self.function)

    @property
    def reading(self) -> str:
        """How the arguments of a step are read, if not by their names alone, or if some are set to 1; "" of others."""
        found, told = self.convention, self.form.reading
        if told or not found.extra or found.kind != MAP:
            return told
        parts: dict[str, tuple[str, ...]] = {
            "the state": (POSITION, VELOCITY, STATE),
            "the time": (TIME,),
            "the step size": (STEP,),
        }
        names = found.named(self.function)
        return reading_of({what: [x for role, x in names if role in of] for what, of in parts.items()}, self.function)

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters of a system that is built in, by name: 1 unless `with_parameters` has set them."""
        extra = {name: x for name, x in self.convention.extra.items() if word_of(name) in UNIT_PARAMETERS}
        return {**extra, **self.adapter.parameters, **self.form.others}

    def with_parameters(self, values: Mapping[str, float]) -> ForeignStepper:
        """The same stepper with these values of some parameters."""
        function, adapter = self.function, self.adapter
        held = {name: x for name, x in values.items() if name in adapter.parameters}
        others, of_others = self.form.others, self.form.of_others
        if of_others and others.keys() & values.keys():
            function = of_others({**others, **values})
        elif extra := {name: x for name, x in values.items() if name not in held}:
            convention = replace(self.convention, extra={**self.convention.extra, **extra})
            return replace(self, convention=convention).with_parameters(held)
        adapter = adapter.with_parameters(held) if held and adapter.with_parameters else adapter
        return replace(self, function=function, adapter=adapter)

    @property
    def takes_time(self) -> bool:
        """True if a step takes a time, or a record that holds one."""
        return TIME in self.convention.order or self.adapter.at is not None

    @property
    def gives_velocities(self) -> bool:
        """True if the stepper passes velocities to its force."""
        return VELOCITY in self.convention.asks

    def step_field(self, rate: FieldFunction, t: AnyNumber, y: Sequence[AnyNumber], h: AnyNumber) -> list[AnyNumber]:
        """One step of y' = rate(t, y). Raises UnsupportedCall if the stepper takes no right-hand side."""
        if self.convention.kind != FIELD:
            kind = f"{self.convention.kind!r}{f' ({self.reading})' if self.reading else ''}"
            raise UnsupportedCall(f"the stepper is called as {kind}, which takes no right-hand side")
        size, write = len(y), self.adapter.write
        roles = {FUNCTION: self.callback(rate, t, size, write), TIME: t, STATE: write(y), STEP: h}
        if CARRIED in self.convention.order:
            roles[CARRIED] = write(rate(t, list(y)))
        if GRID in self.convention.order:
            roles[GRID] = np.array(self.convention.times(t, h))
        answer = self.called(roles, f"t={t!r}, y={list(y)!r}, h={h!r}", y)
        return self.finite(self._read_state(answer, size, t + h), [*y, h])

    def step_batch(self, qs: Sequence[float], vs: Sequence[float], h: float) -> list[tuple[float, float]]:
        """One step of several states at once, as arrays, or as the numbers of one state if a function is taken.

        The force is then -q. Raises UnsupportedCall if a system that is built in has one array, which is one state.
        """
        adapter, n = columns_of(len(qs)) if self.adapter is BATCH else self.adapter, len(qs)
        words, numbers = f"q={list(qs)!r}, v={list(vs)!r}, h={h!r}", [*qs, *vs]
        if self.convention.kind != MAP:
            subject = replace(self, adapter=adapter)
            ends = subject.step_forced(lambda t, x: [-y for y in x], 0.0, list(qs), list(vs), h)
        elif POSITION in self.convention.order:
            write = self._of_several.write
            roles = {POSITION: write(qs), VELOCITY: write(vs), CARRIED: write([-q for q in qs]), STEP: h, TIME: 0.0}
            ends = [x for part in self.two_parts(self.called(roles, words, numbers)) for x in adapter.read(part, n)]
        elif adapter is not self.adapter or adapter.with_parameters is not None:
            state = adapter.write([qs, vs] if adapter is self.adapter else numbers)
            ends = adapter.read(self.called({STATE: state, STEP: h, TIME: 0.0}, words, numbers), 2 * n)
        else:
            raise UnsupportedCall("position and velocity come in one array, which is one state")
        return list(zip(ends[:n], ends[n:], strict=True))

    def step_state(self, y: Sequence[AnyNumber], h: AnyNumber, t: float = 0.0) -> list[AnyNumber]:
        """One step of its built-in system from t, whose state is one array, a record or the like, or [q..., v...]."""
        if STATE not in self.convention.order:
            q, v, write = y[: len(y) // 2], y[len(y) // 2 :], self._of_several.write
            return self._pair({POSITION: write(q), VELOCITY: write(v), STEP: h, TIME: t}, q, v, h)
        adapter = self.adapter if self.adapter.at is None else self.adapter.at(t)
        answer = self.called({STATE: adapter.write(y), STEP: h, TIME: t}, f"state={[*y]!r}, h={h!r}", y)
        return self.finite(self._read_state(answer, len(y), t + h), [*y, h])

    def _map(self, q: AnyNumber, v: AnyNumber, h: AnyNumber, t: float) -> tuple[AnyNumber, AnyNumber]:
        write = self.adapter.write
        if STATE in self.convention.order:
            q1, v1 = self.step_state([q, v], h, t)
            return q1, v1
        roles = {POSITION: write([q]), VELOCITY: write([v]), STEP: h, TIME: t}
        if CARRIED in self.convention.order:
            roles[CARRIED] = write([-q])
        q1, v1 = self._pair(roles, [q], [v], h)
        return q1, v1

    @property
    def _of_several(self) -> ArrayAdapter:
        """The adapter for several positions: a step that works on one float may work on an array of them."""
        return ARRAYS if self.adapter is SCALARS else self.adapter

    def _forced(
        self, force: DraggedForce, t: AnyNumber, q: Sequence[AnyNumber], v: Sequence[AnyNumber], h: AnyNumber
    ) -> list[AnyNumber]:
        """One step under a force; its first call shows which arguments the force gets, and in which order."""
        adapter, order = self.adapter if len(q) == 1 else self._of_several, self.convention.order
        momentum = self.convention.momentum
        v = [momentum * x for x in v]

        def callback(*arguments: Foreign) -> Foreign:
            roles = self.convention.asks or self.log.asks or self._roles_asked(adapter, arguments, q, v, t)
            self.log.asks = roles
            given = dict(zip(roles if len(roles) <= len(arguments) else (POSITION,), arguments, strict=False))
            position = given[POSITION]
            size = 1 if size_of(position) == 1 else len(q)
            asked = adapter.read(position, size)
            (at,) = adapter.read(given[TIME], 1) if TIME in order and TIME in given else (t,)
            moving = [x / momentum for x in adapter.read(given[VELOCITY], size)] if VELOCITY in given else []
            answering = SCALARS if adapter is ARRAYS and np.ndim(position) == 0 else adapter
            return self.answered(answering.write([factor * x for x in force(at, asked, moving)]))

        factor, carried, function = self.convention.factor, self.convention.carried, adapter.function(callback)
        roles = {FUNCTION: function, POSITION: adapter.write(q), VELOCITY: adapter.write(v), STEP: h, TIME: t}
        if CARRIED in order:
            roles[CARRIED] = adapter.write([carried * x for x in force(t, list(q), [x / momentum for x in v])])
        moved = self._pair(roles, q, v, h)
        return [*moved[: len(q)], *(x / momentum for x in moved[len(q) :])]

    def _roles_asked(
        self, adapter: ArrayAdapter, arguments: Sequence[Foreign], q: AnyNumber, v: AnyNumber, t: AnyNumber
    ) -> tuple[str, ...]:
        """The roles of a first call's arguments: that of the closest number at the start of the step, or BESIDES."""
        starts, many = {POSITION: q[0], VELOCITY: v[0], TIME: t}, len(arguments)
        if many > _MOST_ASKED:
            return (POSITION,)

        def off(role: str, asked: Foreign) -> float:
            try:
                return _UNLIKE if role == BESIDES else float(abs(adapter.read(asked, size_of(asked))[0] - starts[role]))
            except (NotANumber, WrongShape):
                return inf

        choices = (roles for roles in permutations((*starts, *[BESIDES] * many), many) if POSITION in roles)
        return min(choices, key=lambda roles: sum(map(off, roles, arguments)))

    def _pair(
        self, roles: dict[str, Foreign], q: Sequence[AnyNumber], v: Sequence[AnyNumber], h: AnyNumber
    ) -> list[AnyNumber]:
        shown = [x[0] if len(x) == 1 else list(x) for x in (q, v)]
        answer = self.called(roles, f"q={shown[0]!r}, v={shown[1]!r}, h={h!r}", [*q, *v])
        return self.finite([x for part in self.two_parts(answer) for x in self.read(part, len(q))], [*q, *v, h])
