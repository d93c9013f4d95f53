"""A plot with axes as SVG: round limits, a few round ticks with exact labels, exact scales, and what is drawn into it.

Places in the picture are exact fractions until they are written, which rounds them once, to hundredths.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from math import ceil, floor
from typing import TypeAlias

from driftproof.reports.page.markup import element, escaped

# Mantissas of the distances between ticks, and of the ends of a symmetric axis. Each is at most twice the previous one.
TICK_STEPS = (1, 2, 4, 5)
AXIS_ENDS = tuple(Fraction(m, 4) for m in (4, 5, 6, 8, 10, 12, 16, 20, 24, 32))
# Two ticks do not show whether an axis is linear; on a logarithmic axis three are too few to read values off.
FEWEST_TICKS, FEWEST_DECADES = 3, 4
# Mantissa of the distance between ticks -> the number of parts into which marks divide it; and the length of a mark.
_PARTS, _MARK = {1: 5, 2: 2, 4: 4, 5: 5}, 4
# Numbers in these decades are written out, others with a power of ten.
_WRITTEN_OUT = range(-4, 6)
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# The margins between the frame of a plot and the edge of its picture.
LEFT, RIGHT, ABOVE, BELOW = 52, 16, 26, 46


@dataclass(frozen=True)
class Scale:
    """The affine map of [low, high] to [start, end], exact; `start` is beyond `end` where the axis points up."""

    low: Fraction
    high: Fraction
    start: Fraction
    end: Fraction

    @cached_property
    def per_unit(self) -> Fraction:
        """The signed length of one unit of the axis in the picture."""
        return (self.end - self.start) / (self.high - self.low)

    def __call__(self, x: float | Fraction) -> Fraction:
        """The place of x in the picture. Raises OverflowError or ValueError for a float that is not finite."""
        return self.start + (Fraction(x) - self.low) * self.per_unit


def decade(x: Fraction) -> int:
    """The largest e with 10ᵉ <= x, for x > 0."""
    e = len(str(x.numerator)) - len(str(x.denominator))  # a digits over b: between 10^(a - b - 1) and 10^(a - b + 1)
    return e if Fraction(10) ** e <= x else e - 1


def symmetric_limit(largest: Fraction) -> Fraction:
    """The end L of an axis from -L to L: the least m 10ᵏ, m in AXIS_ENDS, that is >= 21/20 · largest; 1 for 0.

    AXIS_ENDS grow by a third at most, so L <= 4/3 · 21/20 · largest: what is drawn reaches over 5/7 of the axis.
    """
    if largest == 0:
        return Fraction(1)
    wanted = largest * Fraction(21, 20)
    power = Fraction(10) ** decade(wanted)
    return next((m * power for m in AXIS_ENDS if m * power >= wanted), 10 * power)


def ticks(low: Fraction, high: Fraction, fewest: int = FEWEST_TICKS) -> list[Fraction]:
    """The multiples in [low, high] of the coarsest m 10ᵏ, m in TICK_STEPS, that has at least `fewest` of them there.

    There are at most twice as many: the next coarser step is at most twice as long, and too few of its multiples fit.
    Raises ValueError for an interval without length.
    """
    if not low < high:
        raise ValueError(f"an axis from {low} to {high} has no length")
    steps = _steps_down(high - low)
    every = ([i * step for i in range(ceil(low / step), floor(high / step) + 1)] for step in steps)
    return next(found for found in every if len(found) >= fewest)


def _steps_down(span: Fraction) -> Iterator[Fraction]:
    power = Fraction(10) ** decade(span)
    while True:
        yield from (m * power for m in reversed(TICK_STEPS))
        power /= 10


def label(x: Fraction) -> str:
    """x in full in ordinary decades, else like 4·10⁷. For decimals of at most 28 digits, as ticks are."""
    if x == 0:
        return "0"
    e = decade(abs(x))
    if e in _WRITTEN_OUT:
        return _decimal(x)
    mantissa = _decimal(x / Fraction(10) ** e)
    return ten_to(e) if mantissa == "1" else f"{mantissa}·{ten_to(e)}"


def ten_to(exponent: int) -> str:
    """10ᵉ as text; 1 for e = 0."""
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}" if exponent else "1"


def _decimal(x: Fraction) -> str:
    return f"{Decimal(x.numerator) / Decimal(x.denominator):f}".replace("-", "−")


def place(x: Fraction) -> str:
    """x rounded to hundredths, as text without trailing zeros."""
    hundredths = round(x * 100)
    return f"{hundredths / 100:.2f}".rstrip("0").rstrip(".") if hundredths else "0"


_Place: TypeAlias = tuple[float | Fraction, float | Fraction]


@dataclass(frozen=True)
class Axis:
    """A scale with its name and its ticks; `labels` replaces the numbers at the ticks."""

    scale: Scale
    name: str
    ticks: Sequence[Fraction]
    labels: Sequence[str] | None = None

    def labelled(self) -> Iterable[tuple[Fraction, str]]:
        """The ticks with their labels."""
        return zip(self.ticks, self.labels or [label(tick) for tick in self.ticks], strict=True)

    def marks(self) -> list[Fraction]:
        """The places of marks without a label: every power of ten, if they have room, else parts between the ticks."""
        step = self.ticks[1] - self.ticks[0]
        parts = step if self.labels and step <= 10 else _PARTS[int(step / Fraction(10) ** decade(step))]
        unit, (low, high) = step / parts, (self.scale.low, self.scale.high)
        every = (n * unit for n in range(ceil(low / unit), floor(high / unit) + 1))
        return [x for x in every if x not in self.ticks]

    def line_at(self, tick: Fraction) -> str:
        """The CSS class of the line through a tick: part of the grid, or "axis" at 0, where the other axis runs."""
        return "grid" if tick or self.labels else "axis"


def linear(low: Fraction, high: Fraction, name: str, places: tuple[Fraction, Fraction]) -> Axis:
    """An axis from `low` to `high` with round ticks."""
    return Axis(Scale(low, high, *places), name, ticks(low, high))


def decades_of(values: Iterable[float], name: str, places: tuple[Fraction, Fraction]) -> Axis:
    """A logarithmic axis that contains these exponents of ten, at least two decades long."""
    found = list(values)
    low = floor(min(found))
    return decades(low, max(ceil(max(found)), low + 2), name, places)


def decades(low: int, high: int, name: str, places: tuple[Fraction, Fraction]) -> Axis:
    """A logarithmic axis with exponents of ten from `low` to `high`, which is larger by two at least."""
    scale = Scale(Fraction(low), Fraction(high), *places)
    at = ticks(scale.low, scale.high, min(FEWEST_DECADES, high - low + 1))
    return Axis(scale, name, at, [ten_to(int(tick)) for tick in at])


@dataclass
class Plot:
    """A frame with axes, and what has been drawn into it, in order."""

    x: Axis
    y: Axis
    drawn: list[str] = field(default_factory=list)

    @property
    def size(self) -> tuple[Fraction, Fraction]:
        """Width and height of the picture, in its own units."""
        return self.x.scale.end + RIGHT, self.y.scale.start + BELOW

    def at(self, point: _Place) -> tuple[str, str]:
        """The place of a point in the picture, as text."""
        return place(self.x.scale(point[0])), place(self.y.scale(point[1]))

    def line(self, points: Iterable[_Place], class_: str) -> None:
        """Draw the points joined by straight segments."""
        self._path("L".join(" ".join(self.at(point)) for point in points), class_)

    def dots(self, points: Iterable[_Place], class_: str) -> None:
        """Draw a dot at each point: strokes of length zero with round ends, so that one element holds them all."""
        self._path("M".join(f"{' '.join(self.at(point))}h0" for point in points), class_)

    def _path(self, content: str, class_: str) -> None:
        self.drawn.append(element("path", class_=class_, d=f"M{content}"))

    def disc(self, centre: _Place, radius: int, class_: str, title: str) -> None:
        """Draw a circle with this radius in units of the picture, and a title that a pointer shows."""
        cx, cy = self.at(centre)
        self.drawn.append(element("circle", element("title", escaped(title)), class_=class_, cx=cx, cy=cy, r=radius))

    def words(self, text: str) -> None:
        """Write a line of text in the middle, if there is nothing to draw."""
        x, y = ((scale.start + scale.end) / 2 for scale in (self.x.scale, self.y.scale))
        self.drawn.append(element("text", escaped(text), class_="name x", x=place(x), y=place(y)))

    def circle(self, radius: float | Fraction, class_: str) -> None:
        """Draw the circle around the origin with this radius in units of the axes, whose scales have to be equal."""
        cx, cy = self.at((0, 0))
        reach = place(abs(Fraction(radius) * self.x.scale.per_unit))
        self.drawn.append(element("circle", class_=class_, cx=cx, cy=cy, r=reach))

    def picture(self, identity: str, title: str, description: str) -> str:
        """The whole as an svg element, with a title and a description for those who do not see it."""
        width, height = map(place, self.size)
        return element(
            "svg",
            element("title", escaped(title), id=f"{identity}-title"),
            element("desc", escaped(description), id=f"{identity}-desc"),
            *self.axes(),
            *self.drawn,
            viewBox=f"0 0 {width} {height}",
            role="img",
            aria_labelledby=f"{identity}-title",
            aria_describedby=f"{identity}-desc",
        )

    def axes(self) -> Iterator[str]:
        """The elements of grid, ticks, marks and names."""
        x, y = self.x.scale, self.y.scale
        left, right, bottom, top = map(place, (x.start, x.end, y.start, y.end))
        for tick, words in self.x.labelled():
            at = place(x(tick))
            yield element("path", class_=self.x.line_at(tick), d=f"M{at} {bottom}V{top}")
            yield element("text", escaped(words), class_="tick x", x=at, y=place(y.start + 19))
        for mark in self.x.marks():
            yield element("path", class_="mark", d=f"M{place(x(mark))} {bottom}v{-_MARK}")
        for mark in self.y.marks():
            yield element("path", class_="mark", d=f"M{left} {place(y(mark))}h{_MARK}")
        for tick, words in self.y.labelled():
            at = place(y(tick))
            yield element("path", class_=self.y.line_at(tick), d=f"M{left} {at}H{right}")
            yield element("text", escaped(words), class_="tick y", x=place(x.start - 8), y=at)
        yield element(
            "text", escaped(self.x.name), class_="name x", x=place((x.start + x.end) / 2), y=place(y.start + 38)
        )
        yield element("text", escaped(self.y.name), class_="name y", x=left, y=place(y.end - 11))


def frame(width: int, height: int) -> tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]:
    """Start and end of the horizontal and of the vertical scale of a frame of this size; the vertical one points up."""
    return (Fraction(LEFT), Fraction(LEFT + width)), (Fraction(ABOVE + height), Fraction(ABOVE))


# The frames of a wide figure, with one unit per column of pixels, and of a square one.
COLUMNS_OF_PIXELS = 346
WIDE, SQUARE = frame(COLUMNS_OF_PIXELS, 228), frame(264, 264)
