"""Search for the one mistake in a method's program, a line or a coefficient, that gives the steps a code takes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, islice
from math import isfinite
from operator import sub
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.judging.nonlinear_problems import capped_exp
from driftproof.blackbox.probes.coefficients import exact_shown, simple_rational
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Method, Nystrom, RungeKutta, Splitting
from driftproof.methods.stepping import oscillator

Lines: TypeAlias = tuple[str, ...]
# The coefficients by name: "a" is a list of rows, the others are rows.
Tables: TypeAlias = dict[str, Any]
# q, v and h, of ordinary size; h is so large that every coefficient of a method of high order matters.
_STEPS = ((0.6, -0.8, 1.0), (1.25, 0.5, 0.5), (-0.375, 0.9, 0.75))
# Where no method moves, whatever its mistake; a stale slope that is kept does.
_REST = (0.0, 0.0, 1.0)
# The factor by which numbers inside a step may exceed its result: coefficients reach 50, and slopes 30.
_INSIDE = 64
# Iterations of the secant method for one coefficient, and its first offset; on linear problems one iteration is exact.
_ROUNDS, _ASIDE = 12, 0.125
# Chosen: the most mistakes that are named.
MOST_SHOWN = 4
# Chosen: a longer program has more possible mistakes than can be tried in a second or two.
_MOST_STAGES = 13


@dataclass(frozen=True)
class Program:
    """The lines of one step as in a paper, but in Python, with the coefficients in `tables`.

    A Runge-Kutta method has the states Y[i] and slopes k[i] of y = (q, v) and ends with y1; a Nyström method has Q[i]
    and k[i], and ends with q1 and v1; a splitting goes from q[0] and v[0] to q[-1] and v[-1].
    """

    lines: Lines
    tables: Tables

    def step(self, force: Callable[[float], float], q: float, v: float, h: float) -> tuple[float, float]:
        """The result (q₁, v₁) of the step."""
        room = [None] * len(self.lines)
        known: dict[str, Any] = {**self.tables, "h": h, "k": [*room], "Y": [*room], "Q": [*room], "F": force}
        known |= {"q": q, "v": v} if "c" in self.tables else {"q": [q], "v": [v]}
        known |= {"y": np.array([q, v]), "f": lambda y: np.array([y[1], force(y[0])])}
        known |= {"q_only": np.array([1.0, 0.0]), "v_only": np.array([0.0, 1.0])}
        exec(compile("\n".join(self.lines), "<step>", "exec"), known)
        if "y1" in known:
            return float(known["y1"][0]), float(known["y1"][1])
        return (known["q1"], known["v1"]) if "q1" in known else (known["q"][-1], known["v"][-1])


def single_mistakes(subject: ForeignStepper, method: Method) -> tuple[str, ...]:
    """The mistakes, in words, each of which alone makes the method's program take the subject's steps.

    Steps are compared on q'' = -q if that is built in, else on q'' = exp(-2q), and at rest. At most MOST_SHOWN are
    returned; none if the method is implicit or very long, or if its steps are the subject's.
    """
    calls = len(method.parts) if isinstance(method, Splitting) else getattr(method, "stages", 0)
    if not method.explicit or calls > _MOST_STAGES:
        return ()
    force = oscillator if subject.convention.kind == MAP else _wall
    with suppress(UnsupportedCall):  # what an object keeps from steps of another force is none of the method's
        subject = subject.fresh(subject.convention.steps)
    step = subject.step if subject.convention.kind == MAP else lambda *at: subject.step_with(_wall, *at)
    try:
        rest = oscillator, _REST, subject.step(*_REST)
        seen = _StepsSeen([*((force, at, step(*at)) for at in _STEPS), rest], Rounding(subject.format, calls))
    except Misbehaviour:
        return ()
    program = program_of(method)
    if seen.are_of(program):
        return ()
    edited = (words for words, lines in _edits(method, program.lines) if seen.are_of(replace(program, lines=lines)))
    solved = map(seen.solved, _one_parameter(method, program))
    return tuple(islice(chain(edited, filter(None, solved)), MOST_SHOWN))


def _wall(q: float) -> float:
    return float(capped_exp(-2 * q))


@dataclass(frozen=True)
class _StepsSeen:
    """Steps that the subject takes: the force of each, where it goes from with h, and its end."""

    steps: Sequence[tuple[Callable[[float], float], tuple[float, float, float], Sequence[float]]]
    rounding: Rounding

    def are_of(self, program: Program) -> bool:
        """True if the program takes these steps, to rounding."""
        for force, at, end in self.steps:
            with np.errstate(all="ignore"):
                made = program.step(force, *at)
            allowed = _INSIDE * self.rounding.of(1 + max(map(abs, (*end, *made))))
            if not all(abs(gap) <= allowed for gap in map(sub, made, end)):
                return False
        return True

    def solved(self, one: _Parameter) -> str:
        """The x for which the first step is the one seen, by the secant method, in words; "" if other steps differ."""

        force, at, end = self.steps[0]

        def gap(x: float, m: int) -> float:
            return one.at(x).step(force, *at)[m] - end[m]

        start = 1.0 if one.scaled else one.row[one.chosen[0]]
        with np.errstate(all="ignore"):
            for m in (1, 0):
                x, before = start, start + _ASIDE
                off, off_before = gap(x, m), gap(before, m)
                for _ in range(_ROUNDS):
                    if off == off_before or not isfinite(off):
                        break
                    x, before = x - off * (x - before) / (off - off_before), x
                    off, off_before = gap(x, m), off
                if x != start and self.are_of(one.at(x)):
                    found = simple_rational(x, _INSIDE * self.rounding.of(max(1.0, abs(x))))
                    return one.words.format(f"{x:.12g}" if found is None else found)
        return ""


def program_of(method: Method) -> Program:
    """The program of an explicit method, as its definition says."""

    def row(numbers: Sequence[Exact]) -> list[float]:
        return [float(x) for x in numbers]

    if isinstance(method, Splitting):
        return Program(_splitting_lines(range(len(method.parts)), method), {"d": row([x for _, x in method.parts])})
    assert isinstance(method, RungeKutta | Nystrom)
    tables: Tables = {"a": [row(each) for each in method.a], "c": row(method.c)}
    lines: list[str] = []
    for i, weights in enumerate(method.a):
        pushes = _sum(f"a[{i}]", weights)
        if isinstance(method, RungeKutta):
            lines += [f"Y[{i}] = y" + f" + h * {pushes}" * bool(pushes), f"k[{i}] = f(Y[{i}])"]
        else:
            lines += [f"Q[{i}] = q + h * c[{i}] * v" + f" + h * h * {pushes}" * bool(pushes), f"k[{i}] = F(Q[{i}])"]
    if isinstance(method, RungeKutta):
        return Program((*lines, f"y1 = y + h * {_sum('b', method.b)}"), {**tables, "b": row(method.b)})
    tables |= {"b_position": row(method.b_position), "b_velocity": row(method.b_velocity)}
    moved = f"v1 = v + h * {_sum('b_velocity', method.b_velocity)}"
    return Program((*lines, moved, f"q1 = q + h * v + h * h * {_sum('b_position', method.b_position)}"), tables)


def _sum(row: str, weights: Sequence[Exact]) -> str:
    terms = [f"{row}[{j}] * k[{j}]" for j, x in enumerate(weights) if x != 0]
    return f"({' + '.join(terms)})" if terms else ""


def _splitting_lines(order: Sequence[int], method: Splitting) -> Lines:
    """The lines of the sub-steps in this order, each with the latest q and v."""
    lines, passed = [], {"q": 0, "v": 0}
    for i in order:
        x = "v" if method.parts[i][0] == "kick" else "q"
        slope = f"F(q[{passed['q']}])" if x == "v" else f"v[{passed['v']}]"
        lines.append(f"{x} += [{x}[{passed[x]}] + h * d[{i}] * {slope}]")
        passed[x] += 1
    return tuple(lines)


def _shown(line: str) -> str:
    """The line as it is shown: for a splitting, "new q = q[0] + ..." in place of "q += [q[0] + ...]"."""
    return re.sub(r"^([qv]) \+= \[(.*)\]$", r"new \1 = \2", line)


def _edits(method: Method, program: Lines) -> Iterator[tuple[str, Lines]]:
    """Yield the mistakes in a line, in the order of sub-steps, or in when the state is advanced, with all lines."""
    for at, line in enumerate(program):
        before = program[:at]
        wrong = chain(_wrong_factors(line), _wrong_names(before, line), _left_out(line), _in_one_component(line))
        for words, *lines in wrong:
            yield words, (*before, *lines, *program[at + 1 :])
    if isinstance(method, Splitting):
        for i in range(len(method.parts) - 1):
            order = [*range(i), i + 1, i, *range(i + 2, len(method.parts))]
            words = f"{method.parts[i][0]} {i} and {method.parts[i + 1][0]} {i + 1} are exchanged"
            yield words, _splitting_lines(order, method)
    else:
        yield from _too_early(program, method.stages, isinstance(method, RungeKutta))


def _wrong_factors(line: str) -> Iterator[tuple[str, str]]:
    for found in re.finditer(r"\bh \* ", line):
        yield f"h is missing in {_shown(line)}", line[: found.start()] + line[found.end() :]
        yield f"h appears twice in {_shown(line)}", line[: found.end()] + line[found.start() :]


def _in_one_component(line: str) -> Iterator[tuple[str, str, str]]:
    """Yield the wrong factors of h in the position alone and in the velocity alone, for a state that has both."""
    for words, wrong in _wrong_factors(line) if line[0] in "Yy" else ():
        name, _, right = line.partition(" = ")
        for x, other in ("qv", "vq"):
            mixed = f"{name} = ({right}) * {other}_only + ({wrong[len(name) + 3 :]}) * {x}_only"
            yield f"in the {x}, {words}", line, mixed


def _wrong_names(before: Sequence[str], line: str) -> Iterator[tuple[str, str]]:
    """Yield the line with one slope or state replaced by each other one that is known there."""
    for found in re.finditer(r"(?<=.)\b([kYQqv])\[(\d+)\]", line):
        known = sum(each.startswith((f"{found[1]}[", f"{found[1]} +=")) for each in before) + (found[1] in "qv")
        for j in set(range(known)) - {int(found[2])}:
            wrong = f"{line[: found.start()]}{found[1]}[{j}]{line[found.end() :]}"
            yield f"{_shown(wrong)} in place of {_shown(line)}", wrong


def _left_out(line: str) -> Iterator[tuple[str, ...]]:
    """Yield the line with nothing added to a state, or to one component of a state that has two."""
    if line[0] in "Yy":
        name = line.partition(" = ")[0]
        for x, other in ("qv", "vq"):
            kept = f"{name} = y * {x}_only + {name} * {other}_only"
            yield f"the {x} of {name} is left as it is in y", line, kept
    elif line[0] != "k":
        start = line.partition(" + ")[0]
        yield f"{_shown(line)} is left out", start + "]" * ("[" in start.partition("=")[2])


def _too_early(lines: Lines, stages: int, runge_kutta: bool) -> Iterator[tuple[str, Lines]]:
    """Yield the lines that advance the state, or one component of it, while stages are still formed from it."""
    if not runge_kutta:
        yield "v1 moves the position in place of v", (*lines[:-1], lines[-1].replace("h * v ", "h * v1 "))
    y, weights = ("y", "h * b") if runge_kutta else ("q", "h * h * b_position")
    for i in range(stages):
        early = f"{y} + {weights}[{i}] * k[{i}]"
        for words, starts in (("stages", "YQ"), ("stages and the result", "YQyq")):
            wrong = [each.replace(f" = {y}", f" = ({early})", 1) if each[0] in starts else each for each in lines]
            pairs = enumerate(zip(lines, wrong, strict=True))
            formed = tuple(late if n // 2 > i else line for n, (line, late) in pairs)
            yield f"after k[{i}], {words} are formed from {early}", formed
        for weight in (f"b[{i}]", f"a[{i + 1}][{i}]") if runge_kutta else ():
            if weight in "".join(lines):
                turns = (
                    f"Y[{i}] = Y[{i}] + h * {weight} * k[{i}] * q_only",
                    f"k[{i}] = k[{i}] * q_only + f(Y[{i}]) * v_only",
                )
                words = f"in k[{i}], the position moves by h {weight} k[{i}] before the velocity's slope is taken"
                yield words, (*lines[: 2 * i + 2], *turns, *lines[2 * i + 2 :])


@dataclass(frozen=True)
class _Parameter:
    """Programs with a parameter x: the `chosen` numbers of a row are x, or, if `scaled`, x times the method's."""

    words: str
    program: Program
    name: str
    i: int | None
    chosen: tuple[int, ...]
    scaled: bool

    @property
    def row(self) -> list[float]:
        table: Any = self.program.tables[self.name]
        return list(table if self.i is None else table[self.i])

    def at(self, x: float) -> Program:
        row = [(y * x if self.scaled else x) if j in self.chosen else y for j, y in enumerate(self.row)]
        table = self.program.tables[self.name]
        rows = row if self.i is None else [*table[: self.i], row, *table[self.i + 1 :]]
        return replace(self.program, tables={**self.program.tables, self.name: rows})


def _one_parameter(method: Method, program: Program) -> Iterator[_Parameter]:
    """Yield each coefficient that is not 0, and each row as a whole; for splittings all kicks, and all drifts."""
    parts = method.parts if isinstance(method, Splitting) else ()
    rows: list[tuple[str, int | None, Sequence[Exact]]] = [("d", None, [x for _, x in parts])] if parts else []
    if not parts:
        rows = [("a", i, row) for i, row in enumerate(getattr(method, "a", ()))]
        names = ("b",) if isinstance(method, RungeKutta) else ("c", "b_position", "b_velocity")
        rows += [(name, None, getattr(method, name)) for name in names]
    for name, i, exact in rows:
        there = tuple(j for j, x in enumerate(exact) if x != 0)
        row = name if i is None else f"{name}[{i}]"
        for j in there:
            place = f"{parts[j][0]} {j}" if parts else f"{row}[{j}]"
            yield _Parameter(f"{place}: {{}} instead of {exact_shown(exact[j])}", program, name, i, (j,), scaled=False)
        groups = {f"all {kind}s": tuple(j for j in there if parts[j][0] == kind) for kind in ("kick", "drift") if parts}
        for words, chosen in (groups or {f"all of {row}": there}).items():
            if len(chosen) > 1:
                yield _Parameter(f"{words} times {{}}", program, name, i, chosen, scaled=True)
