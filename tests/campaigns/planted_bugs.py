"""Planted bugs of eleven kinds in plain steppers of twenty methods, twenty of each, and what `verify` says of them.

`python -m tests.campaigns.planted_bugs > docs/planted_bugs.md` runs all of them and their mended twins.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction as Q
from itertools import cycle, islice
from random import Random
from typing import Any

from driftproof.blackbox.report import Report
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method, RungeKutta, Splitting
from tests.campaigns.planted_steppers import ELSEWHERE, Bug, Place, Rates, core, stepper

KEYS = (
    *("forward_euler", "heun2", "midpoint2", "heun3", "kutta3", "rk4", "rk38", "ralston4", "bogacki_shampine32"),
    *("fehlberg45", "cash_karp54", "dormand_prince54", "symplectic_euler", "velocity_verlet", "position_verlet"),
    *("forest_ruth", "mclachlan_atela2", "nystrom4", "nystrom5", "dormand_elmikkawy_prince4"),
)
KINDS = {
    "coefficient": "one coefficient is off by a relative 9·10⁻² to 10⁻¹⁰",
    "row sum": "a row of A or b, or all kicks or drifts, are scaled: they add up to something else",
    "time": "f is called at t + c, t + c h², t + h or c h, or always at t",
    "order of updates": "positions move before the velocity's slope is taken, or two updates are exchanged",
    "stage reuse": "a stage takes the slope of the one before",
    "stale force": "the first slope of a step is that of the step before",
    "state overwritten": "the state is advanced in place while stages are still formed of it",
    "sign": "one coefficient has the other sign",
    "missing factor": "a sum lacks its h, or has it twice",
    "component left out": "one component is left out of one update",
    "elsewhere": "right of few numbers, near t = 0, forward, in one step; not of many, long after, back, or going on",
}
PER_KIND = 20
# More draws than any method has places; what is left then is equivalent or planted already.
DRAWS = 60
EXAMPLES = 100

# Equivalence is decided on the oscillator that a map has built in; on a nonlinear force; on four coupled components, t.
WITNESSES: dict[str, tuple[Rates, tuple[Q, ...]]] = {
    "map": (lambda t, y: [y[1], -y[0]], (Q(2, 3), Q(5, 7))),
    "force": (lambda t, y: [y[1], y[0] * y[0] - 3 * y[0] + 1], (Q(2, 3), Q(5, 7))),
    "field": (
        lambda t, y: [y[2] + 0 * t, y[3], t * t + y[1] * y[0] - y[2], 3 * t - y[0] * y[0] + y[3] * y[1] + y[2]],
        (Q(2, 3), Q(5, 7), Q(-3, 11), Q(4, 13)),
    ),
}


def is_equivalent(bug: Bug) -> bool:
    """True when two steps, of h = 1/3 and 2/5 from t = 1/2, end where the right ones do, in exact arithmetic.

    The coefficients are the floats of the code, as fractions, and so is every other number: no rounding hides a bug.
    """
    rates, start = WITNESSES[bug.calls]
    ends = []
    for each in (bug, bug.mended):
        step, t, y = core(each, lambda x: Q(float(x))), Q(1, 2), list(start)
        for h in (Q(1, 3), Q(2, 5)):
            t, y = t + h, step(rates, t, y, h)
        ends.append(y)
    return ends[0] == ends[1]


def _places(method: Method) -> Iterator[Place]:
    """The coefficients that are not 0, by name and indices."""
    rows = {"RungeKutta": ("b",), "Splitting": ("parts",), "Nystrom": ("c", "b_position", "b_velocity")}
    for name in rows[type(method).__name__]:
        yield from ((name, (i,)) for i, x in enumerate(getattr(method, name)) if x != 0)
    for i, row in enumerate(getattr(method, "a", ())):
        yield from (("a", (i, j)) for j, x in enumerate(row) if x != 0)


def _scaled(method: Any, places: Sequence[Place], factor: Q) -> Any:
    """The method with these coefficients multiplied by the factor."""
    for name, (i, *rest) in places:
        values = list(getattr(method, name))
        if name == "parts":
            values[i] = (values[i][0], values[i][1] * factor)
        elif rest:
            values[i] = tuple(x * factor if j == rest[0] else x for j, x in enumerate(values[i]))
        else:
            values[i] = values[i] * factor
        method = replace(method, **{name: tuple(values)})
    return method


def _changed(kind: str, method: Method, draw: Random) -> tuple[Any, Any]:
    """The method with other coefficients, and what names them."""
    places = list(_places(method))
    name, indices = draw.choice(places)
    chosen = [(name, indices)]
    if kind == "coefficient":
        factor = 1 + draw.choice((-1, 1)) * Q(draw.randrange(1, 10), 10 ** draw.randrange(2, 11))
    elif kind == "sign":
        factor = Q(-1)
    else:
        factor = draw.choice((Q(9, 10), Q(11, 10), Q(1, 2), Q(2)))
        if isinstance(method, Splitting):
            sub_step = method.parts[indices[0]][0]
            chosen = [(name, at) for name, at in places if method.parts[at[0]][0] == sub_step]
        else:
            chosen = [place for place in places if place[0] == name and (name != "a" or place[1][0] == indices[0])]
    return _scaled(method, chosen, factor), tuple(chosen)


def drawn(kind: str, key: str, draw: Random) -> Bug | None:
    """One bug of the kind in the method, at random; None where the kind makes no sense in it."""
    method: Any = METHODS[key]
    calls = "field" if kind in ("time", "elsewhere") else draw.choice(("map", "force", "field", "field"))
    bug = Bug(kind, key, calls, method)
    if kind in ("coefficient", "sign", "row sum"):
        changed, places = _changed(kind, method, draw)
        return replace(bug, method=changed, places=places)
    splits = isinstance(method, Splitting)
    if kind == "elsewhere":
        return replace(bug, variant=draw.choice(ELSEWHERE))
    if kind == "order of updates" and splits:
        i = draw.randrange(len(method.parts) - 1)
        exchanged = (*method.parts[:i], method.parts[i + 1], method.parts[i], *method.parts[i + 2 :])
        return replace(bug, method=replace(method, parts=exchanged))
    # Slopes are taken at stages; updates move numbers: each sub-step, or to every stage but the first, and to the end.
    stages = [i for i, part in enumerate(method.parts) if part[0] == "kick"] if splits else [*range(method.stages)]
    updates = range(len(method.parts)) if splits else range(1, method.stages + 1)
    places = {
        "time": stages,
        "order of updates": stages if isinstance(method, RungeKutta) else [max(updates)],
        "stage reuse": stages[1:], "stale force": stages[:1], "state overwritten": [] if splits else stages[:-1],
        "missing factor": updates, "component left out": updates,
    }[kind]  # fmt: skip
    if not places:
        return None
    variants = {"time": ("t", "t + c", "t + c h**2", "t + h", "c h"), "missing factor": ("no h", "h twice")}
    components = (2 if calls == "field" else 1) * (2 if isinstance(method, RungeKutta) else 1)
    component = draw.randrange(components) if kind == "component left out" else -1
    return replace(bug, at=draw.choice(places), variant=draw.choice(variants.get(kind, ("",))), component=component)


def planted(kind: str) -> Iterator[tuple[Bug, bool]]:
    """Different bugs of the kind, over all methods in turn, each with whether it is equivalent, until there are enough.

    Raises AssertionError if there are not.
    """
    draw, seen, told = Random(kind), set[Bug](), 0
    for key in islice(cycle(KEYS), DRAWS * len(KEYS)):
        bug = drawn(kind, key, draw)
        if bug is None or bug in seen:
            continue
        seen.add(bug)
        equivalent = kind != "elsewhere" and is_equivalent(bug)
        yield bug, equivalent
        told += not equivalent
        if told == PER_KIND:
            return
    raise AssertionError(f"{told} bugs of the kind {kind!r}, {PER_KIND} are wanted")


def words_of(report: Report) -> list[str]:
    """The verdict and every line of a report."""
    return [report.verdict, *(line for section in report.sections for line in section.lines)]


def names_the_cause(bug: Bug, report: Report) -> bool:
    """True when the words of the report hold what was planted.

    That is an entry, a sum or a line that is changed; the wrong times; the memory; h; the component; the other method
    that the step has become; or, of a map, a coefficient of its one-step matrix beside that of the method.
    """
    other = rf"is not {bug.key}; (judging|it is (?!not a known|nearly))(?!.*\b(but|except)\b)(?!.*\b{bug.key}\b)"
    matrix = [rf"coefficient of M_\w\w is .*, {bug.key} has"] if bug.calls == "map" else []
    sums = ["the force enters", "the position moves by", r"with the step \S+ h", r"all of \S+ times", r"all \w+s times"]
    at = bug.at
    # The line of an update: of a stage, of a sub-step, or the last ones.
    last = not isinstance(bug.method, Splitting) and at == bug.method.stages
    line = rf"(new . = \S+ \+ .*d\[{at}\]|[YQ]\[{at}\]{'|y1|v1|q1' if last else ''})"
    patterns = {
        **{kind: [*matrix, *bug.entries, *sums] for kind in ("coefficient", "row sum", "sign")},
        "time": [r"wrong times?\b", r"the times? (of|at) ", rf"\bc\[{at}\]: "],
        "order of updates": [
            *(*matrix, "not advanced alike", rf"\bc\[{at}\]: ", r"b_position\[\d+\]: ", "are exchanged"),
            *(rf"in k\[{at}\], the position moves", "v1 moves the position"),
        ],
        "stage reuse": [
            *(*matrix, rf"\b[ac]\[{at}\]\S*: ", rf"\bk\[{at}\] = [fF]\([YQ]\[{at - 1}\]\) in place"),
            rf"d\[{at}\] \* F\(q\[\d+\]\) in place",
        ],
        "stale force": ["remembers", "depends on the previous call"],
        "state overwritten": [*matrix, rf"\ba\[\d+\]\[{at}\]: ", rf"after k\[{at}\], stages are formed from"],
        "elsewhere": [r"everywhere: (at t|with \d+|a step that continues)", r"in a step of \S+ from t", "h > 0 only"],
        "missing factor": [*matrix, "does not scale with h", rf"h (is missing|appears twice) in {line}"],
        "component left out": [
            *(*matrix, r"\b(drift|c|b_\w+|a)(\[\d+\])*: 0 instead", "not advanced alike", rf"{line}.* is left"),
            rf"its coefficients agree, but on .*\b[qv]\[{bug.component}\]",
        ],
    }
    words = "\n".join(words_of(report))
    # A headline may name a method and leave it to the lines that this is of another system.
    became = re.search(other, words) and "small steps follow" not in words
    return bool(became) or any(re.search(pattern, words) for pattern in patterns[bug.kind])


@dataclass
class Tally:
    """What came of the bugs of one kind, counted; and in words each that was not caught, and each twin that failed."""

    counts: Counter[str]
    stories: list[str]


COLUMNS = ("planted", "equivalent", "caught", "named", "undecided", "false pass", "twin undecided", "false alarm")
VERDICTS = {True: "false pass", False: "caught", None: "undecided"}
VERDICTS_OF_TWINS = {True: "twin passes", False: "false alarm", None: "twin undecided"}


def judged(bug: Bug) -> Report:
    """What `verify` says of the stepper."""
    return verify(stepper(bug), METHODS[bug.key], examples=EXAMPLES, isolate=False)


def campaign(kind: str, twins: dict[Bug, Report]) -> Tally:
    """All bugs of the kind and their twins. A twin that was judged before is in `twins`."""
    tally = Tally(Counter(), [])
    for bug, equivalent in planted(kind):
        if equivalent:
            tally.counts["equivalent"] += 1
            continue
        if bug.mended not in twins:
            twins[bug.mended] = judged(bug.mended)
        report, twin = judged(bug), twins[bug.mended]
        tally.counts.update(("planted", VERDICTS[report.passed], VERDICTS_OF_TWINS[twin.passed]))
        tally.counts["named"] += report.passed is False and names_the_cause(bug, report)
        if report.passed is not False:
            tally.stories.append(f"{VERDICTS[report.passed]}: {bug.words}: {report.verdict}")
        if twin.passed is not True:
            tally.stories.append(f"{VERDICTS_OF_TWINS[twin.passed]}: {bug.mended.words}: {twin.verdict}")
    return tally


def page(tallies: dict[str, Tally]) -> str:
    """The page of docs."""
    total = sum((tally.counts for tally in tallies.values()), Counter[str]())
    rows = [(f"**{kind}**: {KINDS[kind]}", tally.counts) for kind, tally in tallies.items()]
    lines = [HEAD, f"| kind | {' | '.join(COLUMNS)} |", "|---" * (1 + len(COLUMNS)) + "|"]
    lines += [f"| {name} | {' | '.join(str(counts[x]) for x in COLUMNS)} |" for name, counts in (*rows, ("all", total))]
    stories = [f"- {kind}: {story}" for kind, tally in tallies.items() for story in dict.fromkeys(tally.stories)]
    return "\n".join([*lines, "", *(stories or ["Each bug was caught, and each twin passed."]), ""])


HEAD = """# Planted bugs

What `verify` says of 220 wrong steppers, 20 of each of eleven kinds, over 20 methods of the catalogue, and of the right
stepper that each of them is except for its bug. They are plain Python floats, written from the catalogue's exact
coefficients in the three calling conventions, and drawn with a fixed seed in `tests/campaigns/planted_bugs.py`. This
page is written by

    python -m tests.campaigns.planted_bugs > docs/planted_bugs.md

A draw is **equivalent**, and replaced by another one, when two steps of it end where the right ones do in exact
rational arithmetic: a wrong node at a stage of weight 0, say. Maps take these steps on the oscillator that they have
built in, the others with a nonlinear force, or with a nonlinear right-hand side of four components that reads t.
Those of the last kind are right in such steps, and wrong elsewhere by construction.
The cause is **named** when the report holds the changed entry or sum, the wrong line of the method's program, the wrong
times, the memory, the h, the component or the method that the step has become; of a map, a coefficient of its one-step
matrix beside that of the method. `verify` tries programs that are wrong in these ways itself; what it has not thought
of it can name by its coefficients or its matrix only.
A **false pass** is a bug that passes, a **false alarm** a right twin that fails.
"""


if __name__ == "__main__":
    known: dict[Bug, Report] = {}
    sys.stdout.write(page({kind: campaign(kind, known) for kind in KINDS}))
