"""Programs of methods, line by line as in a paper; and each with one mistake in a line, a coefficient or a solver."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, chain, combinations, product
from types import CodeType
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from driftproof.blackbox.matching.tables import Array, exact_tableau
from driftproof.blackbox.probes.coefficients import exact_shown
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.support.plain_text import counted

Lines: TypeAlias = tuple[str, ...]
# The coefficients by name: "a" is a list of rows, the others are rows.
Tables: TypeAlias = dict[str, Any]
# What coefficients of a splitting are called, that of kind and place, where its program has a velocity in the middle,
# and where it has none.
_PARTS = {"d": "{0} {1}", "c": "the time of {0} {1}"}
_WEIGHTS = {"b_position": "the weight of k[{1}] in q1", "b_velocity": "the weight of k[{1}] in v1"}
_WEIGHTS["c"] = "the time of k[{1}]"
# The lines of an implicit method are gone through until its end changes by no more than this part, ten bits below the
# half of the digits to which ends are compared; stages that contract by 3/4 in each round, as where methods are
# compared on a system, need 87 rounds.
_SETTLED, _ROUNDS = 2.0**-36, 87
# Chosen: the most iterations by which stages are said to be solved, and the most unknowns of Newton's.
_FEW, MOST_UNKNOWNS = 4, 24
# The part of a state by which difference quotients move it: they are off by its square, less than half of the digits.
_ASIDE = 2.0**-16


class StepSeen(NamedTuple):
    """A step of a stepper from y at t to its end, on the system with these slopes."""

    rate: Callable[[float, Sequence[float]], Sequence[float]]
    t: float
    y: Sequence[float]
    h: float
    end: Sequence[float]


@dataclass(frozen=True)
class Program:
    """The lines of one step as in a paper, but in Python, with the coefficients in `tables`.

    A Runge-Kutta method has the states Y[i] and slopes k[i] of y and ends with y1; a Nyström method has Q[i] and k[i],
    and ends with q1 and v1; a splitting goes from q[0] and v[0] to q[-1] and v[-1]. Of numbers y, the positions and the
    velocities stand in `halves`; the force F does not depend on the velocity. Where `timed`, slopes are asked with
    their times. The lines of an `implicit` method are gone through from k[i] = f(y) until y1 stays as it is, or, if
    `rounds` is not 0, so many times.
    """

    lines: Lines
    tables: Tables
    timed: bool = False
    halves: tuple[slice, slice] = (slice(None, 1), slice(1, None))
    implicit: bool = False
    rounds: int = 0

    @cached_property
    def _ready(self) -> tuple[CodeType, Tables]:
        """The lines to run, and the coefficients as floats."""
        tables = {name: _floats(row) for name, row in self.tables.items()}
        return compile("\n".join(self.lines), "<step>", "exec"), tables

    def end(self, taken: StepSeen) -> list[float]:
        """The end of the step that starts as the one taken does. Raises ArithmeticError if stages do not settle."""
        y: Array = np.array(taken.y, dtype=float)
        room, (positions, velocities), (code, tables) = [None] * len(self.lines), self.halves, self._ready

        def joined(q: Any, v: Any) -> Array:
            whole = np.empty_like(y)
            whole[positions], whole[velocities] = q, v
            return whole

        def slopes(t: float, y: Any) -> Array:
            return np.array(taken.rate(t, np.asarray(y).tolist()), dtype=float)

        def in_turn(h: float, y: Any, t: float = taken.t) -> Array:
            """The slopes of the numbers, each of which moves by h times its own before that of the next is taken."""
            moved, found = np.array(y), np.zeros(len(y))
            for j in range(len(moved)):
                found[j] = slopes(t, moved)[j]
                moved[j] += h * found[j]
            return found

        q, v = y[positions], y[velocities]
        known: dict[str, Any] = {**tables, "h": taken.h, "t": taken.t, "k": [*room], "Y": [*room], "Q": [*room]}
        known |= {"q": [q], "v": [v]} if "d" in tables else {"q": q, "v": v}
        known |= {"y": y, "in_turn": in_turn, "q_only": joined(1.0, 0.0), "v_only": joined(0.0, 1.0)}
        known["f"] = lambda y, t=taken.t: slopes(t, y)
        known["F"] = lambda q, t=taken.t: slopes(t, joined(q, v))[velocities]
        if self.implicit:
            known |= {"k": [slopes(taken.t, y)] * len(self.lines), "Y": [y] * len(self.lines)}
        exec(code, known)
        for _ in range((self.rounds or _ROUNDS) - 1 if self.implicit else 0):
            before = known["y1"]
            exec(code, known)
            if settled := np.abs(known["y1"] - before).max() <= _SETTLED * np.abs(known["y1"]).max():
                break
        if self.implicit and not (self.rounds or settled):
            raise ArithmeticError("stages do not settle")
        if "y1" not in known:
            known["y1"] = joined(*((known["q1"], known["v1"]) if "q1" in known else (known["q"][-1], known["v"][-1])))
        return [float(x) for x in known["y1"]]


def _floats(row: Sequence[Any]) -> list[Any]:
    return [_floats(x) if isinstance(x, Sequence) else float(x) for x in row]


def programs_of(method: Method, timed: bool = False) -> list[Program]:
    """The programs of a method: as its definition says, and one without a velocity in the middle.

    An implicit one that ends at its last stage has one that says so. Where `timed`, slopes are asked with their times.
    """
    if isinstance(method, Splitting):
        return [*_programs_of_splitting(method, timed)]
    assert isinstance(method, RungeKutta | Collocation | Nystrom)
    a, b, c = (method.a, (), method.c) if isinstance(method, Nystrom) else exact_tableau(method)
    tables: Tables = {"a": a, "c": c}
    lines: list[str] = []
    for i, weights in enumerate(a):
        pushes, at = _sum(f"a[{i}]", weights), _time(i, timed)
        if isinstance(method, Nystrom):
            lines += [f"Q[{i}] = q + h * c[{i}] * v" + f" + h * h * {pushes}" * bool(pushes), f"k[{i}] = F(Q[{i}]{at})"]
        else:
            lines += [f"Y[{i}] = y" + f" + h * {pushes}" * bool(pushes), f"k[{i}] = f(Y[{i}]{at})"]
    if not isinstance(method, Nystrom):
        ends = [f"y1 = Y[{len(a) - 1}]"] * (not method.explicit and _floats(a[-1]) == _floats(b)) + [
            f"y1 = y + h * {_sum('b', b)}"
        ]
        whole = Program((), {**tables, "b": b}, timed, implicit=not method.explicit)
        return [replace(whole, lines=(*lines, end)) for end in ends]
    tables |= {"b_position": method.b_position, "b_velocity": method.b_velocity}
    moved = f"v1 = v + h * {_sum('b_velocity', method.b_velocity)}"
    lines += [moved, f"q1 = q + h * v + h * h * {_sum('b_position', method.b_position)}"]
    return [Program(tuple(lines), tables, timed)]


def _programs_of_splitting(method: Splitting, timed: bool) -> Iterator[Program]:
    shares = [x for _, x in method.parts]
    drifts = (x * int(kind == "drift") for kind, x in method.parts)
    passed: list[Exact] = [*accumulate(drifts, initial=0 * shares[0])]
    yield Program(_splitting_lines(range(len(shares)), method, timed), {"d": shares, "c": passed[:-1]}, timed)
    if [kind for kind, _ in method.parts] == ["kick", "drift", "kick"]:
        lines = (
            f"k[0] = F(q{_time(0, timed)})",
            "q1 = q + h * v + h * h * b_position[0] * k[0]",
            f"k[1] = F(q1{_time(1, timed)})",
            "v1 = v + h * (b_velocity[0] * k[0] + b_velocity[1] * k[1])",
        )
        weights = {"b_position": [shares[0] * shares[1]], "b_velocity": shares[::2]}
        yield Program(lines, {**weights, "c": passed[1:3]}, timed)


def _time(i: int, timed: bool) -> str:
    return f", t + h * c[{i}]" * timed


def _sum(row: str, weights: Sequence[Exact]) -> str:
    terms = [f"{row}[{j}] * k[{j}]" for j, x in enumerate(weights) if x != 0]
    return f"({' + '.join(terms)})" if terms else ""


def _splitting_lines(order: Sequence[int], method: Splitting, timed: bool) -> Lines:
    """The lines of the sub-steps in this order, each with the latest q and v."""
    lines, passed = [], {"q": 0, "v": 0}
    for i in order:
        x = "v" if method.parts[i][0] == "kick" else "q"
        slope = f"F(q[{passed['q']}]{_time(i, timed)})" if x == "v" else f"v[{passed['v']}]"
        lines.append(f"{x} += [{x}[{passed[x]}] + h * d[{i}] * {slope}]")
        passed[x] += 1
    return tuple(lines)


def _shown(line: str) -> str:
    """The line as it is shown: for a splitting, "new q = q[0] + ..." in place of "q += [q[0] + ...]"."""
    return re.sub(r"^([qv]) \+= \[(.*)\]$", r"new \1 = \2", line)


def edits(method: Method, program: Program, pair: bool) -> Iterator[tuple[str, Lines]]:
    """Yield the mistakes in a line, in the order of sub-steps, or in when the state is advanced, with all lines.

    Of a state that is a `pair` of position and velocity, also those in one of them.
    """
    whole = program.lines
    for at, line in enumerate(whole):
        before = whole if program.implicit else whole[:at]
        wrong = chain(_wrong_factors(line), _wrong_names(before, line), _left_out(line), _in_one_component(line))
        for words, *lines in chain(wrong, _exchanged(line)):
            if pair or "_only" not in "".join(lines):
                yield words, (*whole[:at], *lines, *whole[at + 1 :])
    if "d" in program.tables:
        assert isinstance(method, Splitting)
        for i in range(len(method.parts) - 1):
            order = [*range(i), i + 1, i, *range(i + 2, len(method.parts))]
            words = f"{method.parts[i][0]} {i} and {method.parts[i + 1][0]} {i + 1} are exchanged"
            yield words, _splitting_lines(order, method, program.timed)
    elif isinstance(method, RungeKutta | Collocation | Nystrom):
        yield from _too_early(whole, method.stages, not isinstance(method, Nystrom), pair)


@dataclass(frozen=True)
class Unsettled:
    """Stages that so many of Newton's iterations solve, or fewer if they settle, from y or from y + c[i] h f(y)."""

    method: RungeKutta | Collocation
    rounds: int
    predicted: bool
    anew: bool
    called: bool
    timed: bool

    def end(self, taken: StepSeen) -> list[float]:
        """The end of the step. Raises ArithmeticError if its equations are singular."""
        a, b, c = (np.array(_floats(part)) for part in exact_tableau(self.method))
        y: Array = np.array(taken.y, dtype=float)
        times, shape = (taken.t + taken.h * c * self.timed).tolist(), (len(b), len(y))

        def slopes(stages: Array) -> Array:
            return np.array([taken.rate(t, row) for t, row in zip(times, stages.tolist(), strict=True)])

        def gap(flat: Array) -> Array:
            return flat - np.ravel(y + taken.h * a @ slopes(flat.reshape(shape)))

        first = np.array(taken.rate(taken.t, y.tolist())) * self.predicted
        found: Array = np.ravel(y + taken.h * np.outer(c, first))
        away = _ASIDE * np.abs(y).max() * np.eye(found.size)
        for n in range(self.rounds):
            if self.anew or not n:
                rows = np.array([(gap(found + x) - gap(found - x)) / (2 * x.max()) for x in away])
            try:
                change = np.linalg.solve(rows.T, gap(found))
            except np.linalg.LinAlgError as error:
                raise ArithmeticError(str(error)) from None
            found = found - change
            if np.abs(change).max() <= _SETTLED * np.abs(found).max():
                break
        stages = found.reshape(shape)
        if self.called:
            return [float(x) for x in y + taken.h * b @ slopes(stages)]
        return [float(x) for x in y + (stages - y).T @ np.linalg.lstsq(a.T, b, rcond=None)[0]]


def unsettled(method: Method, program: Program, size: int) -> Iterator[tuple[str, Program | Unsettled]]:
    """Yield the steps of an implicit method whose stages are solved by few iterations, in words, for states of a size.

    Slopes weighed are those of the stages that are found, or those that the equations give for these.
    """
    assert isinstance(method, RungeKutta | Collocation)
    together = tuple(sorted(program.lines, key=lambda line: "Yky".index(line[0])))  # all stages in each round
    for n in range(1, _FEW + 1):
        words = f"the stages are iterated {counted(n, 'time')} from k[i] = f(y)"
        yield words, replace(program, lines=together, rounds=n)
    few = range(1, _FEW + 1) if size * method.stages <= MOST_UNKNOWNS else ()
    for n, predicted, anew, called in product(few, (False, True), (False, True), (False, True)):
        start, frozen = (
            "y + c[i] h f(y)" if predicted else "y",
            ", with the Jacobian of the first" * (n > 1 and not anew),
        )
        words = f"the stages are solved by {counted(n, 'iteration')} of Newton's method from {start}{frozen}"
        if n > 1 or anew:
            yield words, Unsettled(method, n, predicted, anew, called, program.timed)


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


def _exchanged(line: str) -> Iterator[tuple[str, str]]:
    """Yield the sum with two of its weights exchanged."""
    for one, other in combinations(re.findall(r"\bk\[\d+\]", line.partition(" = ")[2]), 2):
        turned = line.replace(one, "#").replace(other, one).replace("#", other)
        yield f"the weights of {one} and {other} are exchanged in {line}", turned


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


def _too_early(lines: Lines, stages: int, runge_kutta: bool, pair: bool) -> Iterator[tuple[str, Lines]]:
    """Yield the lines that advance the state, or one component of it, while stages are still formed from it."""
    if not runge_kutta:
        yield "v1 moves the position in place of v", (*lines[:-1], lines[-1].replace("h * v ", "h * v1 "))
    overwritten = {f"Y[{i}] is": (f"Y[{i}]",) for i in range(1, stages) if runge_kutta}
    for words, names in (overwritten | {"each Y[i] is": ("Y",)} if overwritten else {}).items():
        kept = tuple(each.replace(" = y", " = y = y", 1) if each.startswith(names) else each for each in lines)
        yield f"{words} y itself, which it overwrites", kept
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
                what = ("the position", "the velocity's slope") if pair else ("each number", "the next one's slope")
                words = f"in k[{i}], {what[0]} moves by h {weight} k[{i}] before {what[1]} is taken"
                turned = lines[2 * i + 1].replace("f(", f"in_turn(h * {weight}, ")
                yield words, (*lines[: 2 * i + 1], turned, *lines[2 * i + 2 :])


@dataclass(frozen=True)
class Parameter:
    """Programs with a parameter x: the `chosen` numbers of a row are x, or, if `scaled`, x times the method's.

    The number at the place `rest` makes up for what the other one changes.
    """

    words: str
    program: Program
    name: str
    i: int | None
    chosen: tuple[int, ...]
    scaled: bool
    rest: int | None = None

    @property
    def row(self) -> list[Any]:
        """The row that holds it."""
        table: Any = self.program.tables[self.name]
        return list(table if self.i is None else table[self.i])

    def at(self, x: float) -> Program:
        """The program where it is x."""
        row = [(float(y) * x if self.scaled else x) if j in self.chosen else y for j, y in enumerate(self.row)]
        if self.rest is not None:
            row[self.rest] = float(sum(self.row)) - x
        table = self.program.tables[self.name]
        rows = row if self.i is None else [*table[: self.i], row, *table[self.i + 1 :]]
        return replace(self.program, tables={**self.program.tables, self.name: rows})


def one_parameter(method: Method, program: Program) -> Iterator[Parameter]:
    """Yield each coefficient that is not 0, and each row as a whole; for splittings all kicks, and all drifts."""
    parts = method.parts if isinstance(method, Splitting) else ()
    rows: list[tuple[str, int | None, Sequence[Exact]]] = []
    for name, table in program.tables.items():
        if f"{name}[" in "".join(program.lines):
            rows += [("a", i, row) for i, row in enumerate(table)] if name == "a" else [(name, None, table)]
    for name, i, exact in rows:
        there = tuple(j for j, x in enumerate(exact) if x != 0)
        row, groups = name if i is None else f"{name}[{i}]", dict[str, tuple[int, ...]]()
        called = (_PARTS if "d" in program.tables else _WEIGHTS)[name] if parts else f"{row}[{{1}}]"
        for j in there:
            place = called.format(parts[j][0] if parts else "", j)
            yield Parameter(f"{place}: {{}} instead of {exact_shown(exact[j])}", program, name, i, (j,), scaled=False)
        if len(there) == 2 and program.implicit:  # as theta and 1 - theta
            j, k = there
            words = f"{row}[{k}]: {{}} instead of {exact_shown(exact[k])}, and {row}[{j}] the rest of their sum"
            yield Parameter(words, program, name, i, (k,), False, j)
        if name == "d":
            groups = {f"all {kind}s": tuple(j for j in there if parts[j][0] == kind) for kind in ("kick", "drift")}
        for words, chosen in (groups or {f"all of {row}": there}).items():
            if len(chosen) > 1:
                yield Parameter(f"{words} times {{}}", program, name, i, chosen, scaled=True)
