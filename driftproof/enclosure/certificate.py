"""The certificate of a trajectory's error, as text, as JSON, and as a table in a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from decimal import MAX_EMAX, MAX_PREC, MIN_EMIN, Context, Decimal
from fractions import Fraction
from html import escape
from typing import TypeAlias

from flint import arb

from driftproof.enclosure.arithmetic.evaluations import in_bits
from driftproof.enclosure.arithmetic.numbers import size
from driftproof.support.plain_text import Json, as_json, counted
from driftproof.support.results import Printable
from driftproof.symbolic.algebra.certified import Uncertified, endpoints, scientific, significant

# A row for each time, with a ball for each component.
BallRows: TypeAlias = tuple[tuple[arb, ...], ...]
# Digits of balls in JSON: more than are ever proved for the error of a double, rounding included.
_DIGITS = 25
# Those of balls in words, and the least number without an exponent there.
_DIGITS_SHOWN, _LEAST_PLAIN = 10, Fraction(1, 10**4)
# So many bits hold the sum of a ball's middle and radius exactly, unless they are farther apart than any in use.
_BITS_OF_ANY_BALL = 2**18
# The most rows of the table in a notebook, and the most constants that the text lists: a dense system has thousands.
_MOST_SHOWN = 12
# The digits reported for a point that is right to the last bit.
ALL_DIGITS = 17


@dataclass(frozen=True)
class Split:
    """The error in two parts: the `truncation` of the method, run exactly on the same steps, and the `rounding`.

    `states` are z[i], the method's exact run: z[i] + rounding[i] is the float y[i], and z[i] - truncation[i] is the
    solution. If the run's times are rounded, that shift counts as rounding. The run took `steps` steps in `bits` bits.
    `solved` is true of an implicit method: what the run's own solver left unsolved of its stages counts as rounding.
    All points are its steps up to rounding, but for those after the intervals `unchecked`, where that cannot be told.
    """

    method: str
    states: BallRows
    truncation: BallRows
    rounding: BallRows
    steps: int
    bits: int
    solved: bool = False
    unchecked: tuple[int, ...] = ()


@dataclass(frozen=True)
class Drift:
    """The change of a first integral along the float run, and its parts if the method's exact run is known.

    The solution's enclosure is checked at every point: a change that is certainly not 0 is refused.
    """

    total: tuple[arb, ...]
    truncation: tuple[arb, ...] | None = None
    rounding: tuple[arb, ...] | None = None


@dataclass(frozen=True, repr=False)
class Certificate(Printable):
    """The error y[i] - y(t[i]) of each point of a trajectory, as a row of balls; y(t) is the solution through y[0].

    `digits_at` are the digits of the largest error at each point, relative to the solution's largest component there;
    `digits` are the least of these, and `digits_of` those of each component by itself. `steps` and `bits` are those of
    the enclosure. `doubles` are the constants of f, taken exactly: 0.1 is not 1/10. `split` and `drifts` are present if
    they were asked for; `unsplit` says why there is no split. `unknowns` are the names that f gives the components,
    `said` how the columns of the file were read, where their names leave a question, or that the solver failed.
    """

    t: tuple[float, ...]
    y: tuple[tuple[float, ...], ...]
    errors: BallRows
    digits_at: tuple[int, ...]
    bits: int
    steps: int
    doubles: tuple[float, ...]
    split: Split | None = None
    drifts: Mapping[str, Drift] = field(default_factory=dict)
    unknowns: tuple[str, ...] = ()
    said: str = ""
    unsplit: str = ""

    @property
    def digits(self) -> int:
        """The digits of the largest error at every point, relative to the largest component there."""
        return min(self.digits_at)

    @property
    def digits_of(self) -> tuple[int | None, ...]:
        """For each component, the digits right at every point relative to its own largest size; None if it may be 0."""
        with in_bits(self.bits):
            found = list[int | None]()
            for errors, values in zip(zip(*self.errors, strict=True), zip(*self.y, strict=True), strict=False):
                true = [arb(x) - error for x, error in zip(values, errors, strict=False)]
                found.append(None if all(x.contains(0) for x in true) else right_digits(errors, true))
            return tuple(found)

    @property
    def worst(self) -> tuple[int, int]:
        """The indices of the point and of the component with the largest error."""
        return largest_place(self.errors)

    @property
    def largest_error(self) -> arb:
        """A ball of the largest size of any error."""
        return largest_of(self.errors, self.bits)

    def place(self, worst: tuple[int, int] | None = None) -> str:
        """The place of the largest error, or of `worst`, as text."""
        i, j = worst or self.worst
        named = self.unknowns[j] if self.unknowns else j
        return f"component {named} at t = {self.t[i]:.17g}, point {i} of 0 to {len(self.t) - 1}"

    def text(self) -> str:
        """The certificate as text, each number rounded to the digits that are proved."""
        lines = [f"largest error {decimal(self.largest_error)}, proved: {self.place()}"]
        if self.split is not None:
            lines += self._split_lines(self.split)
        lines += [line for name, drift in self.drifts.items() for line in self._drift_lines(name, drift)]
        right = f"{counted(self.digits, 'correct digit')} at every point, relative to its largest component"
        lines += [f"{right}; enclosure: {self.steps} steps, {self.bits} bits"]
        lines += self._own_digits_lines()
        if len(self.t) == len(self.y[0]):
            lines.append(f"there are as many times as components; y was read so that y({self.t[1]:g}) = {self.y[1]}")
        if self.doubles:
            few = len(self.doubles) <= _MOST_SHOWN  # more are those of a table or a matrix
            said = ", ".join(map(repr, self.doubles[: _MOST_SHOWN if few else 3]))
            count, more = ("", "") if few else (f"{len(self.doubles)} ", ", ...")
            lines.append(f"{count}constants in f, each exactly this double: {said}{more}")
        return "\n".join([*lines, *filter(None, [self.said, f"not split: {self.unsplit}" if self.unsplit else ""])])

    def _own_digits_lines(self) -> list[str]:
        """The component with the fewest digits of its own, if they are fewer than those of the whole state."""
        own = {j: digits for j, digits in enumerate(self.digits_of) if digits is not None}
        j = min(own, key=lambda each: own[each], default=0)
        if not own or own[j] >= self.digits:
            return []
        i, _ = largest_place([(row[j],) for row in self.errors])
        name, right = self.unknowns[j] if self.unknowns else j, counted(own[j], "correct digit")
        said = f"one by one, component {name} is the worst: {right}, relative to its own largest size"
        return [f"{said}; off by {decimal(self.errors[i][j])} at t = {self.t[i]:.17g}, point {i}"]

    def _split_lines(self, split: Split) -> list[str]:
        i, j = self.worst
        parts = f"truncation {decimal(split.truncation[i][j])} + rounding {decimal(split.rounding[i][j])}"
        lines = [f"  there {decimal(self.errors[i][j])} = {parts} ({split.method}, steps: {split.steps})"]
        for name, rows in (("truncation", split.truncation), ("rounding", split.rounding)):
            lines.append(f"largest {name} {decimal(largest_of(rows, split.bits))}: {self.place(largest_place(rows))}")
        if split.solved:
            lines.append("rounding includes what the run's own solver, such as Newton's method, left unsolved")
        if split.unchecked:
            where = f"{len(split.unchecked)} of {counted(len(split.states) - 1, 'interval')}"
            said = f"not checked to be its steps, as rounding may have grown too much: {where}"
            lines.append(f"{said}, the first from t = {self.t[split.unchecked[0]]:.17g}")
        return lines

    def _drift_lines(self, name: str, drift: Drift) -> list[str]:
        i, _ = largest_place([(x,) for x in drift.total])
        shown = f"{name}: largest drift {decimal(drift.total[i])} at t = {self.t[i]:.17g}"
        if drift.truncation is None or drift.rounding is None:
            return [shown]
        return [f"{shown} = truncation {decimal(drift.truncation[i])} + rounding {decimal(drift.rounding[i])}"]

    def record(self) -> Json:
        """The certificate for JSON: numbers as strings, a ball as the decimal midpoint and radius of one around it."""
        i, j = self.worst
        found: Json = {
            "largest_error": {**_ball(self.largest_error), "point": i, "component": j, "t": repr(self.t[i])},
            "digits": self.digits,
            "bits": self.bits,
            "steps": self.steps,
            "doubles": [repr(x) for x in self.doubles],
            "t": [repr(t) for t in self.t],
            "errors": _rows(self.errors),
            "digits_at": list(self.digits_at),
            "digits_of": list(self.digits_of),
        }
        if (split := self.split) is not None:
            parts = {"truncation": _rows(split.truncation), "rounding": _rows(split.rounding)}
            run = {"method": split.method, "steps": split.steps, "bits": split.bits}
            found["split"] = {**run, "unchecked": list(split.unchecked), **parts}
        found |= {name: text for name, text in (("said", self.said), ("unsplit", self.unsplit)) if text}
        if self.drifts:
            found["drifts"] = {
                name: {
                    part: [_ball(x) for x in values]
                    for part in ("total", "truncation", "rounding")
                    if (values := getattr(drift, part)) is not None
                }
                for name, drift in self.drifts.items()
            }
        return found

    def written(self, form: str) -> str:
        """The certificate as "text", or its record as canonical "json"."""
        return as_json(self.record()) if form == "json" else self.text()

    def _repr_html_(self) -> str:
        """The text and a table of a few points as HTML, for a notebook."""
        words = "".join(f"<p>{escape(line)}</p>" for line in self.text().splitlines())
        last = len(self.t) - 1
        shown = sorted({round(k * last / (_MOST_SHOWN - 1)) for k in range(_MOST_SHOWN)})
        parts = {"error": self.errors}
        if self.split is not None:
            parts |= {"truncation": self.split.truncation, "rounding": self.split.rounding}
        head = "".join(f"<th>{name}</th>" for name in ("t", *parts, "digits"))
        body = ""
        for i in shown:
            sizes = [decimal(largest_of([rows[i]], self.bits)) for rows in parts.values()]
            cells = [f"{self.t[i]:.6g}", *sizes, str(self.digits_at[i])]
            body += f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"
        return f"<div>{words}<table><tr>{head}</tr>{body}</table></div>"


def decimal(x: arb) -> str:
    """The digits, ten at most, to which all numbers in the ball round; the ball itself if they share not even one."""
    with suppress(Uncertified):  # of a number too long to write out
        ends = endpoints(x) if x.is_finite() else ()
        write = scientific if max(map(abs, ends), default=0) < _LEAST_PLAIN else significant
        for digits in range(_DIGITS_SHOWN * bool(ends), 0, -1):
            low, high = (write(end, digits) for end in ends)
            if low == high:
                return low
    return str(x.str(3))


def largest_place(rows: Sequence[Sequence[arb]]) -> tuple[int, int]:
    """Row and column of the ball that reaches farthest from 0, the first of several."""
    with in_bits(_BITS_OF_ANY_BALL):
        reach = {(i, j): x.abs_upper() for i, row in enumerate(rows) for j, x in enumerate(row)}
        return max(reach, key=reach.__getitem__)


def largest_of(rows: Sequence[Sequence[arb]], bits: int) -> arb:
    """A ball that contains the largest absolute value of the numbers in the balls."""
    with in_bits(bits):
        largest = arb(0)
        for ball in (ball for row in rows for ball in row):
            largest = largest.max(abs(ball))
        return largest


def right_digits(error: Sequence[arb], true: Sequence[arb]) -> int:
    """The number of right digits, floor(-log10 |error|/|y|) in the maximum norm, at least 0; ALL_DIGITS for error 0."""
    largest = size(error)
    if largest == 0:
        return ALL_DIGITS
    whole = max((arb(x.abs_lower()) for x in true), key=float)
    digits = (-(largest / whole).log() / arb(10).log()).lower().floor()
    return max(0, int(digits.unique_fmpz() or 0)) if digits.is_finite() else 0


# Decimals are made without rounding, whatever the caller's context is.
_EXACT = Context(prec=MAX_PREC, Emin=MIN_EMIN, Emax=MAX_EMAX)


def _ball(x: arb) -> Json:
    middle, radius, exponent = (int(part) for part in x.mid_rad_10exp(_DIGITS))
    return {"midpoint": _scaled(middle, exponent), "radius": _scaled(radius, exponent)}


def _scaled(digits: int, exponent: int) -> str:
    return f"{_EXACT.normalize(_EXACT.scaleb(Decimal(digits), exponent)):e}" if digits else "0"


def _rows(rows: BallRows) -> Json:
    return [[_ball(x) for x in row] for row in rows]
