"""The reading of steps in an electric and a magnetic field: rotation, kicks and drift, with controls elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from driftproof.blackbox.families.magnetic import Halves, MagneticReading
from driftproof.blackbox.families.rotations import BETWEEN_ANGLES, TURN_ANGLES, turn_of
from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes.scripted_answers import NotReadable, Rounding
from driftproof.blackbox.stepper.calling_conventions import CHARGES, ELECTRIC
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.turning import Push, Pushed, step_in_fields

# Axes of B whose lengths are whole numbers, two of them oblique: only |B| may count, and not its components.
_AXES = ((0.0, 0.0, 1.0), (1.0, 2.0, 2.0), (-6.0, 2.0, 3.0))
# Two step sizes with the same h B, and so with the same rotation.
_STEPS = (1.0, 0.25)
# The sizes of states and electric fields at which a step is made again, since it is linear in them.
_SIZES = (1.0, 2.0**-20, 2.0**20)
# An angle too small to turn anything, and one so small that codes may leave it out, though it turns by 2^28 u.
_STILL, _SLIGHT = 2.0**-60, 2.0**-24


def read_magnetic(subject: ForeignStepper) -> MagneticReading:
    """Read a step in an electric and a magnetic field, in space or else in the plane. Raises NotReadable."""
    try:
        probe = _Probe(subject, _AXES)
    except Misbehaviour:
        probe = _Probe(subject, None)
    return probe.reading()


class _Probe:
    """Steps in fields of ours, with B along these axes; without axes in the plane, with B across it."""

    def __init__(self, subject: ForeignStepper, axes: Sequence[Sequence[float]] | None) -> None:
        self.subject = subject
        self.rounding = Rounding(subject.format, 8)  # some 40 operations
        self.frames: list[Array] = [_frame(np.array(axis)) for axis in axes] if axes else [np.eye(2)]
        self.electric = ELECTRIC in subject.convention.order
        self.step(1.0)

    def step(
        self,
        angle: float,
        v: Array | None = None,
        e: Array | None = None,
        x: Array | None = None,
        axis: int = 0,
        h: float = 1.0,
        negative: bool = False,
    ) -> Pushed:
        """One step with h B = `angle` along an axis, of a negative charge if asked; arguments left out are 0."""
        frame, b, subject = self.frames[axis], angle / h, self.subject
        place, velocity, electric = ([0.0] * len(frame) if part is None else part.tolist() for part in (x, v, e))
        magnetic = (b * frame[2]).tolist() if len(frame) > 2 else [b]
        charged = subject.convention.scaled(CHARGES, -1.0) if negative else None
        subject = subject if charged is None else replace(subject, convention=charged)
        return step_in_fields(subject, Push(place, velocity, electric, magnetic, h))

    def reading(self) -> MagneticReading:
        """Read rotation, kicks and drift, and compare them with steps elsewhere."""
        one, affine, push = self.frames[0][0], False, 1.0
        self._require_linear(one)
        runs = [self.step(x, one) for x in TURN_ANGLES]
        factors = [self._across(run.v) for run in runs]
        kicks, kick, drift, uneven = [0j] * len(factors), None, None, ""
        pulls = [self.step(x, e=one) for x in TURN_ANGLES if self.electric]
        straight, still = self.step(_STILL, one), self.step(_STILL, e=one)
        if self.electric:
            kicks = [self._across(pull.v) for pull in pulls]
            kick = self._halves(factors, kicks)
            gains = [abs(x * k - (r - 1) / 1j) for x, r, k in zip(TURN_ANGLES, factors, kicks, strict=True)]
            affine, push = max(gains) <= self.rounding.of(8.0), self._across(still.v).real
        moved, lifted = ([self._across(run.x) for run in each if run.x] for each in (runs, pulls))
        if moved:
            law = self._halves(factors, moved)
            drift = None if law is None else law[::-1]
        by_field = zip(kicks, lifted, strict=False)
        if drift and any(abs(drift[1] * k - x) > self.rounding.of(8.0 * (1 + abs(k))) for k, x in by_field):
            drift, uneven = None, "with both fields, the position moves differently than without E"
        along = [self._across(run.x).real for run in (straight, still) if run.x]
        seen = (moved[1], (lifted or kicks)[1], along) if moved else None
        uneven = uneven or self._uneven(factors) or self._other_elsewhere(factors[1], kicks[1], push, seen)
        kept, flags = max(abs(abs(r) - 1) for r in factors), (self.electric, (moved, lifted) if moved else None)
        turn, asked = turn_of(factors, self.rounding), tuple(float(np.dot(place, one)) for place in straight.places)
        slight = self._across(self.step(_SLIGHT, one).v).imag
        if not uneven and abs(slight - turn.scale * _SLIGHT) > _SLIGHT / 64:  # of an angle, 64 is near enough
            uneven = f"the rotation is not a function of h B: it turns by {slight + 0:.3g} at h B = {_SLIGHT:.3g}"
        for x in BETWEEN_ANGLES:
            if not uneven and not turn.is_at(x, self._across(self.step(x, one).v)):
                uneven = f"the rotation is not a function of h B: at h B = {x:.3g} it does not turn as at larger ones"
        two = [self.step(1.0, one, one * self.electric, negative=negative) for negative in (False, True)]
        if not uneven and turn.scale == 1 and np.max(np.abs(np.subtract(two[0].v, two[1].v))) > self.rounding.of(8.0):
            uneven = "with a negative charge in fields that give the same forces, the step is another one"
        known = (turn, kick, affine, push, drift, *flags, asked, uneven, self._at_rest(one, push), kept)
        return MagneticReading(*known, self.rounding, flat=len(self.frames[0]) == 2)

    def _at_rest(self, one: Array, push: float) -> str:
        """What a step without B does to v, in words; "" if it adds to v what it adds in the slightest field."""
        for e in (0.0, 1.0 * self.electric):
            with np.errstate(all="ignore"):
                try:
                    seen = self.step(0.0, one, e * one).v
                except Misbehaviour as failure:
                    return f"with B = 0, {failure}"
            if not np.max(np.abs(np.array(seen) - (1 + e * push) * one)) <= self.rounding.of(4.0):
                also = f" and E = {e:g}" * bool(e)
                return f"with B = 0{also}, the velocity 1 becomes {self._across(seen).real:g}"
        return ""

    def _across(self, v: Sequence[float], axis: int = 0) -> complex:
        """The part of v across B as a complex number z, so that v x B is iz for |B| = 1."""
        one, other = self.frames[axis][:2]
        return complex(float(one @ np.array(v)), -float(other @ np.array(v)))

    def _vector(self, z: complex, axis: int) -> Array:
        one, other = self.frames[axis][:2]
        return np.array(z.real * one - z.imag * other)

    def _halves(self, factors: Sequence[complex], seen: Sequence[complex]) -> Halves | None:
        """The (k, l) for which k R + l was seen at every angle; None if there is none."""
        (r, s), allowed = (factors[1], seen[1]), self.rounding.of(16.0)
        k = s.imag / r.imag if abs(r.imag) > allowed else 0.0
        last = s.real - k * r.real
        pairs = zip(factors, seen, strict=True)
        return (k, last) if all(abs(k * r + last - s) <= allowed * (1 + abs(s)) for r, s in pairs) else None

    def _require_linear(self, one: Array) -> None:
        """Raise NotReadable if the step remembers, or is not linear in v, as a relativistic one."""
        first, second, again, rest = (self.step(0.5, k * one) for k in (1.0, -2.0, 1.0, 0.0))
        if max(map(abs, [*rest.v, *rest.x])) > 0:
            raise NotReadable("at rest at 0 and without an electric field, the step does not stay")
        if first.v != again.v:
            raise NotReadable("the same step taken twice gives different results")
        if max(abs(y + 2 * x) for x, y in zip(first.v, second.v, strict=True)) > self.rounding.of(8.0):
            raise NotReadable("doubling the velocity does not double the new velocity: relativistic, or limited")

    def _uneven(self, factors: Sequence[complex]) -> str:
        """What shows that it is no rotation about B by an angle that depends on h |B| alone; "" if nothing does."""
        for axis, h in product(range(len(self.frames)), _STEPS):
            for x, r in zip(TURN_ANGLES[1:4], factors[1:4], strict=True):
                turned = [self._vector(r, axis), self._vector(-1j * r, axis), *self.frames[axis][2:]]
                for unit, said in zip(self.frames[axis], turned, strict=True):
                    seen = np.array(self.step(x, unit, axis=axis, h=h).v)
                    if np.max(np.abs(seen - said)) <= self.rounding.of(8.0 * (1 + abs(r))):
                        continue
                    if h != _STEPS[0]:
                        return f"the rotation is not a function of h B: at h B = {x:g}, h = {h:g} and h = 1 differ"
                    b, size = ", ".join(f"{y:g}" for y in _AXES[axis]), float(np.linalg.norm(seen))
                    many = f"for B along ({b}) and h B = {x:g}, |v| is multiplied by {size:.6g}"
                    return f"the rotation depends on the direction of B: {many}"
        return ""

    def _other_elsewhere(
        self, r: complex, kick: complex, push: float, moved: tuple[complex, complex, Sequence[float]] | None
    ) -> str:
        """What shows that a step elsewhere, with both fields oblique, is not made of what was read; "" if it is."""
        axis, h, allowed = len(self.frames) - 1, 0.5, self.rounding.of(32.0)
        frame = self.frames[axis]
        along = frame[2:].sum(axis=0)
        x, v, e = frame[0] - 3 * along, frame[0] - 2 * frame[1] + along, (frame[1] - 2 * along) * self.electric
        said = self._vector(r * self._across(v, axis) + h * kick * self._across(e, axis), axis)
        said = said + along * float(along @ (v + h * push * e))
        for size in _SIZES:
            seen = self.step(TURN_ANGLES[1], size * v, size * e, size * x, axis, h)
            if np.max(np.abs(said - np.array(seen.v) / size)) > allowed:
                return "with both fields, and at other states, the step is not made of these kicks and this rotation"
            if not moved:
                continue
            by_v, by_e, (along_v, along_e) = moved
            across = h * by_v * self._across(v, axis) + h**2 * by_e * self._across(e, axis)
            there = x + self._vector(across, axis) + along * float(along @ (h * along_v * v + h**2 * along_e * e))
            if np.max(np.abs(there - np.array(seen.x) / size)) > allowed:
                return "with both fields, and at other states, the position moves in another way"
        return ""


def _frame(axis: Array) -> Array:
    """Two unit vectors across an axis and the one along it, right-handed: e1 x e2 = axis."""
    along = axis / np.linalg.norm(axis)
    one = np.cross(np.eye(3)[int(np.argmin(np.abs(along)))], along)
    one = one / np.linalg.norm(one)
    return np.array([one, np.cross(along, one), along])
