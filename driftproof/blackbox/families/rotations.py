"""The rotation of a step as a complex factor R(θ) of the angle θ that is meant: its method, its angle, its size."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from math import log2

import numpy as np

from driftproof.blackbox.judging.measured_order import CLEARANCE
from driftproof.blackbox.matching.tables import exact_tableau
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.report import Criterion
from driftproof.methods.schemes import Collocation, RungeKutta

# The angles at which factors are compared; the short ones show leading powers, with an error O(θ²).
TURN_ANGLES = (2.0, 1.0, 0.5, 0.25, 2.0**-3, 2.0**-4, 2.0**-5, 2.0**-6, 2.0**-7)
# Between these and the slightest angle tried, where codes may take a series instead.
BETWEEN_ANGLES = (2.0**-9, 2.0**-12, 2.0**-16)
# R as a function of z = i θ, for steps of y' = iy.
_METHODS: dict[str, Callable[[complex], complex]] = {
    "exact": cmath.exp,
    "implicit_midpoint": lambda z: (1 + z / 2) / (1 - z / 2),
    "forward_euler": lambda z: 1 + z,
    "backward_euler": lambda z: 1 / (1 - z),
    "midpoint2": lambda z: 1 + z + z * z / 2,
    "kutta3": lambda z: 1 + z + z * z / 2 + z**3 / 6,
    "rk4": lambda z: 1 + z + z * z / 2 + z**3 / 6 + z**4 / 24,
}
# The multiples of the angle that mistakes turn by, in words.
_TIMES = {1.0: "", 2.0: "twice the angle", 0.5: "half the angle", 4.0: "four times the angle", -1.0: "the other way"}
_TIMES |= {-2.0: "twice the angle the other way", -0.5: "half the angle the other way"}


@dataclass(frozen=True)
class Turn:
    """A rotation by R(θ): that of `method` at `times` the angle, in `parts` equal parts, with size 1 if `normalised`.

    `method` is "" if it is not known. `angle` is arg R/θ - 1 and `growth` is |R| - 1 to leading order, as (power of θ,
    coefficient), or None if it is 0 to rounding; `scale` is arg R/θ for small θ, or a multiple of 1/2 that is near it.
    `factors` holds R at TURN_ANGLES.
    """

    times: float
    parts: int
    normalised: bool
    method: str
    scale: float
    angle: tuple[int, float] | None
    growth: tuple[int, float] | None
    factors: tuple[complex, ...]
    rounding: Rounding

    @property
    def known(self) -> bool:
        """True if it is a known method at the right angle."""
        return bool(self.method) and self.times == 1

    def is_at(self, angle: float, factor: complex) -> bool:
        """True if a known rotation has this factor at this angle, to rounding; also if it is not known."""
        told = _factor(self.times, self.parts, self.normalised, self.method, angle) if self.method else factor
        return abs(told - factor) <= self.rounding.of(4.0) * (1 + abs(factor))

    @property
    def order(self) -> int | None:
        """The order on z' = iz; 0 if the angle is wrong, None if there is no error."""
        if self.scale != 1:
            return 0
        powers = [p for p in (self.angle and self.angle[0], self.growth and self.growth[0] - 1) if p is not None]
        return min(powers, default=None)

    @property
    def name(self) -> str:
        """The rotation in words."""
        if not self.method:
            return "not a known rotation"
        made = f"{self.method}{', normalised to length 1' if self.normalised else ''}"
        made += f" in {self.parts} equal parts" if self.parts > 1 else ""
        return f"{made} at {_TIMES[self.times]}" if self.times not in (1.0, -1.0) else made

    def held_to(self, method: object, made_one: bool = False) -> Criterion:
        """The criterion that R is 1 + z b (1 - zA)⁻¹ 1 of a Runge-Kutta method at every angle, or has its angle."""
        if not isinstance(method, RungeKutta | Collocation):
            words = "a splitting or a Nyström method does not rotate vectors"
            return Criterion("Rotation", False, (words,), {})
        said = [factors_of(method, 1j * x)[0] for x in TURN_ANGLES]
        if made_one and self.method == method.key:  # of two methods that are then the same, the one that it is called
            said = [s / abs(s) for s in said]
        off = [abs(r - s) / (1 + abs(s)) for r, s in zip(self.factors, said, strict=True)]
        worst = int(np.argmax(off))
        same = bool(off[worst] <= Rounding(self.rounding.format, method.stages + self.rounding.calls).of(4.0))
        words = f"{method.key}'s factor at all of {len(TURN_ANGLES)} angles, off by {off[worst]:.1e} at most"
        other = f"{self.name}: off the factor of {method.key} by {off[worst]:.2g} at the angle {TURN_ANGLES[worst]:g}"
        return Criterion("Rotation", same, (words if same else other,), {})

    def lines(self, angle: str) -> list[str]:
        """The angle and the size as lines, for an angle of this name."""
        if self.scale != 1:
            turns = f"it turns by {self.scale:.4g} times {angle} for short steps, not by {angle}"
        else:
            law = {"implicit_midpoint": f"2 atan({angle}/2) = ", "forward_euler": f"atan({angle}) = "}
            named = law.get(self.method, "") if self.parts == 1 else ""
            more = _term(angle, (self.angle[0] + 1, self.angle[1])) if self.angle else ""
            turns = f"it turns by {named}{angle}{more}"
        size = f"multiplied by 1{_term(angle, self.growth)}" if self.growth else "kept to rounding"
        return [turns, f"its size is {size}"]


def factors_of(method: RungeKutta | Collocation, z: complex) -> tuple[complex, complex]:
    """R(z) = 1 + z b (1 - zA)⁻¹ 1, and b A (1 - zA)⁻¹ 1: what a constant slope adds to the integral."""
    a, b, _ = (np.array(part, dtype=np.float64) for part in exact_tableau(method))
    stages = np.linalg.solve(np.eye(len(b)) - z * a, np.ones(len(b)))
    return complex(1 + z * (b @ stages)), complex(b @ a @ stages)


def turn_of(factors: Sequence[complex], rounding: Rounding) -> Turn:
    """The rotation with these factors at TURN_ANGLES: the first method that fits them all, perhaps with a mistake."""
    allowed, pairs = rounding.of(4.0), list(zip(TURN_ANGLES, factors, strict=True))
    candidates = product(_TIMES, (1, 2), (False, True), _METHODS)
    fits = (made for made in candidates if all(abs(_factor(*made, x) - r) <= allowed * (1 + abs(r)) for x, r in pairs))
    found = next(fits, (1.0, 1, False, ""))
    turns = [cmath.phase(r) / x for x, r in pairs]
    near = round(2 * turns[-1]) / 2
    scale = near if abs(turns[-1] - near) < TURN_ANGLES[-1] else turns[-1]
    angle = _leading([x - 1 for x in turns], [allowed / x for x in TURN_ANGLES])
    growth = _leading([abs(r) - 1 for r in factors], [allowed] * len(TURN_ANGLES))
    return Turn(*found, scale, angle, growth, tuple(factors), rounding)


def _factor(times: float, parts: int, normalised: bool, method: str, angle: float) -> complex:
    """R of a method at `times` the angle, in equal parts, its size made 1 if `normalised`."""
    made = _METHODS[method](times / parts * 1j * angle) ** parts
    return made / abs(made) if normalised else made


def _leading(errors: Sequence[float], noise: Sequence[float]) -> tuple[int, float] | None:
    """The power and coefficient of the leading term of errors at halved angles, from the last two above the noise."""
    seen = [(x, e) for x, e, allowed in zip(TURN_ANGLES, errors, noise, strict=True) if abs(e) > CLEARANCE * allowed]
    if len(seen) < 2:
        return None
    (longer, before), (x, last) = seen[-2:]
    power = round(log2(abs(before / last)) / log2(longer / x))
    return power, last / x**power


def _term(angle: str, error: tuple[int, float]) -> str:
    """The term of this power and coefficient, as " - x^3/12 + ..."."""
    power, coefficient = error
    bare = f"({angle})" if " " in angle else angle
    part = round(1 / abs(coefficient))
    told = abs(part * abs(coefficient) - 1) < TURN_ANGLES[-1]
    size = f"{bare}^{power}{f'/{part}' * (part != 1)}" if told else f"{abs(coefficient):.3g} {bare}^{power}"
    return f" {'-' if coefficient < 0 else '+'} {size} + ..."
