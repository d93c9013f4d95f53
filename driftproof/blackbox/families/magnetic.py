"""A step of a velocity in an electric and a magnetic field: Boris' step and its kin, by rotation, kicks and drifts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from driftproof.blackbox.families.rotations import TURN_ANGLES, Turn, factors_of, turn_of
from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.probes.scripted_answers import NotReadable, Rounding
from driftproof.blackbox.report import Criterion
from driftproof.blackbox.stepper.calling_conventions import ELECTRIC
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.turning import Push, Pushed, step_in_fields
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.support.plain_text import Json

# Oblique axes of B with numbers that are exact, so that the length of B counts, and not its components.
_AXES = ((0.0, 0.0, 1.0), (1.0, 2.0, 2.0), (-6.0, 2.0, 3.0))
# Two factors of h at one h B, and times at which nothing may change.
_STEPS = (1.0, 0.25)
# Both parts of a drift, or of a kick: before the rotation, or with the old velocity; and after it.
_Halves = tuple[float, float]
_ALL = "x' = v, v' = E + v x B"
_WHOLE = "the electric field enters as in one method for the whole of v' = E + v x B"
_LEAPFROG, _BOTH_HALVES, _AHEAD = (0.0, 1.0), (0.5, 0.5), (1.0, 0.0)
# Where leapfrogs ask for the fields, in units of h v from x, by their drift; and at which times v and x are.
_TIMES: Mapping[_Halves, tuple[float, str]] = {
    _LEAPFROG: (0.0, "v stands half a step behind x"),
    _BOTH_HALVES: (0.5, "half a drift on either side of the push: x and v are at one time"),
    _AHEAD: (1.0, "v stands half a step ahead of x"),
}
# What a user may call it.
BORIS_NAMES = ("boris", "boris push", "boris pusher", "boris step")


@dataclass(frozen=True)
class Boris:
    """Boris' step, to which a stepper is held: half kicks about a rotation by 2 atan(h B/2), and a leapfrog's drift."""

    key: str = "boris"


@dataclass(frozen=True)
class MagneticReading:
    """v1 = R v + h (k R + l) E, and x1 = x + h (m v + n v1): R a rotation about B, by the name of `turn`.

    `kick` is (k, l), None where there is no E, or another law; `affine` is true where the kick is (R - 1)/z, as of one
    method for the whole of v' = E + v x B, `electric` where there is an E. `push` is what a step without B gives, as
    part of h E. `drift` is (m, n), None where there is no x, or another law; of a step with an x, `moved` is what v and
    what E move it by, as factors of h v and h² E at TURN_ANGLES. `asked` is c where E or B is called at x + c h v.
    `uneven` tells a rotation that depends on more than h B, `at_rest` what goes wrong where B is 0; `kept` is by how
    much |v| was seen to change without E.
    """

    turn: Turn
    kick: _Halves | None
    affine: bool
    push: float
    drift: _Halves | None
    electric: bool
    moved: tuple[Sequence[complex], Sequence[complex]] | None
    asked: float | None
    uneven: str
    at_rest: str
    kept: float
    rounding: Rounding

    @property
    def faults(self) -> list[str]:
        """What is wrong with it, whichever method it is meant to be."""
        found = [*filter(None, [self.uneven, self.at_rest])]
        turn, growth = self.turn, self.turn.growth
        if turn.scale < 0:
            found.append("it turns the other way: by B x v, not by v x B")
        if abs(abs(turn.scale) - 1) > TURN_ANGLES[-1]:
            hint = ": of Boris' step, as with t = h B in place of h B/2" if turn.times == 2 else ""
            found.append(f"{turn.lines('h B')[0]}{hint}")
        if growth is not None and not self.affine and not self.uneven:
            hint = ", as in Boris' step without 1/(1 + t^2)" if turn.method == "midpoint2" else ""
            found.append(f"|v| is not kept without an electric field{hint}: {turn.lines('h B')[1]}")
        if abs(self.push - 1) > self.rounding.of(4.0):
            half = ": one of two half kicks is missing" if abs(self.push - 0.5) < self.rounding.of(4.0) else ""
            found.append(f"without B the electric field gives h E times {self._text(self.push)}{half}")
        if self.drift is not None and abs(sum(self.drift) - 1) > self.rounding.of(4.0):
            found.append(f"without fields the position moves by {self._text(sum(self.drift))} h v")
        elif self._is(self.drift, (1.0, 0.0)) and not self.asked and (self.boris or not self.affine):
            found.append("the position moves with the old velocity: no leapfrog, with fields at the old position")
        elif self.boris and self.asked is not None and self._leapfrog and not self._near(self.asked, self._leapfrog[0]):
            found.append(
                f"the fields are asked at {self._place(self.asked)}, not at {self._place(self._leapfrog[0])}: order 1"
            )
        elif self.affine and self.moved and not self._staggered and not self._of_one_method(self.turn.factors):
            found.append(f"the position moves otherwise than in one method for the whole of {_ALL}")
        return found

    @property
    def _leapfrog(self) -> tuple[float, str] | None:
        """Where the fields belong, and the times of v and x, of a drift of the leapfrogs."""
        return next((times for said, times in _TIMES.items() if self._is(self.drift, said)), None)

    @property
    def _staggered(self) -> bool:
        """Whether x and v are half a step apart."""
        return self._is(self.drift, _LEAPFROG) or (self._is(self.drift, _AHEAD) and bool(self.asked))

    def _of_one_method(self, factors: Sequence[complex], pulled: Sequence[complex] | None = None) -> bool:
        """Whether x moves by (R - 1)/z h v with the R given, and by what is `pulled` of h² E, or ((R - 1)/z - 1)/z."""
        assert self.moved is not None
        said = [(r - 1) / (1j * x) for x, r in zip(TURN_ANGLES, factors, strict=True)]
        pulled = pulled or [(d - 1) / (1j * x) for x, d in zip(TURN_ANGLES, said, strict=True)]
        allowed = [self.rounding.of(8.0 * (1 + abs(d))) / x**2 for x, d in zip(TURN_ANGLES, said, strict=True)]
        rows = [(self.moved[0], said), *([(self.moved[1], pulled)] if self.electric else [])]
        return all(abs(m - d) <= a for mine, its in rows for m, d, a in zip(mine, its, allowed, strict=True))

    @property
    def boris(self) -> bool:
        """True where rotation and kicks are those of Boris' step."""
        return self.turn.known and self.turn.name == "implicit_midpoint" and self._is(self.kick, _BOTH_HALVES)

    @property
    def key(self) -> str | None:
        """What it can be held to as it stands."""
        return "boris" if self.boris and not self.faults else None

    @property
    def verdict(self) -> str:
        """What it is, in one line."""
        staggered = self._leapfrog[1] if self._leapfrog and self._staggered else ""
        if self.uneven:
            name = "no step that is known here"
        elif self.boris:
            name = "boris"
        elif self.turn.known and self.affine:
            name = f"{self.turn.name} of v' = E + v x B"
        elif self.turn.known and self._is(self.kick, _BOTH_HALVES):
            name = f"boris but for its rotation, which is {self.turn.name}"
        elif self._is(self.kick, _BOTH_HALVES) or self.turn.method:
            known = self.turn.known and self.turn.name == "implicit_midpoint"
            name = f"{'the rotation of boris' if known else f'a rotation by {self.turn.name}'}{self._kicks}"
        else:
            name = "no step that is known here"
        unknown = "the position moves by another law" if self.moved and not self.drift and not self.affine else ""
        return "; ".join([f"it is {name}", *filter(None, [staggered, unknown]), *self.faults])

    @property
    def _kicks(self) -> str:
        """Where they are no half kicks."""
        if not self.electric or self._is(self.kick, _BOTH_HALVES) or self.faults:
            return ""
        whole = {(1.0, 0.0): "the whole kick before it", (0.0, 1.0): "the whole kick after it"}
        return f", with {next((words for said, words in whole.items() if self._is(self.kick, said)), 'other kicks')}"

    @property
    def parts(self) -> list[tuple[str, list[str]]]:
        """The evidence, by title."""
        turn = self.turn.lines("h B")
        kept = turn[1] if self.turn.growth else f"|v| is kept in steps with E = 0: off by {self.kept:.1e} at most"
        area = ["areas across B, and so volumes of velocities, are kept"] if self.turn.growth is None else []
        kick, drift, where = self.kick, self.drift, "for B along (0, 0, 1), " if self.uneven else ""
        kicks = [] if kick is None else [f"kick {self._text(kick[0])} h E, rotation, kick {self._text(kick[1])} h E"]
        if self._is(kick, (1.0, 0.0), (0.0, 1.0)) and not self.affine:
            kicks.append("order 1 where both fields act: a half kick on either side of the rotation has order 2")
        if self.affine and not self.boris:
            kicks = [_WHOLE]
        moved = [] if drift is None else [f"x1 = x + {self._drift}"]
        if self._leapfrog and self._staggered:
            moved.append(f"{self._leapfrog[1]}: as a step from x and v at one time it has order 1")
        moved += [] if self.asked is None else [f"the fields are asked at {self._place(self.asked)}"]
        return [
            ("Rotation", [f"{where}{self.turn.name}: {turn[0]}", kept, *area]),
            ("Kicks", kicks),
            ("Position", moved),
        ]

    @property
    def data(self) -> dict[str, Json]:
        """The same for programs."""
        order = self.turn.order
        return {
            "method": "boris" if self.boris and not self.faults else None,
            "rotation": self.turn.name,
            "rotation_order": order,
            "kick": None if self.kick is None else [repr(x) for x in self.kick],
            "drift": None if self.drift is None else [repr(x) for x in self.drift],
        }

    def criteria(self, method: object) -> list[Criterion]:
        """In constant fields: its rotation, how E enters, how x moves; and where the fields are asked for."""
        if isinstance(method, Boris):
            halves = self._is(self.kick, _BOTH_HALVES)
            words = (
                ("half a kick of E on either side of the rotation",) if halves else ("E does not enter by half kicks",)
            )
            place, moved = self._leapfrog or (0.0, "the position moves by no drift of a leapfrog")
            drift = (self._staggered or self._is(self.drift, _BOTH_HALVES)) and self._near(
                place if self.asked is None else self.asked, place
            )
            rotation = self.turn.held_to(METHODS["implicit_midpoint"])
        else:
            whole = "E enters otherwise than in one method for the whole of v' = E + v x B"
            halves, words = self.affine, (_WHOLE if self.affine else whole,)
            drift, moved = self._moved_as(method)
            rotation = self.turn.held_to(method)
        kicks = (halves or not self.electric) and not self.faults
        lines = tuple(self.faults) or (words if self.electric else ("it takes no electric field",))
        checks = [rotation, Criterion("Electric field", kicks, lines, {})]
        return [*checks, Criterion("Position", drift if self.moved else None, (moved,), {})]

    def _moved_as(self, method: object) -> tuple[bool, str]:
        """Whether the position moves as in a Runge-Kutta method for the whole, and in words."""
        if self.moved is None or not isinstance(method, RungeKutta | Collocation):
            return False, "it moves no position"
        factors, pulled = zip(*(factors_of(method, 1j * x) for x in TURN_ANGLES), strict=True)
        same = self._of_one_method(factors, pulled)
        law = "by another law" if self.drift is None else f"by {self._drift}"
        said = f"as in {method.key} for the whole of {_ALL}"
        return same, f"the position moves {said}" if same else f"the position moves {law}, not {said}"

    @property
    def _drift(self) -> str:
        """The position's part of the step."""
        parts = [
            f"{self._text(x)} {v}".removeprefix("1 ") for x, v in zip(self.drift or (), ("v", "v1"), strict=False) if x
        ]
        return f"h ({' + '.join(parts)})" if len(parts) > 1 else f"h {''.join(parts)}"

    def _text(self, x: float) -> str:
        return coefficient_text(x, self.rounding.format, self.rounding.of(4.0))

    def _place(self, node: float) -> str:
        return f"x + {self._text(node)} h v".replace(" 1 h", " h") if node else "x"

    def _near(self, x: float, y: float) -> bool:
        return abs(x - y) <= self.rounding.of(4.0)

    def _is(self, halves: _Halves | None, *said: _Halves) -> bool:
        return halves is not None and any(all(map(self._near, halves, each)) for each in said)


def read_magnetic(subject: ForeignStepper) -> MagneticReading:
    """What a step in an electric and a magnetic field is, in space or else in the plane. Raises NotReadable."""
    try:
        probe = _Probe(subject, _AXES)
    except Misbehaviour:
        probe = _Probe(subject, None)
    return probe.reading()


class _Probe:
    """Steps in fields of ours; without axes in the plane, across which B points."""

    def __init__(self, subject: ForeignStepper, axes: Sequence[Sequence[float]] | None) -> None:
        self.subject = subject
        self.rounding = Rounding(subject.format, 8)  # some 40 operations
        self.frames: list[Array] = [_frame(np.array(axis)) for axis in axes] if axes else [np.eye(2)]
        self.electric = ELECTRIC in subject.convention.order
        self.step(1.0, self.frames[0][0])

    def step(
        self,
        angle: float,
        v: Array | None = None,
        e: Array | None = None,
        x: Array | None = None,
        axis: int = 0,
        h: float = 1.0,
    ) -> Pushed:
        """One step with h B of this size along an axis; what is not given is 0."""
        frame, b = self.frames[axis], angle / h
        place, velocity, electric = ([0.0] * len(frame) if part is None else part.tolist() for part in (x, v, e))
        magnetic = (b * frame[2]).tolist() if len(frame) > 2 else [b]
        return step_in_fields(self.subject, Push(place, velocity, electric, magnetic, h))

    def reading(self) -> MagneticReading:
        """Rotation, kicks and drift, controlled."""
        one, affine, push, asked = self.frames[0][0], False, 1.0, None
        self._demand_linear(one)
        runs = [self.step(x, one) for x in TURN_ANGLES]
        factors = [self._across(run.v) for run in runs]
        kicks, kick, drift, uneven = [1.0 + 0j] * len(factors), None, None, ""
        pulls, still = [self.step(x, e=one) for x in TURN_ANGLES if self.electric], self.step(2.0**-60, e=one)
        if self.electric:
            kicks = [self._across(pull.v) for pull in pulls]
            kick = self._halves(factors, kicks)
            gains = [abs(x * k - (r - 1) / 1j) for x, r, k in zip(TURN_ANGLES, factors, kicks, strict=True)]
            affine, push = max(gains) <= self.rounding.of(8.0), self._across(still.v).real
        moved, lifted = ([self._across(run.x) for run in each if run.x is not None] for each in (runs, pulls))
        if moved:
            law = self._halves(factors, moved)
            drift = None if law is None else law[::-1]
            places = runs[0].places
            asked = float(np.dot(places[0], one)) if places else None
        rise = self._across(still.x).real if self.electric and still.x is not None else 0.0
        by_field = zip(kicks, lifted, strict=False) if drift else ()
        if drift and any(abs(drift[1] * k - x) > self.rounding.of(8.0 * (1 + abs(k))) for k, x in by_field):
            drift, uneven = None, "with both fields, the position moves in another way than without E"
        seen = (moved[1] if moved else 0j, lifted[1] if lifted else 0j, rise)
        uneven = uneven or self._uneven(factors) or self._other_elsewhere(factors[1], kicks[1], push, seen)
        kept, flags = max(abs(abs(r) - 1) for r in factors), (self.electric, (moved, lifted) if moved else None)
        turn = turn_of(factors, self.rounding)
        at_rest = self._at_rest(one)
        return MagneticReading(turn, kick, affine, push, drift, *flags, asked, uneven, at_rest, kept, self.rounding)

    def _at_rest(self, one: Array) -> str:
        """What a step without fields does to v where it does not leave it as it is."""
        with np.errstate(all="ignore"):
            try:
                seen = self.step(0.0, one).v
            except Misbehaviour as failure:
                return f"with B = 0, {failure}"
        moved = not np.max(np.abs(np.array(seen) - one)) <= self.rounding.of(4.0)
        return f"with B = 0, the velocity 1 becomes {self._across(seen).real:g}" if moved else ""

    def _across(self, v: Sequence[float], axis: int = 0) -> complex:
        """The part across B, as a number of which v x B is i times, with B = 1."""
        one, other = self.frames[axis][:2]
        return complex(float(one @ np.array(v)), -float(other @ np.array(v)))

    def _vector(self, z: complex, axis: int) -> Array:
        one, other = self.frames[axis][:2]
        return np.array(z.real * one - z.imag * other)

    def _halves(self, factors: Sequence[complex], seen: Sequence[complex]) -> _Halves | None:
        """(k, l) where what was seen is k R + l at every angle."""
        (r, s), allowed = (factors[1], seen[1]), self.rounding.of(16.0)
        k = s.imag / r.imag if abs(r.imag) > allowed else 0.0
        last = s.real - k * r.real
        pairs = zip(factors, seen, strict=True)
        return (k, last) if all(abs(k * r + last - s) <= allowed * (1 + abs(s)) for r, s in pairs) else None

    def _demand_linear(self, one: Array) -> None:
        """Raises NotReadable if it remembers, or is not linear in v, as a relativistic one."""
        first, second, again, rest = (self.step(0.5, k * one) for k in (1.0, -2.0, 1.0, 0.0))
        if max(map(abs, [*rest.v, *(rest.x or ())])) > 0:
            raise NotReadable("at rest at 0 and without an electric field, the step does not stay")
        if first.v != again.v:
            raise NotReadable("the same step taken twice is not the same")
        if max(abs(y + 2 * x) for x, y in zip(first.v, second.v, strict=True)) > self.rounding.of(8.0):
            raise NotReadable("twice the velocity does not become twice the new velocity: relativistic, or limited")

    def _uneven(self, factors: Sequence[complex]) -> str:
        """What shows that it is no rotation about B by an angle that depends on h |B| alone."""
        for axis, h in product(range(len(self.frames)), _STEPS):
            for x, r in zip(TURN_ANGLES[1:4], factors[1:4], strict=True):
                turned = [self._vector(r, axis), self._vector(-1j * r, axis), *self.frames[axis][2:]]
                for unit, said in zip(self.frames[axis], turned, strict=True):
                    seen = np.array(self.step(x, unit, axis=axis, h=h).v)
                    if np.max(np.abs(seen - said)) <= self.rounding.of(8.0 * (1 + abs(r))):
                        continue
                    if h != _STEPS[0]:
                        return f"the rotation is not one by h B: with h B = {x:g} it is another for h = {h:g} and h = 1"
                    b, size = ", ".join(f"{y:g}" for y in _AXES[axis]), float(np.linalg.norm(seen))
                    many = f"for B along ({b}) and h B = {x:g}, |v| is multiplied by {size:.6g}"
                    return f"the rotation depends on the direction of B: {many}"
        return ""

    def _other_elsewhere(self, r: complex, kick: complex, push: float, moved: tuple[complex, complex, float]) -> str:
        """What shows that a step from any x, with both fields in any direction, is not made of what was read."""
        axis, h, angle = len(self.frames) - 1, 0.5, TURN_ANGLES[1]
        frame = self.frames[axis]
        along = frame[2:].sum(axis=0)
        x, v, e = frame[0] - 3 * along, frame[0] - 2 * frame[1] + along, (frame[1] - 2 * along) * self.electric
        seen = self.step(angle, v, e, x, axis, h)
        said = self._vector(r * self._across(v, axis) + h * kick * self._across(e, axis), axis)
        said = said + along * float(along @ (v + h * push * e))
        if np.max(np.abs(said - seen.v)) > self.rounding.of(32.0):
            return "with both fields, and elsewhere, the step is not made of these kicks and this rotation"
        if seen.x is not None:
            across = h * moved[0] * self._across(v, axis) + h**2 * moved[1] * self._across(e, axis)
            there = x + self._vector(across, axis) + along * float(along @ (h * v + h**2 * moved[2] * e))
            if np.max(np.abs(there - seen.x)) > self.rounding.of(32.0):
                return "with both fields, and elsewhere, the position moves in another way"
        return ""


def _frame(axis: Array) -> Array:
    """Two unit vectors across an axis and the one along it, right-handed: e1 x e2 = axis."""
    along = axis / np.linalg.norm(axis)
    one = np.cross(np.eye(3)[int(np.argmin(np.abs(along)))], along)
    one = one / np.linalg.norm(one)
    return np.array([one, np.cross(along, one), along])
