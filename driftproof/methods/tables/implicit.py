"""Fully implicit Runge-Kutta methods of few stages: Gauss, Radau IA and IIA, Lobatto IIIA, IIIB and IIIC."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.number_field import square_root
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import numbers, padded, row, square

S3, S5, S6, S15 = square_root(3), square_root(5), square_root(6), square_root(15)

_ONE_STEP: tuple[RungeKutta, ...] = (
    # Also Radau IIA with one stage.
    RungeKutta(
        key="backward_euler",
        title="Backward Euler",
        claimed_order=1,
        source="hairer-wanner-1996, IV.3",
        c=row("1"),
        a=square("1"),
        b=row("1"),
    ),
    # Also Gauss with one stage; not the explicit `midpoint2`.
    RungeKutta(
        key="implicit_midpoint",
        title="Implicit midpoint rule",
        claimed_order=2,
        source="hairer-wanner-1996, IV.3",
        c=row("1/2"),
        a=square("1/2"),
        b=row("1"),
    ),
    # Also Lobatto IIIA with two stages, and Crank-Nicolson in time.
    RungeKutta(
        key="trapezoid",
        title="Trapezoidal rule",
        claimed_order=2,
        source="hairer-wanner-1996, IV.3",
        c=row("0 1"),
        a=square("0\n 1/2 1/2"),
        b=row("1/2 1/2"),
    ),
)

_GAUSS: tuple[RungeKutta, ...] = (
    RungeKutta(
        key="gauss2",
        title="Gauss, two stages (Hammer-Hollingsworth)",
        claimed_order=4,
        source="hairer-wanner-1996, IV.5",
        c=(Q(1, 2) - S3 / 6, Q(1, 2) + S3 / 6),
        a=padded((Q(1, 4), Q(1, 4) - S3 / 6), (Q(1, 4) + S3 / 6, Q(1, 4))),
        b=row("1/2 1/2"),
    ),
    RungeKutta(
        key="gauss3",
        title="Gauss, three stages (Kuntzmann-Butcher)",
        claimed_order=6,
        source="hairer-wanner-1996, IV.5",
        c=(Q(1, 2) - S15 / 10, Q(1, 2), Q(1, 2) + S15 / 10),
        a=padded(
            (Q(5, 36), Q(2, 9) - S15 / 15, Q(5, 36) - S15 / 30),
            (Q(5, 36) + S15 / 24, Q(2, 9), Q(5, 36) - S15 / 24),
            (Q(5, 36) + S15 / 30, Q(2, 9) + S15 / 15, Q(5, 36)),
        ),
        b=row("5/18 4/9 5/18"),
    ),
)

_RADAU: tuple[RungeKutta, ...] = (
    RungeKutta(
        key="radau_ia2",
        title="Radau IA, two stages",
        claimed_order=3,
        source="hairer-wanner-1996, IV.5",
        c=row("0 2/3"),
        a=square("1/4 -1/4\n 1/4 5/12"),
        b=row("1/4 3/4"),
    ),
    RungeKutta(
        key="radau_ia3",
        title="Radau IA, three stages",
        claimed_order=5,
        source="hairer-wanner-1996, IV.5",
        c=numbers(0, (6 - S6) / 10, (6 + S6) / 10),
        a=padded(
            (Q(1, 9), (-1 - S6) / 18, (-1 + S6) / 18),
            (Q(1, 9), (88 + 7 * S6) / 360, (88 - 43 * S6) / 360),
            (Q(1, 9), (88 + 43 * S6) / 360, (88 - 7 * S6) / 360),
        ),
        b=(Q(1, 9), (16 + S6) / 36, (16 - S6) / 36),
    ),
    RungeKutta(
        key="radau_iia2",
        title="Radau IIA, two stages",
        claimed_order=3,
        source="hairer-wanner-1996, IV.5",
        c=row("1/3 1"),
        a=square("5/12 -1/12\n 3/4 1/4"),
        b=row("3/4 1/4"),
    ),
    RungeKutta(
        key="radau_iia3",
        title="Radau IIA, three stages",
        claimed_order=5,
        source="hairer-wanner-1996, IV.5",
        c=numbers((4 - S6) / 10, (4 + S6) / 10, 1),
        a=padded(
            ((88 - 7 * S6) / 360, (296 - 169 * S6) / 1800, (-2 + 3 * S6) / 225),
            ((296 + 169 * S6) / 1800, (88 + 7 * S6) / 360, (-2 - 3 * S6) / 225),
            ((16 - S6) / 36, (16 + S6) / 36, Q(1, 9)),
        ),
        b=((16 - S6) / 36, (16 + S6) / 36, Q(1, 9)),
    ),
)

_LOBATTO_NODES4 = numbers(0, (5 - S5) / 10, (5 + S5) / 10, 1)

_LOBATTO: tuple[RungeKutta, ...] = (
    RungeKutta(
        key="lobatto_iiia3",
        title="Lobatto IIIA, three stages",
        claimed_order=4,
        source="hairer-wanner-1996, IV.5",
        c=row("0 1/2 1"),
        a=square("0\n 5/24 1/3 -1/24\n 1/6 2/3 1/6"),
        b=row("1/6 2/3 1/6"),
    ),
    RungeKutta(
        key="lobatto_iiia4",
        title="Lobatto IIIA, four stages",
        claimed_order=6,
        source="hairer-wanner-1996, IV.5",
        c=_LOBATTO_NODES4,
        a=padded(
            (0,),
            ((11 + S5) / 120, (25 - S5) / 120, (25 - 13 * S5) / 120, (-1 + S5) / 120),
            ((11 - S5) / 120, (25 + 13 * S5) / 120, (25 + S5) / 120, (-1 - S5) / 120),
            row("1/12 5/12 5/12 1/12"),
        ),
        b=row("1/12 5/12 5/12 1/12"),
    ),
    # The nodes are not the row sums, which are both 1/2: the stages of this one do not approximate z at the nodes.
    RungeKutta(
        key="lobatto_iiib2",
        title="Lobatto IIIB, two stages",
        claimed_order=2,
        source="hairer-wanner-1996, IV.5",
        c=row("0 1"),
        a=square("1/2 0\n 1/2 0"),
        b=row("1/2 1/2"),
    ),
    RungeKutta(
        key="lobatto_iiib3",
        title="Lobatto IIIB, three stages",
        claimed_order=4,
        source="hairer-wanner-1996, IV.5",
        c=row("0 1/2 1"),
        a=square("1/6 -1/6 0\n 1/6 1/3 0\n 1/6 5/6 0"),
        b=row("1/6 2/3 1/6"),
    ),
    RungeKutta(
        key="lobatto_iiib4",
        title="Lobatto IIIB, four stages",
        claimed_order=6,
        source="hairer-wanner-1996, IV.5",
        c=_LOBATTO_NODES4,
        a=padded(
            (Q(1, 12), (-1 - S5) / 24, (-1 + S5) / 24, 0),
            (Q(1, 12), (25 + S5) / 120, (25 - 13 * S5) / 120, 0),
            (Q(1, 12), (25 + 13 * S5) / 120, (25 - S5) / 120, 0),
            (Q(1, 12), (11 - S5) / 24, (11 + S5) / 24, 0),
        ),
        b=row("1/12 5/12 5/12 1/12"),
    ),
    RungeKutta(
        key="lobatto_iiic2",
        title="Lobatto IIIC, two stages",
        claimed_order=2,
        source="hairer-wanner-1996, IV.5",
        c=row("0 1"),
        a=square("1/2 -1/2\n 1/2 1/2"),
        b=row("1/2 1/2"),
    ),
    RungeKutta(
        key="lobatto_iiic3",
        title="Lobatto IIIC, three stages",
        claimed_order=4,
        source="hairer-wanner-1996, IV.5",
        c=row("0 1/2 1"),
        a=square("1/6 -1/3 1/6\n 1/6 5/12 -1/12\n 1/6 2/3 1/6"),
        b=row("1/6 2/3 1/6"),
    ),
    RungeKutta(
        key="lobatto_iiic4",
        title="Lobatto IIIC, four stages",
        claimed_order=6,
        source="hairer-wanner-1996, IV.5",
        c=_LOBATTO_NODES4,
        a=padded(
            (Q(1, 12), -S5 / 12, S5 / 12, Q(-1, 12)),
            (Q(1, 12), Q(1, 4), (10 - 7 * S5) / 60, S5 / 60),
            (Q(1, 12), (10 + 7 * S5) / 60, Q(1, 4), -S5 / 60),
            row("1/12 5/12 5/12 1/12"),
        ),
        b=row("1/12 5/12 5/12 1/12"),
    ),
)

ENTRIES: tuple[Method, ...] = (*_ONE_STEP, *_GAUSS, *_RADAU, *_LOBATTO)
