"""Stability of methods on a problem: what is proved where it is linear, what float runs show, and where they end."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from driftproof.answers import number
from driftproof.facts import method_of
from driftproof.text import table
from methods.rationals import step_count
from methods.schemes import Method, MethodError
from numeric.advance import Advance, advance, float_start
from numeric.clock import clock
from numeric.problems.problem import Problem
from numeric.stability import Observed, fewest_steps, largest_bounded, observe, size, stays_bounded
from numeric.work_precision.exact import distance
from symbolic.certified import HALF_EVEN
from symbolic.facts import facts_of
from symbolic.linear.conjugate_pairs import UndecidedLimitError
from symbolic.linear.oscillator import stability_function_of
from symbolic.linear.systems import SYSTEM_FACTS, SystemFacts
from symbolic.linear.verdicts import bounded_at, factor_at, largest_eigenvalue

Json: TypeAlias = Any
# Goes over the methods, with a progress bar perhaps.
Walk: TypeAlias = Callable[[Sequence[str]], Iterable[str]]

DIGITS = 6
# Steps of the runs that are looked for, and of those that are shown: implicit steps take a thousand times as long.
MOST_EXPLICIT, MOST_IMPLICIT, MOST_SHOWN = 1 << 14, 1 << 9, 10**6
# Steps of the runs that are shown where no h is asked for.
SHOWN = (10, 100, 1000)
# A run that has grown so many times beyond the solution is not run to its end where only its verdict is asked for.
LOST = 1e6


def stability_answer(problem: Problem, names: Sequence[str], sizes: Sequence[Fraction], walk: Walk = iter) -> Json:
    """{"problem", "title", "linear", "methods": [...]}, one entry a method; numbers are strings.

    `sizes` are step sizes that divide t; without them runs of SHOWN steps are shown. On a linear problem, per method:
    `limit`, `attained`, `at_infinity` as proved, `seen`, the neighbouring doubles between which powers of the float
    step begin to grow. On any other, `fewest_steps` that end within the size of the solution. Raises ValueError.
    """
    counts = [step_count(problem.t, h) for h in sizes] or list(SHOWN)
    if max(counts) > MOST_SHOWN:
        raise ValueError(f"{max(counts)} steps to t = {problem.t}; at most {MOST_SHOWN} are run here")
    return {
        "problem": problem.key,
        "title": problem.title,
        "linear": problem.matrix is not None,
        "methods": [_method_answer(problem, method_of(name), counts) for name in walk(names)],
    }


def _method_answer(problem: Problem, method: Method, counts: Sequence[int]) -> Json:
    """One method, or the reason why it does not apply."""
    header = {"method": method.key, "title": method.title}
    try:
        runs = advance(method, problem)
    except MethodError as reason:
        return {**header, "refused": str(reason)}
    found = None if problem.matrix is None else SystemFacts(method, problem.matrix)
    return {
        **header,
        "expected": problem.expected.get(behaviour(method, problem), ""),
        **(_nonlinear_part(problem, method, runs) if found is None else _linear_part(problem, found, runs)),
        "runs": [_run_answer(problem, runs, found, steps) for steps in counts],
    }


def behaviour(method: Method, problem: Problem) -> str:
    """The name under which `Problem.expected` speaks of the method: the most telling that it has."""
    facts = facts_of(method, ["symplectic", "l_stable", "a_stable"])
    known = [name for name in ("symplectic", "l_stable", "a_stable") if facts[name]]
    if not problem.second_order and "symplectic" in known:
        known.remove("symplectic")
    return next((name for name in known if name in problem.expected), "explicit" if method.explicit else "implicit")


def _linear_part(problem: Problem, found: SystemFacts, runs: Advance) -> Json:
    components = len(problem.start)
    norm = max(sum(abs(x) for x in row) for row in found.rows)
    low, high = largest_bounded(lambda h: stays_bounded(runs, components, h), 1 / float(norm))
    r = stability_function_of(found.method)
    at_infinity = None if r is None else r.at_infinity()
    return {
        "limit": SYSTEM_FACTS["step_limit"](found),
        "attained": SYSTEM_FACTS["step_limit_attained"](found),
        "at_infinity": None if r is None else "oo" if at_infinity is None else str(at_infinity),
        "seen": {"bounded": repr(low), "grows": repr(high)},
    }


def _nonlinear_part(problem: Problem, method: Method, runs: Advance) -> Json:
    start, extent = float_start(problem), solution_size(problem)

    def follows(steps: int) -> bool:
        seen = observe(runs, start, clock(problem.t, steps).h, steps, LOST * extent)
        return seen.failed_after is None and seen.largest <= LOST * extent and error_of(problem, seen) <= extent

    most = MOST_EXPLICIT if method.explicit else MOST_IMPLICIT
    return {"fewest_steps": fewest_steps(follows, most), "looked_up_to": most}


def _run_answer(problem: Problem, runs: Advance, found: SystemFacts | None, steps: int) -> Json:
    h = clock(problem.t, steps).h
    seen = observe(runs, float_start(problem), h, steps)
    ended = seen.failed_after is None
    return {
        "h": repr(h),
        "steps": steps,
        "failed_after": seen.failed_after,
        "remark": seen.remark,
        "largest": repr(seen.largest),
        "error": repr(error_of(problem, seen)) if ended else None,
        "follows": ended and error_of(problem, seen) <= solution_size(problem),
        **({} if found is None else _proved_at(found, Fraction(h))),
    }


def _proved_at(found: SystemFacts, h: Fraction) -> Json:
    """Boundedness at exactly the h that is run, and the factor per step of the eigenvalue that is largest in size."""
    try:
        bounded: bool | str = bounded_at(found, h)
    except UndecidedLimitError as reason:
        bounded = str(reason)
    return {
        "bounded": bounded,
        "factor": number(factor_at(found, largest_eigenvalue(found.rows), h), DIGITS, HALF_EVEN),
    }


def error_of(problem: Problem, seen: Observed) -> float:
    """The Euclidean distance of the last state from the reference at t."""
    return distance(seen.state, problem.reference.states[-1])


def solution_size(problem: Problem) -> float:
    """The largest size of the start and of the reference's states: an error as large says that nothing is right."""
    origin = (0.0,) * len(problem.start)
    return max(size(float_start(problem)), *(distance(origin, state) for state in problem.reference.states))


def stability_text(answer: Json) -> str:
    """The answer as tables: how far steps stay stable, then each run, then what is expected."""
    applying = [entry for entry in answer["methods"] if "refused" not in entry]
    parts = [answer["title"]]
    if applying:
        parts += [_limits_text(answer, applying), _runs_text(answer, applying), _expected_text(applying)]
    parts += [
        f"{entry['method']} does not apply: {entry['refused']}" for entry in answer["methods"] if "refused" in entry
    ]
    return "\n\n".join(part for part in parts if part)


def _limits_text(answer: Json, entries: Sequence[Json]) -> str:
    if not answer["linear"]:
        rows = [["method", "fewest steps that follow the solution"]]
        for entry in entries:
            none = f"none up to {entry['looked_up_to']}"
            rows.append([entry["method"], str(entry["fewest_steps"] or none)])
        return "Observed: the error at the end is below the size of the solution\n\n" + table(rows)
    rows = [["method", "proved: bounded for", "seen over 2^40 steps", "R(oo)"]]
    for entry in entries:
        rows.append([entry["method"], _limit_text(entry), _seen_text(entry["seen"]), entry["at_infinity"] or "none"])
    return "The steps h whose powers stay bounded\n\n" + table(rows)


def _limit_text(entry: Json) -> str:
    limit = entry["limit"]
    if limit in ("0", "oo"):
        return {"0": "no h > 0", "oo": "every h > 0"}[limit]
    if "refused" in limit:
        return f"not decided: {limit['refused']}"
    exact = limit["exact"] if limit["exact"] and len(limit["exact"]) <= 24 else None
    decimal = limit["decimal"].rstrip("0").rstrip(".") if "." in limit["decimal"] else limit["decimal"]
    shown = decimal if len(decimal) <= 12 else f"{decimal[:12]}..."
    return f"h {'<=' if entry['attained'] else '<'} {shown if exact in (None, decimal) else f'{exact} = {shown}'}"


def _seen_text(seen: Json) -> str:
    low, high = float(seen["bounded"]), float(seen["grows"])
    if high == float("inf"):
        return f"up to {low:.4g}, the largest tried"
    return f"up to {low:.10g}" if low else f"growth at {high:.4g}, the smallest tried"


def _runs_text(answer: Json, entries: Sequence[Json]) -> str:
    head = ["method", "h", "steps", *(["bounded?", "factor"] if answer["linear"] else []), "the run to t"]
    rows = [head]
    for entry in entries:
        for run in entry["runs"]:
            proved = [_verdict(run["bounded"]), run["factor"]["decimal"]] if answer["linear"] else []
            rows.append([entry["method"], f"{float(run['h']):.6g}", str(run["steps"]), *proved, _outcome(run)])
    note = "\n\nbounded?: proved, at exactly the h that is run; factor: of the eigenvalue largest in size, a step"
    return table(rows, right=(2,)) + (note if answer["linear"] else "")


def _verdict(bounded: bool | str) -> str:
    return {True: "yes", False: "no"}[bounded] if isinstance(bounded, bool) else "not decided"


def _outcome(run: Json) -> str:
    if run["failed_after"] is not None:
        return f"ends at step {run['failed_after']}: {run['remark']}"
    error = f"error {float(run['error']):.2e}"
    return error if run["follows"] else f"{error}, more than the solution: lost"


def _expected_text(entries: Sequence[Json]) -> str:
    told: dict[str, list[str]] = {}
    for entry in entries:
        if entry["expected"]:
            told.setdefault(entry["expected"], []).append(entry["method"])
    lines = [f"{', '.join(methods)}: {sentence}" for sentence, methods in told.items()]
    return "Expected\n\n" + "\n".join(lines) if lines else ""


def problems_text(problems: Iterable[Problem]) -> str:
    """The problems: key, whether linear, stiff or of second order, title."""
    rows = [["problem", "kind", "title"]]
    for problem in problems:
        kinds = {"linear": problem.matrix is not None, "stiff": problem.stiff, "q'' = F(q)": problem.second_order}
        rows.append([problem.key, ", ".join(kind for kind, holds in kinds.items() if holds), problem.title])
    return table(rows)
