"""The order of coefficients that were read: a condition fails only by more than their rounding explains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from driftproof.blackbox.matching.candidates import ExactTable
from driftproof.blackbox.matching.match import Match
from driftproof.blackbox.probes.coefficients import simple_rational
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.questions import CoefficientReading
from driftproof.blackbox.probes.scripted_answers import CoefficientRow
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.symbolic.trees.order_in_balls import (
    Ball,
    BallNystrom,
    BallTableau,
    ProvableFailure,
    ball_order,
    linear_ball_order,
)
from driftproof.symbolic.trees.order_in_balls import _Row as BallRow
from driftproof.symbolic.trees.rooted_trees import AnyTree, to_brackets

# Chosen: hardly any explicit method in use has a higher order, and the number of trees grows fast.
HIGHEST_ORDER = 12


@dataclass(frozen=True)
class ReadOrder:
    """The order of the coefficients read, on all problems of the kind they were read on, and why it is not higher.

    `failing_tree`, in brackets, is the tree of the first condition Φ = 1/γ that fails, and `residual` encloses Φ - 1/γ
    and excludes 0; both are None if no condition fails up to HIGHEST_ORDER. `linear_order` is the order on linear
    problems, and `untimed_order` that on problems without the time, which is higher if the nodes are wrong.
    """

    order: int
    failing_tree: str | None
    residual: tuple[Fraction, Fraction] | None
    linear_order: int
    untimed_order: int

    @property
    def words(self) -> str:
        """The order, or the least that it may be, e.g. "order 4" and "order 12 or more"."""
        return f"order {self.order}{' or more' * (self.residual is None)}"

    @property
    def reason(self) -> str:
        """Why the order is not one higher, e.g. "the condition of tree [[τ],τ] fails by 1/720"."""
        if self.residual is None:
            return f"no condition up to order {self.order} fails"
        low, high = self.residual
        exact = simple_rational((low + high) / 2, (high - low) / 2)
        amount = f"{float(low + high) / 2:.3g}" if exact is None else str(exact)
        return f"the condition of tree {self.failing_tree} fails by {amount}"

    @property
    def lines(self) -> list[str]:
        """The orders as lines of text."""
        lines = [f"order {self.order}: {self.reason}"]
        if self.linear_order != self.order:
            lines.append(f"order {self.linear_order} on linear problems")
        if self.untimed_order != self.order:
            lines.append(f"order {self.untimed_order} on problems without time: f is called at wrong times")
        return lines


def read_order(reading: CoefficientReading, match: Match | None = None) -> ReadOrder:
    """The largest p such that no condition of order at most p provably fails, with the coefficients taken as balls.

    If `match` recognised the tableau, the radius of each coefficient is as many roundings as the match is off. Else it
    is the most roundings that any program may make (`scripted_answers.Rounding`), of the largest number in its column.
    """
    balls = BallTableaux(reading, match)
    if isinstance(reading, ForceReading):
        table = balls.nystrom(reading)
        return _found(ball_order(table, HIGHEST_ORDER), linear_ball_order(table, HIGHEST_ORDER))
    tableau = balls.tableau(reading)
    untimed = found = ball_order(tableau, HIGHEST_ORDER)
    if not balls.times_agree(reading):
        found = ball_order(tableau, HIGHEST_ORDER, timed=True)
    return _found(found, linear_ball_order(tableau, HIGHEST_ORDER), untimed.order)


def _found(failure: ProvableFailure[AnyTree], linear: int, untimed: int | None = None) -> ReadOrder:
    tree = None if failure.failing_tree is None else to_brackets(failure.failing_tree)
    return ReadOrder(failure.order, tree, failure.residual, linear, failure.order if untimed is None else untimed)


class BallTableaux:
    """The coefficients of a reading as balls; coefficients that are read as 0 are taken to be exactly 0."""

    def __init__(self, reading: CoefficientReading, match: Match | None) -> None:
        """Set the radii: as many roundings as `match` is off, or, without a match, as many as any program may make."""
        drift = Fraction(reading.drift) if isinstance(reading, ForceReading) else None
        table, rounding = ExactTable.of(reading.stages, drift), reading.rounding
        self.own = isinstance(reading, TableauReading) and match is not None and not match.summed
        self.unit = reading.format.u * (max(1, match.roundings) if self.own and match else rounding.most)
        self.besides = Fraction(rounding.besides)
        self.scales = table.scales.tolist()
        # A node is the sum of a row, whose terms may be larger than the sum is.
        self.length = max(table.length, *self.scales)

    def tableau(self, reading: TableauReading) -> BallTableau:
        """A, b and c as balls."""
        *a, b = (self._row(row, self.scales) for row in (*reading.a, reading.b))
        return BallTableau(tuple(a), b, self._nodes(reading.c or ()))

    def nystrom(self, reading: ForceReading) -> BallNystrom:
        """c, A, both rows of weights and the drift as balls."""
        rows = (*reading.a, reading.b_position, reading.b_velocity)
        *a, b_position, b_velocity = (self._row(row, self.scales) for row in rows)
        (drift,) = self._nodes((reading.drift,))
        return BallNystrom(self._nodes(reading.c), tuple(a), b_position, b_velocity, drift)

    def times_agree(self, reading: TableauReading) -> bool:
        """True if each node may be the sum of its row, so that the time adds no order conditions."""
        if reading.c is None:
            return True
        tableau = self.tableau(reading)
        return all(
            abs(Fraction(t) - sum(map(Fraction, row))) <= sum((x.radius for x in (*balls, node) if x), Fraction(0))
            for t, row, balls, node in zip(reading.c, reading.a, tableau.a, tableau.c, strict=True)
        )

    def _nodes(self, row: CoefficientRow) -> BallRow:
        return self._row(row, [self.length] * len(row))

    def _row(self, row: CoefficientRow, scales: Sequence[float]) -> BallRow:
        sizes = map(abs, row) if self.own else scales
        pairs = zip(row, sizes, strict=True)
        return tuple(Ball(Fraction(x), self.unit * Fraction(size) + self.besides) if x else 0 for x, size in pairs)
