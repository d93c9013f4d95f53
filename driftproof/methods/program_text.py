"""Building blocks of the program text of a step: sums from the left, named coefficients, kicks, drifts and stages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Nystrom, Splitting


class ProgramText:
    """The lines of a step and the coefficients that they name, in the order in which they are written.

    In a `compensated` text the additions that advance a component y0 also keep their rounding error, as e_y0;
    `tests/witnesses/compensated.py` derives what is gained.
    """

    def __init__(self, *, compensated: bool) -> None:
        """Start without lines and coefficients."""
        self.compensated = compensated
        self.lines: list[str] = []
        self.coefficients: dict[str, Exact] = {}

    def named(self, name: str, start: str, moved: str) -> str:
        """The name of start + moved: `name`, which a new line defines, or `start` if nothing is added."""
        if not moved:
            return start
        self.lines.append(f"{name} = {start}{moved}")
        return name

    def sum(self, times: str, row: str, weights: Sequence[Exact], slopes: Mapping[int, str]) -> str:
        """The text of times (Σ wⱼ kⱼ), summed from the left; "" if all weights are zero."""
        text = ""
        for j, weight in enumerate(weights):
            if weight != 0:
                sign, factor = self._factor(f"{row}_{j + 1}", weight)
                text += f"{f' {sign} ' if text else sign.removeprefix('+')}{factor}{slopes[j]}"
        return f"{times} {f'({text})' if ' ' in text or '-' in text else text}" if text else ""

    def step(self, name: str, c: Exact) -> str:
        """The text of + c h, such as " + (c2 * h)" or " - h"; "" if c = 0."""
        if c == 0:
            return ""
        sign, factor = self._factor(name, c)
        return f" {sign} ({factor}h)" if factor else f" {sign} h"

    def advance(self, x: str, new: str, old: str, moved: str) -> None:
        """Write new = old + moved; if compensated, also add the last rounding error and keep the new one.

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
        """The sign and the factor of a product with c: ("+", "name * "), or a sign and "" if c is 1 or -1."""
        if c in (1, -1):
            return ("+" if c == 1 else "-"), ""
        self.coefficients[name] = c
        return "+", f"{name} * "


def used_stages(a: Sequence[Sequence[Exact]], weights: Iterable[Sequence[Exact]]) -> list[int]:
    """The stages on which the result depends: those with a nonzero weight, and those that they use in turn."""
    open_rows, used = list(weights), set[int]()
    while open_rows:
        found = {j for j, x in enumerate(open_rows.pop()) if x != 0} - used
        used |= found
        open_rows += [a[j] for j in found]
    return sorted(used)


def indented(lines: Iterable[str]) -> list[str]:
    """The lines, indented by four more columns."""
    return [f"    {line}" for line in lines]


def maker_text(arguments: Iterable[str], name: str, lines: Iterable[str]) -> str:
    """The text of make(arguments...), which returns the function `name` that the lines define."""
    return "\n".join([f"def make({', '.join(arguments)}):", *indented([*lines, f"return {name}"]), ""])


def looping_maker_text(arguments: Sequence[str], head: str, lines: Iterable[str]) -> str:
    """Like `maker_text`, for a function run that loops: it first copies the arguments of make to faster local names."""
    name = lambda x: f"of_{x}"
    taken = [f"{', '.join(arguments)}, = {', '.join(map(name, arguments))},"] if arguments else []
    return maker_text(map(name, arguments), "run", [f"def run({head}):", *indented([*taken, *lines])])


def maker(text: str, key: str, functions: Mapping[str, Callable[..., Any]] | None = None) -> Callable[..., Any]:
    """Execute such a text and return its function make; it knows `functions` by name, and tracebacks show `key`.

    Only for text that driftproof has written, of names, operators and integers.
    """
    namespace: dict[str, Any] = dict(functions or {})
    exec(compile(text, f"<{key}>", "exec"), namespace)
    make: Callable[..., Any] = namespace["make"]
    return make


@dataclass(frozen=True)
class SecondOrder:
    """The system q' = v, v' = F(t, q) by the names of its components.

    `accelerations` writes F, given the current names of t and the positions. The names of the new state end in `new`.
    `timed` says that F reads t; otherwise the times of stages are left out.
    """

    positions: Sequence[str]
    velocities: Sequence[str]
    accelerations: Callable[[Mapping[str, str]], Sequence[str]]
    new: str
    timed: bool = False

    def write(self, method: Splitting | Nystrom, text: ProgramText) -> None:
        """Write one step of an explicit method, which defines the names of the new state.

        F is evaluated at positions only, once for each kick or stage.
        """
        if isinstance(method, Splitting):
            self._splitting(method, text)
        else:
            self._nystrom(method, text)

    def _splitting(self, method: Splitting, text: ProgramText) -> None:
        """Write the kicks and drifts one after the other; time advances with the drifts."""
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
        """Write the forces kᵢ at q + cᵢ h v + h² Σ aᵢⱼ kⱼ, then the two sums."""
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
        """The name of t + c h, which is only written if F reads it."""
        return text.named(f"t_{i}", "t", text.step(name, node)) if self.timed else "t"
