"""The recurrence of a multistep stepper: rho and sigma, read from a run on marked slopes, and their method."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product

import numpy as np

from driftproof.blackbox.families.multistep_runs import MarkedRuns, SteadyRun
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes.coefficients import coefficient_difference, coefficient_text, simple_rational
from driftproof.blackbox.probes.scripted_answers import NotReadable, Rounding
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import MethodError
from driftproof.symbolic.linear.multistep import MultistepFacts
from driftproof.symbolic.rounding.formats import FloatFormat

# The steps of a run; the recurrence is sought in its second half, by which every start in use is over.
RUN_LENGTH = 40
# More steps than any method in use remembers.
_MOST_STEPS = 8
# The residual of an explicit recurrence is rounding; that of solvers in use is 1e-6 or less for numbers of size 1. A
# solver that stops earlier leaves less than the third, an F evaluated elsewhere more.
_EXACT, _SOLVED, _UNSOLVED = 0.0, 1e-6, 2.0**-10
# Further runs that must satisfy it: h, the start, and how many steps. Times are exact, as codes may subtract them for
# h.
_OTHER_RUNS = ((0.5, 3.0, RUN_LENGTH), (0.75, 1.0, RUN_LENGTH), (2.0**-12, 117.5, RUN_LENGTH))
# Further runs that are left out if they fail: numbers may grow, and many codes refuse to step back.
_HARDER_RUNS = ((0.75, 1.0, 5 * RUN_LENGTH), (-0.5, 2.0, RUN_LENGTH))
# The steps in which coefficients are sought: late ones; and early ones, before a growing error is all there is.
_LATER = slice(RUN_LENGTH // 2, None)
_WINDOWS = (_LATER, slice(_MOST_STEPS, 2 * _MOST_STEPS + 1))
ONE_SIZE = "only steps of one size were tested"
# A method that differs in more coefficients than this is another one.
_FEW_DIFFERENCES = 2
# The correctors of one step, by their sigma.
_OF_ONE_STEP: dict[tuple[Fraction, ...], str] = {
    (Fraction(1, 2), Fraction(1, 2)): "trapezoid",
    (Fraction(0), Fraction(1)): "backward_euler",
}
FORWARD_EULER = Multistep(
    "forward_euler", "Forward Euler", 1, "", rho=(Fraction(-1), Fraction(1)), sigma=(Fraction(1), Fraction(0))
)


class NoRecurrence(NotReadable):
    """The steps satisfy no linear recurrence, whatever its coefficients."""

    kind = "no_recurrence"


@dataclass(frozen=True)
class Recurrence:
    """Σⱼ ρⱼ yₙ₊ⱼ = hᵈ Σⱼ σⱼ F(yₙ₊ⱼ) with ρₖ = 1, in floats, oldest first; each may be off by `error`."""

    rho: tuple[float, ...]
    sigma: tuple[float, ...]
    derivative: int
    format: FloatFormat
    error: float = 0.0

    @classmethod
    def of(cls, method: Multistep, fmt: FloatFormat) -> Recurrence:
        """The recurrence of a method."""
        rho, sigma = ([float(x / method.rho[-1]) for x in row] for row in (method.rho, method.sigma))
        return cls(tuple(rho), tuple(sigma), method.derivative, fmt)

    @property
    def steps(self) -> int:
        """The number of steps k."""
        return len(self.rho) - 1

    @property
    def rounding(self) -> float:
        """The residual that rounding may leave, relative to the terms."""
        return Rounding(self.format, self.steps + 1).of(1.0)

    def left(self, run: SteadyRun) -> Array:
        """The residual of each step of a run from the k-th on, relative to the terms."""
        rows = len(run.states) - self.steps
        terms = [x * run.states[j : rows + j] for j, x in enumerate(self.rho)]
        terms += [-x * run.slopes[j : rows + j] for j, x in enumerate(self.sigma)]
        sizes = np.sum(np.abs(terms), axis=0) + float(self.format.eta) / float(self.format.u)
        return np.asarray((np.abs(np.sum(terms, axis=0)) / sizes).max(axis=1))

    def left_later(self, run: SteadyRun) -> float:
        """The largest residual in the second half of a run."""
        return float(self.left(run)[_LATER].max())

    def kept(self, run: SteadyRun, tolerance: float) -> bool:
        """True if the second half of a run satisfies it to the tolerance, or to rounding if that is more."""
        return self.left_later(run) <= max(self.rounding, tolerance)

    @property
    def lines(self) -> list[str]:
        """ρ and σ, with the simple fractions that they are the roundings of, if there are any."""
        rows = (("rho", self.rho), ("sigma", self.sigma))
        return [f"{name} = {', '.join(coefficient_text(x, self.format, self.error) for x in xs)}" for name, xs in rows]

    def off(self, x: float) -> float:
        """How far a coefficient may be off, a few roundings at least: codes divide by the factor of the new value."""
        return max(self.error, 4 * float(self.format.u) * max(1.0, abs(x)))

    @property
    def exact(self) -> Multistep | None:
        """The method with the simple fractions that these are the roundings of; None if one of them is not."""
        rows = [[simple_rational(x, self.off(x)) for x in row] for row in (self.rho, self.sigma)]
        if any(x is None for row in rows for x in row):
            return None
        rho, sigma = (tuple(x for x in row if x is not None) for row in rows)
        try:
            return replace(FORWARD_EULER, rho=rho, sigma=sigma, derivative=self.derivative)
        except MethodError:
            return None

    def _takes_the_last_early(self, method: Multistep) -> bool:
        """True if it is the method with the slope of the new state taken where that of the state before is."""
        *kept, before, last = (x / method.rho[-1] for x in method.sigma)
        pairs = [*zip(self.rho, (x / method.rho[-1] for x in method.rho), strict=True)]
        pairs += zip(self.sigma, (*kept, before + last, Fraction(0)), strict=True)
        return bool(last) and all(abs(x - y) <= self.off(x) for x, y in pairs)

    def differences(self, method: Multistep) -> tuple[str, ...] | None:
        """The few coefficients that are not the method's, in words; None if they are many, or if k or d differs."""
        if (method.steps, method.derivative) != (self.steps, self.derivative):
            return None
        found = []
        if self.steps > 1 and self._takes_the_last_early(method):
            last = f"sigma[{self.steps}]"
            return (f"{last}: the slope that it weighs is taken a step too early, as that of sigma[{self.steps - 1}]",)
        for name, seen, exact in (("rho", self.rho, method.rho), ("sigma", self.sigma, method.sigma)):
            for j, (x, y) in enumerate(zip(seen, exact, strict=True)):
                if abs(x - y / method.rho[-1]) > self.off(x):
                    told = coefficient_difference(f"{name}[{j}]", x, y / method.rho[-1], self.format, self.error)
                    found.append(told)
        return tuple(found) if len(found) <= _FEW_DIFFERENCES else None


@dataclass(frozen=True)
class RecurrenceReading:
    """The recurrence of a stepper, the method that has it (or None), and where its right-hand side F is evaluated.

    `late` counts the steps after the first k - 1 that do not satisfy it yet. `left` is the residual of later steps,
    relative to the terms, or 0 if it is rounding. `asked` says where F is evaluated if not at the returned states; if
    that is at predicted ones, `predictor` is the explicit method, and `corrections` the number of corrections. Where F
    does not depend on t, it is the method `untimed`, so that F is called at wrong times.
    """

    recurrence: Recurrence
    method: Multistep | None
    late: int
    left: float = 0.0
    predictor: Multistep | None = None
    corrections: int = 0
    asked: str = ""
    untimed: Multistep | None = None

    @property
    def near(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """The nearest methods, with the few coefficients that differ."""
        if self.method is not None or self.untimed is not None:
            return ()
        found = [(m.key, self.recurrence.differences(m)) for m in candidates(self.recurrence.derivative)]
        told = [(key, words) for key, words in found if words]
        fewest = min((len(words) for _, words in told), default=None)
        return tuple(each for each in told if len(each[1]) == fewest)

    @property
    def named(self) -> bool:
        """True if the name is that of a method, exactly or nearly."""
        return bool(self._key or self.untimed or self.near or self.theta)

    @property
    def theta(self) -> Fraction | None:
        """The θ, not 0, of y₁ = y₀ + h ((1 - θ) F₀ + θ F₁), F taken at the states returned; None of another one."""
        own = None if self.asked or self.recurrence.steps > 1 else self.recurrence.exact
        if own is None or own.derivative > 1 or own.rho[0] != -1 or sum(own.sigma) != 1:
            return None
        return own.sigma[1] or None

    @property
    def _key(self) -> str | None:
        own = self.recurrence.exact if self.recurrence.steps == 1 and self.asked else None
        of_one_step = None if own is None else _OF_ONE_STEP.get(own.sigma)
        return of_one_step if self.method is None else self.method.key

    @property
    def name(self) -> str:
        """The method in words, or what is known of it."""
        k, key = self.recurrence.steps, self._key
        if key and self.predictor is not None:
            return corrected_name(key, self.predictor.key, self.corrections)
        if key:
            return f"{key}, but {self.asked}" if self.asked else key
        if self.untimed is not None:
            return f"{self.untimed.key} called at wrong times: it is that method only where F does not depend on t"
        if self.near:
            return f"a multistep method of {k} steps, {self.near[0][0]} except for {'; '.join(self.near[0][1])}"
        if self.theta is not None:
            return f"the theta method, theta = {self.theta}"
        if k == 1:
            return "not a multistep method: each step depends on the previous state only"
        return f"a multistep method of {k} steps that is not in the catalogue"

    @cached_property
    def facts(self) -> MultistepFacts | None:
        """The facts of the method, or of the fractions read; None if there are neither."""
        method = self.method or self.recurrence.exact
        return None if method is None else MultistepFacts(method)

    @property
    def lines(self) -> list[str]:
        """The recurrence as lines."""
        held = f"to {self.left:.1e}, the accuracy of its solver," if self.left else "to rounding"
        named = "no multistep method of the catalogue"
        if self.untimed is not None:
            named = "as read where F depends on t alone:"
        if self.method is not None:
            named = f"{self.method.key}: satisfied {held} in runs of {RUN_LENGTH} steps, after the start"
        nearest = [f"nearest: {key} except for {'; '.join(words)}" for key, words in self.near]
        asked = [self.asked] if self.asked else []
        first = self.recurrence.steps - 1 + self.late
        late = ["the first step differs" if first == 1 else f"the first {first} steps differ"] * bool(self.late)
        return [named, *nearest, *self.recurrence.lines, *asked, *late, ONE_SIZE]


def corrected_name(corrector: str, predictor: str, corrections: int) -> str:
    """The method in words whose equation is not solved but put into itself, from a prediction."""
    often = "once" if corrections == 1 else f"{corrections} times"
    return f"{corrector}, corrected {often} from the prediction of {predictor} (P{'EC' * corrections}E)"


def candidates(derivative: int) -> Iterator[Multistep]:
    """The multistep methods of the catalogue for y' = F (derivative 1) or for y'' = F (derivative 2)."""
    return (m for m in FURTHER_METHODS.values() if isinstance(m, Multistep) and m.derivative == derivative)


def tolerance_of(method: Multistep) -> float:
    """The residual that a solver of the method may leave: 0 if it is explicit."""
    return _EXACT if method.explicit else _SOLVED


def read_recurrence(runs: MarkedRuns, asked: Multistep | None = None) -> RecurrenceReading:
    """Read the recurrence that a long run on marked slopes satisfies; `asked` is a further method that it may be.

    Raises NoRecurrence if there is none of up to _MOST_STEPS steps, or if other runs do not satisfy it.
    """
    marked, fmt = runs.run(RUN_LENGTH), runs.subject.format
    read = _solved(marked, runs.derivative, fmt)
    own = [asked] if asked is not None and asked.derivative == runs.derivative else []
    known = [(Recurrence.of(m, fmt), m) for m in (*own, *candidates(runs.derivative))]
    kept = ((r, m) for r, m in known if r.kept(marked, tolerance_of(m)))
    exact, method = min(kept, key=lambda each: each[0].left_later(marked), default=(read, None))
    # The coefficients of an unknown method carry the errors of reading.
    tolerance = tolerance_of(method) if method is not None else 2 * (len(read.rho) + len(read.sigma)) * read.error
    for trial in (*_OTHER_RUNS, *_HARDER_RUNS):
        h, t, steps = trial
        try:
            other = runs.run(steps, h=h, t=t)
        except NotReadable:
            if trial in _HARDER_RUNS:
                continue
            raise
        if not exact.kept(other, tolerance):
            where = f"with h = {h:g} from t = {t:g}, in a run of {steps} steps"
            raise NoRecurrence(f"{where}, steps do not satisfy the recurrence that they satisfy with h = 1")
    late = int(np.flatnonzero(exact.left(marked) > max(exact.rounding, tolerance)).max(initial=-1)) + 1
    reading = RecurrenceReading(replace(exact, error=read.error), method, late)
    found = reading if runs.by_place else _with_places(reading, runs, tolerance)
    shows = not runs.clock and runs.size + runs.derivative > 2  # one number of y' = f(y) does not turn
    if not found.asked or found.predictor or not shows or (untimed := _untimed(runs, known)) is None:
        return found
    return replace(found, asked="", method=None, untimed=untimed)


def _untimed(runs: MarkedRuns, known: Sequence[tuple[Recurrence, Multistep]]) -> Multistep | None:
    """The method whose recurrence the steps satisfy where the slopes do not depend on t, if there is one."""
    run = runs.run(RUN_LENGTH, untimed=True)
    kept = [(each.left_later(run), m) for each, m in known if each.kept(run, tolerance_of(m))]
    return min(kept, key=lambda each: each[0])[1] if kept else None


def _solved(run: SteadyRun, derivative: int, fmt: FloatFormat) -> Recurrence:
    """The shortest recurrence that part of the run satisfies, to rounding or else to 1e-6. Raises NoRecurrence."""
    for window, tolerance, k in product(_WINDOWS, (_EXACT, _SOLVED), range(1, _MOST_STEPS + 1)):
        states, slopes = run.states[window], run.slopes[window]
        rows = len(states) - k
        columns = [-states[j : rows + j].ravel() for j in range(k)]
        columns += [slopes[j : rows + j].ravel() for j in range(k + 1)]
        matrix, ends = np.array(columns).T, states[k:].ravel()
        sizes = np.abs(matrix).max(axis=1) + np.abs(ends)
        scaled, sought = matrix / sizes[:, None], ends / sizes
        found, _, rank, _ = np.linalg.lstsq(scaled, sought, rcond=None)
        left = float(np.abs(scaled @ found - sought).max())
        rounding = Rounding(fmt, k + 1).of(float(np.abs(found).sum()))
        if rank == len(found) and left <= max(tolerance, rounding):
            # The error of the least-squares solution, from errors of this size in each row.
            error = float(np.abs(np.linalg.pinv(scaled)).sum(axis=1).max()) * max(left, rounding)
            clean = [0.0 if abs(x) <= error else float(x) for x in found]
            return Recurrence((*clean[:k], 1.0), tuple(clean[k:]), derivative, fmt, error)
    where = "with slopes at the states that it returns: no linear multistep method, corrected to the end"
    raise NoRecurrence(f"its steps satisfy no recurrence of up to {_MOST_STEPS} steps {where}")


def _with_places(reading: RecurrenceReading, runs: MarkedRuns, tolerance: float) -> RecurrenceReading:
    """The reading with where F is evaluated, which a run shows whose slopes depend on the state as well."""
    run, exact = runs.run(RUN_LENGTH, bent=True), reading.recurrence
    left = exact.left_later(run)
    if left <= max(exact.rounding, tolerance):
        return replace(reading, left=left) if left > exact.rounding else reading
    implicit = exact.sigma[-1] != 0
    for predictor in (FORWARD_EULER, *(m for m in candidates(runs.derivative) if m.explicit)) if implicit else ():
        for corrections in (1, 2):
            if _is_corrected(run, runs, exact, Recurrence.of(predictor, exact.format), corrections):
                told = f"F is evaluated at the prediction of {predictor.key} and at the states returned"
                return replace(reading, predictor=predictor, corrections=corrections, asked=told)
    if implicit and left < _UNSOLVED:
        return replace(reading, asked=f"its equations are solved to {left:.1e} only")
    return replace(reading, asked="its right-hand side is not evaluated at the states that it returns")


def _is_corrected(run: SteadyRun, runs: MarkedRuns, exact: Recurrence, predictor: Recurrence, corrections: int) -> bool:
    """True if each yₙ₊ₖ is what the explicit method predicts, put into the recurrence this many times."""
    k, problem = exact.steps, runs.problem(1.0, 0.0, bent=True)
    allowed = Rounding(exact.format, 2 * (k + 2))
    for n in range(RUN_LENGTH)[_LATER]:
        before, at = slice(n + 1 - k, n + 1), slice(n + 1 - predictor.steps, n + 1)
        value = -np.dot(predictor.rho[:-1], run.states[at]) + np.dot(predictor.sigma[:-1], run.slopes[at])
        known = -np.dot(exact.rho[:-1], run.states[before]) + np.dot(exact.sigma[:-1], run.slopes[before])
        for _ in range(corrections):
            clocked = [*value, *([float(n + 1)] if runs.clock else [])]
            value = known + exact.sigma[-1] * np.array(runs.slopes(problem, float(n + 1), clocked))
        if np.abs(value - run.states[n + 1]).max() > allowed.of(float(np.abs(run.states[before]).sum()) + k):
            return False
    return True
