"""Answers about rounding: the bound derived from a step's own program, and the error budget of one float run."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.rationals import ExactNumber, steps_of
from driftproof.methods.programs.stepping import oscillator
from driftproof.methods.schemes import Method
from driftproof.numeric.steppers import float_stepper, hand_written
from driftproof.support.plain_text import Json, table, unknown
from driftproof.support.results import Answered
from driftproof.symbolic.algebra.certified import AWAY, CertifiableReal, enclose
from driftproof.symbolic.error_budget import ErrorOfRun
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.rounding.fixed_step_bound import fixed_step_bound
from driftproof.symbolic.rounding.formats import BINARY64, FORMATS, FloatFormat
from driftproof.symbolic.rounding.n_steps_bound import HypothesisFails, largest_safe_state, run_bound, safe_state_text
from driftproof.symbolic.rounding.step_bound import StepBound, step_bound, step_with_stored_coefficients
from driftproof.symbolic.rounding.text import first_order_text, format_text, full_text
from driftproof.symbolic.runs import OscillatorRun, exact_matrix_at
from driftproof.texts.writing.answers import exact_and_decimal

if TYPE_CHECKING:
    from driftproof.numeric.run import Counter

_DECIMAL = re.compile(r"\d\.\d")
# Bounds are quoted, not compared: few digits say enough.
BOUND_DIGITS = 6
# The keys of what is measured in a float run; their values are null if it overflows.
MEASURED = ("final_state", "state_error", "truncation", "rounding", "rounding_in_u", "bound")
# The labels of the rows of a table; `as_held` is there only for a program that rounds coefficients.
ROWS = {"plain": "plain", "sharp": "sharp", "as_held": "as held"}


def roundoff(
    method: str | Path | Method, h: ExactNumber | Sequence[ExactNumber] = (), *, float: str = BINARY64.name
) -> Answered:
    """The rounding bound of one step of a method, derived by running it: as formulas, and at each step size of `h`.

    For binary64 it is about the program that float runs use, hand-written if there is one; for other formats about the
    generic step, with its coefficients rounded to the format. All bounds are about the definition's exact M(h), so that
    they include the rounding of the coefficients. Only `as_held` is about the polynomial with the coefficients that the
    program holds; the row is left out if the program holds all of them exactly. Raises ValueError.

    >>> from driftproof import roundoff
    >>> roundoff("symplectic_euler", "1/4").found.format.name
    'binary64'
    """
    if float not in FORMATS:
        raise ValueError(unknown("number format", float, FORMATS))
    method, fmt, steps = method_of(method), FORMATS[float], steps_of(h)
    subject = (hand_written(method) if fmt == BINARY64 else None) or method
    bound = step_bound(subject, fmt)
    answer = {
        "method": method.key,
        "title": method.title,
        "program": "generic" if subject is method else "hand-written",
        "format": format_text(bound),
        "first_order": first_order_text(bound),
        "full": full_text(bound),
        "rounds_coefficients": bound.rounds_constants,
        "differences_from_definition": bound.differences(oscillator_matrix(method)),
        "at": [_at(method, subject, bound, fmt.nearest(size)) for size in steps],
    }
    return Answered(answer, roundoff_text, bound)


def _at(method: Method, subject: Any, bound: StepBound, h: Fraction) -> Json:
    bounds = {"plain": bound.at(h), "sharp": fixed_step_bound(subject, h, bound.format).linear}
    if bound.rounds_constants:
        held = step_with_stored_coefficients(method, bound.format)
        bounds["as_held"] = fixed_step_bound(held, h, bound.format).linear
    rows = {name: [_in_units(x, bound.format) for row in linear.error for x in row] for name, linear in bounds.items()}
    safe = safe_state_text(largest_safe_state(subject, h, bound.format))
    return {"h": str(h), **rows, "per_step": _per_step(subject, h, bound.format), "safe_state": safe}


def _in_units(bound: Fraction, fmt: FloatFormat) -> Json | None:
    return exact_and_decimal(bound / fmt.u, BOUND_DIGITS, AWAY, unit="u")


def _per_step(subject: Any, h: Fraction, fmt: FloatFormat) -> Json:
    """C(h), the growth of the error per step in the step's own norm, from which the theorem on N steps starts."""
    try:
        theorem = run_bound(subject, h, 1, (Fraction(1), Fraction(0)), fmt)
    except HypothesisFails as reason:
        return {"c": None, "reason": str(reason)}
    norm = theorem.norm
    return {
        "c": _in_units(theorem.growth, fmt),
        "norm": {"q2": str(norm.qq), "qv": str(norm.qv), "v2": str(norm.vv)},
        "rho_squared": str(norm.rho_squared),
    }


def budget_answer(asked: OscillatorRun, digits: int, rounding: str, counter: Counter) -> Json:
    """The error of one binary64 run, split into truncation and rounding, each certified, and the theorem's bound.

    The run uses the double nearest to h, and its state is compared at N times that double, so that the error is that of
    the numbers which the program really has. A run that overflows has no such error, only a "reason".
    """
    from driftproof.numeric.run import NonFiniteState, integrate, nearest_double, require_float_steps  # loads NumPy

    method, h, start, steps = asked.method, asked.h, asked.start, asked.steps
    require_float_steps(steps)
    size, *state = (nearest_double(x, name) for x, name in ((h, "h"), (start[0], "q"), (start[1], "v")))
    exact_h, exact_start = Fraction(size), (Fraction(state[0]), Fraction(state[1]))
    h_run = str(exact_h) if exact_h == h else f"{size!r} (the double nearest to {h})"
    try:
        final = integrate(float_stepper(method), oscillator, (state[0], state[1]), size, steps, counter=counter)
    except NonFiniteState as overflow:
        return {"h_run": h_run, **dict.fromkeys(MEASURED), "reason": str(overflow)}
    reached = (Fraction(final[0]), Fraction(final[1]))
    error = ErrorOfRun(exact_matrix_at(method, exact_h), exact_h, steps, exact_start, reached)
    off, u = error.rounding, BINARY64.u
    in_u: CertifiableReal = off / u if isinstance(off, Fraction) else lambda: enclose(off) / enclose(u)
    return {
        "h_run": h_run,
        "final_state": [repr(x) for x in final],
        "state_error": exact_and_decimal(error.total, digits, rounding),
        "truncation": exact_and_decimal(error.truncation, digits, rounding),
        "rounding": exact_and_decimal(off, digits, rounding),
        "rounding_in_u": exact_and_decimal(in_u, BOUND_DIGITS, unit="u"),
        "bound": _theorem(method, exact_h, steps, exact_start),
    }


def _theorem(method: Method, h: Fraction, steps: int, start: tuple[Fraction, Fraction]) -> Json:
    try:
        bound = run_bound(hand_written(method) or method, h, steps, start).euclidean
    except HypothesisFails as reason:
        return {"value": None, "reason": str(reason)}
    return {"value": exact_and_decimal(bound, BOUND_DIGITS, AWAY), "in_u": _in_units(bound, BINARY64)}


def roundoff_text(answer: Json) -> str:
    """The answer of `driftproof roundoff`: formulas first, then the numbers at each h asked for."""
    parts = [
        f"{answer['title']} ({answer['method']}), {answer['program']} step, {answer['format']}",
        "To first order in u, for h >= 0:\n" + "\n".join(f"  {line}" for line in answer["first_order"]),
        "In full, |dz| <= E(h)|z| + r(h):\n" + "\n".join(f"  {line}" for line in answer["full"]),
        _about(answer),
    ]
    if any(_DECIMAL.search(line) for line in (*answer["first_order"], *answer["full"])):
        parts.append("Decimals in the formulas replace long fractions and are rounded up.")
    return "\n\n".join([*parts, *(_at_text(at) for at in answer["at"])])


def _about(answer: Json) -> str:
    """What the bounds are about: the definition's polynomial, or another one that the program evaluates."""
    if different := answer["differences_from_definition"]:
        return "\n".join(["The program differs from the definition of the method:", *different])
    if not answer["rounds_coefficients"]:
        return "The program evaluates the polynomial of the definition."
    return (
        "The program evaluates the definition with rounded coefficients. All bounds are relative to the\n"
        'definition; only those of "as held" are relative to the polynomial with the rounded coefficients.'
    )


def _at_text(at: Json) -> str:
    rows = [["", "|dq| per |q|", "|dq| per |v|", "|dv| per |q|", "|dv| per |v|"]]
    rows += [[label, *(_with_unit(x) for x in at[name])] for name, label in ROWS.items() if name in at]
    step = at["per_step"]
    growth = f"c(h) = {_with_unit(step['c'])}" if step["c"] else f"no c(h): {step['reason']}"
    safe = f"for |q|, |v| <= {at['safe_state']}: no operation of the step overflows"
    return f"At h = {at['h']}, {growth}\n{safe}\n{table(rows, right=(1, 2, 3, 4))}"


def budget_text(budget: Json) -> str:
    """The error budget of `driftproof run --budget`, under the certified answers."""
    title = f"Error budget of the binary64 run with h = {budget['h_run']}"
    if "reason" in budget:
        return f"{title}: none, {budget['reason']}"
    bound = budget["bound"]
    proved = _with_unit(bound["in_u"]) if bound["value"] else f"none: {bound['reason']}"
    rows = [
        ["float final state", ", ".join(budget["final_state"]), ""],
        ["state error", budget["state_error"]["decimal"], "at most the sum of the next two"],
        ["= truncation", budget["truncation"]["decimal"], "the error of the method in exact arithmetic"],
        ["+ rounding", budget["rounding"]["decimal"], f"= {_with_unit(budget['rounding_in_u'])}"],
        ["proved bound", bound["value"]["decimal"] if bound["value"] else "", f"on the rounding: {proved}"],
    ]
    return f"{title}\n\n{table(rows)}"


def _with_unit(x: Json) -> str:
    return f"{x['decimal']} {x['unit']}"
