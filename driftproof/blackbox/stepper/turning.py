"""Steps that turn a vector: a velocity in an electric and a magnetic field, and a quaternion at an angular velocity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import Foreign, as_array


@dataclass(frozen=True)
class Push:
    """A step from x and v in constant fields; in the plane x, v and E have two components, and B is one number."""

    x: Sequence[float]
    v: Sequence[float]
    electric: Sequence[float]
    magnetic: Sequence[float]
    h: float


@dataclass(frozen=True)
class Pushed:
    """The new x, empty if the step has none, and the new v; the places where E and B were last called, if at all."""

    x: list[float]
    v: list[float]
    places: list[list[float]] = field(default_factory=list)


@dataclass(frozen=True)
class Course:
    """A step from t at an angular velocity that changes by so much in the unit of time, and when that was asked for."""

    t: float = 0.0
    change: Sequence[float] = ()
    asked: list[list[float]] = field(default_factory=list)


def step_in_fields(subject: ForeignStepper, push: Push) -> Pushed:
    """One step of x' = v, v' = E + v x B. Raises UnsupportedCall if the stepper takes no magnetic field."""
    if subject.convention.kind != calling.MAGNETIC:
        raise UnsupportedCall("it takes no magnetic field")
    order, factor, write, size = subject.convention.order, subject.convention.factor, subject.adapter.write, len(push.v)
    fields: list[_Field] = []
    roles: dict[str, Foreign] = {calling.POSITION: write(push.x), calling.VELOCITY: write(push.v)}
    roles |= {calling.STEP: push.h, calling.TIME: 0.0}
    for role, numbers in ((calling.ELECTRIC, push.electric), (calling.MAGNETIC_FIELD, push.magnetic)):
        scaled = np.multiply(factor, numbers)
        made = _Field(as_array(write(scaled.tolist())) if len(numbers) > 1 else scaled[0])
        made.asked, made.size_of_place = [], size
        roles[role] = made
        fields.append(made)
    shown = zip("xvEB", (push.x, push.v, push.electric, push.magnetic), strict=True)
    words = ", ".join([*(f"{name}={list(numbers)!r}" for name, numbers in shown), f"h={push.h!r}"])
    answer = subject.called(roles, words, [*push.x, *push.v])
    asked = [made.asked[-1] for made in fields if made.asked]
    if calling.POSITION not in order:
        return Pushed([], subject.finite(subject.read(answer, size), push.v), asked)
    if getattr(answer, "shape", ()) == (2 * size,):  # one state, the position before the velocity
        answer = answer[:size], answer[size:]
    x, v = (subject.read(part, size) for part in subject.two_parts(answer))
    subject.finite([*x, *v], [*push.x, *push.v])
    return Pushed(x, v, asked)


def turn_quaternion(
    subject: ForeignStepper, q: Sequence[float], omega: Sequence[float], h: float, course: Course | None = None
) -> list[float]:
    """One step of a quaternion at an angular velocity, which may depend on t. Raises UnsupportedCall without one."""
    course = course or Course()
    if subject.convention.kind != calling.ROTATION:
        raise UnsupportedCall("it takes no quaternion")
    write = subject.adapter.write
    roles = {calling.QUATERNION: write(q), calling.ANGULAR: write(omega), calling.STEP: h, calling.TIME: course.t}
    if calling.TIME in subject.convention.order and isinstance(roles[calling.ANGULAR], np.ndarray):
        roles[calling.ANGULAR] = made = _Field(roles[calling.ANGULAR])
        made.asked, made.size_of_place, made.change = course.asked, 1, np.array(course.change)
    answer = subject.called(roles, f"q={list(q)!r}, omega={list(omega)!r}, h={h!r}", q)
    return subject.finite(subject.read(answer, len(q)), q)


class _Field(np.ndarray[Any, Any]):
    """A vector that is also the constant function with its value, and records the places at which it is called.

    With a `change`, it is a function of t, which changes by that in the unit of time, and has its value at t = 0.
    """

    asked: list[list[float]]
    size_of_place: int
    change: np.ndarray[Any, Any] = np.zeros(0)

    def __new__(cls, value: Any) -> _Field:
        return np.array(value, dtype=np.float64).view(cls)

    def __call__(self, *arguments: Foreign) -> Foreign:
        places = [as_array(x).ravel() for x in arguments]
        found = next((x for x in places if x.size == self.size_of_place), None)
        if found is None and len(places) >= self.size_of_place:  # E(x, y, z)
            found = np.concatenate(places[: self.size_of_place])
        if found is not None:
            self.asked.append([float(x) for x in found])
        return np.array(self) + self.asked[-1][0] * self.change if self.change.size else np.array(self)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **named: Any) -> Any:
        plain = (np.asarray(x).view(np.ndarray) if isinstance(x, _Field) else x for x in inputs)
        return getattr(ufunc, method)(*plain, **named)
