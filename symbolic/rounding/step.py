"""The rounding bound of a step, derived by running the step: |fl(step(z)) - M(h) z| <= E(h)|z| + r(h).

E is a non-negative 2x2 matrix and r a vector of underflow terms, polynomials in d = u/(1+u), eta and |h|, with every
power of d kept. They belong to a program, that is to one order of operations; the form that belongs to a definition
is in `any_order`, a sharper one for one given h in `sharp`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple, TypeAlias

from sympy.polys.matrices import DomainMatrix

from methods.problems import oscillator
from methods.stepping import Force
from symbolic import one_step
from symbolic.one_step import Polynomial
from symbolic.rounding.formats import BINARY64, FloatFormat
from symbolic.rounding.number import RING, Rounded
from symbolic.rounding.trace import (
    NotLinear,
    Subject,
    Terms,
    at_state,
    at_step,
    in_format,
    magnitude,
    program,
    trace,
)

Table: TypeAlias = tuple[tuple[Polynomial, Polynomial], tuple[Polynomial, Polynomial]]
Coefficients: TypeAlias = tuple[Fraction, ...]
CoefficientTable: TypeAlias = tuple[tuple[Coefficients, Coefficients], tuple[Coefficients, Coefficients]]

# Powers of (q, v) in q, in v, and in what does not depend on the state.
COLUMNS = ((1, 0), (0, 1), (0, 0))


class LinearBound(NamedTuple):
    """|dz| <= E|z| + r, component by component, at one h and in one format: plain non-negative fractions.

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

    It holds too when any product is fused into the sum that it enters, but neither for flushed subnormals nor for
    wider registers (see `FloatFormat`). `outputs` is (q1, v1), the step run on `Rounded` numbers. A step that is not
    linear in the state still has `error_of` and `is_safe`; the matrices raise NotLinear.
    """

    format: FloatFormat
    outputs: tuple[Rounded, Rounded]

    @cached_property
    def matrix(self) -> DomainMatrix:
        """M(h) over Q[h]: the exact matrix of this very program, to be held against that of a definition."""
        rows = [[_in_h(x.exact, column) for column in COLUMNS] for x in self.outputs]
        if any(free != 0 for *_, free in rows):
            raise NotLinear("the step is not linear in the state: it adds a constant of its own")
        return DomainMatrix([row[:2] for row in rows], (2, 2), one_step.MATRICES)

    @cached_property
    def error(self) -> Table:
        """E(h): entries in Q[d, eta, |h|] with non-negative coefficients."""
        (qq, qv, _), (vq, vv, _) = self._error_rows
        return (qq, qv), (vq, vv)

    @cached_property
    def underflow(self) -> tuple[Polynomial, Polynomial]:
        """r(h): what is added whatever the state, in Q[d, eta, |h|]; every term has an eta unless the step adds
        constants of its own.
        """
        (_, _, q), (_, _, v) = self._error_rows
        return q, v

    @cached_property
    def first_order(self) -> Table:
        """The coefficient of u in E(h), in Q[h] for h >= 0: the bound up to terms in u**2 and eta."""
        (qq, qv), (vq, vv) = ([_first_order(entry) for entry in row] for row in self.error)
        return (qq, qv), (vq, vv)

    @cached_property
    def coefficients(self) -> tuple[CoefficientTable, CoefficientTable, tuple[Coefficients, Coefficients]]:
        """(M, E, r) as plain fractions in this format, ascending in h or |h|: what a check of many steps evaluates."""
        mqq, mqv, mvq, mvv = (_ascending(_univariate(entry)) for entry in one_step.entries(self.matrix))
        (qq, qv, rq), (vq, vv, rv) = (
            [_ascending(_in_column(terms, column)) for column in COLUMNS] for terms in self._error_terms
        )
        return ((mqq, mqv), (mvq, mvv)), ((qq, qv), (vq, vv)), (rq, rv)

    def at(self, h: Fraction) -> LinearBound:
        """E(h) and r(h) at one h."""
        return linear_bound(*(at_step(terms, abs(h)) for terms in self._error_terms))

    def error_of(self, h: Fraction, q: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """The bounds on |dq| and |dv| of one step from (q, v)."""
        dq, dv = (at_state(at_step(terms, abs(h)), abs(q), abs(v)) for terms in self._error_terms)
        return dq, dv

    def is_safe(self, h: Fraction, q: Fraction, v: Fraction) -> bool:
        """True when no operation of the step can overflow for steps up to |h| and states up to |q|, |v|.

        Sufficient: each operation's |exact| + error stays within the largest finite number.
        """
        return all(
            at_state(at_step(terms, abs(h)), abs(q), abs(v)) <= self.format.largest for terms in self._magnitude_terms
        )

    def differences(self, definition: DomainMatrix) -> list[str]:
        """Where the program's polynomial is not the definition's: one line per coefficient, none if they are equal."""
        names = ("M_qq", "M_qv", "M_vq", "M_vv")
        pairs = zip(names, one_step.entries(self.matrix), one_step.entries(definition), strict=True)
        return [line for name, mine, theirs in pairs for line in _differences(name, mine, theirs)]

    @cached_property
    def _error_rows(self) -> list[list[Polynomial]]:
        for terms in self._error_terms:
            demand_linear(terms)
        return [[_in_d_eta_h(x.error, column) for column in COLUMNS] for x in self.outputs]

    @cached_property
    def _error_terms(self) -> list[Terms]:
        return [in_format(x.error, self.format) for x in self.outputs]

    @cached_property
    def _magnitude_terms(self) -> list[Terms]:
        distinct = {magnitude(x) for x in program(self.outputs)}
        return [in_format(polynomial, self.format) for polynomial in distinct]


def step_bound(subject: Subject, fmt: FloatFormat = BINARY64, force: Force = oscillator) -> StepBound:
    """The rounding bound of one step, found by running it.

    `subject` is a step function (force, q, v, h) -> (q1, v1), whose own order of operations counts, or a method, which
    stands for its generic step with every coefficient rounded to the format. Raises RefusedOperation.
    """
    q1, v1 = trace(subject, fmt, force)
    return StepBound(fmt, (q1, v1))


def linear_bound(dq: Terms, dv: Terms) -> LinearBound:
    """Two bounds that are linear in (|q|, |v|), as a matrix and a vector. Raises NotLinear."""
    for terms in (dq, dv):
        demand_linear(terms)
    (qq, qv, rq), (vq, vv, rv) = ([terms.get(column, Fraction(0)) for column in COLUMNS] for terms in (dq, dv))
    return LinearBound(((qq, qv), (vq, vv)), (rq, rv))


def demand_linear(powers: Iterable[tuple[int, ...]]) -> None:
    """Raises NotLinear unless each term, by the last two of its powers, is one in q, v or 1."""
    for *_, in_q, in_v in powers:
        if (in_q, in_v) not in COLUMNS:
            raise NotLinear(f"the step is not linear in the state: it holds q**{in_q} * v**{in_v}")


def _in_h(polynomial: Polynomial, column: tuple[int, int]) -> Polynomial:
    """The coefficient of q, v or 1 in an exact polynomial, in Q[h]."""
    demand_linear(polynomial.monoms())
    return one_step.RING({(in_h,): c for (_, _, in_h, *state), c in polynomial.terms() if tuple(state) == column})


def _in_d_eta_h(polynomial: Polynomial, column: tuple[int, int]) -> Polynomial:
    """The coefficient of q, v or 1 in a bound."""
    return RING.from_dict({(*p[:3], 0, 0): c for p, c in polynomial.terms() if p[3:] == column})


def _first_order(entry: Polynomial) -> Polynomial:
    return one_step.RING({(in_h,): c for (in_d, in_eta, in_h, *_), c in entry.terms() if (in_d, in_eta) == (1, 0)})


def _in_column(terms: Terms, column: tuple[int, int]) -> dict[int, Fraction]:
    return {in_h: c for (in_h, *state), c in terms.items() if tuple(state) == column}


def _univariate(polynomial: Polynomial) -> dict[int, Fraction]:
    return {in_h: Fraction(int(c.numerator), int(c.denominator)) for (in_h,), c in polynomial.terms()}


def _ascending(by_power: dict[int, Fraction]) -> Coefficients:
    return tuple(by_power.get(k, Fraction(0)) for k in range(max(by_power, default=-1) + 1))


def _differences(name: str, mine: Polynomial, theirs: Polynomial) -> list[str]:
    found, expected = _univariate(mine), _univariate(theirs)
    return [
        f"{name}, coefficient of h**{k}: the program has {found.get(k, 0)}, the definition {expected.get(k, 0)}"
        for k in sorted(found.keys() | expected.keys())
        if found.get(k, 0) != expected.get(k, 0)
    ]
