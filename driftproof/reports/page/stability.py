"""The panel of stability: per method the exact limit, the verdict proved at the scene's own h, and how powers grow."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, inf

from flint import arb, ctx

from driftproof.methods.catalogue import Entry
from driftproof.methods.given_methods import method_of
from driftproof.methods.schemes import Method
from driftproof.numeric.scenes import Scene
from driftproof.reports.page.figure import Figure
from driftproof.reports.page.markup import html_table
from driftproof.reports.page.plot import WIDE, Plot, decades, linear, ten_to
from driftproof.symbolic.algebra.certified import FIRST_BITS, CertifiableReal, enclose, significant
from driftproof.symbolic.algebra.polynomials import evaluate, scalar, sign
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, rational_root
from driftproof.symbolic.linear import stability_limits
from driftproof.symbolic.linear.facts import LinearFacts
from driftproof.symbolic.linear.stability_limits import Infinity, Limit, smallest
from driftproof.symbolic.runs import as_balls, exact_matrix_at, power
from driftproof.texts.writing.records import number_record

# For how many times the scene's steps powers are followed, and at how many places.
LENGTHS, PLACES = 10, 200
_LINE_STYLES = 8
LIMIT_DIGITS, GROWTH_DIGITS = 10, 3


@dataclass(frozen=True)
class Verdict:
    """What is proved about the powers of M(h) at one h: `bounded`, and `growth`, the spectral radius minus 1.

    `limit` is the largest H such that powers are bounded for every h in (0, H).
    """

    method: Method
    limit: Limit
    bounded: bool
    growth: CertifiableReal


def verdict(method: str | Entry, h: Fraction) -> Verdict:
    """The verdict on a method at exactly this h. Raises ValueError at a pole of M(h)."""
    facts = LinearFacts(method_of(method))
    radius = stability_limits.spectral_radius(exact_matrix_at(facts.method, h))
    growth = radius - 1 if isinstance(radius, Fraction) else lambda: enclose(radius) - 1
    boundary = stability_limits.boundary_of(facts.one_step_matrix)
    bounded = stability_limits.is_bounded(boundary, lambda p: sign(evaluate(p, scalar(h))))
    return Verdict(facts.method, facts.imaginary_limit, bounded, growth)


def verdicts_table(scene: Scene, verdicts: Sequence[Verdict]) -> str:
    """A row per method: its limit, exact and in decimals, whether h is below it, the verdict, and max |λ| - 1."""
    about_h = (f"h = {scene.h} is", "powers at this h", "max\u00a0|λ|\u00a0−\u00a01")
    rows = [["Method", "Bounded for h below", "that is", *about_h]]
    for found in verdicts:
        limit, decimal = _limit(found.limit)
        growth = significant(found.growth, GROWTH_DIGITS)
        powers = "bounded" if found.bounded else "unbounded"
        rows.append([found.method.title, limit, decimal, beside(found.limit, scene.h), powers, growth])
    return html_table(rows, f"Decided exactly, for M(h) on the oscillator at h = {scene.h}", "verdicts")


def _limit(limit: Limit) -> tuple[str, str]:
    if isinstance(limit, Infinity) or limit == ZERO_ROOT:
        return ("all h" if isinstance(limit, Infinity) else "none"), "–"
    known = number_record(limit, LIMIT_DIGITS)
    radicals, decimal = known["exact"], known["decimal"]
    words = (radicals and with_roots(radicals)) or f"a root of degree {len(limit.minimal) - 1}"
    return words, words if words.isdigit() else decimal


def with_roots(text: str) -> str:
    """A number in SymPy's syntax with root signs: "2*sqrt(2)" as 2√2.

    >>> with_roots("2*sqrt(10)/3 - sqrt(2*sqrt(3) - 3)")
    '2√10/3 − √(2√3 − 3)'
    """
    short = re.sub(r"sqrt\((\d+)\)", r"√\1", text)
    return short.replace("sqrt(", "√(").replace("*", "").replace("-", "−")


def beside(limit: Limit, h: Fraction) -> str:
    """Whether h is below, at or above the limit, decided exactly; "negative" for h < 0, as limits are for h > 0."""
    if h < 0:
        return "negative"
    if isinstance(limit, Infinity):
        return "below"
    if limit == ZERO_ROOT:
        return "above"
    step = rational_root(h)
    return "at the limit" if limit == step else "below" if smallest([limit, step]) == step else "above"


def line_style(index: int) -> str:
    """The CSS class of a curve, a colour with dashes; from the ninth on they repeat, broader."""
    again, hue = divmod(index, _LINE_STYLES)
    return f"m{hue}{' again' if again else ''}"


def growth_figure(scene: Scene, verdicts: Sequence[Verdict], identity: str) -> Figure:
    """‖Mⁿ‖ over n, in decades: the root mean square of |Mⁿz|/|z| over all directions of z, from the exact M."""
    end = max(LENGTHS * scene.steps, 1)
    counts = sorted({end * i // PLACES for i in range(PLACES + 1)})
    curves = [_growth(found.method, scene.h, counts) for found in verdicts]
    values = [value for curve in curves for _, value in curve if value > -inf]
    low, high = floor(min(values)), ceil(max(values))
    low, high = (low, high) if high - low >= 2 else (-1, 1)
    x = linear(Fraction(0), Fraction(end), "steps n", WIDE[0])
    plot = Plot(x, decades(low, high, "growth after n steps", WIDE[1]))
    for i, curve in enumerate(curves):
        plot.line([(n, value) for n, value in curve if value > -inf], f"path {line_style(i)}")
    titles = [found.method.title for found in verdicts]
    columns = [[f"{value:z.4f}" for _, value in curve] for curve in curves]
    rows = [list(row) for row in zip(map(str, counts), *columns, strict=True)]
    lasts = [curve[-1][1] for curve in curves]
    ends = [f"{title} {10**last:.3g}" for title, last in zip(titles, lasts, strict=True) if last < 300]
    return Figure(
        identity=f"{identity}-growth",
        kind="wide",
        title=f"Growth of the powers at h = {scene.h}",
        description=f"Size of the n-th power of the one-step matrix, n from 0 to {end}, logarithmic axis from "
        f"{ten_to(low)} to {ten_to(high)}. At the end: {', '.join(ends)}.",
        plot=plot,
        legend=[(f"line path {line_style(i)}", title) for i, title in enumerate(titles)],
        note=f"{LENGTHS} times as many steps as the scene has. The line of an unbounded method keeps climbing.",
        data=[["n", *titles], *rows[:: max(1, len(rows) // 20)]],
        data_title="Growth, as powers of ten",
    )


def _growth(method: Method, h: Fraction, counts: Sequence[int]) -> list[tuple[float, float]]:
    """(n, log₁₀ of the Frobenius norm of Mⁿ over √2); -inf for a power that is zero to FIRST_BITS bits."""
    matrix, found = exact_matrix_at(method, h), []
    with ctx.workprec(FIRST_BITS):
        balls = as_balls(matrix)
        for n in counts:
            size = sum((x * x for x in power(balls, n)), arb(0)) / 2
            found.append((float(n), float((size.log() / arb(10).log() / 2).mid()) if size > 0 else -inf))
    return found
