"""Steps and runs on the oscillator, answered exactly; on request, the error of the same run in floats, bounded."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.rationals import ExactNumber, GivenState, exact_number, state_of, step_of
from driftproof.methods.schemes import Method
from driftproof.reports.progress import count_steps
from driftproof.support.plain_text import DIGITS_UNASKED, Json, as_json
from driftproof.support.results import Printable
from driftproof.symbolic.algebra.certified import HALF_EVEN
from driftproof.symbolic.runs import OscillatorRun
from driftproof.texts.writing.answers import answer_text, run_answer, step_answer


@dataclass(frozen=True, repr=False)
class RunAnswer(Printable, OscillatorRun):
    """A run, or one step, whose quantities are exact; printed, they have `digits` digits.

    `budget` holds the error of the same run in floats, if it was asked for.
    """

    digits: int = DIGITS_UNASKED
    rounding: str = HALF_EVEN
    budget: Json | None = None
    one_step: bool = False

    def written(self, form: str) -> str:
        """The answer as "text" or "json"."""
        answer = (step_answer if self.one_step else run_answer)(self, self.digits, self.rounding)
        if form == "json":
            return as_json(answer if self.budget is None else {**answer, "budget": self.budget})
        if self.budget is None:
            return answer_text(answer)
        from driftproof.reports.rounding import budget_text

        return f"{answer_text(answer)}\n\n{budget_text(self.budget)}"


def step(
    method: str | Path | Method,
    h: ExactNumber,
    *,
    state: GivenState = (1, 0),
    digits: int = DIGITS_UNASKED,
    rounding: str = HALF_EVEN,
) -> RunAnswer:
    """One step of q' = v, v' = -q by a method, given as its key or name, a .toml file, or itself. Raises ValueError.

    >>> from driftproof import step
    >>> step("rk4", "1/2").final_state
    (Fraction(337, 384), Fraction(-23, 48))
    """
    size = step_of(h)
    return RunAnswer(method_of(method), size, size, state_of(state), digits, rounding, one_step=True)


def run(
    method: str | Path | Method,
    h: ExactNumber,
    t: ExactNumber,
    *,
    state: GivenState = (1, 0),
    digits: int = DIGITS_UNASKED,
    rounding: str = HALF_EVEN,
    budget: bool = False,
) -> RunAnswer:
    """t/h steps of q' = v, v' = -q: final and exact state, errors, energy and phase, all exact for any number of steps.

    With `budget` the run is also made in floats, and its error split into truncation and rounding. Raises ValueError if
    h does not divide t.

    >>> from driftproof import run
    >>> found = run("forward_euler", "1/4", 10)
    >>> found.steps, found.state_error
    (40, 2.39029716830675)
    """
    asked = RunAnswer(method_of(method), step_of(h), exact_number(t, "t"), state_of(state), digits, rounding)
    if not budget:
        return asked
    from driftproof.reports.rounding import budget_answer

    return replace(asked, budget=budget_answer(asked, digits, rounding, count_steps))
