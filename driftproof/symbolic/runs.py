"""Runs on the oscillator: powers of M by squaring; final state, errors, energy and phase to any certified digits."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeAlias

from flint import arb, ctx

from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.rationals import exact_number, state_of, step_count
from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import EnclosedReal, certified_sign, enclose
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.linear.oscillator import oscillator_matrix

# (M_qq, M_qv, M_vq, M_vv) over Fractions or over balls.
Entries: TypeAlias = tuple[Any, Any, Any, Any]
# A quantity of a run: `float` and `str` accept either type.
RunNumber: TypeAlias = "Fraction | EnclosedReal"
# Above this many bits a power of M is only enclosed: the fraction would be longer than anyone reads.
LONGEST_FRACTION = 4_000


def exact_matrix_at(method: Method, h: Fraction) -> Entries:
    """(M_qq, M_qv, M_vq, M_vv) at a rational h: rational, or in the number field of the method's coefficients.

    Raises ValueError where M has a pole at h, so that the step has no solution.
    """
    try:
        qq, qv, vq, vv = (exact(entry(scalar(h))) for row in oscillator_matrix(method) for entry in row)
    except ZeroDivisionError:
        raise ValueError(f"{method.key} has no step at h = {h}, a pole of its one-step matrix") from None
    return qq, qv, vq, vv


def exact_flow(start: tuple[Fraction, Fraction], t: Fraction) -> tuple[arb, arb]:
    """(q₀ cos t + v₀ sin t, v₀ cos t - q₀ sin t), the exact state at time t, in balls at the current precision."""
    (q, v), angle = (enclose(x) for x in start), enclose(t)
    c, s = angle.cos(), angle.sin()
    return q * c + v * s, v * c - q * s


def distance(a: tuple[arb, arb], b: tuple[arb, arb]) -> arb:
    """The Euclidean distance of two states in balls."""
    return ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2).sqrt()


def as_balls(matrix: Entries) -> Entries:
    """The entries as Arb balls at the current precision."""
    qq, qv, vq, vv = (enclose(entry) for entry in matrix)
    return qq, qv, vq, vv


def power(matrix: Entries, n: int) -> Entries:
    """matrix**n for n >= 0 by repeated squaring, in the arithmetic of its entries.

    With balls, squaring makes long runs possible: n single steps would widen the radius by (1 + h)**n.
    """
    result: Entries = (1, 0, 0, 1)
    while n:
        if n & 1:
            result = multiply(result, matrix)
        n >>= 1
        if n:
            matrix = multiply(matrix, matrix)
    return result


def short_power(matrix: Entries, n: int, bits: int) -> Entries | None:
    """matrix**n over Fractions; None if an entry is irrational, or longer than `bits` bits on the way.

    High powers may be short, too: all powers of a matrix of finite order are.
    """
    if not all(isinstance(x, Fraction) for x in matrix):
        return None
    result: Entries = (Fraction(1), Fraction(0), Fraction(0), Fraction(1))
    while n:
        if n & 1:
            result = multiply(result, matrix)
        n >>= 1
        if n:
            matrix = multiply(matrix, matrix)
        if max(_length(x) for x in (*result, *matrix)) > bits:
            return None
    return result


def _length(x: Fraction) -> int:
    return max(abs(x.numerator).bit_length(), x.denominator.bit_length())


def multiply(a: Entries, b: Entries) -> Entries:
    """The 2x2 matrix product a b."""
    return (a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3])


def conserves_energy(matrix: Entries) -> bool:
    """True if the matrix is orthogonal, so that q² + v² is the same after every step."""
    qq, qv, vq, vv = matrix
    return bool(multiply((qq, vq, qv, vv), matrix) == (1, 0, 0, 1))


def apply(matrix: Entries, q: Any, v: Any) -> tuple[Any, Any]:
    """The matrix times the column (q, v)."""
    return matrix[0] * q + matrix[1] * v, matrix[2] * q + matrix[3] * v


@dataclass(frozen=True)
class TrigonometricNumber(EnclosedReal):
    """The real number cosine·cos t + sine·sin t for rational t != 0, its coefficients rational and not both zero.

    Calling it returns an Arb ball around the number; its text is what SymPy writes: "cos(10)/3 + 2*sin(10)".
    """

    cosine: Fraction
    sine: Fraction
    t: Fraction

    def __call__(self) -> arb:
        """A ball around the number, at Arb's current precision."""
        return exact_flow((self.cosine, self.sine), self.t)[0]

    def __str__(self) -> str:
        """The terms in ascending order of their values."""
        terms = [(self.cosine, "cos"), (self.sine if self.t == abs(self.t) else -self.sine, "sin")]
        if all(c for c, _ in terms) and certified_sign(TrigonometricNumber(self.cosine, -self.sine, self.t)) == 1:
            terms.reverse()
        return " + ".join(_term(c, f"{name}({abs(self.t)})") for c, name in terms if c).replace("+ -", "- ")

    __repr__ = __str__


def _term(coefficient: Fraction, factor: str) -> str:
    """The term as text, such as "-3*sin(10)/20"."""
    size, over = abs(coefficient.numerator), coefficient.denominator
    text = (factor if size == 1 else f"{size}*{factor}") + (f"/{over}" if over != 1 else "")
    return f"-{text}" if coefficient < 0 else text


@dataclass(frozen=True)
class OscillatorRun:
    """N = t/h steps of `method` on q' = v, v' = -q from the rational state `start`.

    Every quantity is a Fraction where it is rational and short, else a procedure that encloses it (`EnclosedReal`).
    The start and t are rational, so the exact state is rational only at t = 0, where Fractions are returned, or if the
    start is the origin, where the enclosures are exact. Hence no digit of the exact state, of the state error or of the
    phase error is an undecidable tie (Lindemann: cos t and sin t are transcendental at rational t != 0). An energy is a
    Fraction also if every step conserves it. Raises ValueError if h does not divide t.

    >>> from fractions import Fraction
    >>> from driftproof import METHODS, OscillatorRun, significant
    >>> run = OscillatorRun(METHODS["forward_euler"], Fraction(1, 4), Fraction(10))
    >>> run.steps, significant(run.state_error, 10)
    (40, '2.390297168')
    """

    method: Method
    h: Fraction
    t: Fraction
    start: tuple[Fraction, Fraction] = (Fraction(1), Fraction(0))

    def __post_init__(self) -> None:
        """Read method, h, t and start as users give them. Raises ValueError if h does not divide t."""
        read = {"method": method_of(self.method), "h": exact_number(self.h, "h"), "t": exact_number(self.t, "t")}
        for name, value in {**read, "start": state_of(self.start)}.items():
            object.__setattr__(self, name, value)
        step_count(self.t, self.h)

    @property
    def steps(self) -> int:
        """N = t / h."""
        return step_count(self.t, self.h)

    @cached_property
    def _matrix(self) -> Entries:
        return exact_matrix_at(self.method, self.h)

    @cached_property
    def _enclosures(self) -> dict[int, tuple[arb, arb]]:
        """The final state in balls by precision, kept because every quantity needs it."""
        return {}

    @cached_property
    def _power(self) -> Entries | None:
        """M(h)ᴺ in fractions; None if they are irrational or longer than LONGEST_FRACTION bits."""
        return short_power(self._matrix, self.steps, LONGEST_FRACTION)

    @property
    def has_short_fractions(self) -> bool:
        """True if M(h)ᴺ is kept as fractions rather than as balls."""
        return self._power is not None

    @cached_property
    def final_state(self) -> tuple[RunNumber, RunNumber]:
        """(q_N, v_N) = M(h)ᴺ (q₀, v₀)."""
        if self._power is not None:
            q, v = apply(self._power, *self.start)
            return q, v
        return EnclosedReal(lambda: _numerical(self)[0]), EnclosedReal(lambda: _numerical(self)[1])

    @property
    def exact_state(self) -> tuple[RunNumber, RunNumber]:
        """(q₀ cos t + v₀ sin t, v₀ cos t - q₀ sin t)."""
        q, v = self.start
        if not self.t or not (q or v):
            return self.start
        return TrigonometricNumber(q, v, self.t), TrigonometricNumber(v, -q, self.t)

    @property
    def state_error(self) -> RunNumber:
        """The Euclidean distance between the numerical and the exact final state."""
        if not self.t:
            return Fraction(0)
        return EnclosedReal(lambda: distance(_numerical(self), exact_flow(self.start, self.t)))

    @property
    def energy(self) -> RunNumber:
        """½(q_N² + v_N²)."""
        if self.has_short_fractions:
            return Fraction(_energy(*self.final_state))
        if conserves_energy(self._matrix):
            return Fraction(_energy(*self.start))
        return EnclosedReal(lambda: _energy(*_numerical(self)))

    @property
    def energy_change(self) -> RunNumber:
        """½(q_N² + v_N²) - ½(q₀² + v₀²)."""
        before, after = Fraction(_energy(*self.start)), self.energy
        return after - before if isinstance(after, Fraction) else EnclosedReal(lambda: after() - enclose(before))

    @property
    def phase_error(self) -> RunNumber | None:
        """The angle, in degrees in [-180, 180), by which the numerical final state is ahead of the exact one.

        It is atan2 of cross and dot product, so whole turns are not counted. None if a state is the origin.
        """
        origin = (Fraction(0), Fraction(0))
        if origin in (self.start, self.final_state):
            return None
        if not self.t:
            return Fraction(0)
        return EnclosedReal(lambda: _angle_between(_numerical(self), exact_flow(self.start, self.t)) * 180 / arb.pi())


def _numerical(run: OscillatorRun) -> tuple[arb, arb]:
    if ctx.prec not in run._enclosures:
        q, v = (enclose(x) for x in run.start)
        run._enclosures[ctx.prec] = apply(power(as_balls(run._matrix), run.steps), q, v)
    return run._enclosures[ctx.prec]


def _energy(q: Any, v: Any) -> Any:
    return (q * q + v * v) / 2


def _angle_between(numerical: tuple[arb, arb], exact: tuple[arb, arb]) -> arb:
    """The angle in radians by which `numerical` is ahead (clockwise) of `exact`."""
    (q, v), (q_exact, v_exact) = numerical, exact
    return arb.atan2(q * v_exact - v * q_exact, q * q_exact + v * v_exact)
