"""Plain float steppers of a method in three calling conventions and two styles, with one bug at one place or none."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction as Q
from typing import Any, TypeAlias

import numpy as np

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method, Nystrom, RungeKutta, Splitting

Slope: TypeAlias = list[Any]
Rates: TypeAlias = Callable[[Any, list[Any]], Slope]
Step: TypeAlias = Callable[[Rates, Any, list[Any], Any], list[Any]]
Lift: TypeAlias = Callable[[Any], Any]
# A coefficient: its name and its indices.
Place: TypeAlias = tuple[str, tuple[int, ...]]


@dataclass(frozen=True)
class Bug:
    """What is planted: the kind, the method and calling convention, where and which `variant`.

    `method` is the one that the stepper computes with: the changed one, where the kind is a change of coefficients;
    `places` are then those of the changed ones.
    """

    kind: str
    key: str
    calls: str
    method: Method
    at: int = -1
    component: int = -1
    variant: str = ""
    places: tuple[Place, ...] = ()

    @property
    def mended(self) -> Bug:
        """The right stepper, written in the same style."""
        return Bug(self.style, self.key, self.calls, METHODS[self.key])

    @property
    def words(self) -> str:
        """Where it is, in words."""
        place = ", ".join(self.entries).replace("\\", "").replace(": ", "")
        at = f"update {self.at}" if self.at >= 0 else place
        more = [self.variant, f"component {self.component}" if self.component >= 0 else ""]
        return ", ".join(word for word in (f"{self.key} as {self.calls}", at, *more) if word)

    @property
    def entries(self) -> list[str]:
        """Patterns of the changed coefficients as a report names them: a[1][0], b[2], kick 2."""
        found = []
        for name, indices in self.places:
            shown = "".join(f"[{i}]" for i in indices)
            if isinstance(self.method, Splitting):
                name, shown = self.method.parts[indices[0]][0], f" {indices[0]}"
            found.append(rf"\b{re.escape(name + shown)}: ")
        return found

    @property
    def style(self) -> str:
        """The style: slopes taken component by component, or all at once."""
        return "in turn" if self.kind in ("order of updates", "in turn") else "at once"

    def planted(self, kind: str, at: int) -> bool:
        """Whether this is planted at this place."""
        return self.kind == kind and self.at == at

    def length(self, at: int, h: Any) -> Any:
        """The factor h, or what stands for it at this place."""
        if not self.planted("missing factor", at):
            return h
        return h * h if self.variant == "h twice" else 1

    def left(self, at: int, new: list[Any], old: Sequence[Any]) -> list[Any]:
        """The new numbers, one of which keeps its old value if that is planted at this place."""
        if not self.planted("component left out", at):
            return new
        return [old[m] if m == self.component else x for m, x in enumerate(new)]

    def time(self, at: int, t: Any, c: Any, h: Any) -> Any:
        """The time t + c h, or what stands for it at this place."""
        if not self.planted("time", at):
            return t + c * h
        return {"t": t, "t + c": t + c, "t + c h**2": t + c * h * h, "t + h": t + h, "c h": c * h}[self.variant]


def _sum(weights: Sequence[Any], slopes: Sequence[Sequence[Any]], m: int) -> Any:
    """Σ wⱼ kⱼ of component m, from the left, without those that are zero."""
    return sum(w * k[m] for w, k in zip(weights, slopes, strict=False) if w)


def _runge_kutta(method: RungeKutta, bug: Bug, lift: Lift) -> Step:
    (b, c), a = [[lift(x) for x in row] for row in (method.b, method.c)], [[lift(x) for x in row] for row in method.a]
    kept: list[Slope] = []

    def step(rates: Rates, t: Any, y: list[Any], h: Any) -> list[Any]:
        slopes: list[Slope] = []
        base = y
        for i, row in enumerate(a):
            place = bug.left(i, [x + bug.length(i, h) * _sum(row, slopes, m) for m, x in enumerate(base)], y)
            time = bug.time(i, t, c[i], h)
            if bug.planted("stage reuse", i):
                slope = slopes[-1]
            elif bug.style == "in turn":
                slope = []
                for m in range(len(y)):
                    slope.append(rates(time, place)[m])
                    if bug.planted("order of updates", i):
                        place[m] = place[m] + h * b[i] * slope[m]
            else:
                slope = rates(time, place)
            slopes.append(_stale(kept, slope) if bug.planted("stale force", i) else slope)
            if bug.planted("state overwritten", i):
                base = [x + h * b[i] * k for x, k in zip(y, slope, strict=True)]
        return bug.left(len(b), [x + bug.length(len(b), h) * _sum(b, slopes, m) for m, x in enumerate(y)], y)

    return step


def _splitting(method: Splitting, bug: Bug, lift: Lift) -> Step:
    parts = [(kind, lift(c)) for kind, c in method.parts]
    kept: list[Slope] = []

    def step(rates: Rates, t: Any, y: list[Any], h: Any) -> list[Any]:
        half, drifted, forces = len(y) // 2, lift(Q(0)), []
        q, v = list(y[:half]), list(y[half:])
        for i, (kind, c) in enumerate(parts):
            length = bug.length(i, h)
            if kind == "kick":
                if not bug.planted("stage reuse", i):
                    forces = rates(bug.time(i, t, drifted, h), [*q, *v])[half:]
                forces = _stale(kept, forces) if bug.planted("stale force", i) else forces
            old, slope = (v, forces) if kind == "kick" else (q, v)
            new = bug.left(i, [x + c * length * k for x, k in zip(old, slope, strict=True)], old)
            if kind == "kick":
                v = new
            else:
                q, drifted = new, drifted + c
        return [*q, *v]

    return step


def _nystrom(method: Nystrom, bug: Bug, lift: Lift) -> Step:
    a, s = [[lift(x) for x in row] for row in method.a], method.stages
    c, b_q, b_v = ([lift(x) for x in row] for row in (method.c, method.b_position, method.b_velocity))
    kept: list[Slope] = []

    def step(rates: Rates, t: Any, y: list[Any], h: Any) -> list[Any]:
        half, forces = len(y) // 2, list[Slope]()
        q, v = list(y[:half]), list(y[half:])
        base = q
        for i, row in enumerate(a):
            pushes = [h * bug.length(i, h) * _sum(row, forces, m) for m in range(half)]
            place = bug.left(i, [x + c[i] * h * w + push for x, w, push in zip(base, v, pushes, strict=True)], q)
            reused = bug.planted("stage reuse", i)
            slope = forces[-1] if reused else rates(bug.time(i, t, c[i], h), [*place, *v])[half:]
            forces.append(_stale(kept, slope) if bug.planted("stale force", i) else slope)
            if bug.planted("state overwritten", i):
                base = [x + h * h * b_q[i] * k for x, k in zip(q, slope, strict=True)]
        moved = [w + bug.length(s, h) * _sum(b_v, forces, m) for m, w in enumerate(v)]
        speeds = moved if bug.planted("order of updates", s) else v
        end = [x + h * w + h * h * _sum(b_q, forces, m) for m, (x, w) in enumerate(zip(q, speeds, strict=True))]
        return [*bug.left(s, end, q), *moved]

    return step


def _stale(kept: list[Slope], slope: Slope) -> Slope:
    """The slope of the step before, of the first step its own; this one is kept."""
    kept.append(slope)
    return kept.pop(0) if len(kept) > 1 else slope


def core(bug: Bug, lift: Lift = float) -> Step:
    """step(rates, t, y, h) with coefficients in the numbers that `lift` makes, with the bug."""
    makers = {RungeKutta: _runge_kutta, Splitting: _splitting, Nystrom: _nystrom}
    return makers[type(bug.method)](bug.method, bug, lift)


# What is wrong somewhere only, as a rule about times, as a change of the end, or as what a step that goes on remembers.
TIMES: dict[str, Callable[[float, float], float]] = {
    "times in binary32": lambda at, t: float(np.float32(at)),
    "the clock stands at t = 10": lambda at, t: min(at, 10.0),
    "no sign of t": lambda at, t: abs(at),
    "times of 20 bits": lambda at, t: t + round((at - t) * 2**20) / 2**20,
    "backward with forward times": lambda at, t: t + abs(at - t),
}
ENDS: dict[str, Callable[[list[Any], Sequence[Any]], list[Any]]] = {
    "numbers from the sixth on stay": lambda end, y: [*end[:5], *y[5:]] if len(y) > 5 else end,
    "of ten numbers the last stays": lambda end, y: [*end[:-1], y[-1]] if len(y) >= 10 else end,
}
GOES_ON = "the slope of the step before, where it goes on from it"
ELSEWHERE = (*TIMES, *ENDS, GOES_ON)


def _wrong_elsewhere(bug: Bug, inner: Step) -> Step:
    """The step, wrong in the bug's way and right where that is not met."""
    last: dict[str, Any] = {}

    def step(rates: Rates, t: Any, y: list[Any], h: Any) -> list[Any]:
        asked = list[Slope]()

        def slopes(at: Any, z: list[Any]) -> Slope:
            kept = bug.variant == GOES_ON and not asked and last.get("end") == list(y)
            asked.append(last["slope"] if kept else rates(TIMES.get(bug.variant, lambda at, t: at)(at, t), z))
            return asked[-1]

        end = ENDS.get(bug.variant, lambda end, y: end)(inner(slopes, t, list(y), h), y)
        last.update(end=list(end), slope=asked[0])
        return end

    return step


def stepper(bug: Bug) -> Callable[..., Any]:
    """The same as somebody writes it, in the bug's calling convention."""
    inner = _wrong_elsewhere(bug, core(bug)) if bug.kind == "elsewhere" else core(bug)

    def map_step(q: Any, v: Any, h: Any) -> tuple[Any, Any]:
        q, v = inner(lambda t, y: [y[1], -y[0]], 0.0, [q, v], h)
        return q, v

    def force_step(force: Callable[[Any], Any], q: Any, v: Any, h: Any) -> tuple[Any, Any]:
        q, v = inner(lambda t, y: [y[1], force(y[0])], 0.0, [q, v], h)
        return q, v

    def field_step(f: Callable[..., Any], t: Any, y: Any, h: Any) -> list[Any]:
        if len(y) % 2 and not isinstance(bug.method, RungeKutta):
            raise ValueError("y is positions, then as many velocities")
        return inner(lambda t, y: list(f(t, np.array(y))), t, list(y), h)

    return {"map": map_step, "force": force_step, "field": field_step}[bug.calls]
