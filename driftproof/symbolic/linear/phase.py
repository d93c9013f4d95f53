"""Exact series: error constants, dispersion, dissipation and the modified equation on linear problems."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from math import isqrt

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.numbers.number_field import square_root as number_root
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import ONE, exact, reflected, scalar
from driftproof.symbolic.algebra.radicals import perfect_part
from driftproof.symbolic.algebra.rational_functions import (
    PowerSeries,
    RationalFunction,
    exponential_series,
    fraction,
    series_derivative,
    series_integral,
    series_logarithm,
    series_product,
    series_quotient,
    series_root,
    taylor,
)
from driftproof.symbolic.linear.oscillator import area_factor, matrix_trace


class NoRotationError(ValueError):
    """Raised for a step that for small h is no rotation, or turns by s*h + O(h**2) with s**2 no positive rational."""


@dataclass(frozen=True)
class LeadingTerm:
    """The lowest term of a nonzero series: coefficient * h**power, or z**power for R(z)."""

    power: int
    coefficient: Exact


def error_constant(r: RationalFunction) -> LeadingTerm:
    """C zᵖ⁺¹, the leading term of R(z) - eᶻ, computed minus exact; p is the order on linear problems.

    p is never below the order. The term exists: R agrees with exp at most up to the power deg P + deg Q (Padé).
    """
    terms = r.num.degree() + r.den.degree() + 2
    return _leading([a - b for a, b in zip(taylor(r, terms), exponential_series(terms), strict=True)])


def matrix_error(m: StepMatrix) -> int:
    """The lowest power of h at which M(h) and exp(hJ) differ; the order on the oscillator is one less."""
    terms = 2
    while True:
        terms *= 2
        cosine, sine = _real_and_imaginary(exponential_series(terms))
        entries = zip(chain.from_iterable(m), (cosine, sine, [-c for c in sine], cosine), strict=True)
        pairs = ((k, x, y) for f, e in entries for k, (x, y) in enumerate(zip(taylor(f, terms), e, strict=True)))
        if differing := [k for k, x, y in pairs if x != y]:
            return min(differing)


def modified_rate(r: RationalFunction, terms: int) -> PowerSeries:
    """The first `terms` coefficients of log R(z) = z + ...: the step is the exact flow of y' = (log R(hλ)/h) y.

    That is the modified equation on linear problems (hairer-lubich-wanner-2006, IX.1).
    """
    return series_logarithm(taylor(r, terms))


def dispersion_series(r: RationalFunction, terms: int) -> PowerSeries:
    """arg R(ih) - h modulo h**terms, from the odd powers of log R."""
    _, turned = _real_and_imaginary(modified_rate(r, terms))
    return [c - 1 if k == 1 else c for k, c in enumerate(turned)]


def dissipation_series(r: RationalFunction, terms: int) -> PowerSeries:
    """log |R(ih)| modulo h**terms, from the even powers of log R."""
    return _real_and_imaginary(modified_rate(r, terms))[0]


def dispersion(r: RationalFunction) -> LeadingTerm:
    """The leading term of arg R(ih) - h, which exists, as R(z)/R(-z) is rational and e²ᶻ is not."""
    return _leading_of(lambda terms: dispersion_series(r, terms))


def dissipation(r: RationalFunction) -> LeadingTerm | None:
    """The leading term of log |R(ih)|; None if |R(ih)| = 1 for every h, that is R(z) R(-z) = 1."""
    if is_linearly_symmetric(r):
        return None
    return _leading_of(lambda terms: dissipation_series(r, terms))


def is_linearly_symmetric(r: RationalFunction) -> bool:
    """True if R(z) R(-z) = 1: on linear problems a step of -h undoes a step of h."""
    return bool(r.num * reflected(r.num) == r.den * reflected(r.den))


def angle_error_series(m: StepMatrix, terms: int) -> PowerSeries:
    """θ(h) - h modulo h**terms, θ the angle of the eigenvalues: cos θ = tr M / (2 sqrt(det M)).

    It comes from θ' = -(cos θ)' / sin θ. An inconsistent splitting turns by θ = σh + O(h²), σ = sqrt(Σ kicks Σ drifts),
    with a series over Q(σ). Raises NoRotationError unless σ² is rational and positive.
    """
    cosine, sine = _cosine_and_sine(m, terms)
    slope = series_quotient([-c for c in series_derivative(cosine)[1:]], sine)
    return [c - 1 if k == 1 else c for k, c in enumerate(series_integral(slope)[:terms])]


def leading_frequency(m: StepMatrix) -> Exact:
    """The σ in θ = σh + O(h²), 1 for a consistent method. Raises NoRotationError unless σ² is a positive rational."""
    return _square_root(exact(_square_of_sine(_cosine(m, 2))[0]))


def _cosine(m: StepMatrix, terms: int) -> PowerSeries:
    """cos θ = 1 + O(h²) modulo h**(terms + 1), for M = I + O(h) with trace 2 + O(h²) and determinant 1 + O(h²)."""
    root = series_root(taylor(area_factor(m), terms + 1))
    return series_quotient([c / 2 for c in taylor(matrix_trace(m), terms + 1)], root)


def _square_of_sine(cosine: PowerSeries) -> PowerSeries:
    """sin² θ / h² modulo h**(terms - 1)."""
    return [-c for c in series_product(cosine, cosine)][2:]


def _cosine_and_sine(m: StepMatrix, terms: int) -> tuple[PowerSeries, PowerSeries]:
    """cos θ modulo h**(terms + 1) and sin θ / h modulo h**(terms - 1)."""
    cosine = _cosine(m, terms)
    square_of_sine = _square_of_sine(cosine)
    rate = square_of_sine[0]
    root_of_rate = scalar(_square_root(exact(rate)))
    return cosine, [c * root_of_rate for c in series_root([c / rate for c in square_of_sine])]


def _square_root(x: Exact) -> Exact:
    """The exact square root of a rational x > 0. Raises NoRotationError for any other x."""
    if not isinstance(x, Fraction) or x <= 0:
        raise NoRotationError(f"the step turns by s*h + O(h**2) with s**2 = {x}, which is not a positive rational")
    product = x.numerator * x.denominator
    outer, inner = perfect_part(product, 2) or (1, product)
    root = isqrt(inner)
    surd = Fraction(root) if root**2 == inner else number_root(inner)
    return surd * Fraction(outer, x.denominator)


def damping_series(m: StepMatrix, terms: int) -> PowerSeries:
    """½ log det M modulo h**terms, the logarithm of the modulus of the complex eigenvalues."""
    return [c / 2 for c in series_logarithm(taylor(area_factor(m), terms))]


def angle_error(m: StepMatrix) -> LeadingTerm:
    """The leading term of θ(h) - h, which exists, as cos θ is algebraic in h and cos h is not.

    Raises NoRotationError as `leading_frequency` does.
    """
    excess = leading_frequency(m) - 1
    return LeadingTerm(1, excess) if excess else _leading_of(lambda terms: angle_error_series(m, terms))


def leading_dissipation(m: StepMatrix) -> LeadingTerm | None:
    """The leading term of ½ log det M; None if det M = 1 for every h."""
    if area_factor(m) == fraction(ONE):
        return None
    return _leading_of(lambda terms: damping_series(m, terms))


def modified_factor_series(m: StepMatrix, terms: int) -> PowerSeries:
    """θ / sin θ modulo h**terms, the factor of the modified Hamiltonian, for det M = 1."""
    angle = angle_error_series(m, terms + 1)
    over_step = [c if k else c + 1 for k, c in enumerate(angle[1:])]
    return series_quotient(over_step, _cosine_and_sine(m, terms + 1)[1])


def _real_and_imaginary(series: PowerSeries) -> tuple[PowerSeries, PowerSeries]:
    """The real and imaginary parts of Σ cₖ (ih)ᵏ as series in h."""
    signed = [(k % 2, c * (-1) ** (k // 2)) for k, c in enumerate(series)]
    return [c * (1 - odd) for odd, c in signed], [c * odd for odd, c in signed]


def _leading_of(compute: Callable[[int], PowerSeries]) -> LeadingTerm:
    """The leading term of a nonzero series, whose length is doubled until a nonzero term appears."""
    terms = 8
    while not any(compute(terms)):
        terms *= 2
    return _leading(compute(terms))


def _leading(series: PowerSeries) -> LeadingTerm:
    power = next(k for k, c in enumerate(series) if c)
    return LeadingTerm(power, exact(series[power]))
