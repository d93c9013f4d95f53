"""Write certified answers about steps and runs as text, and as JSON with numbers as strings."""

from __future__ import annotations

from typing import Any

from driftproof.numeric.steppers import evaluations_per_step
from driftproof.support.plain_text import Json, table
from driftproof.symbolic.algebra.certified import HALF_EVEN, CertifiableReal, significant
from driftproof.symbolic.algebra.rational_functions import exact_text
from driftproof.symbolic.runs import OscillatorRun, TrigonometricNumber
from driftproof.texts.writing.markup import LONGEST_IN_TEXT

# The entries of an answer that are shown as text, in this order.
_SHOWN = ["final_state", "exact_state", "state_error", "energy", "energy_change", "phase_error", "steps", "evaluations"]


def exact_and_decimal(
    value: CertifiableReal | None, digits: int, rounding: str = HALF_EVEN, unit: str | None = None
) -> Json | None:
    """{"exact": "337/384" or None, "decimal": correctly rounded, "unit": ... if given}; None for an undefined value."""
    if value is None:
        return None
    trigonometric = isinstance(value, TrigonometricNumber)
    exact = str(value) if trigonometric else None if callable(value) else exact_text(value)
    answer: Json = {"exact": exact, "decimal": significant(value, digits, rounding)}
    return answer if unit is None else {**answer, "unit": unit}


def step_answer(run: OscillatorRun, digits: int, rounding: str) -> Json:
    """The answer about a step: the state, its energy and the energy change, exact and in decimals."""
    return {
        "method": run.method.key,
        "title": run.method.title,
        "h": str(run.h),
        "start": [str(x) for x in run.start],
        "digits": digits,
        "rounding": rounding,
        "final_state": _pair(run.final_state, digits, rounding),
        "energy": exact_and_decimal(run.energy, digits, rounding),
        "energy_change": exact_and_decimal(run.energy_change, digits, rounding),
    }


def run_answer(run: OscillatorRun, digits: int, rounding: str) -> Json:
    """The answer about a run of N = t/h steps: that of `step_answer`, exact state, errors, steps and evaluations.

    Evaluations are left out for an implicit method, as they depend on how its equations are solved.
    """
    counted = {"evaluations": run.steps * evaluations_per_step(run.method)} if run.method.explicit else {}
    return {
        **step_answer(run, digits, rounding),
        "t": str(run.t),
        "exact_state": _pair(run.exact_state, digits, rounding),
        "state_error": exact_and_decimal(run.state_error, digits, rounding),
        "phase_error": exact_and_decimal(run.phase_error, digits, rounding, unit="degrees"),
        "steps": run.steps,
        **counted,
    }


def _pair(state: tuple[CertifiableReal, CertifiableReal], digits: int, rounding: str) -> Json:
    return {name: exact_and_decimal(x, digits, rounding) for name, x in zip("qv", state, strict=True)}


def answer_text(answer: Json) -> str:
    """The answer of `driftproof step` or `driftproof run` as a table with a title."""
    start = ", ".join(answer["start"])
    steps = f"{answer['steps']} steps" if "steps" in answer else "one step"
    until = f" to t = {answer['t']}" if "t" in answer else ""
    title = f"{answer['title']} ({answer['method']}): {steps} of h = {answer['h']} from ({start}){until}"
    rows = [row for name in _SHOWN if name in answer for row in _rows(name, answer[name])]
    return f"{title}\n\n{table(rows)}\n\n{answer['digits']} digits, rounded {answer['rounding']}, certified"


def _rows(name: str, value: Any) -> list[list[str]]:
    label = name.replace("_", " ")
    if value is None:
        return [[label, "undefined at the origin", ""]]
    if isinstance(value, int):
        return [[label, str(value), ""]]
    if "decimal" not in value:
        return [row for component, part in value.items() for row in _rows(f"{label} {component}", part)]
    unit = f" {value['unit']}" if "unit" in value else ""
    exact = value["exact"] or ""
    short = f"exactly {exact}" if exact and exact != value["decimal"] and len(exact) <= LONGEST_IN_TEXT else ""
    return [[label, value["decimal"] + unit, short]]
