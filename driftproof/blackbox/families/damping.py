"""A step that loses velocity of its own: by which law of h, and whether for each time, or for each step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, log, sqrt

from flint import arb

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_on
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem, walls
from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.probes.scripted_answers import NotReadable, Rounding
from driftproof.blackbox.stepper.array_adapters import AnyNumber
from driftproof.blackbox.stepper.calling_conventions import FORCE, MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.support.plain_text import Json

# Steps in which a loss is compared; and one in which a loss for each time is as good as linear in h, in binary64.
_STEPS, _SHORT = (1.0, 0.5, 0.25, 2.0**-5, 2.0**-9), 2.0**-20
# As far as a limit of short steps is known.
_DIGITS = 9
# What a velocity is multiplied by in a step, with the rate c, as text and as the rate that a factor D shows.
_LAWS: Mapping[str, Callable[[float, float], float]] = {
    "exp(-{c} h)": lambda d, h: -log(d) / h,
    "1 - {c} h": lambda d, h: (1 - d) / h,
    "1/(1 + {c} h)": lambda d, h: (1 / d - 1) / h,
    "(1 - {c} h/2)/(1 + {c} h/2)": lambda d, h: 2 * (1 - d) / (1 + d) / h,
}


@dataclass(frozen=True)
class Damping:
    """In a step without a force v is multiplied by the `law` of h, to first order 1 - `rate` h; a step loses `at_once`.

    Where the system is built in, it is the area in phase space that is multiplied so. `order` is the one measured with
    the drag -c v beside the force, None where it was not.
    """

    law: str
    rate: float
    at_once: float
    built_in: bool
    order: MeasuredOrder | None = None

    @property
    def faults(self) -> list[str]:
        """A loss in each step, however short: how much is lost in a time then depends on h."""
        if self.at_once == 1:
            return []
        what = "the area in phase space" if self.built_in else "the velocity"
        return [
            f"{what} is multiplied by {self.at_once:.6g} in each step, however short: a damping for each step, none "
            "for each time; with half of h it damps twice as much"
        ]

    @property
    def verdict(self) -> str:
        """What it is, in one line."""
        if self.faults:
            return f"it is no method that is known here: {self.faults[0]}"
        seen = "" if self.order is None or self.order.order is None else f", of order {self.order.order} as measured"
        return f"it is a step of {'the oscillator' if self.built_in else 'a force'} with a drag{seen}: {self.lines[0]}"

    @property
    def lines(self) -> list[str]:
        """The law."""
        law = self.law or f"a law of h that is none of {', '.join(text.format(c='c') for text in _LAWS)}"
        what = "areas in phase space are" if self.built_in else "without a force, v is"
        return [f"{what} multiplied by {law}, as by a drag of {self.rate:.6g} v"]

    @property
    def data(self) -> dict[str, Json]:
        """The same for programs."""
        return {"law": self.law or None, "rate": f"{self.rate:.6g}", "faults": list(self.faults)}


def read_damping(subject: ForeignStepper) -> Damping:
    """What a step takes from v besides its force. Raises UnsupportedCall where it takes nothing, NotReadable."""
    if subject.convention.kind not in (FORCE, MAP):
        raise UnsupportedCall("what a right-hand side does to v is its own")
    built_in = subject.convention.kind == MAP
    factor = _area_factor if built_in else _velocity_factor
    rounding, longer = Rounding(subject.format, 1), _short(subject)
    shorter = longer / 2
    seen = {h: factor(subject, h) for h in (*_STEPS, longer, shorter)}
    lost = [1 - seen[h] for h in (longer, shorter)]
    # Of a loss O(h²), as of a method that keeps no areas, half a step has a quarter.
    if abs(lost[1]) <= max(8 * rounding.of(4.0), 0.375 * abs(lost[0])):
        raise UnsupportedCall("it takes nothing from v")
    if abs(lost[1]) > 0.75 * abs(lost[0]):  # where half a step loses no less, not half as much
        at_once = seen[shorter] if len({*seen.values()}) == 1 else round(1 - 2 * lost[1] + lost[0], _DIGITS)
        if not 0 <= at_once < 1:
            raise NotReadable(f"a step of h = 0 multiplies by {at_once:.6g}: no damping")
        return Damping("", 0.0, at_once, built_in)
    rate = lost[1] / shorter
    if rate < 0 or (built_in and not _follows_drag(subject, rate)):
        raise NotReadable(f"areas grow as 1 + {-rate:.6g} h: no drag" if rate < 0 else "small steps follow no drag")
    laws = (_told(text, rate_of, seen, rounding) for text, rate_of in _LAWS.items())
    found = Damping(next(filter(None, laws), ""), rate, 1.0, built_in)
    return found if built_in else replace(found, order=measured_on(subject, _with_drag(rate)))


def _short(subject: ForeignStepper) -> float:
    """A step in which half of the digits are left to a loss."""
    return max(_SHORT, 4 * sqrt(float(subject.format.u)))


def _told(text: str, rate_of: Callable[[float, float], float], seen: Mapping[float, float], rounding: Rounding) -> str:
    """The law with its rate, if all steps show the same one."""
    if min(seen.values()) <= 0:
        return ""
    (first, most), *others = [(rate_of(seen[h], h), rounding.of(4.0 / h)) for h in _STEPS]
    if any(abs(rate - first) > most + slack for rate, slack in others):
        return ""
    return text.format(c=coefficient_text(first, rounding.format, most))


def _velocity_factor(subject: ForeignStepper, h: float) -> float:
    """v1/v without a force. Raises NotReadable where it is not the same for all v."""

    def stepped(v: float) -> float:
        return float(subject.step_with(lambda q: 0 * q, 0.0, v, h)[1])

    one, two, rest = stepped(1.0), stepped(-2.0), stepped(0.0)
    if rest or abs(two + 2 * one) > Rounding(subject.format, 1).of(4.0):
        raise NotReadable("without a force, the new velocity is no multiple of the old one")
    return one


def _area_factor(subject: ForeignStepper, h: float) -> float:
    """The determinant of a step that is linear."""
    (a, c), (b, d), (x, y) = (subject.step(q, v, h) for q, v in ((1.0, 0.0), (0.0, 1.0), (-2.0, 3.0)))
    size = 8 * sum(map(abs, (a, b, c, d)))
    if max(abs(x + 2 * a - 3 * b), abs(y + 2 * c - 3 * d)) > Rounding(subject.format, 4).of(size):
        raise NotReadable("the step is not linear")
    return float(a * d - b * c)


def _follows_drag(subject: ForeignStepper, rate: float) -> bool:
    """Whether small steps follow q' = v, v' = -k q - c v with any k > 0, as far as h and the digits tell."""
    h = _short(subject)
    (a, c), (b, d) = subject.step(1.0, 0.0, h), subject.step(0.0, 1.0, h)
    slopes = zip((a - 1, b, d - 1), (0.0, 1.0, -rate), strict=True)
    allowed = 8 * (h + float(subject.format.u) / h) * (1 + rate - c / h) ** 2
    return c < 0 and all(abs(x / h - y) <= allowed for x, y in slopes)


def _with_drag(rate: float) -> NonlinearProblem:
    """q'' = F(q) - c v with F = exp(-2q) + c sqrt(1 - exp(-2q)), which makes good the drag: solved by log cosh t."""
    still = walls(1)

    def pushed(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
        wall = (-2 * y[0]).exp() if isinstance(y[0], arb) else exp(-2 * max(y[0], 0.0))
        left = 1 - wall
        return [y[1], wall + rate * (left.sqrt() if isinstance(left, arb) else sqrt(left))]

    return replace(still, words=f"q'' = F(q) - {rate:.6g} v, the drag being the step's own", rate=pushed)
