"""Problems on the page: the errors of methods, and the steps that they can take; and a table of all stiff problems."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import partial

from driftproof.methods.catalogue import Entry
from driftproof.methods.formulas.field_text import choices_as_functions
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.scenes import Scene
from driftproof.numeric.work_precision.curves import Curve, curve_of, for_goal, step_counts, with_points_for
from driftproof.numeric.work_precision.verdicts import GOALS
from driftproof.reports.page.document import Part
from driftproof.reports.page.markup import element, escaped, html_table
from driftproof.reports.page.stability import with_roots
from driftproof.reports.page.work import FINEST, FINEST_IMPLICIT, work_figure, work_table
from driftproof.reports.progress import with_progress
from driftproof.reports.scene_view import comparison_rows, readout_rows, show_scene
from driftproof.reports.stability import expected_of, of_proofs, steps_in_words
from driftproof.reports.stability_tables import STABLE_FROM
from driftproof.reports.user_problem import kinks_of
from driftproof.reports.work_precision.report import wanted_text
from driftproof.reports.work_precision.study import Measured
from driftproof.symbolic.claimed_orders import stated_orders

# One explicit method, and implicit ones that are L-stable, A-stable only, and L-stable of a higher order.
STIFF_METHODS = ("rk4", "backward_euler", "trapezoid", "radau_iia2")
_EVALUATIONS = "evaluations of f"
# Errors to be reached if none is wanted.
_USUAL = GOALS[:2]
# Characters: some three lines on the page.
_LONGEST_EQUATIONS = 300


def problem_part(
    problem: Problem, methods: Sequence[Entry], scene: Scene | None = None, wanted: Sequence[float] = ()
) -> Part:
    """A problem with the errors of some methods against their work, the steps that each can take, and a scene on it.

    For errors that are `wanted` longer runs are made, and the fewest steps are found.
    """
    return Part(problem.title, partial(_problem, problem, methods, scene, wanted))


def stiff_part(methods: Sequence[Entry]) -> Part:
    """The stiff problems of the catalogue, and the steps that methods can take on each."""
    return Part("Stiff problems", lambda _: _stiff(methods))


def _problem(
    problem: Problem, methods: Sequence[Entry], scene: Scene | None, wanted: Sequence[float], identity: str
) -> str:
    found, goals = [_curve(problem, each, wanted) for each in with_progress(methods, "method")], wanted or _USUAL
    figure = work_figure(found, identity, problem.t, cost=_EVALUATIONS).markup()
    work = element("div", figure, work_table(found, stated_orders(methods), goals), class_="beside")
    measured = Measured({curve.key: curve for curve in found})
    lines = [line for goal in goals for line in wanted_text(problem, measured, goal).splitlines()]
    work += "".join(element("p", escaped(line)) for line in lines)
    steps = "found to a sixteenth" if wanted else "among those of the figure"
    notes = [f"Steps are equal, and their fewest number is {steps}."]
    if not all(method.explicit for method in methods):
        notes.append("Calls are those of f; Jacobian matrices are computed by formulas.")
    work += element("p", " ".join(notes), class_="note")
    kinks = element("p", escaped(kinks_of(problem)), class_="note")
    rows = [[each.title, _steps(problem, each), expected_of(problem, each)] for each in methods]
    columns = slice(None) if any(row[-1] for row in rows) else slice(-1)
    rows = [row[columns] for row in (["Method", "Step sizes that it can take", "Expected"], *rows)]
    about = "Observed: with N, 2N, ... steps the error at the end is at most a tenth of the solution's size"
    if problem.matrix is not None:
        about = ". ".join(filter(None, ["Proved: the step sizes h whose powers stay bounded", of_proofs(problem)]))
    if any(STABLE_FROM in row[1] for row in rows):
        about += "; with fewer than are stable, the fastest decay on the way may grow in a longer run"
    table = html_table(rows, about, "words")
    return "".join(
        [
            element("p", escaped(_setting(problem)), class_="setting"),
            "" if scene is None else element("section", element("h3", "Scene"), _scene(scene), class_="panel"),
            element("section", element("h3", "Work"), *[kinks] * (not problem.field.smooth), work, class_="panel"),
            element("section", element("h3", "Stability"), table, class_="panel"),
        ]
    )


def _curve(problem: Problem, method: Entry, wanted: Sequence[float]) -> Curve:
    if not wanted:
        return curve_of(method, problem, step_counts(problem, FINEST if method.explicit else FINEST_IMPLICIT))
    found = curve_of(method, problem, compiled=True)
    return with_points_for(wanted, partial(for_goal, method=method, problem=problem), found)


def _scene(scene: Scene) -> str:
    """The readouts of a scene on a problem, or why its run has none, and its table of methods."""
    shown, at = show_scene(scene), f"h = {scene.h}, t = {scene.t}"
    if isinstance(readouts := shown.get("readouts", {}), str):
        said = element("p", escaped(readouts))
    else:
        rows = [["", scene.method(scene.selected).title], *readout_rows(readouts, scene.problem)]
        said = html_table(rows, at) if readouts else ""
    if "table" not in shown:
        return said
    rows, remarks = comparison_rows(scene, shown["table"])
    return "".join([said, html_table(rows, f"All methods, {at}"), *(element("p", escaped(x)) for x in remarks)])


def _setting(problem: Problem) -> str:
    """Equations, start and parameters if they are short enough to be read; the end; and the source."""
    field = problem.field
    names = problem.unknowns or field.components
    written = map(choices_as_functions, field.at(dict(zip(field.components, names, strict=True))))
    rates = [f"{y}′ = {rate}" for y, rate in zip(names, written, strict=True)]
    start = [f"{y}(0) = {_short(x)}" for y, x in zip(names, problem.start, strict=True)]
    parameters = [f"{name} = {_short(value)}" for name, value in field.parameters if name != "pi"]
    equations = ", ".join([*rates, *start, *parameters])
    shown = [*[equations] * (len(equations) <= _LONGEST_EQUATIONS), f"to t = {_short(problem.t)}"]
    return "; ".join([*shown, *[problem.source] * (problem.source != problem.title)])


def _short(value: object) -> str:
    """The number; the shortest decimal of a double, such as 0.7 in a Python function, instead of a fraction."""
    if isinstance(value, Fraction) and len(str(value)) > len(repr(float(value))) and Fraction(float(value)) == value:
        return repr(float(value))
    return str(value)


def _steps(problem: Problem, method: Entry) -> str:
    words = steps_in_words(problem, method)
    return with_roots(words).replace("<=", "≤") if words.startswith("h ") else words


def _stiff(methods: Sequence[Entry]) -> str:
    rows = list[list[str]]()
    for problem in with_progress([each for each in PROBLEMS.values() if each.stiff], "problem"):
        rows.append([problem.title, *(_steps(problem, method) for method in methods)])
    words = "Linear problems, proved: the h whose powers stay bounded. Others, observed: how many steps are enough"
    return html_table([["Problem", *(method.title for method in methods)], *rows], words, "words")
