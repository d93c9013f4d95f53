"""Chains of marked stages: products of weights and entries, of one function or of two that are asked in one step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import frexp, fsum
from typing import NamedTuple, TypeAlias

from driftproof.blackbox.probes.marked_stages import (
    MarkedSteps,
    Setting,
    StageLabel,
    StageMarks,
    StageShares,
    spread,
)
from driftproof.blackbox.probes.scripted_answers import CoefficientRow, NotReadable, Rounding
from driftproof.blackbox.probes.stage_solutions import UNSOLVED

# What is read once more differs by less where it is a coefficient that a solver has come near to.
_FAR = 2.0**-10
# Less than this is what a solver leaves at a guess that is no stage: a stage has a weight, or a place in one that has.
_LEAST = 2.0**-20
# A stage, and which of the functions is marked there.
Link: TypeAlias = tuple[StageLabel, int]
StageTable: TypeAlias = tuple[CoefficientRow, ...]


class _Variant(NamedTuple):
    setting: Setting
    amplitude: float


# Read from the first; another start, time, h and size show what the solver leaves. Powers of two: products are exact.
_VARIANTS = (_Variant(Setting(), 1.0), _Variant(Setting(1.0, 1.0, 0.5), -1.0))


class StageChains:
    """Chains of marked stages in steps of one subject, with one way to tell its stages apart."""

    def __init__(self, steps: MarkedSteps, marks: StageMarks) -> None:
        """Nothing asked yet."""
        self.steps, self.marks = steps, marks
        self.kept: list[StageLabel] = []
        self._off = 0.0

    @property
    def left(self) -> float:
        """What the two readings differ by at most; and what elimination in a dozen unknowns may lose."""
        return self._off + 32 * float(self.steps.subject.format.u)

    def tables(self) -> tuple[tuple[StageTable, ...], StageTable, CoefficientRow | None]:
        """A and b for each function, and c: of the stages that count, by their first calls. Raises NotReadable.

        bᵢ = y(h)/h for y' = [stage i]; and with x' = [stage j], y' = [stage i] x it is y(h) = h² bᵢ aᵢⱼ, longer chains
        lead to stages without a weight.
        """
        labels, parts = self.marks.labels, range(self.steps.parts)
        weights = {(label, part): self._chained([(label, part)], 1.0) for label in labels for part in parts}
        chains: dict[StageLabel, tuple[list[Link], float]] = {}
        for link, weight in weights.items():
            if abs(weight) > _LEAST:
                chains.setdefault(link[0], ([link], weight))
        if not chains:
            raise NotReadable("no stage of it has a weight")
        rows: dict[StageLabel, Mapping[Link, float]] = {}
        while open_ones := [label for label in chains if label not in rows]:
            chain, product = chains[open_ones[0]]
            row = {link: self._chained([*chain, link], product) for link in weights}
            rows[open_ones[0]] = row
            for link, x in row.items():
                if abs(x) > _LEAST:
                    chains.setdefault(link[0], ([*chain, link], product * x))
        self.kept = kept = [label for label in labels if label in rows]
        self.marks = self.marks.only(kept)
        a = tuple(tuple(tuple(self._cleaned(rows[i][j, part]) for j in kept) for i in kept) for part in parts)
        b = tuple(tuple(self._cleaned(weights[i, part]) for i in kept) for part in parts)
        return a, b, tuple(self.marks.nodes[label[0]] for label in kept) if self.steps.timed else None

    def weight(self, label: StageLabel) -> float:
        """That of one stage, as steps come out now."""
        return self._cleaned(self._chained([(label, 0)], 1.0))

    def demand_chain(self, a: Sequence[StageTable], b: StageTable, rounding: Rounding) -> None:
        """Raises NotReadable unless a chain through all stages at once goes as the coefficients say.

        x' = g(i), y' = g(i) x, ... at each stage i, with other g for each number and function: all aᵢⱼ aⱼₖ ... are in
        its end, so that stages which were taken for one show. In the second variant the chain runs through y from its
        other end.
        """
        for setting, size in _VARIANTS:
            self._demand(a, b, rounding, setting, backward=size == -1.0)

    def _demand(
        self, a: Sequence[StageTable], b: StageTable, rounding: Rounding, setting: Setting, *, backward: bool
    ) -> None:
        kept, parts = self.kept, range(self.steps.parts)
        count = self.steps.size - len(self.marks.hands)
        weights = [
            {(label, p): spread((3 * i + 1 + p) * (link + 1)) for i, label in enumerate(kept) for p in parts}
            for link in range(count)
        ]

        def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
            given = [1.0, *(moved[::-1] if backward else moved)]
            known = [(label, share) for label, share in shares.items() if label in kept]
            here = self.steps.part
            own = [
                x * fsum(share * g[label, here] for label, share in known) for x, g in zip(given, weights, strict=False)
            ]
            return own[::-1] if backward else own

        run = self.steps.run(self.marks, setting, slopes)
        seen = run.result[len(self.marks.hands) :][0 if backward else -1] - setting.start
        at, largest = [1.0] * len(kept), max(1.0, *(fsum(map(abs, row)) for rows in (*a, b) for row in rows))
        for link, row in enumerate(weights):
            pulled = [[row[label, p] * x for label, x in zip(kept, at, strict=True)] for p in parts]
            # Of each function the rows of its A, at the end its weights.
            tables = a if link < count - 1 else [(x,) for x in b]
            moves = [[fsum(x * k for x, k in zip(r, pulled[p], strict=True)) for r in tables[p]] for p in parts]
            at = [setting.h * fsum(several) for several in zip(*moves, strict=True)]
        # Each of the factors, which are up to 2 and sums of A's rows, is off by what the coefficients are off by.
        allowed = count * (2 * largest) ** count * rounding.of(1.0) + UNSOLVED * max(1.0, abs(at[0]))
        if not abs(seen - at[0]) <= allowed:
            raise NotReadable(
                f"with its stages marked, a chain of {count} of them gives {seen:.6g} where the coefficients read "
                f"say {at[0]:.6g}: the step is not made of these stages"
            )

    def _chained(self, chain: Sequence[Link], product: float) -> float:
        """What the last link of a chain i, j, ..., k adds to the product bᵢ aᵢⱼ ... of the others, as a factor."""
        seen = [self._once(variant, chain, product) for variant in _VARIANTS]
        off = abs(seen[0] - seen[1])
        if off > _FAR * max(1.0, *map(abs, seen)):
            raise NotReadable(
                f"with its stages marked, a coefficient is {seen[0]:.6g}, and {seen[1]:.6g} with another start, time, "
                "h and size: a solver that stops too early, or a step not made of stages"
            )
        self._off = max(self._off, off)
        return seen[0]

    def _once(self, variant: _Variant, chain: Sequence[Link], product: float) -> float:
        links, clocks = len(chain), len(self.marks.hands)
        if links + clocks > self.steps.size:
            raise NotReadable(f"a chain of {links} stages needs more than the {self.steps.size} components it takes")
        # So large that what comes out is of size 1: a solver's tolerance is absolute as a rule.
        size = variant.amplitude * 2.0 ** -frexp(product)[1]
        marked = chain[::-1]

        def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
            given, here = [size, *moved[: links - 1]], self.steps.part
            own = [
                x * shares.get(label, 0.0) if part == here else 0.0
                for x, (label, part) in zip(given, marked, strict=True)
            ]
            return [*own, *[0.0] * (len(moved) - links)]

        result = self.steps.run(self.marks, variant.setting, slopes, size=links).result
        start, _, h = variant.setting
        return float((result[clocks + links - 1] - start) / (size * product * h**links))

    def _cleaned(self, x: float) -> float:
        return x if abs(x) > Rounding(self.steps.subject.format, 1, 4 * self.left).of(1.0) else 0.0
