"""Steps with a drag or a turn of v built in: its law in h, and whether it acts per unit of time or per step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, sqrt
from typing import Any, TypeAlias

import numpy as np
from flint import arb

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_on
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem, walls
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.probes.scripted_answers import NotReadable, Rounding
from driftproof.blackbox.stepper.calling_conventions import FORCE, MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.second_functions import zeros
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.support.plain_text import Json

# Step sizes at which the loss is compared; and one so short that a loss per unit of time is linear in h, in binary64.
_STEPS, _SHORT = (1.0, 0.5, 0.25, 2.0**-5, 2.0**-9), 2.0**-20
_FEWEST = 3  # of them tell laws apart
# The parts of a rate and of a shown matrix that count as 0; the condition number from which eigenvectors are useless.
_LITTLE, _NONE, _WORST = 2.0**-10, 2.0**-20, 2.0**10
_SIZE = 16.0  # of numbers whose rounding is no loss
# The factor of v in a step by the rate c: as text, and the rate from the eigenvalues D of a step.
_LAWS: Mapping[str, Callable[[Any, float], Any]] = {
    "exp(-{c} h)": lambda d, h: -np.log(d) / h,
    "1 - {c} h": lambda d, h: (1 - d) / h,
    "1/(1 + {c} h)": lambda d, h: (1 / d - 1) / h,
    "(1 - {c} h/2)/(1 + {c} h/2)": lambda d, h: 2 * (1 - d) / (1 + d) / h,
}
_Rows: TypeAlias = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Damping:
    """The factor of v in a step without a force: the `law` of h, 1 - `rate` h to first order, times `at_once`.

    Both are matrices, 1 by 1 for a scalar v; `at_once` is the factor in the limit h -> 0, the identity for a true drag.
    If the system is built in, the factor is that of areas in phase space. `order` is measured with the drag -c v added
    to the force, None if it was not.
    """

    law: str
    rate: _Rows
    at_once: _Rows
    built_in: bool
    order: MeasuredOrder | None = None

    @property
    def faults(self) -> list[str]:
        """The fault of a factor that every step has, however short: the loss per unit of time then depends on h."""
        if (np.array(self.at_once) == np.eye(len(self.at_once))).all():
            return []
        what = "the area in phase space" if self.built_in else "the velocity"
        factor = np.array(self.at_once)
        kept = len(factor) > 1 and np.abs(factor @ factor.T - np.eye(len(factor))).max() < _LITTLE  # lengths
        noun = "turn" if kept else "damping"
        shown = _shown(factor) if _shown(factor) != "1" else f"1 {factor.item() - 1:+.2g}"
        return [
            f"{what} is multiplied by {shown} in each step, however short: a {noun} per step, "
            "not per unit of time: halving h doubles it"
        ]

    @property
    def turns(self) -> bool:
        """True if v is turned, as by the Coriolis force: C is antisymmetric."""
        rate = np.array(self.rate)
        return bool(np.abs(rate + rate.T).max() < _LITTLE * np.abs(rate).max())

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        if self.faults:
            return f"it is not a known method: {self.faults[0]}"
        seen = "" if self.order is None or self.order.order is None else f", of order {self.order.order} as measured"
        of, force = "the oscillator" if self.built_in else "a force", "a force that turns v" if self.turns else "a drag"
        return f"it is a step of {of} with {force}{seen}: {self.lines[0]}"

    @property
    def lines(self) -> list[str]:
        """The law as a line of text."""
        law = self.law or f"a function of h that is none of {', '.join(text.format(c='c') for text in _LAWS)}"
        what = "areas in phase space are" if self.built_in else "without a force, v is"
        rate = _shown(np.array(self.rate))
        by = f"the force -C v with C = {rate}" if self.turns else f"a drag of {rate} v"
        return [f"{what} multiplied by {law}, which corresponds to {by}"]

    @property
    def data(self) -> dict[str, Json]:
        """The law, the rate and the faults for programs."""
        return {"law": self.law or None, "rate": _shown(np.array(self.rate)), "faults": list(self.faults)}


def read_damping(subject: ForeignStepper) -> Damping:
    """Read what a step does to v besides its force. Raises UnsupportedCall if nothing, NotReadable if no drag."""
    if subject.convention.kind not in (FORCE, MAP):
        raise UnsupportedCall("what a right-hand side does to v is its own")
    built_in = subject.convention.kind == MAP
    factor = _area_factor if built_in else _velocity_factor
    rounding, longer = _rounding(subject), _short(subject)
    shorter = longer / 2
    seen = {h: factor(subject, h) for h in (*_STEPS, longer, shorter)}
    one = np.eye(len(seen[shorter]))
    lost = [one - seen[h] for h in (longer, shorter)]
    sizes = [float(np.abs(part).max()) for part in lost]
    # If the loss is O(h²), as in methods that do not keep areas, half a step has a quarter of it.
    if sizes[1] <= max(rounding.of(_SIZE), 0.375 * sizes[0]):
        raise UnsupportedCall("it does not damp v")
    if sizes[1] > 0.75 * sizes[0]:  # where half a step loses no less, not half as much
        at_once = one - 2 * lost[1] + lost[0]
        values = np.linalg.eigvals(at_once)
        if np.abs(values).max() > 1 + _LITTLE or values.real.min() < 0:
            raise NotReadable(f"a step of h = 0 multiplies by {_shown(at_once)}: no damping")
        return Damping("", _rows(0 * one), _rows(at_once), built_in)
    rate = lost[1] / shorter
    grown = -float(np.trace(rate))
    if grown > _LITTLE * float(np.abs(rate).max()):
        raise NotReadable(f"areas grow as 1 + {grown:.6g} h: no drag")
    if built_in and not _follows_drag(subject, -grown):
        raise NotReadable("small steps do not follow a drag")
    laws = (_law(text, rate_of, seen, rounding) for text, rate_of in _LAWS.items())
    found = Damping(next(filter(None, laws), ""), _rows(rate), _rows(one), built_in)
    return found if built_in else replace(found, order=measured_on(subject, _with_drag(rate)))


def _rounding(subject: ForeignStepper) -> Rounding:
    """The rounding of a step without a force, and of a determinant of two rows."""
    return Rounding(subject.format, 4)


def _short(subject: ForeignStepper) -> float:
    """A step size that leaves half of the digits to a loss."""
    return max(_SHORT, 4 * sqrt(float(subject.format.u)))


def _shown(matrix: Array, text: Callable[[float], str] = "{:.6g}".format, *off: float) -> str:
    """The matrix as text, a multiple of the identity as one number; entries within rounding or `off` are shown as 0."""
    slack = max([_NONE * float(np.abs(matrix).max()), *off])
    if np.abs(matrix - matrix[0, 0] * np.eye(len(matrix))).max() <= slack:
        return text(float(matrix[0, 0]))
    rows = (", ".join(text(float(x)) if abs(x) > slack else "0" for x in row) for row in matrix)
    return f"[[{'], ['.join(rows)}]]"


def _rows(matrix: Array) -> _Rows:
    return tuple(map(tuple, matrix.tolist()))


def _law(text: str, rate_of: Callable[[Any, float], Any], seen: Mapping[float, Array], rounding: Rounding) -> str:
    """The law with its rate, on the eigenvectors of the step; "" if steps of different sizes show different rates."""
    told = []
    for h in _STEPS:
        values, vectors = np.linalg.eig(seen[h].astype(complex))
        grown = float(np.linalg.cond(vectors))
        if not grown < _WORST:
            return ""
        if any(x.imag == 0 and x.real <= 0 for x in values):  # in a long step, as where 1 - c h is 0 or less
            continue
        rate = vectors @ np.diag(rate_of(values, h)) @ np.linalg.inv(vectors)
        told.append((rate, rounding.of(2.0 / h) * grown))
    if len(told) < _FEWEST:
        return ""
    (first, slack), *others = told
    if any(np.abs(rate - first).max() > slack + more for rate, more in others):
        return ""
    shown = _shown(first.real, lambda x: coefficient_text(x, rounding.format, slack), slack)
    return text.format(c=shown) if shown != "1" else text.replace("{c} ", "")


def _velocity_factor(subject: ForeignStepper, h: float) -> Array:
    """The matrix D of v1 = D v without a force. Raises NotReadable if it is not the same for all v."""
    n = max(1, subject.adapter.together)

    def stepped(v: Array) -> Array:
        end = subject.step_forced(zeros, 0.0, [0.0] * n, v.tolist(), h)
        return np.array(end[n:])

    found = np.array([stepped(unit) for unit in np.eye(n)]).T
    other = np.array([-2.0, 0.5, 1.0][:n])
    if np.abs(stepped(other) - found @ other).max() > _rounding(subject).of(4.0):
        raise NotReadable("without a force, the new velocity is not a multiple of the old one")
    return found


def _area_factor(subject: ForeignStepper, h: float) -> Array:
    """The determinant of a linear step. Raises NotReadable if the step is not linear, or its shortest step long."""
    if any(subject.step(0.0, 0.0, h)):
        raise NotReadable("the step is not linear: a force acts at rest in (0, 0)")
    (a, c), (b, d), (x, y) = (subject.step(q, v, h) for q, v in ((1.0, 0.0), (0.0, 1.0), (-2.0, 3.0)))
    size = 8 * sum(map(abs, (a, b, c, d)))
    if max(abs(x + 2 * a - 3 * b), abs(y + 2 * c - 3 * d)) > _rounding(subject).of(size):
        raise NotReadable("the step is not linear")
    if h <= _short(subject) and not abs(a * d) + abs(b * c) <= _SIZE:
        raise NotReadable(f"the factor of areas is lost in rounding: a step of {h:g} is long in the system's own time")
    return np.array([[a * d - b * c]], dtype=float)


def _follows_drag(subject: ForeignStepper, rate: float) -> bool:
    """True if short steps follow q' = v, v' = -k q - c v for some k > 0, as far as h and rounding show."""
    h = _short(subject)
    (a, c), (b, d) = subject.step(1.0, 0.0, h), subject.step(0.0, 1.0, h)
    slopes = zip((a - 1, b, d - 1), (0.0, 1.0, -rate), strict=True)
    allowed = 9 * h * (1 + rate - c / h) ** 2  # 8 (h + u/h), and h is at least 4 sqrt(u)
    return c < 0 and all(abs(x / h - y) <= allowed for x, y in slopes)


def _with_drag(rate: Array) -> NonlinearProblem:
    """q'' = F(q) - C v with F = exp(-2q) + C sqrt(1 - exp(-2q)), which balances the drag: solved by log cosh."""
    still = walls(len(rate))

    def pushed(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
        n = len(rate)
        near = [(-2 * q).exp() if isinstance(q, arb) else exp(-2 * abs(q)) for q in y[:n]]
        speeds = [(1 - x).sqrt() if isinstance(x, arb) else sqrt(1 - x) for x in near]
        drags = (sum((float(c) * v for c, v in zip(row, speeds, strict=True)), 0 * speeds[0]) for row in rate)
        return [*y[n:], *(x + drag for x, drag in zip(near, drags, strict=True))]

    return replace(still, words=f"q'' = F(q) - {_shown(rate)} v, the drag being the step's own", rate=pushed)
