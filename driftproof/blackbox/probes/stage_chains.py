"""Chains of marked stages, which show products of weights and entries, of one function or of two in the same step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import frexp, fsum
from typing import NamedTuple, TypeAlias

from driftproof.blackbox.probes.marked_stages import MarkedSteps, Setting, StageLabel, StageMarks, StageShares, spread
from driftproof.blackbox.probes.scripted_answers import CoefficientRow, NotReadable, Rounding
from driftproof.blackbox.probes.stage_solutions import UNSOLVED

# Two readings of a coefficient differ by less than this if a solver came near it.
_FAR = 2.0**-10
# A solver leaves less at a guess that is no stage; a stage has a weight, or an entry in the row of another stage.
_LEAST = 2.0**-20
# A stage, and the number of the function that is marked there.
Link: TypeAlias = tuple[StageLabel, int]
StageTable: TypeAlias = tuple[CoefficientRow, ...]


class _Variant(NamedTuple):
    setting: Setting
    amplitude: float


# Coefficients are read from the first, and the second shows what a solver leaves. Powers of two: products are exact.
_VARIANTS = (_Variant(Setting(), 1.0), _Variant(Setting(1.0, 1.0, 0.5), -1.0))


class StageChains:
    """Chains of marked stages in steps of one subject, whose stages are told apart by one set of marks."""

    def __init__(self, steps: MarkedSteps, marks: StageMarks) -> None:
        """Begin without any chain read."""
        self.steps, self.marks = steps, marks
        self.kept: list[StageLabel] = []
        self._off = 0.0

    @property
    def left(self) -> float:
        """The largest difference between two readings, and what elimination in a dozen unknowns may lose."""
        return self._off + 32 * float(self.steps.subject.format.u)

    def tables(self) -> tuple[tuple[StageTable, ...], StageTable, CoefficientRow | None]:
        """A and b of each function, and c, for the stages that count, in the order of their first calls.

        For y' = [stage i], bᵢ = y(h)/h. For x' = [stage j], y' = [stage i] x, y(h) = h² bᵢ aᵢⱼ. Longer chains lead to
        stages without a weight. Raises NotReadable.
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
        """The weight of one stage, read again from the steps as they are now."""
        return self._cleaned(self._chained([(label, 0)], 1.0))

    def demand_chain(self, a: Sequence[StageTable], b: StageTable, rounding: Rounding) -> None:
        """Raise NotReadable unless a chain through all stages at once ends where the coefficients say.

        The chain is x' = g(i), y' = g(i) x, ... at each stage i, with a different g for each number and function. Its
        end contains all products aᵢⱼ aⱼₖ ..., so that stages which were taken for one show. In the second variant the
        chain runs through y in the opposite order.
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
            pairs = zip(given, weights, strict=False)
            own = [x * fsum(share * g[label, here] for label, share in known) for x, g in pairs]
            return own[::-1] if backward else own

        run = self.steps.run(self.marks, setting, slopes)
        seen = run.result[len(self.marks.hands) :][0 if backward else -1] - setting.start
        at, largest = [1.0] * len(kept), max(1.0, *(fsum(map(abs, row)) for rows in (*a, b) for row in rows))
        for link, row in enumerate(weights):
            pulled = [[row[label, p] * x for label, x in zip(kept, at, strict=True)] for p in parts]
            # The rows of A of each function, and its weights at the end.
            tables = a if link < count - 1 else [(x,) for x in b]
            moves = [[fsum(x * k for x, k in zip(r, pulled[p], strict=True)) for r in tables[p]] for p in parts]
            at = [setting.h * fsum(several) for several in zip(*moves, strict=True)]
        # Each factor, at most 2 times a row sum of A, is off by the error of the coefficients.
        allowed = count * (2 * largest) ** count * rounding.of(1.0) + UNSOLVED * max(1.0, abs(at[0]))
        if not abs(seen - at[0]) <= allowed:
            raise NotReadable(
                f"with its stages marked, a chain of {count} of them gives {seen:.6g} where the coefficients read "
                f"say {at[0]:.6g}: the step is not made of these stages"
            )

    def _chained(self, chain: Sequence[Link], product: float) -> float:
        """The factor that the last link of a chain i, j, ..., k adds to the product bᵢ aᵢⱼ ... of the others."""
        seen = [self._one_reading(variant, chain, product) for variant in _VARIANTS]
        off = abs(seen[0] - seen[1])
        if off > _FAR * max(1.0, *map(abs, seen)):
            raise NotReadable(
                f"with its stages marked, a coefficient is {seen[0]:.6g}, and {seen[1]:.6g} with another start, time, "
                "h and size: a solver that stops too early, or a step not made of stages"
            )
        self._off = max(self._off, off)
        return seen[0]

    def _one_reading(self, variant: _Variant, chain: Sequence[Link], product: float) -> float:
        links, clocks = len(chain), len(self.marks.hands)
        if links + clocks > self.steps.size:
            raise NotReadable(f"a chain of {links} stages needs more than the {self.steps.size} components it takes")
        # The amplitude brings the result to size 1, because a solver's tolerance is usually absolute.
        size = variant.amplitude * 2.0 ** -frexp(product)[1]
        marked = chain[::-1]

        def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
            given, here = [size, *moved[: links - 1]], self.steps.part
            pairs = zip(given, marked, strict=True)
            own = [x * shares.get(label, 0.0) if part == here else 0.0 for x, (label, part) in pairs]
            return [*own, *[0.0] * (len(moved) - links)]

        result = self.steps.run(self.marks, variant.setting, slopes, size=links).result
        start, _, h = variant.setting
        return float((result[clocks + links - 1] - start) / (size * product * h**links))

    def _cleaned(self, x: float) -> float:
        return x if abs(x) > Rounding(self.steps.subject.format, 1, 4 * self.left).of(1.0) else 0.0
