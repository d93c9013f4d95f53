"""The rounding bound of a step, derived by running the step: |fl(step(z)) - M(h) z| <= E(h)|z| + r(h).

E is a non-negative 2x2 matrix and r a vector of underflow terms, polynomials in d = u/(1+u), eta and |h|; no term of
higher order is dropped. M is the exact matrix of the definition; the rounding of its coefficients, rational or not, is
part of E. E and r belong to a program, that is, to one order of operations. `any_evaluation_order` has the bound that
belongs to a definition, and `fixed_step_bound` a sharper one for one given h.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple, TypeAlias

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import Force, Lift, Step, oscillator, stepper
from driftproof.methods.schemes import Method, MethodError
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat
from driftproof.symbolic.rounding.number import RefusedOperation, Rounded, constant, rational_value
from driftproof.symbolic.rounding.polynomials import ErrorPolynomial, H, Q, V, from_terms, majorant, terms

# The subject of a bound: a method, or anybody's step function.
StepOrMethod: TypeAlias = Method | Step
# Powers of (q, v), or of (h, q, v), with their coefficients.
Terms: TypeAlias = dict[tuple[int, ...], Fraction]
ErrorMatrix: TypeAlias = tuple[tuple[ErrorPolynomial, ErrorPolynomial], tuple[ErrorPolynomial, ErrorPolynomial]]
# An entry of M(h): its coefficients by power of h.
ByPower: TypeAlias = dict[int, Exact]

# The powers of (q, v) in the terms q, v and 1.
COLUMNS = ((1, 0), (0, 1), (0, 0))


class NotLinear(ValueError):
    """The step is not linear in the state, so it has no one-step matrix and no error matrix."""


class LinearBound(NamedTuple):
    """A bound |dz| <= E|z| + r, component by component, at one h and in one format, in non-negative fractions.

    `error` is ((E_qq, E_qv), (E_vq, E_vv)), `underflow` is (r_q, r_v).
    """

    error: tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]
    underflow: tuple[Fraction, Fraction]

    def of(self, q: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """E|z| + r at z = (q, v)."""
        (qq, qv), (vq, vv) = self.error
        return qq * abs(q) + qv * abs(v) + self.underflow[0], vq * abs(q) + vv * abs(v) + self.underflow[1]


@dataclass(frozen=True)
class StepBound:
    """|fl(step(z)) - M(h) z| <= E(h)|z| + r(h) for all numbers h, q, v of the format for which nothing overflows.

    It also holds if products are fused into the sums that they enter, but not with flushed subnormals or wider
    registers (see `FloatFormat`). `outputs` is (q1, v1), the step run on `Rounded` numbers. A step that is not
    linear in the state still has `error_of` and `is_safe`; the matrices raise NotLinear.
    """

    format: FloatFormat
    outputs: tuple[Rounded, Rounded]

    @cached_property
    def entries(self) -> tuple[ByPower, ByPower, ByPower, ByPower]:
        """(M_qq, M_qv, M_vq, M_vv) of this program before any rounding, exact, zero coefficients left out."""
        (qq, qv, free_q), (vq, vv, free_v) = ([_in_h(x.exact, column) for column in COLUMNS] for x in self.outputs)
        if free_q or free_v:
            raise NotLinear("the step is not linear in the state: it adds a constant")
        return qq, qv, vq, vv

    @property
    def rounds_constants(self) -> bool:
        """True if the program holds a rounded constant, so that its own polynomial differs slightly from M(h)."""
        return any(x.stored_value is not None and bool(x.error) for x in operations_of(self.outputs))

    @cached_property
    def error(self) -> ErrorMatrix:
        """E(h): entries in Q[d, eta, |h|] with non-negative coefficients, rounded up where they are irrational."""
        (qq, qv, _), (vq, vv, _) = self._error_rows
        return (qq, qv), (vq, vv)

    @cached_property
    def underflow(self) -> tuple[ErrorPolynomial, ErrorPolynomial]:
        """r(h) in Q[d, eta, |h|], whatever the state; every term has an eta unless the step adds constants."""
        (_, _, q), (_, _, v) = self._error_rows
        return q, v

    @cached_property
    def first_order(self) -> ErrorMatrix:
        """The coefficient of u in E(h), a polynomial in h >= 0: the bound up to terms in u**2 and eta."""
        (qq, qv), (vq, vv) = (
            [from_terms(((0, 0, *p[2:]), c) for p, c in terms(entry) if p[:2] == (1, 0)) for entry in row]
            for row in self.error
        )
        return (qq, qv), (vq, vv)

    def at(self, h: Fraction) -> LinearBound:
        """E(h) and r(h) at one h."""
        return linear_bound(*(at_step(error, abs(h)) for error in self._error_terms))

    def error_of(self, h: Fraction, q: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """The bounds on |dq| and |dv| of one step from (q, v)."""
        dq, dv = (at_state(at_step(error, abs(h)), abs(q), abs(v)) for error in self._error_terms)
        return dq, dv

    def is_safe(self, h: Fraction, q: Fraction, v: Fraction) -> bool:
        """True if no operation of the step can overflow for steps up to |h| and states up to |q|, |v|.

        The test is sufficient, not necessary: each operation's |exact| + error is at most the largest finite number.
        """
        return all(
            at_state(at_step(size, abs(h)), abs(q), abs(v)) <= self.format.largest for size in self._magnitude_terms
        )

    def differences(self, definition: StepMatrix) -> list[str]:
        """One line for each coefficient in which the program differs from the definition, compared exactly."""
        names = ("M_qq", "M_qv", "M_vq", "M_vv")
        pairs = zip(names, self.entries, (entry for row in definition for entry in row), strict=True)
        return [line for name, mine, theirs in pairs for line in _differences(name, mine, theirs)]

    @cached_property
    def _error_rows(self) -> list[list[ErrorPolynomial]]:
        """The coefficients of |q|, |v| and 1 in each bound."""
        for error in self._error_terms:
            require_linear(error)
        return [
            [from_terms(((*p[:3], 0, 0), c) for p, c in terms(x.error) if p[3:] == column) for column in COLUMNS]
            for x in self.outputs
        ]

    @cached_property
    def _error_terms(self) -> list[Terms]:
        return [in_format(x.error, self.format) for x in self.outputs]

    @cached_property
    def _magnitude_terms(self) -> list[Terms]:
        sizes = [magnitude(x) for x in operations_of(self.outputs)]
        distinct = {tuple(terms(size)): size for size in sizes}
        return [in_format(size, self.format) for size in distinct.values()]


def step_bound(subject: StepOrMethod, fmt: FloatFormat = BINARY64, force: Force = oscillator) -> StepBound:
    """The rounding bound of one step, found by running it.

    `subject` is a step function (force, q, v, h) -> (q1, v1), whose own order of operations counts, or a method, which
    stands for its generic step with every coefficient rounded to the format. Raises RefusedOperation.
    """
    q1, v1 = trace_step(subject, fmt, force)
    return StepBound(fmt, (q1, v1))


def trace_step(
    subject: StepOrMethod, fmt: FloatFormat, force: Force = oscillator, h: Fraction | None = None
) -> list[Rounded]:
    """Run one step, given as a function or a method, on symbolic (q, v) and return [q1, v1].

    With `h` given (a number of the format) the step size is that constant rather than a symbol. Raises
    RefusedOperation for an operation that cannot be bounded, and MethodError for an implicit method.
    """
    size = Rounded(fmt, H) if h is None else constant(h, fmt)
    try:
        step = subject if callable(subject) else stepper(subject, lift_to(fmt))
    except MethodError as error:
        raise MethodError(f"{error}; `driftproof certify` encloses the error of a run, rounding included") from None
    result = step(force, Rounded(fmt, Q), Rounded(fmt, V), size)
    outputs = list(result) if isinstance(result, Iterable) else []
    if len(outputs) != 2:
        raise RefusedOperation(f"the step returned {result!r}; it must return the pair (q1, v1)")
    return [x if isinstance(x, Rounded) else constant(_require_number(x), fmt) for x in outputs]


def lift_to(fmt: FloatFormat) -> Lift:
    """The lift of exact coefficients to floats of the format: 1/6 becomes the nearest one, with its error."""
    return lambda exact: constant(exact, fmt)


def step_with_stored_coefficients(method: Method, fmt: FloatFormat) -> Step:
    """The generic step of a method with coefficients rounded to the format: in exact arithmetic, another method."""
    return stepper(method, lambda exact: decide_by_enclosure(exact, fmt.nearest))


def operations_of(outputs: Iterable[Rounded]) -> list[Rounded]:
    """Every number that the outputs depend on, once each, operands before results."""
    order: dict[int, Rounded] = {}

    def visit(x: Rounded) -> None:
        if id(x) not in order:
            for operand, _ in x.operands:
                visit(operand)
            order[id(x)] = x

    for output in outputs:
        visit(output)
    return list(order.values())


def magnitude(x: Rounded) -> ErrorPolynomial:
    """|x| + error, a bound on |x^| and on the number that was rounded to x^."""
    return majorant(x.exact) + x.error


def in_format(polynomial: ErrorPolynomial, fmt: FloatFormat) -> Terms:
    """The polynomial in (h, q, v) that remains when the format's d and eta are substituted."""
    left: Terms = {}
    for (in_d, in_eta, *powers), c in terms(polynomial):
        value = c * fmt.relative_error**in_d * fmt.eta**in_eta
        left[tuple(powers)] = left.get(tuple(powers), Fraction(0)) + value
    return left


def at_step(by_powers: Terms, h: Fraction) -> Terms:
    """The polynomial in (q, v) that remains when h is substituted."""
    left: Terms = {}
    for (in_h, *powers), c in by_powers.items():
        left[tuple(powers)] = left.get(tuple(powers), Fraction(0)) + c * h**in_h
    return left


def state_terms(polynomial: ErrorPolynomial, fmt: FloatFormat) -> Terms:
    """The polynomial in (q, v) in this format, where h does not occur, since it was a constant of the program."""
    return {tuple(powers): c for (_, *powers), c in in_format(polynomial, fmt).items()}


def at_state(by_powers: Terms, q: Fraction, v: Fraction) -> Fraction:
    """The value at this (q, v)."""
    return sum((c * q**in_q * v**in_v for (in_q, in_v), c in by_powers.items()), Fraction(0))


def linear_bound(dq: Terms, dv: Terms) -> LinearBound:
    """Two bounds that are linear in (|q|, |v|), as a matrix and a vector. Raises NotLinear."""
    (qq, qv, rq), (vq, vv, rv) = linear_form(dq), linear_form(dv)
    return LinearBound(((qq, qv), (vq, vv)), (rq, rv))


def linear_form(by_state: Terms) -> tuple[Fraction, Fraction, Fraction]:
    """The coefficients of q, v and 1. Raises NotLinear."""
    require_linear(by_state)
    a, b, c = (by_state.get(column, Fraction(0)) for column in COLUMNS)
    return a, b, c


def require_linear(powers: Iterable[tuple[int, ...]]) -> None:
    """Raise NotLinear unless the last two powers of each term are those of q, v or 1."""
    for *_, in_q, in_v in powers:
        if (in_q, in_v) not in COLUMNS:
            raise NotLinear(f"the step is not linear in the state: it has the term q**{in_q} * v**{in_v}")


def _require_number(x: object) -> Fraction:
    exact = rational_value(x)
    if exact is None:
        raise RefusedOperation(f"the step returned {x!r}, a {type(x).__name__} that is not a number")
    return exact


def _in_h(polynomial: ErrorPolynomial, column: tuple[int, int]) -> ByPower:
    """The coefficient, by power of h, of q, v or 1 in an exact polynomial."""
    found = terms(polynomial)
    require_linear(powers for powers, _ in found)
    return {in_h: c for (_, _, in_h, *state), c in found if tuple(state) == column}


def _differences(name: str, mine: ByPower, theirs: RationalFunction) -> list[str]:
    if theirs.den != 1:
        return [f"{name}: in the definition it is not a polynomial in h"]
    expected = {k: c for k, c in enumerate(coefficients(theirs.num)) if c}
    pairs = ((k, mine.get(k, 0), expected.get(k, 0)) for k in sorted(mine.keys() | expected.keys()))
    return [
        f"{name}, coefficient of h**{k}: the program has {has}, the definition {wanted}"
        for k, has, wanted in pairs
        if has != wanted
    ]
