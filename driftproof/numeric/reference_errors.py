"""The exact distance of a float state from a reference's digits, and how much of it rounding may explain.

Floats and decimals are fractions: their difference is formed without rounding, and its size is rounded once, in Decimal
with _DIGITS digits. An energy is computed in the same Decimals: each operation and function is rounded by 10⁻⁶⁰ of it,
sines and cosines by 10⁻⁶⁰ of 1, and so is forty digits below what binary64 can show of the same operation.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal, DecimalException, InvalidOperation, localcontext
from fractions import Fraction
from math import atan2, degrees, isfinite
from operator import add, ge, gt, le, lt, mul, sub, truediv
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.formulas.vector_fields import VectorField, partial_derivative
from driftproof.methods.numbers.number_field import Exact
from driftproof.numeric.advance import Advance, field_rate, rests_at_origin
from driftproof.numeric.problems.problem import DenseSolution, Digits, Problem
from driftproof.numeric.readouts import phase_error
from driftproof.numeric.steps.engine import functions_of
from driftproof.support.plain_text import with_digits

_DIGITS = 60
# Chosen: the largest exponent of an angle. Products of a few doubles are below it, and its sine takes a hundredth of a
# second.
_LARGEST_ANGLE = 1000
# States whose energies floats find largest; rounding may exchange neighbours. Chosen.
_CANDIDATES = 8
U = Fraction(1, 2**53)
STATE, ENERGY, PHASE = "state", "energy", "phase"
QUANTITIES = (STATE, ENERGY, PHASE)
# Which of a run's errors is meant.
ENDS = ("final", "largest")
# A run whose error is up to this part of the size of the solution follows it; with an error above that size it is lost.
FOLLOWS = 0.1
_Floats: TypeAlias = Sequence[float]
_OSCILLATOR = ((Fraction(0), Fraction(1)), (Fraction(-1), Fraction(0)))


class Size(NamedTuple):
    """An error at the end, the largest one of those that were looked at, and at how many times that was."""

    final: float
    largest: float
    looks: int = 1


class Way(NamedTuple):
    """The states of a run at some times on the way and at its end, rows of an array, where a dense solution is known.

    >>> Way.of([0.5, 1.0], [(1.0, 0.0), (2.0, 0.0)]).states.shape
    (2, 2)
    """

    times: NDArray[np.float64]
    states: NDArray[np.float64]

    @classmethod
    def of(cls, times: Iterable[float], states: Iterable[_Floats]) -> Way:
        """The way through these states."""
        return cls(np.array([*times], float), np.array([[*state] for state in states], float))


def errors(problem: Problem, states: Mapping[Fraction, _Floats], way: Way | None = None) -> dict[str, Size]:
    """The sizes of the errors of a run, from its states at some of the reference's times, its last one among them.

    `state`: Euclidean distance. `energy`: |E(y) - E(y(t))|, if the problem has an energy. `phase`: degrees, for the
    oscillator only; undefined at the origin, where it counts as half a turn. With a `way` the largest are those of all
    its states, too, in doubles. Raises ArithmeticError for a state that is not finite.
    """
    if not all(isfinite(x) for state in states.values() for x in state):
        raise ArithmeticError("the state is no longer finite")
    digits = dict(zip(problem.reference.times, problem.reference.states, strict=True))
    at = [t for t in sorted(states) if t in digits]
    found = {STATE: [distance_from_digits(states[t], digits[t]) for t in at]}
    if problem.energy is not None:
        found[ENERGY] = [float(abs(decimal_energy(problem, states[t]) - energy_of_solution(problem, t))) for t in at]
    if is_oscillator(problem):
        found[PHASE] = [_phase(states[t], digits[t]) for t in at]
    dense = problem.reference.dense
    also = {} if dense is None or way is None else _largest_on(way, problem, dense)
    looks = max(len(at), len(way.times) if also and way else 0)
    return {name: Size(x[-1], max(*x, also.get(name, 0.0), 0.0), looks) for name, x in found.items()}


def _largest_on(way: Way, problem: Problem, dense: DenseSolution) -> dict[str, float]:
    """The largest errors at the states of a way."""
    true = dense.at(way.times)
    found = {STATE: largest_state_error(problem, way)}
    if problem.energy is not None:
        found[ENERGY] = abs(largest_energy_error(problem, way))
    if is_oscillator(problem):
        ahead = np.abs(phase_error(tuple(way.states.T), tuple(true.T)))
        found[PHASE] = float(np.nan_to_num(ahead, nan=180.0).max())
    return found


def largest_state_error(problem: Problem, way: Way) -> float:
    """The largest distance on the way from a solution that is known all along, in floats."""
    assert problem.reference.dense is not None
    return float(np.hypot.reduce(way.states - problem.reference.dense.at(way.times), axis=1).max())


def energy_of_solution(problem: Problem, t: Fraction) -> Decimal:
    """E(y(t)) at one of the reference's times: that of the start where the solution conserves it."""
    state = problem.reference.states[problem.reference.times.index(t)] if problem.energy_changes else problem.start
    return decimal_energy(problem, map(Fraction, state))


def largest_energy_error(problem: Problem, way: Way) -> float:
    """E(y) - E(y(t)) where it is largest in size on the way; in floats, unless the solution conserves E."""
    dense = problem.reference.dense
    if not problem.energy_changes or dense is None:
        return largest_energy_change(problem, way.states)
    off = _float_energies(problem, way.states) - _float_energies(problem, dense.at(way.times))
    if not np.isfinite(off).all():
        raise ArithmeticError("the energy has no value at a state reached")
    return float(off[np.abs(off).argmax()])


def _float_energies(problem: Problem, states: NDArray[np.float64]) -> NDArray[np.float64]:
    energy = VectorField((problem.energy or "0",) * len(problem.start), problem.field.parameters)
    with np.errstate(all="ignore"):
        found: NDArray[np.float64] = np.zeros(len(states)) + field_rate(energy, functions_of(np))(0.0, states.T)[0]
    return found


def largest_energy_change(problem: Problem, states: NDArray[np.float64]) -> float:
    """E(y) - E(y(0)) where it is largest in size: found in floats, computed in Decimals.

    Raises ArithmeticError where the energy has no value.
    """
    before = decimal_energy(problem, problem.start)
    nearly = np.argsort(np.abs(_float_energies(problem, states) - float(before)))[-_CANDIDATES:]  # NaN is last
    return max((float(decimal_energy(problem, states[i]) - before) for i in nearly), key=abs)


def is_oscillator(problem: Problem) -> bool:
    """True for q' = v, v' = -q, whose phase is an angle in the plane of q and v; not about another point of rest."""
    return problem.matrix == _OSCILLATOR and rests_at_origin(problem)


def distance_from_digits(state: _Floats, digits: Digits) -> float:
    """The Euclidean distance of the floats from the decimals, rounded once."""
    return _length(Fraction(x) - Fraction(text) for x, text in zip(state, digits, strict=True))


def half_unit(digits: Digits) -> float:
    """The most that the exact state may be off these decimals: half a unit of the last digit in every component."""
    places = [Decimal(text).as_tuple().exponent for text in digits]
    return _length(Fraction(10) ** int(place) / 2 for place in places)


def told_apart(error: float, digits: Digits) -> str:
    """The least of two digits that an error from these decimals is certainly below, if it is below their half unit.

    Nothing smaller can be told by them. "" for other errors.

    >>> told_apart(2e-64, ("0.25",)), told_apart(0.1, ("0.25",))
    ('0.0051', '')
    """
    if error >= (half := half_unit(digits)):
        return ""
    with localcontext(prec=2, rounding=ROUND_CEILING):
        return with_digits(float(+(Decimal(half) + Decimal(error))), 2)


def floors(problem: Problem) -> dict[str, float]:
    """The error of rounding the exact result y to binary64, to first order in u: no method is better but by luck.

    Each component is off by at most u|yᵢ|. Hence the state is off by u ‖y‖, the energy by u Σ |∂E/∂yᵢ||yᵢ|, and the
    phase by u in radians, the angle at which a chord of u ‖y‖ is seen from the distance ‖y‖.
    """
    y = [Fraction(text) for text in problem.reference.states[-1]]
    found = {STATE: _length(U * x for x in y)}
    if problem.energy is not None:
        slopes = (partial_derivative(problem.energy, name) for name in problem.field.components)
        moves = (abs(_evaluated(problem, slope, y) * _decimal(x)) for slope, x in zip(slopes, y, strict=True))
        found[ENERGY] = float(sum(moves) * _decimal(U))
    if is_oscillator(problem):
        found[PHASE] = degrees(U)
    return found


def largest_state_size(problem: Problem) -> float:
    """Q, the largest norm of the start and of the reference's states: larger errors say nothing about the solution."""
    sizes = (_length(map(Fraction, state)) for state in problem.reference.states)
    return max(_length(problem.start), *sizes, problem.reference.largest_between)


def branch_remark(problem: Problem, run: Advance | None, error: float) -> str:
    """What is to be said of a run that found roots on another branch, as `numeric.steps.implicit` says; "" if nothing.

    A linear problem's stage equations have one root, and a run that follows the solution has found a good one.
    """
    past = getattr(run, "past", 0.0)
    told = past and error > FOLLOWS * largest_state_size(problem) and not problem.field.linear
    return f"another branch from t = {past:.3g} on" if told else ""


def doubt(problem: Problem, steps: int, speed: float) -> float:
    """(N + 1) u Q + u t ‖f‖ + half a unit: the part of an error that need not be the method's own.

    Q is the `largest_state_size`: rounding the start, and each of N additions to the state, costs up to u Q. The steps,
    h = fl(t/N), end within u t of t (`float_step`), where the solution moves at `speed` = ‖f(t, y(t))‖. The last
    term is the reference's. The sum is to first order and leaves out what the flow magnifies: it is a threshold, which
    a stiff or chaotic problem may exceed.
    """
    moved = float(U * problem.t) * speed
    return (steps + 1) * float(U) * largest_state_size(problem) + moved + half_unit(problem.reference.states[-1])


def decimal_energy(problem: Problem, state: Iterable[float | Fraction]) -> Decimal:
    """E of a state of floats or fractions. Raises ArithmeticError if a function in E is undefined there."""
    try:
        return _evaluated(problem, problem.energy or "0", state)
    except DecimalException:
        raise ArithmeticError("the energy has no value at a state reached") from None


def _evaluated(problem: Problem, text: str, state: Iterable[float | Fraction]) -> Decimal:
    VectorField((text,) * len(problem.start), problem.field.parameters)  # refuses what an expression may not hold
    with localcontext(prec=_DIGITS):
        names = {f"y{i}": _decimal(Fraction(x)) for i, x in enumerate(state)}
        names |= {name: _decimal(value) for name, value in problem.field.parameters}
        return _value(ast.parse(text, mode="eval").body, names)


def _phase(state: _Floats, digits: Digits) -> float:
    """The size of the phase error in degrees, from exact dot and cross products rounded once; 180 if undefined."""
    (q, v), (q_exact, v_exact) = map(Fraction, state), map(Fraction, digits)
    cross, dot = float(q * v_exact - v * q_exact), float(q * q_exact + v * v_exact)
    return degrees(abs(atan2(cross, dot))) if cross or dot else 180.0


def _length(parts: Iterable[Fraction]) -> float:
    with localcontext(prec=_DIGITS):
        return float(_decimal(sum((x * x for x in parts), Fraction(0))).sqrt())


def _decimal(x: Exact) -> Decimal:
    if not isinstance(x, Fraction):  # algebraic, or pi
        x, _ = x.enclosure(4 * _DIGITS)  # 4 > log2(10) bits a digit
    return Decimal(x.numerator) / x.denominator if x.denominator > 1 else Decimal(x.numerator)  # all its digits


def _value(node: Any, names: Mapping[str, Decimal]) -> Decimal:
    """Evaluate an expression of `VectorField` in Decimals: a number, a name, -x, an operation or a function."""
    match node:
        case ast.Constant(value=int(number)):
            return Decimal(number)
        case ast.Name(id=name):
            return names[name]
        case ast.UnaryOp(operand=operand):
            return -_value(operand, names)
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATIONS[type(op)](_value(left, names), _value(right, names))
        case ast.IfExp(test=ast.Compare(left=left, ops=[op], comparators=[right]), body=one, orelse=other):
            return _value(one if _COMPARISONS[type(op)](_value(left, names), _value(right, names)) else other, names)
    found: Decimal = _FUNCTIONS[node.func.id](*(_value(argument, names) for argument in node.args))
    return found


def _sin(x: Decimal) -> Decimal:
    """sin x by Taylor's series for |x| <= 1, from which sin 3x = 3 sin x - 4 sin³x leads to any x.

    Each such step multiplies an error by |3 - 12 sin²x| <= 9, and there are fewer than 2.1 log₁₀|x| + 1: two digits for
    each of |x|; five more are for the last step and for what the series rounds.
    """
    if x.adjusted() > _LARGEST_ANGLE:
        raise InvalidOperation
    with localcontext(prec=_DIGITS + 2 * max(0, x.adjusted() + 1) + 5):
        thirds = 0
        while abs(x) > 1:
            x, thirds = x / 3, thirds + 1
        term, total, n = x, Decimal(0), 1
        while total + term != total:
            total, n = total + term, n + 2
            term = -term * x * x / (n * (n - 1))
        for _ in range(thirds):
            total = 3 * total - 4 * total * total * total
    return +total


def _cos(x: Decimal) -> Decimal:
    """cos x = 1 - 2 sin²(x/2)."""
    with localcontext(prec=_DIGITS + max(0, x.adjusted() + 1) + 5):
        half = _sin(x / 2)
    return 1 - 2 * half * half


_OPERATIONS: dict[Any, Callable[[Any, Any], Decimal]] = {ast.Add: add, ast.Sub: sub, ast.Mult: mul, ast.Div: truediv}
_FUNCTIONS: dict[str, Any] = {"sin": _sin, "cos": _cos, "exp": Decimal.exp, "log": Decimal.ln, "sqrt": Decimal.sqrt}
_FUNCTIONS |= {"abs": abs, "copysign": Decimal.copy_sign, "floor": lambda x: x.to_integral_value(ROUND_FLOOR)}
_COMPARISONS: dict[Any, Callable[[Any, Any], bool]] = {ast.Gt: gt, ast.GtE: ge, ast.Lt: lt, ast.LtE: le}
