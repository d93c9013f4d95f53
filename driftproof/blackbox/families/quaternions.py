"""Steps of a quaternion at an angular velocity: the factor 1/2, the length, the order, and which product is taken."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from driftproof.blackbox.families.rotations import BETWEEN_ANGLES, TURN_ANGLES, Turn, turn_of
from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.matching.tables import Array, exact_tableau
from driftproof.blackbox.probes.scripted_answers import NotReadable, Rounding
from driftproof.blackbox.report import Criterion
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.turning import Course, turn_quaternion
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.support.plain_text import Json

# Two unit vectors, exact to one rounding, with no two components alike: a step must not prefer one.
_AXES = (np.array([2.0, 3.0, 6.0]) / 7, np.array([-6.0, 2.0, 3.0]) / 7)
# The relative error allowed in a rate that is read from a short step, which errs by O(h) and by u/h.
_NEAR = 2.0**-6
_MISTIMED = "where omega depends on t, it is no step of {} nor of another known method, as with other stage times"
# Where omega is a function of t, a step of 1 begins here.
_LATER = 0.5
# So small that codes may leave it out, though it turns by 2^28 u.
_SLIGHT = 2.0**-24


# The products with omega that a rate may be: whether q is the first factor, and whether its scalar is its last number.
_PRODUCTS: Mapping[str, tuple[bool, bool]] = {
    "q omega (scalar first)": (True, False),
    "omega q (scalar first)": (False, False),
    "q omega (scalar last)": (True, True),
    "omega q (scalar last)": (False, True),
}


def _matrix(omega: Array, product: str) -> Array:
    """The matrix that takes q to its product with omega."""
    (x, y, z), (first, last) = omega, _PRODUCTS[product]
    sign = 1 if first else -1
    rows = [[0, -x, -y, -z], [x, 0, sign * z, -sign * y], [y, -sign * z, 0, sign * x], [z, sign * y, -sign * x, 0]]
    place = [1, 2, 3, 0] if last else [0, 1, 2, 3]
    return np.array(rows, dtype=np.float64)[np.ix_(place, place)]


@dataclass(frozen=True)
class QuaternionReading:
    """The step a + b G, where G is the matrix of a `product` with omega/|omega|; `turn` is a + ib at h |omega|/2.

    `product` is "" if the rate is no product. `normalised` is true if the result always has length 1. `uneven` says in
    words what else the step depends on, `at_rest` that it moves with omega = 0. `driven` is the step where omega is a
    function of t, if it may be one, and `mistimed` says that this is a step of no known method.
    """

    product: str
    turn: Turn
    normalised: bool
    uneven: str
    at_rest: str = ""
    driven: tuple[tuple[float, ...], ...] = ()
    mistimed: str = ""

    @property
    def faults(self) -> list[str]:
        """The faults, whatever method it is meant to be."""
        return [*self._of_rate, *filter(None, [self.mistimed])]

    @property
    def _of_rate(self) -> list[str]:
        found, scale = [*filter(None, [self.uneven, self.at_rest])], self.turn.scale
        if not self.uneven and scale != 1:
            half = {2.0: ": the factor 1/2 is missing", 0.5: ": the factor 1/2 appears twice"}.get(scale, "")
            found.append(f"it turns {scale:.4g} times as fast as omega{half}")
        return found

    @property
    def key(self) -> str | None:
        """The catalogue key of the method, if there is one and it has no fault; else None."""
        known = self.turn.known and not self.turn.normalised and self.turn.parts == 1 and self.turn.method != "exact"
        return self.turn.method if known and not self.faults else None

    @property
    def named(self) -> bool:
        """True if the verdict names a method, exactly or nearly."""
        return bool(self.product and self.turn.method)

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        if not self.product:
            return f"it is not a known quaternion step; {self.uneven}"
        rate = f"q' = {self.product.replace(' (', '/2 (')}"
        name = {"exact": "the exact rotation"}.get(self.turn.name, self.turn.name)
        name += "," * self.turn.normalised
        order = self.turn.order
        measured = f", of order {order}" if order and not self.turn.known else ""
        rate += ", omega constant" * (not self.driven)
        return "; ".join([f"it is {name} of {rate}{measured}", *self.faults])

    @property
    def parts(self) -> list[tuple[str, list[str]]]:
        """The evidence: titles with lines."""
        if not self.product:
            return []
        (turn, size), order = self.turn.lines("phi"), self.turn.order
        length = "the result has length 1, whatever the input" if self.normalised else size.replace("size", "length")
        shown = "no error" if order is None else f"order {order} at a constant omega"
        return [("Rotation", [f"{self.turn.name}: {turn}, phi = h |omega|/2", length, shown])]

    @property
    def data(self) -> dict[str, Json]:
        """The product and the rotation for programs."""
        turn = self.turn
        told = {"rotation": turn.name, "order": turn.order, "normalised": self.normalised, "scale": f"{turn.scale:.6g}"}
        return {"method": self.key, "product": self.product or None, **told}

    def criteria(self, method: object) -> list[Criterion]:
        """The criteria of a method: the rotation, and a rate without faults."""
        rate = tuple(self._of_rate) or (f"that of q' = {self.product.replace(' (', '/2 (')}",)
        checks = [self.turn.held_to(method, self.normalised), Criterion("Rate", not self._of_rate, rate, {})]
        if not self.driven or not all(check.passed for check in checks):
            return checks
        same = self.is_of(method)
        of = f"{'that' if same else 'not that'} of {getattr(method, 'key', '')}"
        words = f"where omega depends on t, the step is {of}"
        return [*checks, Criterion("Stage times", same, (words,), {})]

    def is_of(self, method: object) -> bool:
        """True if the step at an angular velocity that depends on t is that of a Runge-Kutta method."""
        if not isinstance(method, RungeKutta | Collocation):
            return False
        a, b, c = (np.array(part, dtype=np.float64) for part in exact_tableau(method))
        sign, product = (-1, self.product[1:]) if self.product[0] == "-" else (1, self.product)
        rates = [sign / 2 * _matrix(_AXES[0] + (_LATER + x) * _AXES[1], product) for x in c]
        # K_i = A(c_i) (1 + sum of a_ij K_j) for all stages at once.
        within = np.block([[x * rate for x in row] for rate, row in zip(rates, a, strict=True)])
        slopes = np.linalg.solve(np.eye(4 * len(b)) - within, np.vstack(rates)).reshape(-1, 4, 4)
        said = np.eye(4) + np.tensordot(b, slopes, 1)
        said = said / np.linalg.norm(said, axis=0) if self.normalised else said
        return bool(np.max(np.abs(said - np.array(self.driven))) <= self.turn.rounding.of(8.0))


def read_quaternion(subject: ForeignStepper) -> QuaternionReading:
    """Read a step of a quaternion at constant angular velocities. Raises NotReadable, or the stepper's Misbehaviour."""
    rounding = Rounding(subject.format, 12)  # some 60 operations
    normalised, bent = _normalised(subject, rounding)
    product, scale, unlike = _rate(subject)
    if unlike := bent or unlike:
        return QuaternionReading("", turn_of([1.0] * len(TURN_ANGLES), rounding), normalised, unlike)
    factors, uneven = _factors(subject, product, rounding)
    slight, turning = _columns(subject, _SLIGHT * _AXES[1], 1.0), _matrix(_AXES[1], product)
    if not uneven and np.max(np.abs(slight - scale * _SLIGHT * turning)[turning != 0]) > _NEAR * _SLIGHT:
        uneven = f"with h |omega| = {_SLIGHT:.3g} it does not turn as with larger ones"
    if scale < 0:
        product, factors = f"-{product}", [r.conjugate() for r in factors]
    reading = QuaternionReading(product, turn_of(factors, rounding), normalised, uneven, _at_rest(subject))
    course = Course(_LATER, _AXES[1].tolist())
    driven, still = (_columns(subject, _AXES[0], 1.0, each) for each in (course, Course(_LATER)))
    if (driven == still).all():
        return reading
    timed = _timed(replace(reading, driven=tuple(map(tuple, driven.tolist()))))
    held = len(course.asked) == len(driven)  # over the step, as samples are
    return reading if timed.mistimed and held else timed


def _timed(reading: QuaternionReading) -> QuaternionReading:
    """The reading of a step that takes omega as a function of t, with the method that it is where that changes."""
    turn = reading.turn
    if reading.faults or not turn.known or turn.method not in METHODS:
        return reading
    found = next((m for m in (METHODS[turn.method], *METHODS.values()) if reading.is_of(m)), None)
    if found is None:
        return replace(reading, mistimed=_MISTIMED.format(turn.method))
    return replace(reading, turn=replace(turn, method=found.key))


def _rate(subject: ForeignStepper) -> tuple[str, float, str]:
    """The product nearest to the rate of a short step, its factor, and in words what the rate is instead, or ""."""
    short = float(subject.format.u) ** 0.5
    rate = (_columns(subject, _AXES[0], short) - np.eye(4)) / short
    tables = {product: _matrix(_AXES[0], product) for product in _PRODUCTS}
    product = max(tables, key=lambda words: abs(float((rate * tables[words]).sum())))
    said = tables[product]
    scale = float(np.median(rate[said != 0] / said[said != 0]))
    off = rate - scale * said
    if np.max(np.abs(off)) <= _NEAR * (1 + abs(scale)):
        return product, scale, ""
    i, j = np.unravel_index(int(np.argmax(np.abs(off))), off.shape)
    there = f"at omega = (2, 3, 6)/7 the rate of q[{i}] takes {rate[i, j]:.3g} q[{j}]"
    its = f"that of {product} {scale * said[i, j]:.3g} q[{j}]"
    return product, scale, f"its rate is not a product of q and omega: {there}, {its}"


def _factors(subject: ForeignStepper, product: str, rounding: Rounding) -> tuple[list[complex], str]:
    """The factors a + ib at TURN_ANGLES, and in words what else a step depends on, or ""."""
    factors, uneven = list[complex](), ""

    def factor(angle: float, axis: Array, h: float) -> tuple[complex, float, str]:
        """R of a step about an axis, how far it may be off, and what is no rotation about that axis."""
        turning, step = _matrix(axis, product), _columns(subject, 2 * angle * axis / h, h)
        a, b = float(np.trace(step)) / 4, float((step * turning).sum()) / 4
        allowed = rounding.of(8.0 * (1 + abs(complex(a, b))))
        off = np.max(np.abs(step - a * np.eye(4) - b * turning)) > allowed
        return complex(a, b), allowed, f"a step of h |omega| = {2 * angle:g} is not a rotation about omega" * bool(off)

    for angle in TURN_ANGLES:
        (r, _, off), (other, allowed, also) = factor(angle, _AXES[0], 1.0), factor(angle, _AXES[1], 0.25)
        uneven = uneven or off or also
        factors.append(r)
        if abs(other - r) > allowed:
            uneven = uneven or "its angle depends on more than h |omega|: on the step or on the direction"
    turn = turn_of(factors, rounding)
    for angle in BETWEEN_ANGLES:
        if not uneven and not turn.is_at(angle, factor(angle, _AXES[1], 1.0)[0]):
            uneven = f"with h |omega| = {2 * angle:.3g} it does not turn as with larger ones"
    return factors, uneven


def _at_rest(subject: ForeignStepper) -> str:
    """What a step with omega = 0 does to q, in words; "" if it leaves q as it is."""
    with np.errstate(all="ignore"):
        try:
            seen = turn_quaternion(subject, (0.5, 0.5, 0.5, 0.5), (0.0, 0.0, 0.0), 0.5)
        except Misbehaviour as failure:
            return f"with omega = 0, {failure}"
    moved = any(not abs(x - 0.5) <= _NEAR for x in seen)
    return f"with omega = 0, (0.5, 0.5, 0.5, 0.5) becomes ({', '.join(f'{x:g}' for x in seen)})" if moved else ""


def _columns(subject: ForeignStepper, omega: Array, h: float, course: Course | None = None) -> Array:
    """The matrix of a step, from the steps of the four units."""
    return np.array([turn_quaternion(subject, unit.tolist(), omega.tolist(), h, course) for unit in np.eye(4)]).T


def _normalised(subject: ForeignStepper, rounding: Rounding) -> tuple[bool, str]:
    """Whether the step sets the length to 1, and in words that it is otherwise not linear, or "".

    Raises NotReadable if it remembers, or if it may make the length of what it is given 1, and is linear in the rest.
    """
    q, omega = [0.5, -0.5, 0.5, 0.5], [0.5, 1.0, -0.25]
    one, two, again = (np.array(turn_quaternion(subject, [k * x for x in q], omega, 0.5)) for k in (1, 2, 1))
    if (one != again).any():
        raise NotReadable("the same step taken twice gives different results")
    allowed = rounding.of(8.0)
    if np.max(np.abs(two - 2 * one)) <= allowed:
        return False, ""
    bent, free = "the step is not linear in q, and does not make its length 1", np.max(np.abs(two - one)) <= allowed
    if free and abs(np.linalg.norm(one) - 1) > allowed:
        raise NotReadable(bent)
    return bool(free), "" if free else bent
