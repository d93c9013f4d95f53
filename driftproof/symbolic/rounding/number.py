"""A number that carries an exact polynomial and a bound on what rounding has done to it.

Model. With d = u/(1+u) and eta the smallest subnormal, rounding a real x to nearest gives x(1 + a) + b, |a| <= d,
|b| <= eta/2, a*b = 0, unless it overflows. Three cases are better, because every finite number is a multiple of eta:
* a sum or difference of two numbers is such a multiple, so b = 0 (a sum below 2**emin is exact);
* a product with an integer is such a multiple, too, so b = 0;
* multiplying or dividing by a power of two only moves the exponent, so a = 0.
The bounds below are worst cases over a and b, so they hold for every state, at every scale, and also when a product and
the sum that it enters are fused into one rounding: fusing drops the product's a and leaves one b, no more than before.
"""

from __future__ import annotations

import linecache
import sys
from fractions import Fraction
from itertools import product
from numbers import Rational, Real
from typing import Any, NoReturn

from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.methods.numbers.number_field import Algebraic, Exact
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.rounding.formats import FloatFormat, is_power_of_two
from driftproof.symbolic.rounding.polynomials import (
    ETA,
    ONE,
    ZERO,
    D,
    ErrorPolynomial,
    absolute_value,
    constant_polynomial,
    constant_term,
    majorant,
    rational_above,
)

# A bound on u = d/(1 - d) in powers of d, for errors of constants, which are known as multiples of u: for d <= 1/2,
# u = d + d**2 + d**3/(1 - d) <= _UNIT.
_UNIT = D + D**2 + 2 * D**3
# Higher powers of d and eta are bounded by these powers: they would only make the bounds of long programs longer.
MOST_D, MOST_ETA = 16, 2


class RefusedOperation(TypeError):
    """An operation of the step has a rounding error that cannot be bounded; the message says what and where."""


class Rounded:
    """A float x^ computed from q, v, h: the exact polynomial x that it approximates, and a bound on |x^ - x|.

    `propagated` bounds what the operands' errors do to the result before it is rounded itself, so
    error = propagated + [rounds] d (|x| + propagated) + [underflows] eta/2, where |x| is the sum of |monomials|, with
    the highest powers of d and eta replaced by `_shortened`.
    `operands` pairs each operand with the exact partial derivative of x by it; `crossed` bounds the product of two
    operands' errors, the only part of `propagated` that those derivatives do not give. `stored_value` is the float
    itself if it is a known constant, and `may_fuse` marks a product, which a compiler may fuse into a sum; `in_sums`
    holds what a known constant may be in a sum: itself and, of a product, its value before rounding.
    """

    __slots__ = (
        "crossed",
        "error",
        "exact",
        "format",
        "in_sums",
        "may_fuse",
        "operands",
        "propagated",
        "rounds",
        "stored_value",
        "underflows",
    )

    def __init__(
        self,
        fmt: FloatFormat,
        exact: ErrorPolynomial,
        operands: tuple[tuple[Rounded, ErrorPolynomial], ...] = (),
        crossed: ErrorPolynomial = ZERO,
        rounds: bool = False,
        underflows: bool = False,
    ) -> None:
        """Make the result of one operation on `operands` or, without operands, an exact input."""
        self.format, self.exact, self.operands, self.crossed = fmt, exact, operands, crossed
        self.rounds, self.underflows = rounds, underflows
        self.may_fuse = False
        self.stored_value: Fraction | None = None
        self.in_sums: tuple[Fraction, ...] = ()
        self.propagated: ErrorPolynomial = sum((majorant(partial) * x.error for x, partial in operands), crossed)
        relative = D * (majorant(exact) + self.propagated) if rounds else ZERO
        self.error: ErrorPolynomial = _shortened(self.propagated + relative + (ETA / 2 if underflows else ZERO), fmt)

    def __add__(self, other: object) -> Rounded:
        """x + y, rounded once."""
        return _sum(self, self._operand(other, "addition"), 1)

    def __radd__(self, other: object) -> Rounded:
        """y + x, rounded once."""
        return _sum(self._operand(other, "addition"), self, 1)

    def __sub__(self, other: object) -> Rounded:
        """x - y, rounded once."""
        return _sum(self, self._operand(other, "subtraction"), -1)

    def __rsub__(self, other: object) -> Rounded:
        """y - x, rounded once."""
        return _sum(self._operand(other, "subtraction"), self, -1)

    def __mul__(self, other: object) -> Rounded:
        """x*y, rounded once."""
        return _product(self, self._operand(other, "multiplication"))

    def __rmul__(self, other: object) -> Rounded:
        """y*x, rounded once."""
        return _product(self._operand(other, "multiplication"), self)

    def __truediv__(self, other: object) -> Rounded:
        """x/c for a constant c != 0, rounded once."""
        divisor = self._operand(other, "division")
        if divisor.stored_value is None:
            _refuse("division by something that depends on q, v or h")
        if not divisor.stored_value or not divisor.exact:
            _refuse("division by zero")
        return _product(self, _reciprocal(divisor))

    def __rtruediv__(self, other: object) -> Rounded:
        """c/x for a constant x != 0, rounded once."""
        return self._operand(other, "division") / self

    def __neg__(self) -> Rounded:
        if self.in_sums:
            return _known(self.format, -self.exact, *(-value for value in self.in_sums))
        return Rounded(self.format, -self.exact, ((self, -ONE),))

    def __pos__(self) -> Rounded:
        return self

    def __getattr__(self, name: str) -> Any:
        """A method that raises RefusedOperation when called: numpy.sin(x) calls x.sin()."""
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *operands: _refuse(f"a call of {name}()")

    def _operand(self, other: object, operation: str) -> Rounded:
        if isinstance(other, Rounded):
            return other
        exact = rational_value(other)
        if exact is None:
            _refuse(f"{operation} with {other!r}, a {type(other).__name__} that is not a finite number")
        return constant(exact, self.format)


def _refusal(what: str) -> Any:
    def refuse(self: Rounded, *operands: object) -> NoReturn:
        _refuse(what)

    return refuse


# A comparison branches on a value, and a conversion hands it to code that cannot be followed.
for _name, _what in {
    **dict.fromkeys(("__eq__", "__ne__", "__lt__", "__le__", "__gt__", "__ge__"), "a comparison of computed values"),
    "__bool__": "a branch on a computed value",
    **dict.fromkeys(("__float__", "__complex__"), "a conversion to float (float(x), or a function of math)"),
    **dict.fromkeys(("__int__", "__index__", "__trunc__"), "a conversion to int"),
    **dict.fromkeys(("__round__", "__floor__", "__ceil__"), "rounding a value to an integer"),
    **dict.fromkeys(("__pow__", "__rpow__"), "a power, whose rounding is the library's own; write it as a product"),
    **dict.fromkeys(("__floordiv__", "__mod__", "__divmod__", "__rfloordiv__", "__rmod__"), "a floor division"),
    "__abs__": "abs(), which branches on a value",
    "__hash__": "a set or dictionary of computed values",
}.items():
    setattr(Rounded, _name, _refusal(_what))


def constant(exact: Exact | int, fmt: FloatFormat) -> Rounded:
    """The number of the format nearest to `exact`, with its distance from it as the error."""
    exact = exact if isinstance(exact, Algebraic) else Fraction(exact)
    return _known(fmt, constant_polynomial(exact), _nearest(fmt, exact))


def _shortened(bound: ErrorPolynomial, fmt: FloatFormat) -> ErrorPolynomial:
    """A bound at least as large without the highest powers, as d <= 1/2, and eta <= 1 in all but toy formats."""
    if fmt.eta > 1:
        return bound
    for number, most, largest in ((D, MOST_D, Fraction(1, 2)), (ETA, MOST_ETA, Fraction(1))):
        while (parts := divmod(bound, number ** (most + 1)))[0]:
            bound = parts[1] + parts[0] * number**most * as_fmpq(largest)
    return bound


def _sum(x: Rounded, y: Rounded, sign: int) -> Rounded:
    exact = x.exact + sign * y.exact
    if x.in_sums and y.in_sums:
        values = {_nearest(x.format, a + sign * b) for a, b in product(x.in_sums, y.in_sums)}
        if len(values) == 1:  # else the constant depends on what is fused
            return _known(x.format, exact, values.pop())
    if _is_zero(y):
        return x
    if _is_zero(x):
        return y if sign == 1 else -y
    return Rounded(x.format, exact, ((x, ONE), (y, ONE * sign)), rounds=True)


def _is_zero(x: Rounded) -> bool:
    """True for the exact constant 0, with which sum(...) starts."""
    return not (x.exact or x.error or x.operands)


def _product(x: Rounded, y: Rounded) -> Rounded:
    factors = [factor.stored_value for factor in (x, y) if factor.stored_value is not None]
    exact = x.exact * y.exact
    if len(factors) == 2:
        fused = factors[0] * factors[1]
        result = _known(x.format, exact, _nearest(x.format, fused), fused)
    else:
        result = Rounded(
            x.format,
            exact,
            ((x, y.exact), (y, x.exact)),
            crossed=x.error * y.error,
            rounds=not any(is_power_of_two(c) for c in factors),
            underflows=not any(c.denominator == 1 for c in factors),
        )
    result.may_fuse = True
    return result


def _reciprocal(divisor: Rounded) -> Rounded:
    """1/c as a factor: not a float, but multiplying by it rounds exactly as dividing by c does."""
    assert divisor.stored_value is not None
    return _known(divisor.format, constant_polynomial(1 / constant_term(divisor.exact)), 1 / divisor.stored_value)


def _known(fmt: FloatFormat, exact: ErrorPolynomial, *in_sums: Fraction) -> Rounded:
    """A constant, stored as the first of `in_sums` where the mathematics has `exact`; the error is their distance.

    It is the larger distance where a product of constants enters sums without a rounding, as the second of `in_sums`.

    The distance is sharper than the general bound u|exact|: a rational one is not rounded, so it is 0 for a constant
    that the format holds; an irrational one is rounded up by a relative 2**-GUARD_BITS at most.
    """
    x = Rounded(fmt, exact)
    x.stored_value, x.in_sums = in_sums[0], in_sums
    distance = max(rational_above(absolute_value(constant_term(exact) - value)) for value in in_sums)
    x.error = x.propagated = _UNIT * as_fmpq(distance / fmt.u)
    return x


def _nearest(fmt: FloatFormat, exact: Exact) -> Fraction:
    try:
        return decide_by_enclosure(exact, fmt.nearest)
    except OverflowError as overflow:
        raise OverflowError(f"{_place()}: a constant is too large: {overflow}") from None


def rational_value(x: object) -> Fraction | None:
    """The exact value of an integer, a fraction, or a finite float of any library; None for anything else."""
    if isinstance(x, bool):
        return None
    if isinstance(x, Rational):
        return Fraction(int(x.numerator), int(x.denominator))
    ratio = getattr(x, "as_integer_ratio", None)
    if not isinstance(x, Real) or ratio is None:
        return None
    try:
        numerator, denominator = ratio()
    except (OverflowError, ValueError):  # infinities and NaN
        return None
    return Fraction(int(numerator), int(denominator))


def _refuse(what: str) -> NoReturn:
    raise RefusedOperation(f"{_place()}: no rounding bound for {what}")


def _place() -> str:
    """The place in the user's code, the innermost frame outside this file, as file:line and the line itself."""
    frame = sys._getframe()
    while frame.f_code.co_filename == __file__ and frame.f_back is not None:
        frame = frame.f_back
    name, line = frame.f_code.co_filename, frame.f_lineno
    text = linecache.getline(name, line).strip()
    return f"{name}:{line}: `{text}`" if text else f"{name}:{line}"
