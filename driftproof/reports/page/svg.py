"""SVG, written out: elements, paths, and a plot with axes; places are rounded to hundredths, once."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from html import escape
from typing import TypeAlias

from driftproof.reports.page.axes import Scale, label

Point: TypeAlias = tuple[float | Fraction, float | Fraction]
# Characters that HTML does not allow, whatever somebody named a scene.
FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
# Elements of HTML that nothing closes.
VOID = {"input"}
# What is between the frame of a plot and the edge of its picture: left, right, above, below.
LEFT, RIGHT, ABOVE, BELOW = 52, 16, 26, 46


def text(content: object) -> str:
    """The content as text of HTML or of an attribute: it can close no tag and no quotation mark."""
    return escape(FORBIDDEN.sub("\ufffd", str(content)))


def element(name: str, /, *children: str, **attributes: object) -> str:
    """<name key="value">children</name>; underscores in keys are hyphens, a last one is dropped, as in class_.

    Attributes that are None are left out. Children are markup: text goes through `text` first.
    """
    given = {key.rstrip("_").replace("_", "-"): value for key, value in attributes.items() if value is not None}
    written = "".join(f' {key}="{text(value)}"' for key, value in given.items())
    return f"<{name}{written}>" if name in VOID else f"<{name}{written}>{''.join(children)}</{name}>"


def place(x: Fraction) -> str:
    """x rounded to hundredths, without trailing zeros."""
    hundredths = round(x * 100)
    return f"{hundredths / 100:.2f}".rstrip("0").rstrip(".") if hundredths else "0"


@dataclass(frozen=True)
class Axis:
    """A scale with its name and its ticks; `labels` stands in for what the ticks themselves say."""

    scale: Scale
    name: str
    ticks: Sequence[Fraction]
    labels: Sequence[str] | None = None

    def labelled(self) -> Iterable[tuple[Fraction, str]]:
        """The ticks with what stands at them."""
        return zip(self.ticks, self.labels or [label(tick) for tick in self.ticks], strict=True)

    def line_at(self, tick: Fraction) -> str:
        """What the line through a tick is: part of the grid, or where the other axis runs."""
        return "grid" if tick or self.labels else "axis"


@dataclass
class Plot:
    """A frame with axes, and what is drawn into it, in the order drawn."""

    x: Axis
    y: Axis
    drawn: list[str] = field(default_factory=list)

    @property
    def size(self) -> tuple[Fraction, Fraction]:
        """Width and height of the picture, in its own units."""
        return self.x.scale.end + RIGHT, self.y.scale.start + BELOW

    def at(self, point: Point) -> tuple[str, str]:
        """The place of a point, as text."""
        return place(self.x.scale(point[0])), place(self.y.scale(point[1]))

    def line(self, points: Iterable[Point], class_: str) -> None:
        """The points, joined by straight segments."""
        self._path("L".join(" ".join(self.at(point)) for point in points), class_)

    def dots(self, points: Iterable[Point], class_: str) -> None:
        """A dot at each point: strokes of length zero with round ends, so that one element holds them all."""
        self._path("M".join(f"{' '.join(self.at(point))}h0" for point in points), class_)

    def _path(self, content: str, class_: str) -> None:
        self.drawn.append(element("path", class_=class_, d=f"M{content}"))

    def disc(self, centre: Point, radius: int, class_: str, title: str) -> None:
        """A circle of this radius in units of the picture, with a title that a pointer shows."""
        cx, cy = self.at(centre)
        self.drawn.append(element("circle", element("title", text(title)), class_=class_, cx=cx, cy=cy, r=radius))

    def circle(self, radius: float | Fraction, class_: str) -> None:
        """The circle around the origin with this radius, in units of the axes: both scales have to be equal."""
        cx, cy = self.at((0, 0))
        reach = place(abs(Fraction(radius) * self.x.scale.per_unit))
        self.drawn.append(element("circle", class_=class_, cx=cx, cy=cy, r=reach))

    def picture(self, identity: str, title: str, description: str) -> str:
        """The whole as an svg element, with its title and description for those who do not see it."""
        width, height = map(place, self.size)
        return element(
            "svg",
            element("title", text(title), id=f"{identity}-title"),
            element("desc", text(description), id=f"{identity}-desc"),
            *self._axes(),
            *self.drawn,
            viewBox=f"0 0 {width} {height}",
            role="img",
            aria_labelledby=f"{identity}-title",
            aria_describedby=f"{identity}-desc",
        )

    def _axes(self) -> Iterable[str]:
        x, y = self.x.scale, self.y.scale
        left, right, bottom, top = map(place, (x.start, x.end, y.start, y.end))
        for tick, words in self.x.labelled():
            at = place(x(tick))
            yield element("path", class_=self.x.line_at(tick), d=f"M{at} {bottom}V{top}")
            yield element("text", text(words), class_="tick x", x=at, y=place(y.start + 19))
        for tick, words in self.y.labelled():
            at = place(y(tick))
            yield element("path", class_=self.y.line_at(tick), d=f"M{left} {at}H{right}")
            yield element("text", text(words), class_="tick y", x=place(x.start - 8), y=at)
        yield element("text", text(self.x.name), class_="name x", x=place((x.start + x.end) / 2), y=place(y.start + 38))
        yield element("text", text(self.y.name), class_="name y", x=left, y=place(y.end - 11))


def frame(width: int, height: int) -> tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]:
    """Start and end of the horizontal and of the vertical scale of a frame of this size; the vertical one points up."""
    return (Fraction(LEFT), Fraction(LEFT + width)), (Fraction(ABOVE + height), Fraction(ABOVE))
