"""The results of a study of error against work as tables: orders, least work, and what was not run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite
from statistics import median
from typing import TypeAlias, TypeVar

from driftproof.methods.schemes import Splitting
from driftproof.numeric.problems.problem import Digits, Problem
from driftproof.numeric.reference_errors import ENDS, ENERGY, STATE, floors, half_unit, told_apart
from driftproof.numeric.work_precision.curves import (
    ABOVE,
    MOST,
    MOST_FOR_GOAL,
    MOST_IMPLICIT,
    NOT_RUN,
    SPREAD,
    Against,
    Curve,
    Point,
    lasting,
)
from driftproof.numeric.work_precision.integrators import COMPILED, ENSEMBLE, PYTHON, has_numba
from driftproof.numeric.work_precision.timing import ROUNDS, seconds_text
from driftproof.numeric.work_precision.verdicts import GOALS, Priced, dominators, goal_text
from driftproof.reports.user_problem import KINKED, kinks_of
from driftproof.reports.work_precision.peers import INSTALL
from driftproof.reports.work_precision.study import EVALUATIONS, Measured, Study, timing_name
from driftproof.support.plain_text import counted, table, with_digits

_LABELS = {EVALUATIONS: EVALUATIONS, COMPILED: "compiled", PYTHON: "Python", ENSEMBLE: "ensemble, per state"}
# Why methods may have a lower order on a problem than on smooth ones, and the verdicts that it explains.
_EXPLAINED = {"order reduction": (Against.BELOW,), KINKED: (Against.BELOW, Against.NOT_SETTLED)}
# Characters of a step size that is shown as a fraction.
_LONGEST_STEP = 12
_Key = TypeVar("_Key")
_Member = TypeVar("_Member")
# The points by kind of cost and by curve.
_Costs: TypeAlias = Mapping[str, Mapping[str, Sequence[Priced]]]


def priced(measured: Measured, cost: str) -> dict[str, list[Priced]]:
    """The points of each curve with errors below the solution's size, and their cost, infinite if not measured."""
    found: dict[str, list[Priced]] = {}
    for key, curve in measured.curves.items():
        costs, counted = measured.costs(curve, cost), cost == EVALUATIONS
        points = [p for p in curve.points if p.error < p.scale and (not counted or p.setting in costs)]
        applies = counted or timing_name(key, cost) in measured.warm_up
        found[key] = [Priced(p.error, costs.get(p.setting, inf)) for p in points if applies]
    return found


def least_work(measured: Measured, goal: float, which: str, cost: str = EVALUATIONS) -> tuple[Curve, Point] | None:
    """The `lasting` point of least cost; `which` error is meant, "final" or "largest"."""
    costs = {key: measured.costs(curve, cost) for key, curve in measured.curves.items()}
    met = [
        (c, p) for key, c in measured.curves.items() for p in lasting(c.points, goal, which) if p.setting in costs[key]
    ]
    return min(met, key=lambda each: (costs[each[0].key][each[1].setting], each[1].error), default=None)


def _run_text(problem: Problem, curve: Curve, point: Point, cost: str, which: str) -> str:
    """A method with its step or tolerance, its cost, the largest errors on the way, and how often it was looked at.

    The error of the state on the way is not said where it is the one that was asked for.
    """
    how, h = f"{curve.key} with tolerance {point.setting}", problem.t / (point.steps or 1)
    if point.steps:
        step = h if len(str(h)) <= _LONGEST_STEP else with_digits(float(h), 6)
        how = f"{curve.key} with h = {step}, N = {point.steps}"
    said, state, energy = [f"{how}: {cost}"], point.errors[STATE], point.errors.get(ENERGY)
    said += [f"largest error on the way {with_digits(state.largest, 2)}"] * (which == "final")
    said += [f"largest error of the energy on the way {with_digits(energy.largest, 2)}"] if energy else []
    return "; ".join([*said, f"looked at {counted(state.looks, 'time')}"])


def _least_work_text(problem: Problem, measured: Measured, goal: float, which: str) -> str:
    found = least_work(measured, goal, which)
    return _run_text(problem, *found, f"{found[1].evaluations} evaluations", which) if found else "none of these runs"


def study_text(study: Study, measured: Measured, stiff: str = "") -> str:
    """The tables: orders, dominated methods, and the least work for each goal; then what was not run, and why.

    `stiff` is said near the top.
    """
    from driftproof.symbolic.claimed_orders import stated_orders

    by_cost = {cost: priced(measured, cost) for cost in (EVALUATIONS, *measured.kinds)}
    goals, problem = study.wanted or GOALS, study.problem
    reduces = "order reduction" if problem.stiff else "" if problem.field.smooth else KINKED
    parts = [
        _head(study),
        table(order_rows(measured, reduces, stated_orders(study.methods), problem.reference.states[-1]), right=(1,)),
    ]
    dominated = dominated_rows(by_cost)
    if len(dominated) > 1:
        title = "Dominated: for each of its points, another method has no larger error and no larger cost"
        parts.append(f"{title}\n\n{table(dominated)}")
    for goal in goals:
        title = f"Least work for an error at the end of at most {goal_text(goal)}, each cost by itself (* the least)"
        told = f"By the largest error on the way: {_least_work_text(problem, measured, goal, 'largest')}"
        shown = [title, table(goal_rows(measured, [*by_cost], goal)), told * (goal not in study.wanted)]
        parts.append("\n\n".join(filter(None, shown)))
    if any(_untried(curve, goal) for curve in measured.curves.values() for goal in goals):
        implicit = MOST_FOR_GOAL if study.wanted and has_numba() else MOST_IMPLICIT
        parts.append(f"Longer runs than those are not made: {MOST} steps, of implicit methods {implicit}, at most")
    parts = [*(wanted_text(problem, measured, goal) for goal in study.wanted), stiff, *parts]
    return "\n\n".join([*filter(None, parts), "\n".join(_remarks(study, measured))])


def wanted_text(problem: Problem, measured: Measured, goal: float) -> str:
    """The least work, and the least time, for an error at the end, and for one that is kept all along.

    A solution that comes to rest forgets at its end what a run did on the way.
    """
    costs = (EVALUATIONS, COMPILED, PYTHON)
    end, way = ([least_work(measured, goal, which, cost) for cost in costs] for which in ENDS)
    asked = {"final": "at the end", "largest": "on the way"} if end != way else {"largest": "at the end and on the way"}
    lines = []
    for which, where in asked.items():
        least, *timed = way if which == "largest" else end
        work = _least_work_text(problem, measured, goal, which)
        lines.append(f"For an error of at most {goal_text(goal)} {where}, {work}")
        for kind, run in [(kind, run) for kind, run in zip(costs[1:], timed, strict=True) if run][:1]:
            spent = seconds_text(measured.costs(run[0], kind)[run[1].setting])
            how = f"the same run: {spent}" if run == least else _run_text(problem, *run, spent, which)
            lines.append(f"In the least time ({_LABELS[kind]}), {how}")
    return "\n".join(lines)


def _head(study: Study) -> str:
    problem = study.problem
    floor, digits = floors(problem)["state"], half_unit(problem.reference.states[-1])
    return (
        f"{problem.title}{f' ({problem.key})' * (problem.key != problem.title)}\n\n"
        f"Reference {problem.reference.evidence}: {problem.reference.source}\n"
        f"Half a unit of its last digits: {digits:.1e}\n"
        f"Rounding of the exact state, u |y(t)|: {floor:.1e}; that of a run may be larger"
        + ("" if problem.field.smooth else f"\n{kinks_of(problem)}")
        + (f"\n{problem.energy_note}" if problem.energy_note else "")
    )


def order_rows(
    measured: Measured, reduces: str = "", stated: Mapping[str, str] = {}, digits: Digits = ()
) -> list[list[str]]:
    """Stated and measured order, with the least and the largest slope, and the least error; and what reduces orders."""
    rows = [["method", "order", "measured", "least error", ""]]
    for key, curve in measured.curves.items():
        order = str(stated.get(key.removesuffix(" controlled"), ""))
        shown = f"{x.median:.2f} ({x.least:.2f} to {x.largest:.2f})" if (x := curve.order) else ""
        reduced = f": {reduces}" * (curve.against in _EXPLAINED.get(reduces, ()))
        least = _least_error(curve, digits)
        rows.append([key, order, shown, least, _why_none(curve) if least == "none" else curve.verdict + reduced])
    return rows


def dominated_rows(by_cost: _Costs) -> list[list[str]]:
    """The methods that are dominated in some cost, and the methods that dominate them."""
    dominated = [dominators(curves) for curves in by_cost.values()]
    keys = list(dict.fromkeys(key for found in dominated for key in found))
    rows = [[key, *(f"by {', '.join(found[key])}" if key in found else "" for found in dominated)] for key in keys]
    return [["method", *(_LABELS[cost] for cost in by_cost)], *rows]


def goal_rows(measured: Measured, costs: Sequence[str], goal: float) -> list[list[str]]:
    """The cheapest `lasting` point of each method for the goal, in each cost; nothing is interpolated.

    A time of another run than that with the fewest evaluations has the setting of its run.
    """
    met = {key: {point.setting for point in lasting(c.points, goal)} for key, c in measured.curves.items()}
    spent = {cost: {key: measured.costs(c, cost) for key, c in measured.curves.items()} for cost in costs}
    found = {
        cost: {key: min(((x, s) for s, x in of[key].items() if s in met[key]), default=(inf, "")) for key in met}
        for cost, of in spent.items()
    }
    rows = [["method", *(_LABELS[cost] for cost in costs)]]
    for key, curve in measured.curves.items():
        counted = any(point.evaluations and isfinite(point.error) for point in curve.points) or _untried(curve, goal)
        applies = {c: counted if c == EVALUATIONS else timing_name(key, c) in measured.warm_up for c in costs}
        if not curve.refused:
            missed = "over the limit" if met[key] else _missed(curve, goal)
            fewest = found[EVALUATIONS][key][1] if EVALUATIONS in found else ""
            cells = (_goal_cell(cost, key, found[cost], missed, fewest) if applies[cost] else "-" for cost in costs)
            rows.append([key, *cells])
    return rows


def _goal_cell(cost: str, key: str, found: Mapping[str, tuple[float, str]], missed: str, fewest: str) -> str:
    spent, setting = found[key]
    if spent == inf:
        return missed
    shown = f"{spent:.0f}" if cost == EVALUATIONS else seconds_text(spent)
    least = " *" if spent == min(found.values())[0] else ""
    other = f" ({'N =' if setting.isdigit() else 'tol'} {setting})" if fewest not in ("", setting) else ""
    return f"{shown}{least}{other}"


def _missed(curve: Curve, goal: float) -> str:
    """Why no point of the curve is said to meet the goal."""
    if _is_by_chance(curve, goal):
        met = next(point.setting for point in curve.points if point.error <= goal)
        return f"met with {'N =' if met.isdigit() else 'tol'} {met}, but not in finer runs"
    most = _untried(curve, goal)
    return f"{f'not reached by N = {most}' if most else 'not met'}: {_least_error(curve)}"


def _is_by_chance(curve: Curve, goal: float) -> bool:
    """True if only runs meet the goal that are coarser than one that misses it."""
    return not lasting(curve.points, goal) and any(point.error <= goal for point in curve.points)


def _untried(curve: Curve, goal: float) -> int:
    """The most steps of a curve that misses the goal, if more were not tried and it is above the floor; else 0."""
    *_, last = None, *(point for point in curve.points if point.steps and not point.remark.startswith(NOT_RUN))
    missed = last and last.error > last.doubt and min(p.error for p in curve.points) > goal
    return (last.steps or 0) if last and missed else 0


def _least_error(curve: Curve, digits: Digits = ()) -> str:
    best = min(curve.points, key=lambda point: point.error, default=None)
    if best is None or not isfinite(best.error):
        return "none"
    if best.error >= best.scale:
        return "lost"
    if below := told_apart(best.error, digits):
        return f"below {below}"
    mantissa, _, exponent = f"{best.error:.1e}".partition("e")
    return f"{best.error:.2g}" if 1e-3 <= best.error < 100 or not best.error else f"{mantissa}e{int(exponent)}"


def _why_none(curve: Curve) -> str:
    """Why no run of a curve has an error: it does not apply, or what stopped the last one."""
    remarks = [point.remark for point in curve.points if point.remark]
    return f"does not apply: {curve.refused}" if curve.refused else remarks[-1] if remarks else curve.verdict


def _remarks(study: Study, measured: Measured) -> list[str]:
    """What does not apply, was not run or is absent; then how times were taken, and what counts."""
    asked = study.question()
    machine = f"{asked['machine']}; " + ", ".join(f"{name} {v}" for name, v in asked["versions"].items())
    return [*_not_measured(study, measured), *_of_times(measured), *_what_counts(study, measured), machine]


def _not_measured(study: Study, measured: Measured) -> Iterator[str]:
    """The remarks of points, the peers that are absent, and the times that were not taken."""
    for key, curve in measured.curves.items():
        by_remark = _grouped((point.remark, point) for point in curve.points if point.remark)
        yield from (f"{key} at {_settings(curve, points)}: {remark}" for remark, points in by_remark.items())
    yield from (f"peer {peer.name}: {INSTALL}" for peer in study.peers if not peer.installed)
    absent = _grouped(((name.split(" | ")[1], why), name.split(" | ")[0]) for name, why in measured.absent.items())
    yield from (f"no times ({_LABELS[kind]}) for {', '.join(keys)}: {why}" for (kind, why), keys in absent.items())
    over = Counter(name.split(" | ")[0] for name, timing in measured.timings.items() if timing.too_long)
    if counts := ", ".join(f"{key} {count}" for key, count in over.items()):
        yield f"not timed, being longer than {study.limit:g} s (--time-limit): points of {counts}"
    marked = (name.split(" | ") for name, t in measured.timings.items() if t.remark and not t.too_long)
    untimed = _grouped((f"{key} ({_LABELS[kind]})", setting) for key, kind, setting in marked)
    yield from (f"not timed: {whose} at {', '.join(settings)}" for whose, settings in untimed.items())


def _of_times(measured: Measured) -> Iterator[str]:
    """How times were taken, if any were, and what starts multistep methods."""
    if spreads := [t.spread for t in measured.timings.values() if t.samples and t.spread is not None]:
        yield (
            f"Times are the least of up to {ROUNDS} turns in random order, garbage collection off; half of the spreads "
            f"are below {100 * median(spreads):.0f} %. Warm-up and compilation are not included."
        )
    yield from (f"first values of {c.key}: steps of {c.started}" for c in measured.curves.values() if c.started)


def _what_counts(study: Study, measured: Measured) -> Iterator[str]:
    """Which runs and which evaluations count, and what the signs in the tables mean."""
    from driftproof.symbolic.claimed_orders import false_claims

    if study.wanted:
        beside = "the next two numbers that end at the times looked at"
        if not study.problem.field.smooth:
            beside = f"numbers of all remainders on which it depends where f changes in a step, or {SPREAD} others"
        yield f"For such errors the fewest steps are found to a sixteenth; tried are, too, {beside};"
        yield "tolerances are among 1, 2 and 5 times 10^-n."
    yield (
        f"A run counts if all finer ones that were made are as good, or have errors below about {ABOVE} (N + 1) 2^-53"
        " times the solution's size, which may be rounding."
    )
    curves = measured.curves.values()
    if any(_is_by_chance(curve, goal) for curve in curves for goal in study.wanted or GOALS):
        chance = "its error changes sign" if study.problem.field.smooth else "its steps end where f changes"
        yield f"A coarser run that meets what finer ones miss may do so by chance, as where {chance}: take finer ones."
    yield from (f"{curve.key}: order not settled: {curve.unsettled}" for curve in curves if curve.unsettled)
    yield from (f"{m.key}: {claim}" for m in study.methods for claim in false_claims(m) if claim.embedded)
    yield "-: nothing to measure, or no point with an error."
    if any(_least_error(curve) == "lost" for curve in curves):
        yield "lost: no run has an error below the size of the solution."
    again = [x.key for x in study.methods if isinstance(x, Splitting) and x.parts[0][0] == x.parts[-1][0] == "kick"]
    which = f" (so {', '.join(again)}: code that keeps it makes one less in each step)" if again else ""
    yield f"Evaluations are those of f, as made, even if a step begins by repeating the last of the one before{which};"
    yield "Jacobian matrices are not among them: they are computed by formulas."
    if any(key.endswith(" controlled") for key in measured.curves):
        yield "controlled: each step's error estimate is within tolerance (1 + |y|) in every component."


def _settings(curve: Curve, points: Sequence[Point]) -> str:
    """The settings of some points of a curve, with neighbouring ones given by the first and the last."""
    runs: list[list[Point]] = []
    for point in points:
        if runs and curve.points.index(point) == curve.points.index(runs[-1][-1]) + 1:
            runs[-1].append(point)
        else:
            runs.append([point])
    what = "N =" if points[0].steps else "tolerance"
    return f"{what} " + ", ".join(" to ".join(dict.fromkeys((run[0].setting, run[-1].setting))) for run in runs)


def _grouped(pairs: Iterable[tuple[_Key, _Member]]) -> dict[_Key, list[_Member]]:
    found: dict[_Key, list[_Member]] = {}
    for key, member in pairs:
        found.setdefault(key, []).append(member)
    return found
