"""Numbers on which a user's right-hand side is run: balls, Taylor series and Taylor models, with derivatives.

One class carries a value and, on request, its partial derivatives with respect to the state. NumPy's functions call its
methods, for single numbers and for numbers in arrays. Operations that have no enclosure are refused: a comparison that
a ball cannot decide, a conversion to a float, a function where it is not analytic.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import partial, wraps
from math import ceil, floor, trunc
from numbers import Rational
from typing import Any, cast

import numpy as np
from flint import arb, arb_series

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused, Value, ZeroByZero, running_line
from driftproof.enclosure.arithmetic.functions import ANALYTIC, inverse_of, power_of, quotient_of
from driftproof.methods.formulas.vector_fields import FLOOR
from driftproof.methods.numbers.flint_rationals import dyadic


def _lifts_other(operation: Callable[[Enclosed, Enclosed], Any]) -> Callable[[Enclosed, object], Any]:
    """The operation with its second operand lifted; NotImplemented for arrays and matrices, which do it themselves."""

    @wraps(operation)
    def lifting(x: Enclosed, other: object) -> Any:
        if isinstance(other, Enclosed):
            return operation(x, other)
        if isinstance(other, np.ndarray) or getattr(other, "__array_ufunc__", x) is None:
            return NotImplemented
        return operation(x, Enclosed(x.evaluation, x.evaluation.constant(other)))

    return lifting


def exact_value(x: object) -> Fraction | None:
    """The rational number that x is: a finite number of Python or NumPy, or an enclosed one that is a constant."""
    if isinstance(x, Enclosed):
        return x.exact
    if isinstance(x, np.generic):
        x = x.item()
    if isinstance(x, Rational) or (isinstance(x, float) and np.isfinite(x)):
        return Fraction(x)
    return None


def _compares(name: str) -> Callable[[Enclosed, object], Any]:
    """The comparison gt, lt, ge or le: of a difference, or its negative, that has to be positive, or not negative.

    The answer is NumPy's, as of components: of two such, + is "or", and ~ is "not". Constants are compared exactly.
    """
    compare, exchanged, at_zero = getattr(operator, name), name in ("lt", "le"), name in ("ge", "le")

    def compared(x: Enclosed, other: object) -> Any:
        if isinstance(other, np.ndarray):
            return NotImplemented
        if x.exact is not None and (known := exact_value(other)) is not None:
            return np.bool_(compare(x.exact, known))
        value = other.value if isinstance(other, Enclosed) else x.evaluation.constant(other)
        sides = (value, x.value) if exchanged else (x.value, value)
        return np.bool_(x.evaluation.decide(*sides, at_zero=at_zero))

    return compared


# The derivative of a component with respect to itself; a factor is not multiplied by it.
OWN_SLOPE = arb(1)


def _summed(x: Mapping[int, Value] | None, y: Mapping[int, Value] | None) -> Mapping[int, Value] | None:
    """The partial derivatives of a sum."""
    return {**x, **{j: x[j] + d if j in x else d for j, d in y.items()}} if x and y else x or y


def _times(x: Mapping[int, Value], factor: Value) -> Mapping[int, Value]:
    return {j: factor if d is OWN_SLOPE else factor * d for j, d in x.items()}


class Enclosed:
    """A number of an `Evaluation`: a value and its partial derivatives by the components that it depends on, if asked.

    `exact` is the rational number that a constant is, as far as that is known.
    """

    __slots__ = ("evaluation", "exact", "partials", "value")
    __hash__ = None  # type: ignore[assignment]

    def __init__(
        self,
        evaluation: Evaluation,
        value: Value,
        partials: Mapping[int, Value] | None = None,
        exact: Fraction | None = None,
    ) -> None:
        """Take all as they are."""
        self.evaluation, self.value, self.partials, self.exact = evaluation, value, partials, exact

    def _with_chain_rule(self, value: Value, *rules: tuple[Enclosed, Callable[[], Value]]) -> Enclosed:
        """The value with derivatives by the chain rule; each rule gives the derivative with respect to its argument."""
        partials: Mapping[int, Value] | None = None
        for argument, rule in rules:
            if argument.partials:
                partials = _summed(partials, _times(argument.partials, rule()))
        return Enclosed(self.evaluation, value, partials)

    @_lifts_other
    def __add__(self, o: Enclosed) -> Enclosed:
        value = self.value + o.value
        self.evaluation.made_of(value, self.value, o.value, product=False)
        return Enclosed(self.evaluation, value, _summed(self.partials, o.partials))

    __radd__ = __add__

    def __neg__(self) -> Enclosed:
        value = -self.value
        self.evaluation.made_of(value, self.value, arb(-1), product=True)
        return Enclosed(self.evaluation, value, self.partials and {j: -d for j, d in self.partials.items()})

    def __pos__(self) -> Enclosed:
        return self

    @_lifts_other
    def __sub__(self, o: Enclosed) -> Any:
        return self + -o

    @_lifts_other
    def __rsub__(self, o: Enclosed) -> Any:
        return o + -self

    @_lifts_other
    def __mul__(self, o: Enclosed) -> Enclosed:
        value = self.value * o.value
        self.evaluation.made_of(value, self.value, o.value, product=True)
        partials = self.partials and _times(self.partials, o.value)
        return Enclosed(self.evaluation, value, _summed(partials, o.partials and _times(o.partials, self.value)))

    __rmul__ = __mul__

    @_lifts_other
    def __truediv__(self, o: Enclosed) -> Enclosed:
        inverse = inverse_of(o.value)
        if isinstance(inverse, arb) and not inverse.is_finite() and self.value.contains(0):
            raise ZeroByZero("f divides a number that may be 0 by one that may be 0")
        value = self.value * inverse
        self.evaluation.made_of(value, self.value, inverse, product=True)
        return self._with_chain_rule(value, (self, lambda: inverse), (o, lambda: -value * inverse))

    @_lifts_other
    def __rtruediv__(self, o: Enclosed) -> Any:
        return o / self

    def __pow__(self, other: object) -> Any:
        """The power; x has to be positive unless the exponent is an integer."""
        if isinstance(other, float) and other.is_integer():
            other = int(other)
        if isinstance(other, int | np.integer):
            return self._whole_power(int(other))
        if isinstance(other, float) and (2 * other).is_integer():
            return self.sqrt()._whole_power(int(2 * other))
        return NotImplemented if isinstance(other, np.ndarray) else (other * self.log()).exp()

    @_lifts_other
    def __rpow__(self, o: Enclosed) -> Any:
        """The power with the operands exchanged, for a positive base."""
        return (self * o.log()).exp()

    def _whole_power(self, n: int) -> Any:
        if n < 0:
            return 1 / self._whole_power(-n)
        if n == 0:
            return Enclosed(self.evaluation, self.value * 0 + 1)
        before = power_of(self.value, n - 1)
        return self._with_chain_rule(before * self.value, (self, lambda: n * before))

    __gt__, __lt__, __ge__, __le__ = map(_compares, ("gt", "lt", "ge", "le"))

    def __eq__(self, other: object) -> Any:
        """False if the two certainly differ, True if they are the same exact number. Raises Refused otherwise."""
        return NotImplemented if isinstance(other, np.ndarray) else (self >= other and self <= other)

    def __bool__(self) -> bool:
        """True if the number is certainly not 0. Raises Refused otherwise."""
        return bool(self != 0)

    def __abs__(self) -> Enclosed:
        """x or -x, by the sign of x on the whole box; as text |x|. Raises Refused if the sign is not known."""
        if (written := self.evaluation.written("abs", self.value)) is not None:
            return Enclosed(self.evaluation, written)
        return self if self > 0 else -self

    def __float__(self, *_: object) -> float:
        """Raise Refused, with the line of f that wants it: an enclosure is not a float."""
        said = f"f converts a number to a float{running_line()}; what has an enclosure are functions of NumPy and math"
        raise Refused(f"{said}, SciPy's CubicSpline and make_interp_spline, and arrays that f makes itself")

    __index__ = __complex__ = cast(Any, __float__)

    def __floor__(self) -> Any:
        """The largest integer that is not larger, as text of a text. Raises Refused if two are in the ball."""
        if (written := self.evaluation.written(FLOOR, self.value)) is not None:
            return Enclosed(self.evaluation, written)
        return self.evaluation.floor(self.value) if self.exact is None else floor(self.exact)

    def __ceil__(self) -> Any:
        return -floor(-self)

    def __trunc__(self) -> Any:
        return floor(self) if self > 0 else ceil(self)

    def __int__(self) -> int:
        return self._as_integer(trunc(self))

    def __round__(self, digits: int | None = None) -> Any:
        """The nearest integer, or the nearest multiple of 10^-digits; where two are equally near, the even one."""
        if digits is not None:
            return round(self * Fraction(10) ** digits) / Fraction(10) ** digits
        if self.evaluation.span is None and isinstance(self.value, arb) and self.value.is_exact():
            return round(dyadic(self.value))
        return self._as_integer(floor(self + Fraction(1, 2)))

    @staticmethod
    def _as_integer(x: Any) -> int:
        if isinstance(x, int):
            return x
        raise Refused("f rounds a number to an integer; a problem may use math.floor, as of x + 0.5, math.trunc and %")

    @_lifts_other
    def __floordiv__(self, o: Enclosed) -> Any:
        return floor(self / o)

    @_lifts_other
    def __mod__(self, o: Enclosed) -> Any:
        """The remainder, by Python's rule: it has the sign of the divisor."""
        return self - floor(self / o) * o

    @_lifts_other
    def __rfloordiv__(self, o: Enclosed) -> Any:
        return o // self

    @_lifts_other
    def __rmod__(self, o: Enclosed) -> Any:
        return o % self

    def __divmod__(self, other: object) -> Any:
        return self // other, self % other

    def fmod(self, other: Any) -> Any:
        """The remainder by the rule of C: it has the sign of the number itself."""
        by = abs(other)
        return self % by if self > 0 else -(-self % by)

    @_lifts_other
    def copysign(self, o: Enclosed) -> Any:
        """|x|, or -|x| if the other number is negative."""
        return abs(self) if o >= 0 else -abs(self)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Apply a NumPy function to numbers, or to arrays that contain them."""
        if method != "__call__" or options:
            raise Refused(f"f uses numpy.{ufunc.__name__} in a way that has no enclosure")
        if ufunc.__name__ in _WITHOUT_LOOP:
            call = lambda first, *more: getattr(enclosed(self.evaluation, first), ufunc.__name__)(*more)
            return enclosed(self.evaluation, np.vectorize(call, otypes=[object])(*inputs))
        try:
            result = ufunc(*(_boxed(x) for x in inputs))
        except TypeError as error:
            if isinstance(error.__cause__, Refused):
                raise error.__cause__ from None
            if "not supported" not in str(error):
                raise
            raise Refused(f"f uses {ufunc.__name__}, which has no enclosure") from None
        return enclosed(self.evaluation, result) if ufunc.__name__ in SELECTING else _unboxed(result)

    def __getattr__(self, name: str) -> Callable[[], Enclosed]:
        """A function of the tables below: numpy.sin(x) calls x.sin(), and asks for what an array has."""
        if name.startswith("__"):
            raise AttributeError(name)
        if name in ANALYTIC:
            return lambda: self._analytic(*ANALYTIC[name])
        if name in _BY_OTHERS:
            return lambda: _BY_OTHERS[name](self)
        if isinstance(getattr(np, name, None), np.ufunc):  # not an AttributeError, which f may catch
            raise Refused(f"f uses {name}, which has no enclosure")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def _analytic(self, name: str, slope: Callable[[Value, Value], Value]) -> Enclosed:
        value = self.evaluation.function(name, self.value)
        return self._with_chain_rule(value, (self, lambda: slope(self.value, value)))

    def exprel(self) -> Enclosed:
        """(exp x - 1)/x, 1 at 0."""
        return self._quotient("exprel")

    def sinc(self) -> Enclosed:
        """NumPy's sin(πx)/(πx), 1 at 0."""
        angle: Enclosed = self * Enclosed(self.evaluation, arb.pi())
        return angle._quotient("sinc")

    def _quotient(self, name: str) -> Enclosed:
        if (written := self.evaluation.written(name, self.value)) is not None:
            return Enclosed(self.evaluation, written)
        rule = lambda: quotient_of(self.value, name, slope=True)
        return self._with_chain_rule(quotient_of(self.value, name), (self, rule))

    def heaviside(self, at_zero: Any) -> Any:
        """0 below 0, 1 above, `at_zero` at 0."""
        return 1 if self > 0 else 0 if self < 0 else at_zero

    def sign(self) -> int:
        """-1, 0 or 1."""
        return 1 if self > 0 else -1 if self < 0 else 0

    @_lifts_other
    def hypot(self, o: Enclosed) -> Any:
        """sqrt(x² + y²)."""
        return (self * self + o * o).sqrt()

    @_lifts_other
    def arctan2(self, x: Enclosed) -> Any:
        """The angle of the point (x, self), which jumps where x < 0 and self = 0."""
        certain, half_turn = self.evaluation.is_positive, Enclosed(self.evaluation, arb.pi())
        right = x > 0
        above = right or self >= 0
        away = x if right else -x
        near_axis = certain((away - self).value) and certain((away + self).value)
        for side in () if near_axis else (1, -1):  # from the other axis
            if certain((side * self).value):
                return side * half_turn / 2 - (x / self).arctan()
        angle = (self / x).arctan()
        return angle if right else angle + half_turn if above else angle - half_turn


# Functions in terms of others; the number itself is its conjugate, since it is real.
_BY_OTHERS: dict[str, Callable[[Any], Any]] = {
    "tan": lambda x: x.sin() / x.cos(),
    "sinh": lambda x: (x.exp() - (-x).exp()) / 2,
    "cosh": lambda x: (x.exp() + (-x).exp()) / 2,
    "tanh": lambda x: 1 - 2 / ((2 * x).exp() + 1),
    "exp2": lambda x: 2**x,
    "expm1": lambda x: x.exp() - 1,
    "log1p": lambda x: (1 + x).log(),
    "log2": lambda x: x.log() / Enclosed(x.evaluation, arb(2).log()),
    "log10": lambda x: x.log() / Enclosed(x.evaluation, arb(10).log()),
    "cbrt": lambda x: (x.log() / 3).exp() if x > 0 else -(((-x).log() / 3).exp()),
    "erfc": lambda x: 1 - x.erf(),
    "expit": lambda x: 1 / (1 + (-x).exp()),
    **dict.fromkeys(("conjugate", "item"), lambda x: x),
    "fabs": abs,
    "rint": round,
    **dict.fromkeys(("radians", "deg2rad"), lambda x: x * Enclosed(x.evaluation, arb.pi() / 180)),
    **dict.fromkeys(("degrees", "rad2deg"), lambda x: x * Enclosed(x.evaluation, 180 / arb.pi())),
}


# Functions of NumPy and SciPy that have no loop over objects.
_WITHOUT_LOOP = ("copysign", "erf", "erfc", "exprel", "expit", "fmod", "heaviside", "sign")
# What returns one of its arguments, which may be a constant: it stays exact in what f makes of it.
SELECTING = ("maximum", "minimum", "fmax", "fmin", "clip")


def _unboxed(x: Any) -> Any:
    return x[()] if isinstance(x, np.ndarray) and not x.ndim else x


def _boxed(x: Any) -> Any:
    """A number as a zero-dimensional array, so that NumPy's functions call its methods."""
    if not isinstance(x, Enclosed):
        return x
    box = np.empty((), dtype=object)
    box[()] = x
    return box


def size(values: Iterable[arb]) -> arb:
    """An upper bound, of radius 0, of |x| over the balls: the least one but for its rounding; NaN if any is NaN."""
    largest = arb(0)
    for x in values:
        largest = largest.max(arb(x.abs_upper()))  # Python's max would lose a NaN
    return largest


def series(evaluation: Evaluation, coefficients: Sequence[arb], length: int) -> Enclosed:
    """A Taylor series of `length` coefficients, those that are not given being 0."""
    return Enclosed(evaluation, arb_series(list(coefficients[:length]), length))


def enclosed(evaluation: Evaluation, x: Any) -> Any:
    """A number as an enclosed one, or an array of such."""
    x = _unboxed(x)
    if isinstance(x, np.ndarray):
        return np.vectorize(partial(enclosed, evaluation), otypes=[object])(x)
    return x if isinstance(x, Enclosed) else Enclosed(evaluation, evaluation.constant(x), exact=exact_value(x))
