"""How far a float step may be from the exact one: the definition's bound in any order of evaluation, and allowances."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import inf, log
from typing import Any, NamedTuple

from flint import arb, arb_poly, ctx

from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.judging.specification import NO_ALLOWANCE, Allowance, Specification
from driftproof.methods.catalogue import of_one_state
from driftproof.methods.schemes import Method, RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import CertifiableReal, enclose
from driftproof.symbolic.algebra.polynomials import coefficients
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.rounding.any_evaluation_order import Columns, any_order_columns, flushed_columns, size_columns
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64, FloatFormat, power_of_two
from driftproof.symbolic.runs import apply, exact_matrix_at

# A product of two doubles needs 106 bits, and a step of the longest program some 30 products. At this precision the
# radii of all balls here are below 2**-200 of what they enclose, so every comparison with a bound of size u is decided.
_BITS = 320
# A stage may be an average of states and a slope, as the last one of Heun's method is in (y + y1 + h f(y1))/2. That
# takes each of its terms through at most four roundings (a weight, its product, two sums), and a sum of slopes one.
AVERAGES = 4
# A kick may be added in parts, as of a force that is a sum of three: each of its terms passes two more roundings, which
# at most triple its share of the bound.
KICKS = 3


class Judgement(NamedTuple):
    """The error of one component of a step: `ratio` to its bound, and `scaled` to u times the sum of |monomials|.

    `allowed`, by the bound or a multiple of it where stages may be averages, is decided in balls; `ratio` and `scaled`
    are floats for people, and `scaled` is 0 in the range of underflow.
    """

    allowed: bool
    ratio: float
    scaled: float


@dataclass(frozen=True)
class Tolerance:
    """The exact step of `method` on the oscillator, and the bound on the error of a float step in one format.

    Raises ValueError for an implicit method without `solver_tolerance`, and for an explicit one with it.
    """

    method: Method
    format: FloatFormat = BINARY64
    allowance: Allowance = NO_ALLOWANCE
    kicks: int = 1

    @classmethod
    def of(cls, wanted: Specification, fmt: FloatFormat, kicks: int = 1) -> Tolerance:
        """The tolerance of a specification in a format; of a splitting, whose kicks may be added in so many parts."""
        method = of_one_state(wanted.method)
        return cls(method, fmt, wanted.allowance, kicks if isinstance(method, Splitting) else 1)

    def __post_init__(self) -> None:
        """Raise ValueError unless a `solver_tolerance` is given for an implicit method, and only then."""
        given = self.allowance.solver_tolerance is not None
        if self.method.explicit and given:
            raise ValueError(f"{self.method.key} is explicit: its bound is derived, and takes no solver_tolerance")
        if not self.method.explicit and not given:
            raise ValueError(
                f"{self.method.key} is implicit: its definition does not fix how accurately its stages are solved; "
                "give --solver-tolerance 1e-10, in Python allowance=Allowance(solver_tolerance=1e-10)"
            )

    def exact(self, q: float, v: float, h: float) -> tuple[arb, arb]:
        """The exact step from exactly these floats, in balls of negligible radius."""
        with ctx.workprec(_BITS):
            at = arb(self._step(h))
            (qq, qv), (vq, vv) = ([num(at) / den(at) for num, den in row] for row in self._matrix)
            return qq * q + qv * v, vq * q + vv * v

    def in_full(self, q: float, v: float, h: float) -> tuple[CertifiableReal, CertifiableReal]:
        """The exact step as exact numbers, for people; slower than `exact`, which returns balls."""
        matrix = exact_matrix_at(self.method, Fraction(self._step(h)))
        return apply(matrix, Fraction(q), Fraction(v))

    def judge(self, q: float, v: float, h: float, answer: tuple[float, float]) -> tuple[Judgement, Judgement]:
        """Compare both components of a float step with the bound."""
        expected = self.exact(q, v, h)
        with ctx.workprec(_BITS):
            at, state = abs(arb(self._step(h))), (abs(arb(q)), abs(arb(v)))
            judged = []
            for i, (want, got) in enumerate(zip(expected, answer, strict=True)):
                bound, size = self._bound(i, at, state), _at(self._size[i], at, state)
                if i == 1 and self.allowance.velocity_from_positions:
                    bound += enclose(self.format.u) * (state[0] + abs(expected[0])) / at
                # In the range of underflow, errors say nothing about the method.
                unit = size * enclose(self.format.u)
                unit = unit if bool(unit >= enclose(power_of_two(self.format.emin))) else arb.pos_inf()
                judged.append(_judgement(abs(arb(got) - want), bound, unit, self.averages))
            return judged[0], judged[1]

    def allows(self, q: float, v: float, h: float, answer: tuple[float, float]) -> bool:
        """True if both components of a float step are within what is allowed."""
        return all(component.allowed for component in self.judge(q, v, h, answer))

    @property
    def averages(self) -> int:
        """How many times the bound a step may be off that averages states of its stages, or adds `kicks` in parts."""
        staged = isinstance(self.method, RungeKutta) and self.method.explicit and self.method.stages > 1
        return AVERAGES if staged else self.kicks

    def require_no_overflow(self, state: float, h: float) -> None:
        """Raise BadInput for sizes at which a sum of |monomials| overflows, so that no bound holds."""
        with ctx.workprec(_BITS):
            largest = arb(max(state, 1.0))
            reached = max(float(_at(size, arb(h), (largest, largest)).log().mid()) for size in self._size)
            room = float(enclose(self.format.largest / 2).log().mid())
        if not reached < room:
            raise BadInput(
                f"states up to {state:g} and steps up to {h:g}: sums of {self.method.key} reach about "
                f"10^{reached / log(10):.0f}, where {self.format.name} overflows; choose smaller sizes"
            )

    def _step(self, h: float) -> float:
        return float(BINARY32.nearest(Fraction(h))) if self.allowance.step_in_binary32 else h

    def _bound(self, component: int, h: arb, state: tuple[arb, arb]) -> arb:
        if self.allowance.solver_tolerance is not None:
            # A stage, or a slope times h, that is off by the tolerance moves the step by as much. Solvers see a norm.
            (_, below), _ = self._matrix[component]
            moved = enclose(Fraction(self.allowance.solver_tolerance)) / abs(below(h))
            larger = max(_at(size, h, state) for size in self._size)
            return moved * (larger + 1 + h) + enclose(power_of_two(self.format.emin))
        bound = _at(self._derived[component], h, state)
        return bound + _at(self._flushed[component], h, state) if self.allowance.flush_to_zero else bound

    @cached_property
    def _matrix(self) -> list[list[tuple[arb_poly, arb_poly]]]:
        rows = oscillator_matrix(self.method)
        return [[(_series(coefficients(x.num)), _series(coefficients(x.den))) for x in row] for row in rows]

    @cached_property
    def _derived(self) -> Sequence[Columns]:
        return any_order_columns(self.method, self.format, _BITS)

    @cached_property
    def _flushed(self) -> Sequence[Columns]:
        return flushed_columns(self.method, self.format, _BITS)

    @cached_property
    def _size(self) -> Sequence[Columns]:
        """The sum of |monomials|: of the definition, before cancellation, or of the numerators of an implicit one."""
        if self.method.explicit:
            return size_columns(self.method, self.format, _BITS)
        return [[*(arb_poly([abs(c) for c in num.coeffs()]) for num, _ in row), arb_poly([])] for row in self._matrix]


def _judgement(error: arb, bound: arb, unit: arb, times: int) -> Judgement:
    if not error.is_finite():
        return Judgement(False, inf, inf)
    return Judgement(bool(error <= times * bound), _ratio(error, bound), _ratio(error, unit))


def _ratio(error: arb, bound: arb) -> float:
    """The quotient as a float, for people: 0 for no error, and infinite for an error if none is allowed."""
    if bool(error == 0):
        return 0.0
    return float((error / bound).mid()) if bool(bound > 0) else inf


def _series(ascending: Iterable[Any]) -> arb_poly:
    with ctx.workprec(_BITS):
        return arb_poly([enclose(c) for c in ascending])


def _at(columns: Columns, h: arb, state: tuple[arb, arb]) -> arb:
    q, v, one = (polynomial(h) for polynomial in columns)
    return q * state[0] + v * state[1] + one
