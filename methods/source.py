"""The step of a method as program text: straight-line Python, zeros dropped, coefficients bound to names.

This one text is what floats run, what a compiler is given, what polynomials trace and what rounding bounds are derived
from. It holds no number and no branch on a value, so it runs over whatever the coefficients are lifted into.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from methods.number_field import Exact
from methods.schemes import Method, MethodError, Nystrom, RungeKutta, Splitting

FORCE = "force({})"


@dataclass(frozen=True)
class Source:
    """The lines of a step, which end with q1 and v1 known, and the coefficients that they name.

    The lines read q, v, h and the names, and write the force as they were told to.
    """

    lines: tuple[str, ...]
    coefficients: tuple[tuple[str, Exact], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the coefficients, in the order in which they come up."""
        return tuple(name for name, _ in self.coefficients)

    def run(self) -> str:
        """The text of make(coefficients...) -> run(q, v, h, steps) -> (q, v): so many steps in one loop."""
        loop = ["for _ in range(steps):", *_indented([*self.lines, "q, v = q1, v1"])]
        return self._made("run", ["def run(q, v, h, steps):", *_indented([*loop, "return q, v"])])

    def step(self) -> str:
        """The text of make(coefficients...) -> step(force, q, v, h) -> (q1, v1)."""
        return self._made("step", ["def step(force, q, v, h):", *_indented([*self.lines, "return q1, v1"])])

    def _made(self, name: str, lines: list[str]) -> str:
        return "\n".join([f"def make({', '.join(self.names)}):", *_indented([*lines, f"return {name}"]), ""])


def step_source(method: Method, force: str = FORCE) -> Source:
    """The step of `method` for q' = v, v' = F(q), with F(x) written as `force.format(x)`, x always a name.

    Sums are taken from the left, h multiplies a sum once, and a coefficient of 1 or -1 is not multiplied by: that is
    exact in every arithmetic. A stage that nothing uses is left out. Raises MethodError for an implicit method, whose
    stages are equations rather than formulas.
    """
    writer = _Writer(force)
    if isinstance(method, Splitting):
        writer.splitting(method)
    elif method.explicit and isinstance(method, RungeKutta):
        writer.runge_kutta(method)
    elif method.explicit and isinstance(method, Nystrom):
        writer.nystrom(method)
    else:
        raise MethodError(f"{method.key} is implicit: its stages are equations, so it has no explicit step")
    return Source(tuple(writer.lines), tuple(writer.coefficients.items()))


class _Writer:
    """Lines and coefficients, as they come up."""

    def __init__(self, force: str) -> None:
        self.force = force
        self.lines: list[str] = []
        self.coefficients: dict[str, Exact] = {}

    def runge_kutta(self, method: RungeKutta) -> None:
        """Stages qᵢ with slopes (kᵢ_q, kᵢ_v), then the sums of both components."""
        slopes: dict[str, dict[int, str]] = {"q": {}, "v": {}}
        for i in _used(method.a, [method.b]):
            moved = {x: self._sum(" + h *", f"a{i + 1}", method.a[i], slopes[x]) for x in slopes}
            slopes["q"][i] = self._named(f"k{i + 1}_q", "v", moved["v"])
            place = self._named(f"q_{i + 1}", "q", moved["q"])
            slopes["v"][i] = f"k{i + 1}_v"
            self.lines.append(f"k{i + 1}_v = {self.force.format(place)}")
        self.lines += [f"{x}1 = {x}{self._sum(' + h *', 'b', method.b, slopes[x])}" for x in slopes]

    def splitting(self, method: Splitting) -> None:
        """Kicks and drifts, each from what the last one left."""
        latest, moves = {"q": "q", "v": "v"}, {"kick": "v", "drift": "q"}
        for i, (kind, c) in enumerate(method.parts, 1):
            if c == 0:
                continue
            moved = moves[kind]
            rate = self.force.format(latest["q"]) if kind == "kick" else latest["v"]
            self.lines.append(f"{moved}_{i} = {latest[moved]}{self._step(f'c{i}', c)} * {rate}")
            latest[moved] = f"{moved}_{i}"
        self.lines += [f"{x}1 = {name}" for x, name in latest.items()]

    def nystrom(self, method: Nystrom) -> None:
        """Forces kᵢ at q + cᵢ h v + h² Σ aᵢⱼ kⱼ, then the two sums."""
        forces: dict[int, str] = {}
        for i in _used(method.a, [method.b_position, method.b_velocity]):
            node = method.c[i]
            moved = f"{self._step(f'c{i + 1}', node)} * v" if node != 0 else ""
            moved += self._sum(" + h * h *", f"a{i + 1}", method.a[i], forces)
            forces[i] = f"k{i + 1}"
            self.lines.append(f"{forces[i]} = {self.force.format(self._named(f'q_{i + 1}', 'q', moved))}")
        self.lines.append(f"q1 = q + h * v{self._sum(' + h * h *', 'p', method.b_position, forces)}")
        self.lines.append(f"v1 = v{self._sum(' + h *', 'b', method.b_velocity, forces)}")

    def _named(self, name: str, start: str, moved: str) -> str:
        """A name for start + what it moved by: a new one, or that of the start if it did not."""
        if not moved:
            return start
        self.lines.append(f"{name} = {start}{moved}")
        return name

    def _sum(self, times: str, row: str, weights: Sequence[Exact], slopes: Mapping[int, str]) -> str:
        """The text of times (Σ wⱼ kⱼ), from the left; nothing where all weights are zero."""
        text = ""
        for j, weight in enumerate(weights):
            if weight != 0:
                sign, factor = self._factor(f"{row}_{j + 1}", weight)
                text += f"{f' {sign} ' if text else sign.removeprefix('+')}{factor}{slopes[j]}"
        return f"{times} {f'({text})' if ' ' in text or '-' in text else text}" if text else ""

    def _step(self, name: str, c: Exact) -> str:
        """The text + (c h), or - h."""
        sign, factor = self._factor(name, c)
        return f" {sign} ({factor}h)" if factor else f" {sign} h"

    def _factor(self, name: str, c: Exact) -> tuple[str, str]:
        """A sign, and the coefficient with its sign for product: ("+", "name * "), or nothing to multiply by."""
        if c in (1, -1):
            return ("+" if c == 1 else "-"), ""
        self.coefficients[name] = c
        return "+", f"{name} * "


def _used(a: Sequence[Sequence[Exact]], weights: Iterable[Sequence[Exact]]) -> list[int]:
    """The stages that the result depends on: those with a weight, and those that such stages are formed of."""
    open_rows, used = list(weights), set[int]()
    while open_rows:
        found = {j for j, x in enumerate(open_rows.pop()) if x != 0} - used
        used |= found
        open_rows += [a[j] for j in found]
    return sorted(used)


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"    {line}" for line in lines]
