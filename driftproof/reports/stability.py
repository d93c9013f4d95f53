"""Stability of methods on a problem: what is proved if it is linear, what float runs show, and where they end."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import ceil, frexp, inf, isfinite
from time import perf_counter
from typing import TypeVar

import numpy as np
from flint import ctx

from driftproof.enclosure.problem_tables import GivenParameters, steps_to
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import Entry, of_one_state
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.given_methods import GivenMethods, methods_of
from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.numbers.rationals import ExactNumber, brief, step_count
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import Method, MethodError
from driftproof.numeric.advance import Advance, advance, float_start, float_step, rests_at_origin
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import (
    FOLLOWS,
    branch_remark,
    distance_from_digits,
    largest_state_size,
    told_apart,
)
from driftproof.numeric.stability import (
    LARGEST,
    Observed,
    bounded_again,
    fastest_decay,
    fewest_steps,
    in_balanced_units,
    largest_bounded,
    observe,
    stays_bounded,
)
from driftproof.numeric.steps.multistep import MultistepRun
from driftproof.numeric.sweep import digest
from driftproof.numeric.work_precision.curves import MOST, MOST_FOR_GOAL
from driftproof.numeric.work_precision.integrators import has_numba
from driftproof.reports import user_problem
from driftproof.reports.progress import with_progress
from driftproof.reports.stability_tables import DIGITS, STABLE_FROM, limit_text, problems_text, stability_text
from driftproof.reports.user_problem import MOST_PROVED, GivenProblem, kinks_of, problem_given, program
from driftproof.support import kept
from driftproof.support.plain_text import Json, counted
from driftproof.support.progress import stage
from driftproof.support.results import Answered
from driftproof.symbolic.algebra.certified import (
    HALF_EVEN,
    CertifiableReal,
    EnclosedReal,
    Uncertified,
    enclose,
    significant,
)
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.claimed_orders import false_claims
from driftproof.symbolic.facts import Facts
from driftproof.symbolic.linear.eigenvalues import Eigenvalue, eigenvalues
from driftproof.symbolic.linear.multistep import MultistepFacts
from driftproof.symbolic.linear.multistep_systems import MultistepSystemFacts
from driftproof.symbolic.linear.ray_bounds import UndecidedLimitError
from driftproof.symbolic.linear.stability_limits import Infinity
from driftproof.symbolic.linear.systems import LinearSystem, SystemFacts, ball_of, limit_of, of_largest_modulus
from driftproof.texts.writing.answers import exact_and_decimal
from driftproof.texts.writing.records import record

_Rounded = TypeVar("_Rounded")
# One of each behaviour, and the lesson's three among them.
STABILITY_METHODS = ("forward_euler", "rk4", "symplectic_euler", "backward_euler", "implicit_midpoint", "radau_iia2")
# The most steps of a run in the search for the fewest, of an explicit and of an implicit method, whose steps take a
# thousand times as long; of compiled runs, which go on where the last two of those do not both follow; and of a run
# that is shown. Chosen: a second or so each, and ten to compile an implicit method.
_MOST_EXPLICIT, _MOST_IMPLICIT, _MOST_SHOWN = 1 << 14, 1 << 9, 10**6
_MOST_COMPILED = {True: MOST, False: MOST_FOR_GOAL}
# The numbers of steps that are shown if no h is given.
_SHOWN = (10, 100, 1000)
# Far more than the 53 bits of h: a factor whose ball contains 1 even with these is printed as 1.
_ONE_BITS = 1024
# In the search for the fewest steps a run is stopped once it is this many times as large as the solution.
_LOST = 1e6


def stability(
    problem: GivenProblem | None = None,
    methods: GivenMethods = (),
    h: ExactNumber | Sequence[ExactNumber] = (),
    *,
    parameters: GivenParameters = (),
) -> Answered:
    """Which steps methods can take on a problem, where their runs end, and what is expected; without one, the problems.

    A problem is a key, a .toml file, or a dict with the contents of one, whose function may be a Python function;
    `parameters` replace some of its own.

    The data are {"problem", "title", "linear", "size", "methods": [...]}, with one entry per method. `h` are step sizes
    that divide t; without them runs of 10, 100 and 1000 steps are shown. For a linear problem `limit`, `attained` and
    `at_infinity` are proved, and powers of the float step begin to grow between the neighbouring doubles `seen`; for
    others, runs of `fewest_steps` and more follow the solution to its end. Raises ValueError.

    >>> from driftproof import stability
    >>> stability("dahlquist_1e3", ["rk4"])["methods"][0]["limit"]["decimal"]
    '0.002785293563405281623529759189769'
    """
    if problem is None:
        return Answered(problems_json(PROBLEMS.values()), problems_text)
    about = problem_given(problem, parameters)
    counts = [step_count(about.t, size) for size in steps_to(about.t, h)] or list(_SHOWN)
    if max(counts) > _MOST_SHOWN:
        raise ValueError(f"{brief(max(counts))} steps to t = {about.t} are too many; at most {_MOST_SHOWN} are run")
    asked = methods_of(methods or STABILITY_METHODS)
    largest = () if about.matrix is None else of_largest_modulus(eigenvalues(about.matrix))
    answer = {
        "problem": about.key,
        "title": about.title,
        "linear": about.matrix is not None,
        "size": repr(largest_state_size(about)),
        **({"stiffest": ", ".join(map(eigenvalue_text, largest))} if largest else {}),
        **({"proofs": proofs} if (proofs := of_proofs(about)) else {}),
        **({} if about.field.smooth else {"kinks": kinks_of(about)}),
        "methods": [_in_its_stage(about, each, counts) for each in with_progress(asked, "method")],
    }
    return Answered(answer, stability_text)


def of_proofs(problem: Problem) -> str:
    """What must be said of proofs on a linear problem: of which numbers they are, or why there are none; else ""."""
    constants = [f"{name} = {float(x)!r}" for name, x in problem.field.parameters if not isinstance(x, Fraction)]
    if problem.matrix is not None:
        said = ["of the difference of two solutions, from whose slopes b(t) drops out"]
        said = said * (not problem.field.autonomous)
        said += [f"with {', '.join(constants)}, the double of the runs"] if constants else []
        return f"Proved {'; '.join(said)}" if said else ""
    wanted = f"solutions that do not grow, at most {MOST_PROVED} components, slopes of + - * / of numbers and pi"
    linear = problem.field.linear and any(problem.field.dependence())
    return f"Linear, but nothing is proved: that takes {wanted}" if linear else ""


def _in_its_stage(problem: Problem, method: Entry, counts: Sequence[int]) -> Json:
    with stage(f"{method.key} on {problem.key}"):
        return _method_answer(problem, method, counts)


def _method_answer(problem: Problem, method: Entry, counts: Sequence[int]) -> Json:
    header = {"method": method.key, "title": method.title}
    try:
        runs = advance(method, problem)
    except MethodError as reason:
        return {**header, "refused": str(reason)}
    found = None if problem.matrix is None else _system_facts(method, problem.matrix)
    return {
        **header,
        **({"started": runs.start_method.key} if isinstance(runs, MultistepRun) else {}),
        **({"claims": list(map(str, missed))} if (missed := false_claims(method)) else {}),
        "expected": expected_of(problem, method),
        **(_nonlinear_answer(problem, method, runs) if found is None else _linear_part(problem, method, found)),
        "runs": [_run_answer(problem, method, found, steps) for steps in counts],
    }


def expected_of(problem: Problem, method: Entry) -> str:
    """What the problem says is expected of methods of this kind; "" if nothing."""
    if isinstance(method, Multistep) and not MultistepFacts(method).zero_stable:
        return "is not zero-stable: errors of its runs grow without bound as h tends to 0"
    return "" if isinstance(method, Additive) else problem.expected.get(behaviour(method, problem), "")


def steps_in_words(problem: Problem, method: Entry) -> str:
    """The steps that the method can take: proved on a linear problem, else how many follow the solution to its end."""
    try:
        runs = advance(method, problem)
    except MethodError as reason:
        return f"does not apply: {reason}"
    if problem.matrix is not None:
        return limit_text(_proved_limit(_system_facts(method, problem.matrix)))
    found = _nonlinear_answer(problem, method, runs)
    fewest, most = found["fewest_steps"], found["looked_up_to"]
    stable = f"{STABLE_FROM} {found['decay']['stable_from']} on" if "decay" in found else ""
    return f"not with {most} steps{stable}" if fewest is None else f"from {counted(fewest, 'step')} on{stable}"


def _system_facts(method: Entry, rows: Sequence[Sequence[Fraction]]) -> LinearSystem:
    if isinstance(method, Multistep):
        return MultistepSystemFacts(method, rows)
    return SystemFacts(_on_linear_problems(method), rows)


def _on_linear_problems(method: Entry) -> Method:
    return method.linear_twin() if isinstance(method, Rosenbrock) else of_one_state(method)


def _proved_limit(found: LinearSystem) -> Json:
    limit, attained = limit_of(found)
    return {"limit": record(limit), "attained": attained}


def behaviour(method: Entry, problem: Problem) -> str:
    """The key of `Problem.expected` for the method: its strongest proved property there, else explicit or implicit."""
    if isinstance(method, Multistep):
        facts = MultistepFacts(method)
        damps = bool(facts.a_stable) and not any(method.sigma[:-1])
        known = {"l_stable": damps, "a_stable": facts.a_stable}
    else:
        found = Facts(_on_linear_problems(method))
        known = {name: getattr(found, name) for name in ("symplectic", "l_stable", "a_stable")}
    names = (name for name, holds in known.items() if holds and name in problem.expected)
    return next(names, "explicit" if method.explicit else "implicit")


def _linear_part(problem: Problem, method: Entry, found: LinearSystem) -> Json:
    runs = advance(method, problem if rests_at_origin(problem) else replace(problem, field=_linear(found.rows)))
    norm = float(np.abs(in_balanced_units(np.array(found.rows, dtype=float))).sum(axis=1).max()) or 1.0
    limit, step, components = _proved_limit(found), runs, len(problem.start)
    if isinstance(runs, MultistepRun):
        step, components = runs.of_all, components * runs.method.steps
    is_bounded = lambda h: stays_bounded(step, components, h)
    proved = limit["limit"]["decimal"] if isinstance(limit["limit"], dict) and "decimal" in limit["limit"] else 0
    most = max(LARGEST, frexp(float(problem.t) * norm)[1])  # up to a step that is as long as the problem
    low, high = largest_bounded(is_bounded, 1 / norm, float(proved), most)
    again = bounded_again(is_bounded, high, 2**most / norm) if isfinite(high) else ()
    return {
        **limit,
        "at_infinity": _at_infinity_text(found.at_infinity()),
        "seen": {"bounded": repr(low), "grows": repr(high), **({"again": list(map(repr, again))} if again else {})},
    }


def _at_infinity_text(size: Exact | Infinity | EnclosedReal | None) -> str | None:
    if isinstance(size, Infinity):
        return "oo"
    if isinstance(size, EnclosedReal):
        return significant(size, DIGITS)
    return None if size is None else str(size)


def _linear(rows: Sequence[Sequence[Fraction]]) -> VectorField:
    """The field Ay, in which a velocity that is a rate stands alone."""
    terms = ([(x, f"y{j}") for j, x in enumerate(row) if x] for row in rows)
    return VectorField(tuple(" + ".join(y if x == 1 else f"({x}) * {y}" for x, y in each) or "0" for each in terms))


def _nonlinear_part(problem: Problem, method: Entry, runs: Advance) -> Json:
    """The fewest steps that follow the solution; in this user's cache, if the search was long."""
    start, extent = float_start(problem), largest_state_size(problem)
    least = runs.method.steps if isinstance(runs, MultistepRun) else 1  # fewer are those of the start

    @cache
    def follows(steps: int) -> bool:
        if steps < least:
            return False
        seen = observe(runs, start, float_step(problem.t, steps), steps, _LOST * extent)
        return seen.failed_after is None and error_of(problem, seen) <= FOLLOWS * extent

    about = {"problem": digest(problem), "method": digest(method), "numba": str(has_numba()), "program": program()}
    if (held := kept.cached(about)) is not None:
        return {name: held[name] for name in ("fewest_steps", "looked_up_to")}
    began, most = perf_counter(), _MOST_EXPLICIT if method.explicit else _MOST_IMPLICIT
    if has_numba() and not (follows(most // 2) and follows(most)):  # one alone may be luck
        runs, longest = advance(method, problem, compiled=True), _MOST_COMPILED[method.explicit]
        while most < longest and not (follows(most // 2) and follows(most)):
            most *= 2
    found = {"fewest_steps": fewest_steps(follows, most), "looked_up_to": most}
    if perf_counter() - began > user_problem.LONG:
        kept.cache(about, found)
    return found


def _nonlinear_answer(problem: Problem, method: Entry, runs: Advance) -> Json:
    """`_nonlinear_part`, and from how many steps on the fastest decay along the solution is stable, if that is more.

    It is more than the fewest that follow or, if none does, than were tried.
    """
    found, (decay, at) = _nonlinear_part(problem, method, runs), fastest_decay(problem)
    stable = steps_for_decay(method, problem.t, decay)
    if stable <= (found["fewest_steps"] or found["looked_up_to"]):
        return found
    return found | {"decay": {"rate": repr(decay), "t": repr(at), "stable_from": stable}}


def steps_for_decay(method: Entry, t: Fraction, decay: float) -> int:
    """The number of steps to t from which on y' = -decay y is stable; 0 if every h is, or no small one."""
    facts = MultistepFacts(method) if isinstance(method, Multistep) else Facts(_on_linear_problems(method))
    limit = facts.real_limit
    return ceil(float(t) * decay / float(limit)) if isinstance(limit, RealRoot) and limit != ZERO_ROOT else 0


def _run_answer(problem: Problem, method: Entry, found: LinearSystem | None, steps: int) -> Json:
    h = float_step(problem.t, steps)
    runs = advance(method, problem)
    seen = observe(runs, float_start(problem), h, steps)
    error = error_of(problem, seen) if seen.failed_after is None else inf
    branch = branch_remark(problem, runs, error)
    return {
        "h": repr(h),
        "steps": steps,
        "failed_after": seen.failed_after,
        "remark": seen.remark,
        "largest": repr(seen.largest),
        "error": repr(error) if isfinite(error) else None,
        **({"below": below} if (below := told_apart(error, problem.reference.states[-1])) else {}),
        "lost": error > largest_state_size(problem),
        **({"another_branch": branch} if branch else {}),
        **({"only": runs.start_method.key} if isinstance(runs, MultistepRun) and steps < runs.method.steps else {}),
        **({} if found is None else _proved_at(found, Fraction(h))),
    }


def _proved_at(found: LinearSystem, h: Fraction) -> Json:
    """Boundedness at exactly the h that is run, and the factor per step of the eigenvalue that is largest in size."""
    try:
        bounded: bool | str = found.bounded_at(h)
    except UndecidedLimitError as reason:
        bounded = str(reason)
    try:
        factor = found.stiffest_factor(h)
        answer = {"bounded": bounded, **_factor(factor)}
        if bounded is False and not enclose(factor) > 1:  # it is another one that grows
            factors = [(float(enclose(found.factor_at(e, h))), e) for e, _ in found.bounds]
            largest, other = max(factors, key=lambda each: each[0])
            if largest >= 1:
                answer["grows"] = {"eigenvalue": eigenvalue_text(other), **_factor(found.factor_at(other, h))}
        return answer
    except ArithmeticError as reason:  # Uncertified, or a pole
        return {"bounded": bounded, "factor": {"refused": str(reason)}, "factor_less_one": None}


def _factor(factor: CertifiableReal) -> Json:
    shown = _with_a_digit_more(lambda digits: exact_and_decimal(factor, digits, HALF_EVEN), DIGITS)
    return {"factor": shown, "factor_less_one": _minus_one(factor)}


def eigenvalue_text(eigenvalue: Eigenvalue) -> str:
    """The eigenvalue, or the pair, to DIGITS digits."""
    z = ball_of(eigenvalue)
    real, imag = (f"{float(x.mid()):.{DIGITS}g}" if x != 0 else "" for x in (z.real, z.imag))
    return f"{real} ± {imag}i".strip() if imag else real or "0"


def _minus_one(factor: CertifiableReal) -> str | None:
    """The factor minus 1, to two digits; None if its ball of _ONE_BITS bits contains 1."""
    with ctx.workprec(_ONE_BITS):
        if (enclose(factor) - 1).contains(0):
            return None
    return _with_a_digit_more(lambda digits: significant(lambda: enclose(factor) - 1, digits), 2)


def _with_a_digit_more(rounded: Callable[[int], _Rounded], digits: int) -> _Rounded:
    """A number to so many digits; if no ball tells it from half a unit of the last, that 5 is its next digit."""
    with suppress(Uncertified):
        return rounded(digits)
    return rounded(digits + 1)


def error_of(problem: Problem, seen: Observed) -> float:
    """The Euclidean distance of the last state from the reference at t."""
    return distance_from_digits(seen.state, problem.reference.states[-1])


def problems_json(problems: Iterable[Problem]) -> list[Json]:
    """The problems: key, title, and whether linear, stiff or q'' = F(q)."""
    return [
        {"problem": x.key, "title": x.title, "linear": x.matrix is not None}
        | {"stiff": x.stiff, "second_order": x.second_order}
        for x in problems
    ]
