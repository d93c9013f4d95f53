"""Splittings and Nyström methods for q'' = F(t, q) of any number of components, as straight-line program text."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from driftproof.methods.number_field import Exact
from driftproof.methods.program_text import ProgramText, used_stages
from driftproof.methods.schemes import Nystrom, Splitting


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
                moved = f"{text.step(f'c{i + 1}', node)} * {v}" if node != 0 else ""
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
        if not self.timed or node == 0:
            return "t"
        return text.named(f"t_{i}", "t", text.step(name, node))
