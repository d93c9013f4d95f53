"""Order reduction, exactly: the first term of a method's error on a stiff problem whose solution is smooth."""

from __future__ import annotations

from dataclasses import dataclass

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.polynomials import exact
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.stability_function import prothero_robinson


@dataclass(frozen=True)
class StiffError:
    """φ(t + h) - y₁ = C hᵏ (hλ)⁻ᵐ φ⁽ᵏ⁾(t) + terms that are smaller for small h and large |hλ|.

    k is `power`, m is `decay`, C is `coefficient`; `at_infinity` is R(oo).
    """

    power: int
    decay: int
    coefficient: Exact
    at_infinity: Exact

    @property
    def order(self) -> int:
        """The order in h of the error at a fixed time, λ fixed and |hλ| large.

        That error is Σ Rⁿ times local ones: bounded by a multiple of one where |R(oo)| < 1, and where R(oo) = -1, as
        they alternate; where R(oo) = 1 there are t/h of them.
        """
        return self.power - self.decay - (1 if self.at_infinity == 1 else 0)


def stiff_error(method: RungeKutta | Collocation) -> StiffError:
    """The leading ψₖ(z) of `prothero_robinson` for z to -oo: k <= stages + 2: the slowest to fall, then the lowest.

    With A invertible and distinct nodes that are not 0, ψₖ tends to (1 - bᵀA⁻¹cᵏ)/k!. Where that is zero for k up to
    stages + 1, the functional bᵀA⁻¹ on the multiples of c is the value at 1, and 1 is a node: it is zero for every k.
    Raises ValueError for a method with |R(oo)| > 1, which is unstable there.
    """
    r = stability_function_of(method)
    limit = None if r is None else r.at_infinity()
    if limit is None or limit > 1 or limit < -1:
        raise ValueError(f"{method.key} is unstable where |h lambda| is large: its errors grow")
    leading = (_leading(method, k) for k in range(1, method.stages + 3))
    decay, power, coefficient = min((x for x in leading if x is not None), key=lambda x: x[:2])
    return StiffError(power, decay, coefficient, limit)


def _leading(method: RungeKutta | Collocation, power: int) -> tuple[int, int, Exact] | None:
    """m, k and C where ψₖ(z) = C z⁻ᵐ + ...; None where it is zero."""
    f = prothero_robinson(method, power)
    if f.num == 0:
        return None
    quotient = f.num.leading_coefficient() / f.den.leading_coefficient()
    return f.den.degree() - f.num.degree(), power, exact(quotient)
