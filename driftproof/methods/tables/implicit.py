"""Fully implicit Runge-Kutta methods of few stages: Gauss, Radau IA and IIA, Lobatto IIIA, IIIB and IIIC."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.number_field import square_root
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import numbers, padded, row, tableaux

S5 = square_root(5)

_ONE_STEP: tuple[RungeKutta, ...] = tableaux(
    """
    # Also Radau IIA with one stage.
    backward_euler | Backward Euler | 1 | hairer-wanner-1996, IV.3
    1 | 1
      | 1

    # Also Gauss with one stage; not the explicit `midpoint2`.
    implicit_midpoint | Implicit midpoint rule | 2 | hairer-wanner-1996, IV.3
    1/2 | 1/2
        | 1

    # Also Lobatto IIIA with two stages, and Crank-Nicolson in time.
    trapezoid | Trapezoidal rule | 2 | hairer-wanner-1996, IV.3
    0 |
    1 | 1/2 1/2
      | 1/2 1/2
    """
)

_GAUSS: tuple[RungeKutta, ...] = tableaux(
    """
    gauss2 | Gauss, two stages (Hammer-Hollingsworth) | 4 | hairer-wanner-1996, IV.5
    1/2-sqrt(3)/6 | 1/4 1/4-sqrt(3)/6
    1/2+sqrt(3)/6 | 1/4+sqrt(3)/6 1/4
                  | 1/2 1/2

    gauss3 | Gauss, three stages (Kuntzmann-Butcher) | 6 | hairer-wanner-1996, IV.5
    1/2-sqrt(15)/10 | 5/36 2/9-sqrt(15)/15 5/36-sqrt(15)/30
                1/2 | 5/36+sqrt(15)/24 2/9 5/36-sqrt(15)/24
    1/2+sqrt(15)/10 | 5/36+sqrt(15)/30 2/9+sqrt(15)/15 5/36
                    | 5/18 4/9 5/18
    """
)

_RADAU: tuple[RungeKutta, ...] = tableaux(
    """
    radau_ia2 | Radau IA, two stages | 3 | hairer-wanner-1996, IV.5
      0 | 1/4 -1/4
    2/3 | 1/4 5/12
        | 1/4 3/4

    radau_ia3 | Radau IA, three stages | 5 | hairer-wanner-1996, IV.5
                 0 | 1/9 (-1-sqrt(6))/18 (-1+sqrt(6))/18
    (6-sqrt(6))/10 | 1/9 (88+7*sqrt(6))/360 (88-43*sqrt(6))/360
    (6+sqrt(6))/10 | 1/9 (88+43*sqrt(6))/360 (88-7*sqrt(6))/360
                   | 1/9 (16+sqrt(6))/36 (16-sqrt(6))/36

    radau_iia2 | Radau IIA, two stages | 3 | hairer-wanner-1996, IV.5
    1/3 | 5/12 -1/12
      1 | 3/4 1/4
        | 3/4 1/4

    radau_iia3 | Radau IIA, three stages | 5 | hairer-wanner-1996, IV.5
    (4-sqrt(6))/10 | (88-7*sqrt(6))/360 (296-169*sqrt(6))/1800 (-2+3*sqrt(6))/225
    (4+sqrt(6))/10 | (296+169*sqrt(6))/1800 (88+7*sqrt(6))/360 (-2-3*sqrt(6))/225
                 1 | (16-sqrt(6))/36 (16+sqrt(6))/36 1/9
                   | (16-sqrt(6))/36 (16+sqrt(6))/36 1/9
    """
)

_LOBATTO_NODES4 = numbers(0, (5 - S5) / 10, (5 + S5) / 10, 1)

_LOBATTO: tuple[RungeKutta, ...] = (
    *tableaux(
        """
    lobatto_iiia3 | Lobatto IIIA, three stages | 4 | hairer-wanner-1996, IV.5
      0 |
    1/2 | 5/24 1/3 -1/24
      1 | 1/6 2/3 1/6
        | 1/6 2/3 1/6
    """
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
    *tableaux(
        """
    # The nodes are not the row sums, which are both 1/2: the stages of this one do not approximate z at the nodes.
    lobatto_iiib2 | Lobatto IIIB, two stages | 2 | hairer-wanner-1996, IV.5
    0 | 1/2 0
    1 | 1/2 0
      | 1/2 1/2

    lobatto_iiib3 | Lobatto IIIB, three stages | 4 | hairer-wanner-1996, IV.5
      0 | 1/6 -1/6 0
    1/2 | 1/6 1/3 0
      1 | 1/6 5/6 0
        | 1/6 2/3 1/6
    """
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
    *tableaux(
        """
    lobatto_iiic2 | Lobatto IIIC, two stages | 2 | hairer-wanner-1996, IV.5
    0 | 1/2 -1/2
    1 | 1/2 1/2
      | 1/2 1/2

    lobatto_iiic3 | Lobatto IIIC, three stages | 4 | hairer-wanner-1996, IV.5
      0 | 1/6 -1/3 1/6
    1/2 | 1/6 5/12 -1/12
      1 | 1/6 2/3 1/6
        | 1/6 2/3 1/6
    """
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
