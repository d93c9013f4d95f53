"""Tables in floats, and a quick test that tells nearly all of them apart before they are compared exactly."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.symbolic.linear.reduced_tableau import Stages

Array: TypeAlias = "np.ndarray[Any, Any]"
# The powers of nodes whose weighted sums are compared: methods of high order agree in the low ones.
POWERS = (0, 1, 2, 11)


class Fingerprint:
    """A table with all its stages, in floats; of a right-hand side the sums of A's rows are nodes, too."""

    def __init__(self, stages: Stages, drift: Any) -> None:
        """`drift` is None of a right-hand side, where c counts if the weights stand twice."""
        self.a = np.array([[float(x) for x in row] for row in stages.a])
        self.weights = np.array([[float(x) for x in row] for row in stages.weights])
        nodes = np.array([float(x) for x in stages.c])
        if drift is None:
            timed, self.weights = len(stages.weights) > 1, self.weights[:1]
            self.nodes = [self.a.sum(axis=1), nodes] if timed else [self.a.sum(axis=1)]
        else:
            self.nodes = [nodes]
        self.drift = 0.0 if drift is None else float(drift)

    @property
    def calls(self) -> int:
        """The number of stages."""
        return len(self.a)

    @cached_property
    def used(self) -> int:
        """The number of stages that the result depends on."""
        reached = np.any(self.weights != 0, axis=0)
        for _ in range(self.calls):
            reached = reached | np.any(self.a[reached] != 0, axis=0)
        return max(int(reached.sum()), 1)

    @cached_property
    def length(self) -> float:
        """The largest node, in size."""
        return max(float(np.abs(nodes).max()) for nodes in self.nodes)

    @cached_property
    def scale(self) -> float:
        """The sum over the stages of the largest number that its answer is multiplied by on the way to any place."""
        columns = np.abs(np.vstack([self.a, self.weights])).max(axis=0)
        return float(columns.sum()) * max(1.0, self.length, abs(self.drift))

    def may_be(self, other: Fingerprint, rounding: Rounding) -> bool:
        """False if the two are different methods: sums that no order and no reduction of the stages changes differ.

        They are wcᵏ, wAcᵏ and wAAcᵏ for each row w of weights, c the nodes in units of the largest. Where no entry is
        off by more than e times the largest in its column, and s > 1 is above the sum of these, the last is off by at
        most e (k + 4) s³ to first order: each of k nodes, of three factors and of the unit by e.
        """
        unit, scale = self.length or 1.0, 1.0 + max(self.scale, other.scale)
        allowed = rounding.of(2 * (max(POWERS) + 4) * scale**3)
        pairs = zip(self._sums(unit), other._sums(unit), strict=True)
        return all(bool((np.abs(mine - its) <= allowed).all()) for mine, its in pairs)

    def _sums(self, unit: float) -> Iterator[Array]:
        for nodes in self.nodes:
            for power in POWERS:
                values = (nodes / unit) ** power
                for _ in range(3):
                    yield self.weights @ values
                    values = self.a @ values
