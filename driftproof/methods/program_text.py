"""What the program text of any step is made of: sums from the left, named coefficients, kicks, drifts and stages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Nystrom, Splitting


class ProgramText:
    """Lines of a step and the coefficients that they name, as they come up.

    `compensated`: the additions that advance the state carry along what they round off, under names e_ and the
    component's; `tests/witnesses/compensated.py` derives what that is good for.
    """

    def __init__(self, *, compensated: bool) -> None:
        """Start with neither."""
        self.compensated = compensated
        self.lines: list[str] = []
        self.coefficients: dict[str, Exact] = {}

    def named(self, name: str, start: str, moved: str) -> str:
        """A name for start + what it moved by: a new one, or that of the start if it did not."""
        if not moved:
            return start
        self.lines.append(f"{name} = {start}{moved}")
        return name

    def sum(self, times: str, row: str, weights: Sequence[Exact], slopes: Mapping[int, str]) -> str:
        """The text of times (Σ wⱼ kⱼ), from the left; nothing where all weights are zero."""
        text = ""
        for j, weight in enumerate(weights):
            if weight != 0:
                sign, factor = self._factor(f"{row}_{j + 1}", weight)
                text += f"{f' {sign} ' if text else sign.removeprefix('+')}{factor}{slopes[j]}"
        return f"{times} {f'({text})' if ' ' in text or '-' in text else text}" if text else ""

    def step(self, name: str, c: Exact) -> str:
        """The text + (c h), or - h; nothing where c = 0."""
        if c == 0:
            return ""
        sign, factor = self._factor(name, c)
        return f" {sign} ({factor}h)" if factor else f" {sign} h"

    def advance(self, x: str, new: str, old: str, moved: str) -> None:
        """The text new = old + what it moves by; compensated, with what was lost before, and what is lost now kept.

        That is Knuth's exact sum (muller-2018, 4.3.2): six additions without a branch, whichever summand is larger.
        """
        if not self.compensated:
            self.lines.append(f"{new} = {old}{moved}")
            return
        self.lines += [
            f"d = e_{x}{moved}",
            f"{new} = {old} + d",
            f"g = {new} - {old}",
            f"e_{x} = ({old} - ({new} - g)) + (d - g)",
        ]

    def _factor(self, name: str, c: Exact) -> tuple[str, str]:
        """A sign, and the coefficient with its sign for product: ("+", "name * "), or nothing to multiply by."""
        if c in (1, -1):
            return ("+" if c == 1 else "-"), ""
        self.coefficients[name] = c
        return "+", f"{name} * "


def used_stages(a: Sequence[Sequence[Exact]], weights: Iterable[Sequence[Exact]]) -> list[int]:
    """The stages that the result depends on: those with a weight, and those that such stages are formed of."""
    open_rows, used = list(weights), set[int]()
    while open_rows:
        found = {j for j, x in enumerate(open_rows.pop()) if x != 0} - used
        used |= found
        open_rows += [a[j] for j in found]
    return sorted(used)


def indented(lines: Iterable[str]) -> list[str]:
    """The lines, four columns further in."""
    return [f"    {line}" for line in lines]


def maker_text(arguments: Iterable[str], name: str, lines: Iterable[str]) -> str:
    """The text of make(arguments...), which returns the function `name` that the lines define."""
    return "\n".join([f"def make({', '.join(arguments)}):", *indented([*lines, f"return {name}"]), ""])


def looping_maker_text(arguments: Sequence[str], head: str, lines: Iterable[str]) -> str:
    """The same of a function run that loops: it first takes the arguments of make over, into names that are faster."""
    name = lambda x: f"of_{x}"
    taken = [f"{', '.join(arguments)}, = {', '.join(map(name, arguments))},"] if arguments else []
    return maker_text(map(name, arguments), "run", [f"def run({head}):", *indented([*taken, *lines])])


def maker(text: str, key: str, functions: Mapping[str, Callable[..., Any]] | None = None) -> Callable[..., Any]:
    """The function make of such a text, in which `functions` are known by name; `key` stands in tracebacks.

    Only for text of our own writing, which is names, operators and integers: it is executed.
    """
    namespace: dict[str, Any] = dict(functions or {})
    exec(compile(text, f"<{key}>", "exec"), namespace)
    make: Callable[..., Any] = namespace["make"]
    return make


@dataclass(frozen=True)
class SecondOrder:
    """q' = v, v' = F(t, q) by names: `accelerations` writes F, given the names that t and the positions have now.

    `new` is what the names of a new state end with. `timed`: F reads t; otherwise times of stages are left out.
    """

    positions: Sequence[str]
    velocities: Sequence[str]
    accelerations: Callable[[Mapping[str, str]], Sequence[str]]
    new: str
    timed: bool = False

    def write(self, method: Splitting | Nystrom, text: ProgramText) -> None:
        """The lines of one step, after which the names of the new state are known. The method is explicit.

        F is written at positions only, and once for each kick or stage.
        """
        if isinstance(method, Splitting):
            self._splitting(method, text)
        else:
            self._nystrom(method, text)

    def _splitting(self, method: Splitting, text: ProgramText) -> None:
        """Kicks and drifts, each from what the last one left; time passes with the drifts."""
        latest = {x: x for x in (*self.positions, *self.velocities, "t")}
        drifted: Exact = Fraction(0)
        for i, (kind, c) in enumerate(method.parts, 1):
            if c == 0:
                continue
            if kind == "kick":
                latest["t"] = self._time(text, i, f"s{i}", drifted)
                moved, rates = self.velocities, self.accelerations(latest)
            else:
                moved, rates = self.positions, [latest[v] for v in self.velocities]
                drifted = drifted + c
            for x, rate in zip(moved, rates, strict=True):
                text.advance(x, f"{x}_{i}", latest[x], f"{text.step(f'c{i}', c)} * {rate}")
                latest[x] = f"{x}_{i}"
        text.lines += [f"{x}{self.new} = {latest[x]}" for x in (*self.positions, *self.velocities)]

    def _nystrom(self, method: Nystrom, text: ProgramText) -> None:
        """Forces kᵢ at q + cᵢ h v + h² Σ aᵢⱼ kⱼ, then the two sums."""
        pairs = list(zip(self.positions, self.velocities, strict=True))
        forces: dict[str, dict[int, str]] = {q: {} for q in self.positions}
        for i in used_stages(method.a, [method.b_position, method.b_velocity]):
            node = method.c[i]
            names = {"t": self._time(text, i + 1, f"c{i + 1}", node)}
            for q, v in pairs:
                drift = text.step(f"c{i + 1}", node)
                moved = f"{drift} * {v}" if drift else ""
                moved += text.sum(" + h * h *", f"a{i + 1}", method.a[i], forces[q])
                names[q] = text.named(f"{q}_{i + 1}", q, moved)
            for (q, v), force in zip(pairs, self.accelerations(names), strict=True):
                forces[q][i] = f"k{i + 1}_{v}"
                text.lines.append(f"{forces[q][i]} = {force}")
        for q, v in pairs:
            drift = f" + h * {v}{text.sum(' + h * h *', 'p', method.b_position, forces[q])}"
            text.advance(q, f"{q}{self.new}", q, drift)
        for q, v in pairs:
            text.advance(v, f"{v}{self.new}", v, text.sum(" + h *", "b", method.b_velocity, forces[q]))

    def _time(self, text: ProgramText, i: int, name: str, node: Exact) -> str:
        """The name of t + c h, which is written where F reads it."""
        return text.named(f"t_{i}", "t", text.step(name, node)) if self.timed else "t"
