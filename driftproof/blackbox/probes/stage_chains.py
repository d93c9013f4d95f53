"""Chains of marked stages, which show products of weights and entries, of one function or of two in the same step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import frexp, fsum
from typing import TypeAlias

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


# Settings with amplitudes. Coefficients are read from the first, and the second shows what a solver leaves. Powers of
# two: products are exact.
_VARIANTS = ((Setting(), 1.0), (Setting(1.0, 1.0, 0.5), -1.0))


class StageChains:
    """Chains of marked stages in steps of one subject, whose stages are told apart by one set of marks."""

    def __init__(self, steps: MarkedSteps, marks: StageMarks) -> None:
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

    def require_chain(self, a: Sequence[StageTable], b: StageTable, rounding: Rounding) -> None:
        """Raise NotReadable unless a chain through all stages at once ends where the coefficients say.

        The chain is x' = g(i), y' = g(i) x, ... at each stage i, with a different g for each number and function. Its
        end contains all products aᵢⱼ aⱼₖ ..., so that stages which were taken for one show. In the second variant the
        chain runs through y in the opposite order.
        """
        count, largest = len(self._factors), max(1.0, *(fsum(map(abs, row)) for rows in (*a, b) for row in rows))
        for (setting, _), order in zip(_VARIANTS, (1, -1), strict=True):
            seen, expected = self._end_of_chain(setting, order), self._expected_end(a, b, setting.h)
            # Each factor, at most 2 times a row sum of A, is off by the error of the coefficients.
            allowed = count * (2 * largest) ** count * rounding.of(1.0) + UNSOLVED * max(1.0, abs(expected))
            if not abs(seen - expected) <= allowed:
                raise NotReadable(
                    f"with its stages marked, a chain of {count} of them gives {seen:.6g} where the coefficients read "
                    f"say {expected:.6g}: the step is not made of these stages"
                )

    @property
    def _factors(self) -> list[dict[Link, float]]:
        """The g of each number of the longest chain: a factor for each stage and function."""
        stages, parts = [*enumerate(self.kept)], range(self.steps.parts)
        return [
            {(label, part): spread((3 * i + 1 + part) * (link + 1)) for i, label in stages for part in parts}
            for link in range(self.steps.size - len(self.marks.hands))
        ]

    def _end_of_chain(self, setting: Setting, order: int) -> float:
        """The end of the longest chain as a step shows it; if `order` is -1, the chain begins with the last number."""
        factors = self._factors

        def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
            known = [(label, share) for label, share in shares.items() if label in self.kept]
            here, given = self.steps.part, [1.0, *moved[::order]]
            pairs = zip(given, factors, strict=False)
            return [x * fsum(share * g[label, here] for label, share in known) for x, g in pairs][::order]

        result = self.steps.run(self.marks, setting, slopes).result
        return result[len(self.marks.hands) :][::order][-1] - setting.start

    def _expected_end(self, a: Sequence[StageTable], b: StageTable, h: float) -> float:
        """The end of the longest chain by the coefficients: bᵢ g(i) h aᵢⱼ g(j) h ..., summed over all stages."""
        *inner, last = self._factors
        at = [1.0] * len(self.kept)
        for factors, tables in [*((each, a) for each in inner), (last, [(row,) for row in b])]:
            pulled = [[factors[i, part] * x for i, x in zip(self.kept, at, strict=True)] for part in range(len(tables))]
            moves = [
                [fsum(x * k for x, k in zip(row, pull, strict=True)) for row in rows]
                for rows, pull in zip(tables, pulled, strict=True)
            ]
            at = [h * fsum(several) for several in zip(*moves, strict=True)]
        return at[0]

    def _chained(self, chain: Sequence[Link], product: float) -> float:
        """The factor that the last link of a chain i, j, ..., k adds to the product bᵢ aᵢⱼ ... of the others."""
        seen = [self._one_reading(*variant, chain, product) for variant in _VARIANTS]
        off = abs(seen[0] - seen[1])
        if off > _FAR * max(1.0, *map(abs, seen)):
            raise NotReadable(
                f"with its stages marked, a coefficient is {seen[0]:.6g}, and {seen[1]:.6g} with another start, time, "
                "h and size: a solver that stops too early, or a step not made of stages, as of exponential integrators"
            )
        self._off = max(self._off, off)
        return seen[0]

    def _one_reading(self, setting: Setting, amplitude: float, chain: Sequence[Link], product: float) -> float:
        links, clocks = len(chain), len(self.marks.hands)
        if links + clocks > self.steps.size:
            raise NotReadable(f"a chain of {links} stages needs more than the {self.steps.size} components it takes")
        # The amplitude brings the result to size 1, because a solver's tolerance is usually absolute.
        size = amplitude * 2.0 ** -frexp(product)[1]
        marked = chain[::-1]

        def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
            given, here = [size, *moved[: links - 1]], self.steps.part
            pairs = zip(given, marked, strict=True)
            own = [x * shares.get(label, 0.0) if part == here else 0.0 for x, (label, part) in pairs]
            return [*own, *[0.0] * (len(moved) - links)]

        result = self.steps.run(self.marks, setting, slopes, size=links).result
        return float((result[clocks + links - 1] - setting.start) / (size * product * setting.h**links))

    def _cleaned(self, x: float) -> float:
        return x if abs(x) > Rounding(self.steps.subject.format, 1, 4 * self.left).of(1.0) else 0.0
