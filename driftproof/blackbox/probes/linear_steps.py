"""The one-step matrix M(h) of a floating-point stepper, read from its steps after a test of linearity."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite, ldexp, log2, sqrt
from typing import TypeAlias

from driftproof.blackbox.findings import Misbehaviour, NoAnswer
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, FloatFormat

# The entries M_qq, M_qv, M_vq, M_vv as floats.
MatrixEntries: TypeAlias = tuple[float, float, float, float]
# The kinds of a reading.
LINEAR, LINEARISED, NOT_LINEAR = "linear", "linear at tiny states only", "not linear"
NOT_REPEATABLE, NOT_AT_REST = "not repeatable", "not at rest in (0, 0)"
# A generic state and step size: their products and sums fill the significands of any format.
STATE, STEP = (1 / 3, 0.7), 0.3
# Step sizes at states of size 1, in units of the system's own time.
ORDINARY_STEPS = (0.25, 0.5, 0.125)
# Step sizes in units of the system's own time: in both directions of time, and far beyond its time scale.
DYADIC = ("1/256", "1/16", "1/8", "1/4", "1/2", "1", "-1/16", "-1/8", "-1/4", "-1/2", "-1")
NOT_DYADIC = ("1/10", "3/10", "7/10", "-3/10")
_FAR = ("2", "4", "16", "-2", "-4")
# At the step LINEARITY_STEP, no program of the catalogue errs by more than this many u (1 + |M|): a test holds this.
LINEARITY_ROUNDINGS, LINEARITY_STEP = 1 << 12, Fraction(1, 8)
# In binary16, so many roundings would be the number itself: there a defect counts as rounding up to 64 u.
MOST_ROUNDING = 2.0**-5
# Answers that differ by no more roundings are the same: those of sums of up to 18 terms in another order.
REPEATED = 16
# States of this size, in bits, show a limit: a million is beyond what people bound speeds and lengths by.
FAR_BITS = 20
# Tiny steps, in bits, for steppers that refuse smaller ones.
COARSE_BITS = (20, 12)
# Rates read at two tiny steps agree to this many bits unless they are noise; binary16 has no more.
RATE_BITS = 10
# At 1/256 of the system's own time rates have changed by far less than a part in four of both.
_OTHER_RATE_BITS = 2


@dataclass(frozen=True)
class LinearReading:
    """What was read: `steps` are pairs (h, M(h)), where M(h) is rounded as the stepper rounds in `format`.

    `kind` is LINEAR, LINEARISED (read at states of size `amplitude`), or what stands in the way. `at_zero` is
    M(0) + h A at the step `tiny`, where A is known to O(h²) in the entries that vanish in M(0); it is None if tiny
    steps show only noise. `unit` is a power of two near the system's own time. `ordinary` are pairs (h, M(h)) read at
    states of size 1, where the step is off linearity by `loose`. `remarks` are for people; `limited` is True if one
    is of a limit on the size of states.
    """

    format: FloatFormat
    kind: str
    amplitude: float = 1.0
    unit: float = 1.0
    tiny: float = 0.0
    at_zero: MatrixEntries | None = None
    steps: tuple[tuple[float, MatrixEntries], ...] = ()
    ordinary: tuple[tuple[float, MatrixEntries], ...] = ()
    loose: float = 0.0
    remarks: tuple[str, ...] = ()
    limited: bool = False

    @property
    def starts_at_identity(self) -> bool:
        """True if M(0) = I, as far as a tiny step shows."""
        slack = 8 * (self.tiny / self.unit + float(self.format.u))
        pairs = zip(self.at_zero or (), (1, 0, 0, 1), strict=False)
        return self.at_zero is not None and all(abs(x - one) <= slack for x, one in pairs)

    @property
    def identifiable(self) -> bool:
        """True if the steps are those of a linear map."""
        return self.kind in (LINEAR, LINEARISED)


def read_linear_steps(subject: ForeignStepper, amplitude: float = 1.0) -> LinearReading:
    """The one-step matrix of a stepper at some twenty steps, from some seventy calls at states of size `amplitude`.

    A Misbehaviour is raised at steps well within the system's own time; at longer and negative steps it is a remark.
    """
    # The narrowest format that holds the answers to a generic step is taken as the one in which it was computed.
    answers = [Fraction(x) for x in subject.step(*STATE, STEP)]
    fmt = next((f for f in (BINARY16, BINARY32) if any(answers) and all(map(f.holds, answers))), subject.format)
    first = subject.step(*STATE, STEP)
    subject.step(-STATE[1], STATE[0], STEP / 2)
    # A few roundings, as of sums in another order.
    allowed = REPEATED * float(fmt.u) * max(map(abs, (*STATE, *first)))
    if not all(abs(x - y) <= allowed for x, y in zip(first, subject.step(*STATE, STEP), strict=True)):
        return LinearReading(fmt, NOT_REPEATABLE, remarks=("the same call gives different answers",))
    rest = subject.step(0.0, 0.0, _in_format(fmt, STEP))
    if rest != (0.0, 0.0):
        moved = f"a step of {STEP} from (0, 0) ends in ({rest[0]!r}, {rest[1]!r})"
        return LinearReading(fmt, NOT_AT_REST, remarks=(moved,))
    reading = _at_amplitude(subject, LinearReading(fmt, LINEAR, amplitude))
    seen = _nonlinearity(subject, reading, 1.0)
    if seen is None:
        return _with_steps(subject, _far_out(subject, reading))
    words, off = seen
    tiny = _linearised(subject, fmt, reading.starts_at_identity)
    if tiny is not None:
        steps = [_in_format(fmt, tiny.unit * share) for share in ORDINARY_STEPS]
        ordinary = tuple((h, _matrix(subject, h, 1.0)) for h in steps)
        remark = f"not linear at ordinary size: {words}"
        return _with_steps(subject, replace(tiny, ordinary=ordinary, loose=off, remarks=(remark,)))
    return _with_steps(subject, replace(reading, kind=NOT_LINEAR, remarks=(words,)))


def _linearised(subject: ForeignStepper, fmt: FloatFormat, at_identity: bool) -> LinearReading | None:
    """The reading at states so small that the step is linear there, and yet not put to rest; None if there are none.

    At the first size, products of two states are below a rounding of one, and still ordinary numbers.
    """
    if fmt == BINARY16:  # binary16 has no numbers so small
        return None
    for bits in (fmt.precision + 7, fmt.precision // 2 + 4, 2 * fmt.precision // 5):
        tiny = _at_amplitude(subject, LinearReading(fmt, LINEARISED, ldexp(1.0, -bits)))
        asleep = at_identity and not tiny.starts_at_identity
        if asleep or tiny.at_zero is None:
            continue
        # States of a fourth of the size have the same rates; those of a cubic force are a sixteenth.
        less = _matrix(subject, tiny.tiny, tiny.amplitude / 4)
        if all(map(_agree, tiny.at_zero, less)) and _nonlinearity(subject, tiny, 1.0) is None:
            return tiny
    return None


def _in_format(fmt: FloatFormat, x: float) -> float:
    return float(fmt.nearest(Fraction(x)))


def _matrix(subject: ForeignStepper, h: float, amplitude: float) -> MatrixEntries:
    (qq, vq), (qv, vv) = subject.step(amplitude, 0.0, h), subject.step(0.0, amplitude, h)
    return qq / amplitude, qv / amplitude, vq / amplitude, vv / amplitude


def _at_amplitude(subject: ForeignStepper, reading: LinearReading, coarse: bool = False) -> LinearReading:
    """The reading with its tiny step, M there, and its unit of time; only steps that are not so tiny if `coarse`."""
    unit = 1.0
    for _ in range(2):  # the first step is tiny in seconds, the second in the system's own time
        found = _rates(subject, reading, unit, coarse)
        if found is None:
            return replace(reading, unit=unit)
        tiny, m = found
        reading, before = replace(reading, tiny=tiny, at_zero=m), unit
        # The power of two nearest to 1/sqrt|ak|, for the rates a and k; 1 if they give none.
        frequency = sqrt(abs(m[1] / tiny)) * sqrt(abs(m[2] / tiny))
        unit = ldexp(1.0, -round(log2(frequency))) if isfinite(frequency) and frequency else 1.0
        if unit == before:
            break
    return replace(reading, unit=unit)


def _rates(
    subject: ForeignStepper, reading: LinearReading, unit: float, coarse: bool
) -> tuple[float, MatrixEntries] | None:
    """The smallest of some tiny steps at which rates show rather than noise, with M there; None if there is none."""
    p = reading.format.precision
    for bits in sorted({*([] if coarse else (p + 7, p // 2)), *COARSE_BITS}, reverse=True):
        tiny = unit * ldexp(1.0, -bits)
        try:
            m, finer = (_matrix(subject, h, reading.amplitude) for h in (tiny, tiny / 4))
        except (Misbehaviour, NoAnswer):  # steps that are too small may be refused or never end
            if bits == min(COARSE_BITS):
                raise
            continue
        if _same_rates(m, finer):
            found = _extrapolated(m, finer)
            if not _asleep(subject, reading, unit, found):
                return tiny, found
    return None


def _asleep(subject: ForeignStepper, reading: LinearReading, unit: float, m: MatrixEntries) -> bool:
    """True if entries vanish in a tiny step but not in a longer one: small numbers are put to rest or lost."""
    if all(m[1:3]):
        return False
    h = unit * ldexp(1.0, -min(COARSE_BITS))
    longer = _matrix(subject, h, reading.amplitude)
    return any(x == 0 and abs(y) > h / 2**RATE_BITS for x, y in zip(m[1:3], longer[1:3], strict=True))


def _same_rates(m: MatrixEntries, finer: MatrixEntries) -> bool:
    """True if the entries that vanish in M(0) are four times smaller at a fourth of the step, or smaller still.

    They are smaller still if they are O(h²), without a rate; noise is as large at a fourth of the step.
    """
    pairs = [(x, 4 * y) for x, y in zip(m[1:3], finer[1:3], strict=True)]
    return all(abs(y) <= abs(x) / 2 or _agree(x, y) for x, y in pairs)


def _agree(x: float, y: float) -> bool:
    """True if two rates are the same to RATE_BITS bits."""
    return abs(x - y) <= ldexp(abs(x) + abs(y), -RATE_BITS)


def _extrapolated(m: MatrixEntries, finer: MatrixEntries) -> MatrixEntries:
    """M with c h for the entries that vanish in M(0), c known to O(h²) from both steps, or 0 if they are O(h²)."""
    found = list(m)
    for i in (1, 2):
        x, y = m[i], 4 * finer[i]
        found[i] = (4 * y - x) / 3 if _agree(x, y) else 0.0
    qq, qv, vq, vv = found
    return qq, qv, vq, vv


def _nonlinearity(subject: ForeignStepper, reading: LinearReading, size: float) -> tuple[str, float] | None:
    """The first case of M(z + w) ≠ M(z) + M(w) at `size` times the amplitude, in words, with how far it is off.

    None if none is seen.
    """
    h = _in_format(reading.format, reading.unit * float(LINEARITY_STEP))
    (qq, qv, vq, vv), scale = _matrix(subject, h, reading.amplitude), size * reading.amplitude
    u = float(reading.format.u)
    for q, v in ((1.0, 1.0), (0.625, -0.75), (-1.5, 0.0)):
        got = subject.step(scale * q, scale * v, h)
        for x, (a, b) in zip(got, ((qq * q, qv * v), (vq * q, vv * v)), strict=True):
            allowed = min(LINEARITY_ROUNDINGS * u, MOST_ROUNDING) * (abs(a) + abs(b) + abs(q) + abs(v))
            off = abs(x / scale - (a + b))
            if not off <= allowed:
                start = f"({scale * q:g}, {scale * v:g})"
                return f"a step of {h:g} from {start} is off the sum of its parts by {off:.1e} of their size", off
    return None


def _far_out(subject: ForeignStepper, reading: LinearReading) -> LinearReading:
    """The reading, with a remark on a limit on the size of states if one is seen."""
    try:
        seen, _ = _nonlinearity(subject, reading, 2.0 ** min(FAR_BITS, reading.format.emax // 2)) or ("", 0.0)
    except Misbehaviour as failure:
        seen = str(failure)
    except NoAnswer as hang:
        return replace(reading, remarks=(f"not seen far out: {hang}",))
    return replace(reading, remarks=(f"not linear far out: {seen}",), limited=True) if seen else reading


def _with_steps(subject: ForeignStepper, reading: LinearReading, coarse: bool = False) -> LinearReading:
    """The reading with its steps; from the first one on again if tiny steps had other rates, as differences cancel."""
    found, failures = [], []
    for text in (*DYADIC, *NOT_DYADIC, *_FAR):
        h, forward = _in_format(reading.format, reading.unit * float(Fraction(text))), text[0] != "-"
        try:
            found.append((h, _matrix(subject, h, reading.amplitude)))
        except (Misbehaviour, NoAnswer) as failure:
            if forward and h <= reading.unit / 2:
                raise
            failures.append((forward, h, str(failure)))
    (h, m), tiny = found[0], reading.tiny
    if not coarse and reading.at_zero is not None and reading.identifiable:
        rates = zip(reading.at_zero[1:3], m[1:3], strict=True)
        if any(abs(x / tiny - y / h) > ldexp(abs(x / tiny) + abs(y / h), -_OTHER_RATE_BITS) for x, y in rates):
            return _with_steps(subject, _at_amplitude(subject, reading, coarse=True), coarse=True)
    remarks = list(reading.remarks)
    for way in (False, True):
        at = [(h, seen) for forward, h, seen in failures if forward is way]
        if at:
            steps = ", ".join(f"{h:g}" for h, _ in at)
            remarks.append(f"no answer at h = {steps}: {at[0][1]}")
    return replace(reading, steps=tuple(found), remarks=tuple(remarks))
