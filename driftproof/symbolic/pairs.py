"""Exact facts about the error estimate of an embedded pair, and about continuous extensions (dense output)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from itertools import count
from typing import NamedTuple

from driftproof.methods.catalogue import EMBEDDED_SUFFIX, extensions_of
from driftproof.methods.continuous import ContinuousExtension
from driftproof.methods.numbers.flint_rationals import as_fraction
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import RealRoot, rational_root
from driftproof.symbolic.linear.fact_values import ExactFunction
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import INFINITY, Infinity
from driftproof.symbolic.trees.elementary_weights import EXACT, RingElement, TableauStages
from driftproof.symbolic.trees.order_conditions import RungeKuttaConditions, order, runge_kutta_conditions


class EstimateFacts(NamedTuple):
    """The estimate h Σ (bᵢ - b̂ᵢ) kᵢ of a pair: O(h^(order + 1)), and E(z) = R(z) - R̂(z) on y' = λy.

    `at_infinity` is |E| at infinity: if it is not 0, stiff components that R damps still keep the step small.
    `b_ratio` = |τ̂⁺|/|τ̂| and `c_ratio` = |τ̂⁺ - τ⁺|/|τ̂|, with τ̂ the leading error coefficients of the row of lower
    order, τ̂⁺ those one order higher and τ⁺ those of the other row: near 1, the estimate is close to the error
    (prince-dormand-1981, 2). Both are None if coefficients are decimals or irrational.
    """

    order: int
    function: ExactFunction
    at_infinity: Exact | Infinity
    b_ratio: RealRoot | None
    c_ratio: RealRoot | None


class ExtensionFacts(NamedTuple):
    """A continuous extension: its `order` for every θ, and how well it joins the steps at θ = 0 and θ = 1.

    `largest_residual` is the largest coefficient of a power of θ in the residuals up to the claimed order, not 0 for
    decimal tables. `step_residual` is the largest |bᵢ(1) - bᵢ|, `slope_residual` the largest difference from the slopes
    f(t, y) and f(t + h, y₁) at the ends, or None if no stage is the slope at the end.
    """

    key: str
    source: str
    stages: int
    degree: int
    claimed_order: int
    order: int
    largest_residual: Exact
    step_residual: Exact
    slope_residual: Exact | None


def estimate_facts(method: RungeKutta) -> EstimateFacts | None:
    """The facts about the error estimate of a pair; None if there is no pair, or its two rows are equal."""
    if method.b_embedded is None or method.b_embedded == method.b:
        return None
    other = method.embedded(EMBEDDED_SUFFIX)
    row = [x - y for x, y in zip(method.b, method.b_embedded, strict=True)]
    conditions = RungeKuttaConditions(TableauStages(method.a, row))
    difference = stability_function(method) - stability_function(other)
    ratios = (None, None) if method.decimal or method.field else _ratios(method, other)
    return described_estimate(conditions, difference, ratios)


def described_estimate(
    conditions: RungeKuttaConditions, difference: RationalFunction, ratios: tuple[RealRoot | None, RealRoot | None]
) -> EstimateFacts:
    """The facts about an estimate, from the conditions of the row b - b̂, which is not 0, and from E(z)."""
    vanishing = next(n for n in count(1) if any(conditions.of_order(n))) - 1
    limit = difference.at_infinity()
    return EstimateFacts(vanishing, ExactFunction(difference), INFINITY if limit is None else _size(limit), *ratios)


def _ratios(method: RungeKutta, other: RungeKutta) -> tuple[RealRoot, RealRoot]:
    low, high = sorted((method, other), key=lambda each: order(each).order)
    p = order(low).order
    leading, next_low, next_high = (
        _error_coefficients(each, n) for each, n in ((low, p + 1), (low, p + 2), (high, p + 2))
    )
    differences = [x - y for x, y in zip(next_low, next_high, strict=True)]
    square, next_square, c_square = (sum((x * x for x in row), Fraction(0)) for row in (leading, next_low, differences))
    b_square, c_square = next_square / square, c_square / square
    return rational_root(b_square).square_root(), rational_root(c_square).square_root()


def _error_coefficients(method: RungeKutta, vertices: int) -> list[Fraction]:
    """τ = (Φ - 1/γ)/σ of all trees with `vertices` vertices."""
    conditions = runge_kutta_conditions(method)
    pairs = zip(conditions.residuals(vertices), conditions.symmetries(vertices), strict=True)
    return [as_fraction(x) / sigma for (_, x), sigma in pairs]


def extension_facts(method: RungeKutta) -> tuple[ExtensionFacts, ...] | None:
    """The facts about the continuous extensions of the method in the catalogue; None if it has none."""
    return tuple(map(facts_of_extension, extensions_of(method))) or None


def facts_of_extension(extension: ContinuousExtension) -> ExtensionFacts:
    """The exact facts about one continuous extension."""
    method = extension.method
    at_one = [sum(weight, Fraction(0)) for weight in extension.weights]
    own = [*method.b, *[Fraction(0)] * (len(at_one) - method.stages)]
    of_order, zero = _theta_residuals(extension), EXACT.lift(Fraction(0))
    return ExtensionFacts(
        extension.key,
        extension.source,
        len(extension.a),
        extension.degree,
        extension.claimed_order,
        next(n for n in count(1) if any(of_order(n))) - 1,
        EXACT.exact(max((_size(x) for n in range(1, extension.claimed_order + 1) for x in of_order(n)), default=zero)),
        max(_size(x - y) for x, y in zip(at_one, own, strict=True)),
        _slope_residual(extension, own),
    )


def _theta_residuals(extension: ContinuousExtension) -> Callable[[int], Sequence[RingElement]]:
    """A function of n: the coefficients of all powers of θ in Σ bᵢ(θ) Φᵢ(t) - θⁿ/γ(t), t being the trees of order n."""
    constant, *others = (TableauStages(extension.a, row) for row in extension.columns)
    stages = RungeKuttaConditions(constant)
    powers = [stages, *map(stages.weighed_by, others)]

    @cache
    def of_order(n: int) -> Sequence[RingElement]:
        found = (
            [x for _, x in conditions.residuals(n)] if power == n else conditions.of_order(n)
            for power, conditions in enumerate(powers)
        )
        return [x for row in found for x in row]

    return of_order


def _slope_residual(extension: ContinuousExtension, own: Sequence[Exact]) -> Exact | None:
    """The largest distance of b'(0) from the first stage and of b'(1) from the stage at the end; None without these."""
    pairs = zip(extension.a, extension.c, strict=True)
    last = next((i for i, (row, node) in enumerate(pairs) if list(row) == own and node == 1), None)
    if last is None or any(extension.a[0]) or extension.c[0]:
        return None
    slopes = [
        (weight[1], sum((k * x for k, x in enumerate(weight)), Fraction(0)))
        for weight in ((*weight, Fraction(0)) for weight in extension.weights)
    ]
    ends = (_size(start - (i == 0)) for i, (start, _) in enumerate(slopes))
    return EXACT.exact(max(*ends, *(_size(end - (i == last)) for i, (_, end) in enumerate(slopes))))


def _size(x: RingElement) -> RingElement:
    return max(x, -x)
