"""Answers about y' = f(t, y) of a problem, ours or a .toml file, and about y' = λy: runs in balls, solutions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial

from flint import arb, ctx

from driftproof.enclosure.exact_runs import exact_step
from driftproof.enclosure.fields import rebound
from driftproof.enclosure.solutions import BITS_AT_FIRST, enclose_solution
from driftproof.enclosure.text_fields import field_function
from driftproof.methods.field_text import LONGEST_PROBLEM, PROBLEM_KEYS, field_of_table
from driftproof.methods.rationals import parse_rational
from driftproof.methods.schemes import Method, Nystrom, Splitting
from driftproof.methods.vector_fields import VectorField
from driftproof.support.toml_tables import TomlTable, as_list, demand_keys, read_toml
from driftproof.symbolic.algebra.certified import CertifiableReal, enclose
from driftproof.texts.questions.answer import CERTIFIED, Answer
from driftproof.texts.questions.arithmetic import NUMBER_FUNCTIONS, OPERATIONS, raised

# Some minutes in balls of a few hundred bits.
MOST_STEPS_OF_PROBLEM = 10**5


@dataclass(frozen=True)
class ProblemRun:
    """A method on y' = f(t, y), y(0) = start, with `steps` steps of size h; all enclosed, to any number of bits."""

    method: Method | None
    rates: VectorField
    start: tuple[Fraction, ...]
    h: Fraction
    steps: int
    known: dict[tuple[str, int], Sequence[arb]] = field(default_factory=dict, compare=False)

    @property
    def t(self) -> Fraction:
        """The end."""
        return self.h * self.steps

    def numerical(self) -> Sequence[arb]:
        """The method's state after the last step, without rounding, in balls of the present precision."""
        return self._kept("numerical", self._stepped)

    def true(self) -> Sequence[arb]:
        """The solution at the end, enclosed."""

        def solved() -> Sequence[arb]:
            if self.t == 0:
                return [enclose(x) for x in self.start]
            times = (Fraction(0), self.t)
            bits = max(ctx.prec, BITS_AT_FIRST)
            return enclose_solution(field_function(self.rates), self.start, times, bits).states[-1]

        return self._kept("true", solved)

    def _stepped(self) -> Sequence[arb]:
        assert self.method is not None
        step = exact_step(self.method, rebound(field_function(self.rates)), len(self.start))
        y = tuple(enclose(x) for x in self.start)
        for n in range(self.steps):
            y = step(y, n * self.h, self.h)
        return y

    def _kept(self, which: str, find: Callable[[], Sequence[arb]]) -> Sequence[arb]:
        key = which, ctx.prec
        if key not in self.known:
            self.known[key] = find()
        return self.known[key]


def problem_run(method: Method | None, problem: str, h: Fraction, t: Fraction) -> ProblemRun:
    """The run to t by steps of h; without a method only the solution is asked for.

    Raises ValueError for an unknown problem, a method that cannot take it, and more steps than anybody waits for.
    """
    rates, start = _problem(problem)
    steps = t / h
    if steps.denominator != 1 or steps < 1:
        raise ValueError(f"h = {h} does not divide t = {t}: t / h = {steps}")
    if steps > MOST_STEPS_OF_PROBLEM:
        raise ValueError(f"{steps} steps; on a problem at most {MOST_STEPS_OF_PROBLEM} are made in balls")
    if isinstance(method, Splitting | Nystrom):
        rates.second_order()
    return ProblemRun(method, rates, start, h, int(steps))


def problem_readouts(run: ProblemRun) -> dict[str, Callable[[ProblemRun], Answer]]:
    """By name, what can be read of the run: y0, y1, ..., exact.y0, ..., and where a method steps, its state_error."""
    exact = "exact." if run.method is not None else ""
    found: dict[str, Callable[[ProblemRun], Answer]] = {}
    for i in range(len(run.start)):
        if run.method is not None:
            found[f"y{i}"] = partial(_component, ProblemRun.numerical, i)
        found[f"{exact}y{i}"] = partial(_component, ProblemRun.true, i)
    if run.method is not None:
        found["state_error"] = lambda run: _enclosed(lambda: _distance(run.numerical(), run.true()))
        found["steps"] = lambda run: Answer("", Fraction(run.steps))
    return found


def _component(state: Callable[[ProblemRun], Sequence[arb]], index: int, run: ProblemRun) -> Answer:
    return _enclosed(lambda: state(run)[index])


def _distance(a: Sequence[arb], b: Sequence[arb]) -> arb:
    return sum(((x - y) ** 2 for x, y in zip(a, b, strict=True)), arb(0)).sqrt()


def _enclosed(x: CertifiableReal) -> Answer:
    return Answer("", x, CERTIFIED)


def decay_readouts(factor: Answer, rate: Fraction, h: Fraction, steps: int) -> dict[str, Callable[[], Answer]]:
    """Of y' = λy, y(0) = 1: y after the steps, R(hλ)^N; exact.y, exp(λt); and state_error, how far apart they are."""

    def exact() -> Answer:
        return NUMBER_FUNCTIONS["exp"][0](Answer("", rate * h * steps))

    def y() -> Answer:
        return raised(factor, Fraction(steps))

    return {
        "y": y,
        "exact.y": exact,
        "state_error": lambda: NUMBER_FUNCTIONS["abs"][0](OPERATIONS["-"](y(), exact())),
        "steps": lambda: Answer("", Fraction(steps)),
    }


def _problem(name: str) -> tuple[VectorField, tuple[Fraction, ...]]:
    """Field and start of a problem of ours, or of a file."""
    if not name.endswith(".toml"):
        from driftproof.numeric.problems.catalogue import problem_named

        problem = problem_named(name)
        return problem.field, problem.start

    def read(table: TomlTable) -> tuple[VectorField, tuple[Fraction, ...]]:
        demand_keys(table, PROBLEM_KEYS, "a problem")
        rates = field_of_table(table)
        start = tuple(parse_rational(str(x), f"start[{i}]") for i, x in enumerate(as_list(table.get("start"), "start")))
        if len(start) != len(rates.rates):
            raise ValueError(f"start has {len(start)} entries, {len(rates.rates)} are needed")
        return rates, start

    return read_toml(name, LONGEST_PROBLEM, read)
