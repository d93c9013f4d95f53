"""Nonlinear, time-dependent problems with known solutions, which distinguish steps that linear problems do not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import exp, prod
from typing import TypeAlias

from flint import arb

from driftproof.blackbox.findings import WrongShape, first_taken
from driftproof.blackbox.stepper.calling_conventions import FIELD, MAP
from driftproof.blackbox.stepper.foreign_code import FieldFunction
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.support.plain_text import counted

_State: TypeAlias = list[AnyNumber]
# The start is not 0, so that a clock that stays at 0 or is reset to it shows. Of the starts, spacings of the bells and
# strengths of the coupling that were tried, these show the most orders of the catalogue: all but those of two pairs.
START, _SPACING, _STRENGTH = 0.25, 0.5, 4
# The numbers of components tried, the largest first; some codes take only two, or one.
_SIZES = (4, 2, 1)
# A step size so small that every stage is of ordinary size.
_SHORT = 2.0**-5
# Just below 709.8, where exp overflows in double precision; a step that gets this far is wrong whatever follows.
_LARGEST_EXPONENT = 700.0


@dataclass(frozen=True)
class NonlinearProblem:
    """A problem y' = rate(t, y), over floats and over balls, with its solution in balls.

    If `positions` is not 0, it is q'' = F(t, q) with that many positions, or q'' = F(t, q, v) if `dragged`, and y is
    [q..., v...]; if `interleaved`, a stepper of a right-hand side gets [q, v, q, v, ...]. `scales` are the sizes of the
    components if they are not 1, and `pace` is how much faster than t its own time runs. The rate depends on t only if
    `timed`. If the positions are not `coupled`, their forces may be asked for one at a time.
    """

    words: str
    rate: FieldFunction
    solution: Callable[[arb], list[arb]]
    positions: int = 0
    interleaved: bool = False
    dragged: bool = False
    scales: tuple[float, ...] = ()
    timed: bool = False
    coupled: bool = True
    pace: float = 1.0

    @property
    def names(self) -> list[str]:
        """The names of the components in reports: q[0], ..., v[0], ..., or y[0], ..."""
        numbers = len(self.solution(arb(START)))
        return [f"{x}[{i}]" for x in ("qv" if self.positions else "y") for i in range(self.positions or numbers)]

    def start(self, t: float) -> list[float]:
        """The state at the time t, rounded to floats, from which runs and steps begin."""
        return [float(x.mid()) for x in self.solution(arb(t))]

    def force(self, t: AnyNumber, q: Sequence[AnyNumber]) -> _State:
        """The force F(t, q), for any number of positions if they are not coupled."""
        return [*self.rate(t, [*q, *q])][len(q) :]

    def stepped(self, subject: ForeignStepper, t: float, y: Sequence[AnyNumber], h: float) -> _State:
        """Take one step of the stepper, on numbers of its adapter; of its own system if that is built in."""
        if subject.convention.kind == MAP:
            return [*subject.step(y[0], y[1], h)]
        at, size, n = subject.adapter.number(t), subject.adapter.number(h), self.positions
        if self.dragged:
            return subject.step_dragged(lambda at, q, v: self.rate(at, [*q, *v])[n:], at, y[:n], y[n:], size)
        if n:
            return subject.step_forced(self.force, at, y[:n], y[n:], size, interleaved=self.interleaved)
        return subject.step_field(self.rate, at, y, size)


def moved(problem: NonlinearProblem, sizes: Sequence[float], pace: float, origin: float) -> NonlinearProblem:
    """The problem with its components scaled by `sizes`, repeated as needed, and its time by `pace` from `origin`.

    Its solution is S z(pace (t - origin)), with velocities that are scaled by the pace, too. Sizes and pace are powers
    of two, up to signs, so that only the time is rounded differently.
    """

    def scales(numbers: int) -> list[float]:
        of_first = [sizes[i % len(sizes)] for i in range(numbers // 2 if problem.positions else numbers)]
        return [*of_first, *(pace * x for x in of_first)] if problem.positions else of_first

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        own = scales(len(y))
        slopes = problem.rate(pace * (t - origin), [x / s for x, s in zip(y, own, strict=True)])
        return [pace * s * k for k, s in zip(slopes, own, strict=True)]

    def solution(t: arb) -> list[arb]:
        state = problem.solution(pace * (t - origin))
        return [s * x for x, s in zip(state, scales(len(state)), strict=True)]

    own = tuple(scales(len(problem.solution(arb(START)))))
    return replace(problem, rate=rate, solution=solution, scales=own, pace=pace)


def beginning_at_rest(problem: NonlinearProblem, t: float) -> NonlinearProblem:
    """The problem with velocities of 0 at its start and with its slopes less those at the time t, which vanish there.

    In floats they vanish exactly; `solution` then gives starts only.
    """

    def solution(at: arb) -> list[arb]:
        state = problem.solution(at)
        return [*state[: problem.positions or None], *[arb(0)] * problem.positions]

    still = problem.rate(t, [float(x.mid()) for x in solution(arb(t))])
    rate = lambda t, y: [k - s for k, s in zip(problem.rate(t, y), still, strict=True)]
    return replace(problem, rate=rate, solution=solution)


def standing_still(place: float, near: float, numbers: int, positions: int = 0) -> NonlinearProblem:
    """The problem y' = C y, or q'' = q, whose slopes, or forces, are 0 where the first number is `near` this place."""

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        moves = abs(y[0] - place) > near
        pushes = [(1 - 1.5 * (i % 2)) * moves * x for i, x in enumerate(y[: positions or None])]
        return [*y[positions:], *pushes] if positions else pushes

    words = "a problem that stands still at the place of one stage"
    return NonlinearProblem(words, rate, lambda t: [arb(1)] * (numbers or 2 * positions), positions)


def turned(problem: NonlinearProblem) -> NonlinearProblem:
    """The problem with its components, or positions, rotated by half their number if they are three or more.

    A clock in the last place, which no force moves, is then in the middle, so that a mistake in the last place shows.
    """

    def by(numbers: Sequence[AnyNumber], back: int) -> _State:
        rows = (numbers[: problem.positions], numbers[problem.positions :]) if problem.positions else (numbers,)
        turns = [back * (len(row) // 2) if len(row) > 2 else 0 for row in rows]
        return [x for row, k in zip(rows, turns, strict=True) for x in [*row[k:], *row[:k]]]

    return replace(
        problem, rate=lambda t, y: by(problem.rate(t, by(y, -1)), 1), solution=lambda t: by(problem.solution(t), 1)
    )


def field_problem(subject: ForeignStepper) -> NonlinearProblem:
    """The problem with as many components as a step(f, t, y, h) takes, and with t if the step passes times to f.

    Raises the Misbehaviour of the first size if all are refused, and UnsupportedCall if no right-hand side is taken.
    """
    return first_taken(lambda size: driven(size, timed=passes_time(subject, size)), _SIZES)


def driven(size: int, *, timed: bool) -> NonlinearProblem:
    """The problem with `size` components; if it is not timed and there are two or more, the last one is the clock."""
    if timed or size > 1:
        numbers = counted(size, "component")
        words = f"a nonlinear problem of {numbers}, {'with t' if timed else 'without t: the code passes no time'}"
        bells = size if timed else size - 1
        ends: Callable[[arb], list[arb]] = lambda t: [*(_bell(i, t)[0] for i in range(bells)), *[t] * (size - bells)]
        return NonlinearProblem(words, _bells(timed), ends, timed=timed)
    words = "y' = exp(-y), without t: the code passes no time"
    return NonlinearProblem(words, lambda t, y: [capped_exp(-x) for x in y], lambda t: [(1 + t).log()])


def force_problem(subject: ForeignStepper) -> NonlinearProblem:
    """A problem with one position: q'' = F(t, q) if times are passed on, else q'' = exp(-2q) with q = log cosh t."""
    return pushed(1, timed=True) if gives_force_times(subject) else walls(1)


def dragged_problem(subject: ForeignStepper, positions: int = 1) -> NonlinearProblem:
    """The problem q'' = F(t, q, v) if times are passed on, else qᵢ'' = exp(-2qᵢ) (exp(-2qⱼ) + vⱼ²) with the next j.

    The solutions are the bells of `_bell`, and log cosh (t + i/2).
    """
    timed = gives_force_times(subject)
    still = pushed(positions, timed=True) if timed else walls(positions)

    def pull(q: AnyNumber, v: AnyNumber) -> AnyNumber:
        return (1 + v) * (1 + v) / (1 + q * q) if timed else capped_exp(-2 * q) + v * v

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        q, v = _halves(y, positions)
        pulls = [pull(q[(i + 1) % positions], v[(i + 1) % positions]) for i in range(positions)]
        if not timed:
            return [*v, *(capped_exp(-2 * x) * p for x, p in zip(q, pulls, strict=True))]
        bells = [_bell(i, t) for i in range(positions)]
        known = [pull(bell, slope) for bell, slope, _ in [*bells[1:], bells[0]]]
        return [*v, *(own + p - k for (*_, own), p, k in zip(bells, pulls, known, strict=True))]

    several = "" if positions == 1 else f" of {positions} positions"
    return replace(still, words=f"a nonlinear q'' = F({'t, ' * timed}q, v){several}", rate=rate, dragged=True)


def in_each_order(subject: ForeignStepper, problem: NonlinearProblem) -> list[NonlinearProblem]:
    """The problem in each order in which y may hold it. Raises a Misbehaviour if the stepper does not take it."""
    problem.stepped(subject, START, problem.start(START), _SHORT)
    orders = (False, True) if subject.convention.kind == FIELD and problem.positions > 1 else (False,)
    return [replace(problem, interleaved=interleaved) for interleaved in orders]


def gives_force_times(subject: ForeignStepper) -> bool:
    """True if the stepper passes times to the force. Raises UnsupportedCall if it takes no force."""
    return _is_given_times(lambda force, t: subject.step_forced(force, t, [1.0], [2.0], _SHORT))


def passes_time(subject: ForeignStepper, size: int) -> bool:
    """True if the stepper passes times to the right-hand side."""
    return _is_given_times(lambda rate, t: subject.step_field(rate, t, [float(k) for k in range(1, size + 1)], 0.25))


def _is_given_times(step: Callable[[FieldFunction, float], object]) -> bool:
    """True if a step passes times of its own to its function, rather than the very object that it got as the time."""
    clock, given = float(START), []

    def slopes(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        given.append(t is not clock)
        return [0.0 * x for x in y]

    step(slopes, clock)
    return any(given)


def _halves(y: Sequence[AnyNumber], positions: int) -> tuple[Sequence[AnyNumber], Sequence[AnyNumber]]:
    """The positions and the velocities of y. Raises WrongShape if y holds another number of them."""
    if len(y) != 2 * positions:
        raise WrongShape(f"the force is called with {len(y) // 2} of {positions} positions")
    return y[:positions], y[positions:]


def _bell(i: int, t: AnyNumber) -> tuple[AnyNumber, AnyNumber, AnyNumber]:
    """The bell 1/(1 + x²) of x = t + i/2, whose derivatives vanish at isolated points only, with the first two."""
    x = t + _SPACING * i
    bell = 1 / (1 + x * x)
    return bell, -2 * x * bell * bell, 8 * x * x * bell**3 - 2 * bell * bell


def _coupled(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
    """The coupling 4 (1 + t) y_(i+1) y_(i+2)/(1 + y_i²), which has mixed derivatives of all orders, also with t."""
    n = len(y)
    return [_STRENGTH * (1 + t) * y[(i + 1) % n] * y[(i + 2) % n] / (1 + y[i] * y[i]) for i in range(n)]


def _bells(timed: bool) -> Callable[[AnyNumber, Sequence[AnyNumber]], _State]:
    """The rate φ'(t) + G(t, y) - G(t, φ(t)), with the bells φ as solution; if not timed, y ends with the clock."""

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        at, state = (t, y) if timed else (y[-1], y[:-1])
        bells = [_bell(i, at) for i in range(len(state))]
        pairs = zip(bells, _coupled(at, state), _coupled(at, [bell for bell, *_ in bells]), strict=True)
        slopes = [mine - its + slope for (_, slope, _), mine, its in pairs]
        return slopes if timed else [*slopes, at * 0 + 1]

    return rate


def _product_of_others(q: Sequence[AnyNumber]) -> _State:
    """For each i, the product of the q_j with j ≠ i, times 1/(1 + q_i²)."""
    return [prod([*q[:i], *q[i + 1 :]], start=1 / (1 + x * x)) for i, x in enumerate(q)]


def pushed(positions: int, *, timed: bool) -> NonlinearProblem:
    """The problem q'' = φ''(t) + S(q) - S(φ(t)) with S from `_product_of_others` and the bells φ as solution.

    If it is not timed, the last position is the clock, which no force moves.
    """
    bells = positions if timed else positions - 1

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        q, v = _halves(y, positions)
        at = t if timed else q[-1]
        known = [_bell(i, at) for i in range(bells)]
        pulls = zip(known, _product_of_others(q[:bells]), _product_of_others([bell for bell, *_ in known]), strict=True)
        forces = [own + mine - its for (*_, own), mine, its in pulls]
        return [*v, *forces, *([] if timed else [0 * at])]

    def solution(t: arb) -> list[arb]:
        places, speeds, _ = zip(*(_bell(i, t) for i in range(bells)), strict=True)
        return [*places, *speeds] if timed else [*places, t, *speeds, arb(1)]

    several = "" if positions == 1 else f" of {positions} positions"
    words = f"a nonlinear q'' = {'F(t, q)' if timed else 'F(q)'}{several}{'' if timed else ', one being the time'}"
    return NonlinearProblem(words, rate, solution, positions, timed=timed)


def capped_exp(x: AnyNumber) -> AnyNumber:
    """The exponential; of a float, at most exp(700), which does not overflow."""
    return x.exp() if isinstance(x, arb) else exp(min(x, _LARGEST_EXPONENT))


def walls(positions: int) -> NonlinearProblem:
    """The problem q'' = exp(-2q) for each position, solved by log cosh (t + i/2)."""

    def solution(t: arb) -> list[arb]:
        times = [t + _SPACING * i for i in range(positions)]
        return [*(x.cosh().log() for x in times), *(x.tanh() for x in times)]

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        half = len(y) // 2
        return [*y[half:], *(capped_exp(-2 * q) for q in y[:half])]

    words = "q'' = exp(-2q)" if positions == 1 else f"q'' = exp(-2q) of {positions} positions"
    return NonlinearProblem(words, rate, solution, positions, coupled=False)
