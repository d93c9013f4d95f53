"""Answers about problems y' = f(t, y), from the catalogue, a file or the question: enclosed runs and solutions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache, partial, reduce
from itertools import count, islice
from typing import Any

from flint import arb, ctx

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.fields import RightHandSide, enclosable, enclosed_values
from driftproof.enclosure.fields.text_fields import field_function, linear_part
from driftproof.enclosure.problem_tables import ProblemTable, problem_table, with_parameters
from driftproof.enclosure.runs.exact_runs import exact_step
from driftproof.enclosure.runs.implicit_runs import implicit_step
from driftproof.enclosure.runs.multistep_runs import StartedMultistep
from driftproof.enclosure.solution.solutions import BITS_AT_FIRST, enclose_solution
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.field_text import LONGEST_PROBLEM
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.support.files import file_named
from driftproof.support.plain_text import counted
from driftproof.support.toml_tables import read_toml
from driftproof.symbolic.algebra.certified import CertifiableReal, Uncertified, enclose, near_zero
from driftproof.symbolic.algebra.polynomials import exact
from driftproof.symbolic.facts import Facts
from driftproof.texts.questions.answer import CERTIFIED, Answer
from driftproof.texts.questions.runs import evaluations, explicit_slopes

# At most this many steps: some minutes in balls of a few hundred bits.
MOST_STEPS_OF_PROBLEM = 10**5
# Chosen: 300 digits or so; more take minutes, and a solution that is a whole number stays undecided at any precision.
_MOST_BITS_OF_SOLUTION = 1024
# Chosen: a longer state is not kept in Fractions, as its length may double with every step, as for y' = y².
_LONGEST_EXACT = 4096
# Readouts of a run: 0 stands for any index and 1 for any stage, of explicit Runge-Kutta methods only.
_ERRORS = ("state_error", "relative_error", "largest_error", "error.y0", "position_error")
_ENERGIES = ("energy", "energy_change", "relative_energy_change", "largest_energy_change")
PROBLEM_READOUTS = (
    "y0",
    "exact.y0",
    "slope.y0",
    "k1.y0",
    "embedded.y0",
    "estimate.y0",
    *_ERRORS,
    *_ENERGIES,
    "steps",
    "evaluations",
)
# A vector of balls or of Fractions.
_Row = Sequence[Any]


@dataclass(frozen=True)
class ProblemRun:
    """A run of a method, None for the solution alone, on y' = f(t, y), y(0) = start, with `steps` steps of size h.

    States and solutions are enclosed at Arb's current precision, once for all runs of a method with the same steps, and
    for all runs on a problem.
    """

    method: Method | StartedMultistep | None
    rates: VectorField
    start: tuple[CertifiableReal, ...]
    h: Fraction
    steps: int
    energy: str | None = None

    @property
    def t(self) -> Fraction:
        """The final time."""
        return self.h * self.steps

    def numerical(self) -> list[_Row]:
        """Enclosures of the states of the exact run, the start first; in as many bits as f needs, if it has a value."""
        bits = ctx.prec
        while True:
            try:
                with ctx.workprec(bits):
                    return self._run()
            except Refused:  # wide balls may hold a pole of f
                if bits >= _MOST_BITS_OF_SOLUTION:
                    raise
                bits *= 2

    def _run(self) -> list[_Row]:
        """The states of the exact run, in balls of the current precision; without a method the solution at the end."""
        if self.method is None:
            return self.true(range(self.steps, self.steps + 1))
        found = _states(self.method, self.rates, self.start, self.h, ctx.prec)
        if isinstance(self.method, StartedMultistep):
            if self.steps not in found:
                with ctx.workprec(ctx.prec + self.method.bits_lost(self.steps)):
                    found.update(enumerate(islice(self._multistep(), self.steps + 1)))
        elif self.steps not in found:
            step = exact_step(self.method, _function_of(self.rates), len(self.start))
            found[0] = tuple(enclose(x) for x in self.start)
            for n in range(len(found), self.steps + 1):
                found[n] = step(tuple(found[n - 1]), (n - 1) * self.h, self.h)
        return [found[n] for n in range(self.steps + 1)]

    def true(self, steps: range) -> list[_Row]:
        """Enclosures of the solution after these increasing numbers of steps. Raises Uncertified at too many bits."""
        bits, times = max(ctx.prec, BITS_AT_FIRST), [n * self.h for n in steps]
        if bits > _MOST_BITS_OF_SOLUTION:
            raise Uncertified(f"not decided with {_MOST_BITS_OF_SOLUTION} bits: too many digits, or a tie")
        found = _states(None, self.rates, self.start, Fraction(0), bits)
        if missing := [t for t in times if t not in found]:
            with ctx.workprec(bits):
                start = [enclose(x) for x in self.start]
            at = [Fraction(0), *(t for t in missing if t)]
            found.update(zip(at, enclose_solution(_function_of(self.rates), start, at, bits).states, strict=True))
        return [found[t] for t in times]

    @cached_property
    def exactly(self) -> _Row | None:
        """The final state in Fractions; None if it is not rational, not from an explicit method, or too long."""
        y: _Row = self.start
        if not all(isinstance(x, Fraction) for x in y):
            return None
        try:
            for y in islice(self._exact_states(), self.steps + 1):
                if sum(x.numerator.bit_length() + x.denominator.bit_length() for x in y) > _LONGEST_EXACT:
                    return None
        except (TypeError, ZeroDivisionError):  # an irrational coefficient, or a function in a rate
            return None
        return y

    def _exact_states(self) -> Iterator[_Row]:
        """Yield the states in Fractions, the start first. Raises TypeError if they are not rational."""
        if isinstance(self.method, StartedMultistep):
            yield from self._multistep(exactly=True)
        y: _Row = self.start
        factor = self._factor()
        for n in count():
            yield y
            if factor is not None:
                y = [factor * y[0]]
                continue
            changes = self.change(getattr(self.method, "b", ()), n * self.h, y)
            y = [x + change for x, change in zip(y, changes, strict=True)]

    def _factor(self) -> Fraction | None:
        """R(hλ) on y' = λy of a method whose stages are solved; None for others. Raises TypeError if there is none."""
        method = self.method
        if not isinstance(method, RungeKutta | Collocation) or method.explicit:
            return None
        part = linear_part(self.rates) if len(self.rates.rates) == 1 else None
        if part is None or part[1] is None or any(part[1]):
            raise TypeError("not y' = λy")
        function, ((rate,),) = Facts(method).stability_function, part[0]
        found = exact(function.f(as_fmpq(self.h * rate))) if function else None
        if not isinstance(found, Fraction):
            raise TypeError("an irrational factor")
        return found

    def _multistep(self, exactly: bool = False) -> Iterator[_Row]:
        """Yield the states of a multistep method, the start first, in balls or `exactly`, which raises TypeError."""
        assert isinstance(self.method, StartedMultistep)
        k, starter = self.method.method.steps, self.method.starter
        if exactly and (starter is None or not self.method.method.explicit):
            raise TypeError("not from an explicit method")
        first = self.true(range(k)) if starter is None else self._started(starter, k, exactly)
        yield from first
        solved = implicit_step(METHODS["backward_euler"], _function_of(self.rates), len(self.start))
        yield from self.method.states(self.rate, first, self.h, solved)

    def _started(self, starter: Method, many: int, exactly: bool) -> list[_Row]:
        run = replace(self, method=starter, steps=many - 1)
        return [*islice(run._exact_states(), many)] if exactly else run.numerical()

    def slopes(self, t: Fraction, y: _Row) -> list[_Row]:
        """The slopes k_j = f(t + c_j h, y + h sum a_jl k_l) of an explicit Runge-Kutta step, in the type of y.

        Raises TypeError for other methods, and if Fractions do not lead to Fractions.
        """
        if not isinstance(self.method, RungeKutta) or not self.method.explicit:
            raise TypeError("no explicit Runge-Kutta method")
        return explicit_slopes(self.method, self.rate, t, y, self.h, _lift_of(y))

    def change(self, weights: Sequence[Any], t: Fraction, y: _Row) -> _Row:
        """The sum of h b_j k_j for these weights b, in the type of y. Raises TypeError as `slopes` does."""
        lift = _lift_of(y)
        slopes, by = self.slopes(t, y), [lift(self.h) * lift(b) for b in weights]
        return [sum((b * k[i] for b, k in zip(by, slopes, strict=True)), x - x) for i, x in enumerate(y)]

    def rate(self, t: Any, y: _Row) -> _Row:
        """f(t, y), in the type of y. Raises TypeError if y is in Fractions and a rate has no value in them."""
        return _values(_function_of(self.rates), t, y)

    def energy_of(self, t: Any, y: _Row) -> Any:
        """The energy of y, in the type of y. Raises TypeError as `rate` does."""
        return _values(_function_of(self.rates, self.energy), t, y)[0]

    def energy_change(self, t: Any, y: _Row, first: _Row) -> Any:
        """The energy of y at t less that of the first state, in the type of y. Raises TypeError as `rate` does."""
        return self.energy_of(t, y) - self.energy_of(Fraction(0), first)


def _lift_of(y: _Row) -> Callable[[Any], Any]:
    """What makes an exact number one of the type of y."""
    return Fraction if isinstance(y[0], Fraction) else enclose


@lru_cache(maxsize=64)
def _function_of(rates: VectorField, energy: str | None = None) -> RightHandSide:
    """The rates or the energy as a function on balls, written and compiled once for all runs on a problem."""
    return enclosable(field_function(rates, energy and [energy]))


def _values(function: RightHandSide, t: Any, y: _Row) -> _Row:
    if isinstance(y[0], Fraction):
        return [*function(t, y)]
    evaluation = Evaluation()
    state, at = [Enclosed(evaluation, x) for x in y], t if isinstance(t, arb) else enclose(t)
    found = enclosed_values("f", partial(function, Enclosed(evaluation, at)), state, evaluation)
    return [arb(x.value) for x in found]


def problem_run(
    method: Method | StartedMultistep | None,
    problem: ProblemTable,
    given: tuple[CertifiableReal, ...] | None,
    h: Fraction,
    t: Fraction,
) -> ProblemRun:
    """The run to time t with steps of size h from the `given` start, else that of the problem; see ProblemRun.

    Raises ValueError for a method that is not for the problem, a start of another dimension, an h that does not divide
    t, and more than MOST_STEPS_OF_PROBLEM steps.
    """
    rates, start = problem.field, given or problem.start
    if len(start) != len(rates.rates):
        raise ValueError(f"the start has {len(start)} entries, required: {len(rates.rates)}, as in y(0)=1 or from 1,0")
    steps = t / h if h else t
    if steps.denominator != 1 or steps < (method is not None):
        raise ValueError(f"h = {h} does not divide t = {t}: t / h = {steps}")
    if steps > MOST_STEPS_OF_PROBLEM:
        raise ValueError(f"{steps} steps; on a problem at most {MOST_STEPS_OF_PROBLEM} are allowed")
    if isinstance(method.starter if isinstance(method, StartedMultistep) else method, Splitting | Nystrom):
        rates.second_order()
    if isinstance(method, StartedMultistep) and steps < method.method.steps:
        raise ValueError(
            f"{counted(int(steps), 'step')}: {method.key} makes the first of its own after those of its start"
        )
    return ProblemRun(method, rates, start, h, int(steps), problem.energy)


@lru_cache(maxsize=64)
def _states(
    method: Method | StartedMultistep | None,
    rates: VectorField,
    start: tuple[CertifiableReal, ...],
    h: Fraction,
    bits: int,
) -> dict[Fraction | int, _Row]:
    """The states known so far, by the number of steps or, without a method, by time; filled by its callers."""
    return {}


def problem_readouts(run: ProblemRun, unknowns: Sequence[str] = ()) -> dict[str, Callable[[ProblemRun], Answer]]:
    """The readouts of a run by name; `unknowns` replace the names y0, y1, ...

    Without a method these are the components of the solution, and its energy. With one they are y0, ... and exact.y0,
    ... at the end; slope.y0, ..., which is f(t, y) there; state_error, relative_error, largest_error over all steps,
    error.y0, ... of a component, and for q'' = F(t, q, q') position_error; if the problem has an energy, that at the
    end, energy_change, relative_energy_change, and largest_energy_change, where it is largest in size; steps and
    evaluations; k1.y0, k2.y0, ... of the first step of an explicit Runge-Kutta method, and if it is a pair,
    embedded.y0, ..., the other solution after that step, and estimate.y0, ..., the first one minus the other.
    """
    all_steps = range(run.steps + 1)

    def error_of(part: slice, run: ProblemRun) -> Answer:
        return _enclosed(lambda: _distance(run.numerical()[-1][part], solved(run)[part]))

    def solved(run: ProblemRun) -> _Row:
        return run.true(all_steps[-1:])[0]

    exact = "exact." if run.method is not None else ""
    components = [(i, unknowns[i] if unknowns else f"y{i}") for i in range(len(run.start))]
    solution = {f"{exact}{y}": (lambda run, i=i: _enclosed(lambda: solved(run)[i])) for i, y in components}
    energy = {} if run.energy is None else {"energy": partial(_read, lambda run, _, end: run.energy_of(run.t, end))}
    if (method := run.method) is None:
        return {**solution, **energy}
    errors = {f"error.{y}": slice(i, i + 1) for i, y in components}
    half = len(run.start) // 2
    if run.rates.rates[:half] == run.rates.components[half:]:
        errors["position_error"] = slice(half)
    rows: dict[str, _OfStates] = {"slope": lambda run, _, end: run.rate(run.t, end)}
    if isinstance(run.method, RungeKutta) and run.method.explicit:
        for j in range(len(run.method.b)):
            rows[f"k{j + 1}"] = lambda run, first, _, j=j: run.slopes(Fraction(0), first)[j]
        if (other := run.method.b_embedded) is not None:
            apart = [b - c for b, c in zip(run.method.b, other, strict=True)]
            rows["estimate"] = lambda run, first, _: run.change(apart, Fraction(0), first)
            rows["embedded"] = lambda run, first, _: [
                x + change for x, change in zip(first, run.change(other, Fraction(0), first), strict=True)
            ]
    return {
        **{y: partial(_read, lambda run, _, end, i=i: end[i]) for i, y in components},
        **solution,
        "state_error": partial(error_of, slice(None)),
        "relative_error": lambda run: _enclosed(
            lambda: _distance(run.numerical()[-1], solved(run)) / _distance(solved(run), [0] * len(run.start))
        ),
        **{name: partial(error_of, part) for name, part in errors.items()},
        "largest_error": lambda run: _enclosed(lambda: _largest(map(_distance, run.numerical(), run.true(all_steps)))),
        **energy,
        **(_CHANGES if energy else {}),
        "steps": lambda run: Answer("", Fraction(run.steps)),
        **({} if isinstance(method, StartedMultistep) else {"evaluations": lambda run: evaluations(method, run.steps)}),
        **{
            f"{name}.{y}": partial(_read, lambda run, first, end, row=row, i=i: row(run, first, end)[i])
            for name, row in rows.items()
            for i, y in components
        },
    }


# A function of a run and its first and last states, in the type of these.
_OfStates = Callable[..., Any]


def _read(read: _OfStates, run: ProblemRun) -> Answer:
    """A function of the first and the last state: exactly if it is rational, and else enclosed."""
    if run.exactly is not None:
        with suppress(TypeError):  # a function such as log
            return Answer("", read(run, run.start, run.exactly))
    return _enclosed(lambda: read(run, run.numerical()[0], run.numerical()[-1]))


def _relative_change(run: ProblemRun, first: _Row, end: _Row) -> Any:
    if (energy := run.energy_of(Fraction(0), first)) == 0:
        raise ValueError("the energy of the start is 0, so no change is relative to it")
    return run.energy_change(run.t, end, first) / abs(energy)


def _largest(numbers: Iterable[arb]) -> arb:
    """The one that is largest in size, in a ball that holds all that may be."""
    balls = [*numbers]
    least = max(ball.abs_lower() for ball in balls)
    return reduce(arb.union, (ball for ball in balls if ball.abs_upper() >= least))


def _largest_change(run: ProblemRun) -> arb:
    states = run.numerical()
    return _largest(run.energy_change(n * run.h, y, states[0]) for n, y in enumerate(states))


def _distance(a: _Row, b: _Row) -> arb:
    # Balls that hold 0 have no power in python-flint.
    differences = [x - y for x, y in zip(a, b, strict=True)]
    return sum((d * d for d in differences), arb(0)).nonnegative_part().sqrt()


def _enclosed(read: Callable[[], arb]) -> Answer:
    def decided() -> arb:
        try:
            return read()
        except Uncertified:
            with ctx.workprec(_MOST_BITS_OF_SOLUTION):
                most = read()
            if not (said := near_zero(most)):
                raise
            raise Uncertified(f"not decided with {_MOST_BITS_OF_SOLUTION} bits: {said}") from None

    return Answer("", decided, CERTIFIED)


_CHANGES: dict[str, Callable[[ProblemRun], Answer]] = {
    "energy_change": partial(_read, lambda run, first, end: run.energy_change(run.t, end, first)),
    "relative_energy_change": partial(_read, _relative_change),
    "largest_energy_change": lambda run: _enclosed(lambda: _largest_change(run)),
}


def problem_of_name(name: str, parameters: Mapping[str, Fraction]) -> ProblemTable:
    """The problem with this name in the catalogue, or in this .toml file with other values of some of its parameters.

    Raises ValueError if there is none, or no such parameter.
    """
    if name.endswith(".toml"):
        changed = lambda table: problem_table(with_parameters(table, parameters, name))
        return read_toml(file_named(name), LONGEST_PROBLEM, changed)
    from driftproof.numeric.problems.catalogue import problem_named

    problem = problem_named(name)
    return ProblemTable(problem.field, problem.start, problem.energy)
