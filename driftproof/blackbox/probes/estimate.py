"""The error estimate of an embedded pair, read from what its step returns after y1: another y1, or a difference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import fsum

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import (
    AT_REST,
    CONTROLS,
    CoefficientRow,
    Control,
    NotReadable,
    require_predicted,
    unit,
)
from driftproof.blackbox.probes.tableau import TableauProbe, starts
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.rounding.formats import FloatFormat

# What a step may return after y1, in words.
DIFFERENCE = "an estimate of the error"
SOLUTION = "the result of the other row"
ABSOLUTE = "the absolute value of an estimate"
NORM = "a norm of an estimate, one number"
# Further step sizes by which estimates are compared with their rows of weights.
_LENGTHS = (
    Control("h = 1/64", "it does not scale with h as an estimate does", h=2.0**-6, salt=3),
    Control("h = -1/2", "backward in time it differs", h=-0.5, salt=4),
)
_TWICE = next(control for control in CONTROLS if control.h != 1)
_UNLIKE = "the components of y do not have the same estimate"
_TIMED = Control("another time", "", h=0.375, time=7.0)
_AT_FIVE = Control("another start", "", start=5.0)


@dataclass(frozen=True)
class EstimateReading:
    """The row e of an estimate h Σ eⱼ kⱼ of the error of y1, where b - e is the other row of weights.

    kⱼ is the answer to call j, as in a `TableauReading`. `form` is what is returned; if that is the other result, e is
    the exact difference of two floats. The rounding errors of e scale with `sizes`. `power` is 0 if the estimate is
    divided by h, else 1. `relative` says that it also depends on the size of y, and `fault` where it departs from its
    row.
    """

    form: str
    row: tuple[Fraction, ...]
    sizes: CoefficientRow
    format: FloatFormat
    power: int = 1
    relative: bool = False
    fault: str = ""


def read_estimate(subject: ForeignStepper) -> EstimateReading:
    """The row e of a step (f, t, y, h) that returns (y1, y1_hat) or (y1, error), from its answers to 0 and 1.

    As in `read_tableau`, call j is answered by 1 and every other by 0. The answer -1 shows whether an absolute value is
    returned, whose signs then follow from pairs of calls. Further steps show whether the estimate scales with h, and
    whether it depends on y. Raises NotReadable, saying what was seen, and UnsupportedCall if nothing is returned after
    y1.
    """
    nothing = UnsupportedCall("the stepper returns nothing besides y1: no error estimate is seen")
    try:
        probe = _EstimateProbe(subject, 1.0)
    except NotReadable:
        if subject.log.beside is None:  # there is no estimate that could be unreadable
            raise nothing from None
        raise
    if subject.log.beside is None:
        raise nothing
    probe.run(probe.size, [], _TIMED)
    if subject.log.beside == [_TIMED.time + _TIMED.h]:  # the step returns (y1, t1)
        raise nothing
    return probe.estimate()


class _EstimateProbe(TableauProbe):
    """Steps of one subject with both answers; the second is a list of as many numbers as the first, or of one."""

    def estimate(self) -> EstimateReading:
        """The row, with its form, how it scales, and the first control that it does not meet."""
        offset = self._offset()
        rows = [self._first_numbers(unit(self.calls, j)) for j in range(self.calls)]
        weights, signed = [b for b, _ in rows], [e for _, e in rows]
        opposite = [self._first_numbers([-k for k in unit(self.calls, j)])[1] for j in range(self.calls)]
        form = SOLUTION if offset else DIFFERENCE
        if any(signed) and signed == opposite and min(signed) >= 0:
            signed = self._with_signs(signed)
            form = ABSOLUTE
        fault = ""
        if len(self._beside) < self.size:
            form, fault = NORM, self._unseen_number()
        row = tuple(Fraction(b) - Fraction(e) if offset else Fraction(e) for b, e in zip(weights, signed, strict=True))
        sizes = tuple(map(max, map(abs, weights), map(abs, signed)))
        reading = EstimateReading(form, row, sizes, self.subject.format, fault=fault)
        return self._controlled_reading(reading, signed, offset)

    def _offset(self) -> float:
        """1 if the second answer is a y1, 0 if it is a difference."""
        run = self.run(self.size, [], _AT_FIVE)
        found, state = self._beside, run.result
        if not any(found):
            return 0.0
        if found == state:
            return 1.0
        raise NotReadable(f"with all slopes 0, from y = 5, what it returns besides y1 is {found[0]:.6g}")

    @property
    def _beside(self) -> list[float]:
        found = self.subject.log.beside
        if found is None:
            raise NotReadable("it returns something besides y1 at some steps only")
        return found

    def _first_numbers(self, first: Sequence[float], control: Control = AT_REST) -> tuple[float, float]:
        """The first numbers of y1 and of what follows it; if that is one number, all of y get the same slopes."""
        alike = len(self._beside) < self.size
        answers = [[k if alike or i == 0 else 0.0 for i in range(self.size)] for k in first]
        run = self.run(self.size, answers, control)
        if not alike and control == AT_REST and any(self._beside[1:]):
            raise NotReadable("the slope of one component of y changes the estimate of another")
        return run.result[0], self._beside[0]

    def _unseen_number(self) -> str:
        """A line on the first number of y whose slopes a norm does not see; "" if there is none."""
        for i in range(self.size):
            seen = False
            for j in range(self.calls):
                self.run(self.size, [[x * (m == i) for m in range(self.size)] for x in unit(self.calls, j)], AT_REST)
                seen |= bool(self._beside[0])
            if not seen:
                return f"of {self.size} components, y[{i}] does not enter what it returns besides y1"
        return ""

    def _with_signs(self, sizes: Sequence[float]) -> list[float]:
        """The row with signs, up to a common one: |e + e'| shows whether two entries have the same sign."""
        first = next(j for j, x in enumerate(sizes) if x)
        signed = [0.0] * self.calls
        for j, x in enumerate(sizes):
            both = self._first_numbers([float(i in (first, j)) for i in range(self.calls)])[1]
            same = abs(both - (sizes[first] + x)) <= abs(both - abs(sizes[first] - x))
            signed[j] = x if same else -x
        return signed

    def _controlled_reading(self, reading: EstimateReading, row: Sequence[float], offset: float) -> EstimateReading:
        """The reading after the controls, which may set its `power`, `relative` and `fault`."""
        for control in (*CONTROLS, *_LENGTHS):
            try:
                (seen, said, allowed), *others = self._predictions(reading, row, offset, control)
                if abs(seen * control.h - said) <= allowed * abs(control.h) and control is _TWICE:
                    reading = replace(reading, power=0)
                    (seen, said, allowed), *others = self._predictions(reading, row, offset, control)
            except Misbehaviour:
                if control is not _LENGTHS[1]:
                    raise
                break  # a stepper that refuses to step back has no estimate there
            if not abs(seen - said) <= allowed and not offset and self._depends_on_y(control):
                return replace(reading, relative=True)
            try:
                require_predicted(control, "what it returns besides y1", seen, said, allowed)
                for i, of_number in enumerate(others, 1):
                    require_predicted(control._replace(broken=_UNLIKE), f"what it returns besides y1[{i}]", *of_number)
            except NotReadable as failure:
                if control is CONTROLS[0] and abs(seen - said) > allowed:
                    raise
                return replace(reading, fault=reading.fault or str(failure))
        return reading

    def _depends_on_y(self, control: Control) -> bool:
        """True if the same slopes give a far smaller estimate far away: it is divided by the size of y."""
        slopes = self.slopes(control)[0]
        near, far = (self._first_numbers(slopes, control._replace(start=start))[1] for start in (0.0, 2.0**20))
        return abs(far) < abs(near) / 2

    def _predictions(
        self, reading: EstimateReading, row: Sequence[float], offset: float, control: Control
    ) -> list[tuple[float, float, float]]:
        """For each number after y1: what is seen, what the row says, and how far rounding may carry it."""
        alike, slopes = reading.form == NORM, self.slopes(control)
        answers = [[k] * self.size for k in slopes[0]] if alike else list(zip(*slopes, strict=True))
        self.run(self.size, answers, control)
        scale, found = control.h if reading.power else 1.0, []
        for seen, y, k in zip(self._beside, starts(control, self.size), slopes, strict=False):
            said = offset * y + scale * fsum(e * x for e, x in zip(row, k, strict=True))
            terms = fsum(size * abs(x) for size, x in zip(reading.sizes, k, strict=True))
            allowed = self.rounding.of(2 * (abs(y) + abs(control.h) * terms))
            found.append((seen, abs(said) if reading.form in (ABSOLUTE, NORM) else said, allowed))
        return found
