"""The step of a method as program text: straight-line Python, zeros dropped, coefficients bound to names.

This one text is what floats run, what a compiler is given, what polynomials trace and what rounding bounds are derived
from. It holds no number and no branch on a value, so it runs over whatever the coefficients are lifted into.
"""

from __future__ import annotations

from dataclasses import dataclass

from methods.number_field import Exact
from methods.program_text import ProgramText, indented, looping_maker_text, maker_text, used_stages
from methods.schemes import Method, MethodError, Nystrom, RungeKutta, Splitting

FORCE = "force({})"


@dataclass(frozen=True)
class Source:
    """The lines of a step, which end with q1 and v1 known, and the coefficients that they name.

    The lines read q, v, h and the names, and write the force as they were told to. Those of a compensated step also
    read and write e_q and e_v, what the additions so far have lost, and only a run of many can be made of them.
    """

    lines: tuple[str, ...]
    coefficients: tuple[tuple[str, Exact], ...]
    compensated: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the coefficients, in the order in which they come up."""
        return tuple(name for name, _ in self.coefficients)

    def run(self) -> str:
        """The text of make(coefficients...) -> run(q, v, h, steps) -> (q, v): so many steps in one loop."""
        loop = ["for _ in range(steps):", *indented([*self.lines, "q, v = q1, v1"])]
        start = ["e_q, e_v = q - q, v - v"] if self.compensated else []
        return looping_maker_text(self.names, "q, v, h, steps", [*start, *loop, "return q, v"])

    def step(self) -> str:
        """The text of make(coefficients...) -> step(force, q, v, h) -> (q1, v1)."""
        lines = ["def step(force, q, v, h):", *indented([*self.lines, "return q1, v1"])]
        return maker_text(self.names, "step", lines)


def step_source(method: Method, force: str = FORCE, *, compensated: bool = False) -> Source:
    """The step of `method` for q' = v, v' = F(q), with F(x) written as `force.format(x)`, x always a name.

    Sums are taken from the left, h multiplies a sum once, and a coefficient of 1 or -1 is not multiplied by: that is
    exact in every arithmetic. A stage that nothing uses is left out. `compensated`: the additions that advance the
    state carry along what they round off; `numeric.compensated` derives what that is good for. Raises MethodError for
    an implicit method, whose stages are equations rather than formulas.
    """
    writer = _Writer(force, compensated=compensated)
    if isinstance(method, Splitting):
        writer.splitting(method)
    elif method.explicit and isinstance(method, RungeKutta):
        writer.runge_kutta(method)
    elif method.explicit and isinstance(method, Nystrom):
        writer.nystrom(method)
    else:
        raise MethodError(f"{method.key} is implicit: its stages are equations, so it has no explicit step")
    return Source(tuple(writer.lines), tuple(writer.coefficients.items()), compensated)


class _Writer(ProgramText):
    """The three families."""

    def __init__(self, force: str, *, compensated: bool) -> None:
        super().__init__()
        self.force, self.compensated = force, compensated

    def runge_kutta(self, method: RungeKutta) -> None:
        """Stages qᵢ with slopes (kᵢ_q, kᵢ_v), then the sums of both components."""
        slopes: dict[str, dict[int, str]] = {"q": {}, "v": {}}
        for i in used_stages(method.a, [method.b]):
            moved = {x: self.sum(" + h *", f"a{i + 1}", method.a[i], slopes[x]) for x in slopes}
            slopes["q"][i] = self.named(f"k{i + 1}_q", "v", moved["v"])
            place = self.named(f"q_{i + 1}", "q", moved["q"])
            slopes["v"][i] = f"k{i + 1}_v"
            self.lines.append(f"k{i + 1}_v = {self.force.format(place)}")
        for x in slopes:
            self.advance(x, f"{x}1", x, self.sum(" + h *", "b", method.b, slopes[x]))

    def splitting(self, method: Splitting) -> None:
        """Kicks and drifts, each from what the last one left."""
        latest, moves = {"q": "q", "v": "v"}, {"kick": "v", "drift": "q"}
        for i, (kind, c) in enumerate(method.parts, 1):
            if c == 0:
                continue
            moved = moves[kind]
            rate = self.force.format(latest["q"]) if kind == "kick" else latest["v"]
            self.advance(moved, f"{moved}_{i}", latest[moved], f"{self.step(f'c{i}', c)} * {rate}")
            latest[moved] = f"{moved}_{i}"
        self.lines += [f"{x}1 = {name}" for x, name in latest.items()]

    def nystrom(self, method: Nystrom) -> None:
        """Forces kᵢ at q + cᵢ h v + h² Σ aᵢⱼ kⱼ, then the two sums."""
        forces: dict[int, str] = {}
        for i in used_stages(method.a, [method.b_position, method.b_velocity]):
            node = method.c[i]
            moved = f"{self.step(f'c{i + 1}', node)} * v" if node != 0 else ""
            moved += self.sum(" + h * h *", f"a{i + 1}", method.a[i], forces)
            forces[i] = f"k{i + 1}"
            self.lines.append(f"{forces[i]} = {self.force.format(self.named(f'q_{i + 1}', 'q', moved))}")
        self.advance("q", "q1", "q", f" + h * v{self.sum(' + h * h *', 'p', method.b_position, forces)}")
        self.advance("v", "v1", "v", self.sum(" + h *", "b", method.b_velocity, forces))

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
