"""Fully implicit Runge-Kutta methods of few stages: Gauss, Radau IA and IIA, Lobatto IIIA, IIIB and IIIC."""

from __future__ import annotations

from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import tableaux

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

_LOBATTO: tuple[RungeKutta, ...] = tableaux(
    """
    lobatto_iiia3 | Lobatto IIIA, three stages | 4 | hairer-wanner-1996, IV.5
      0 |
    1/2 | 5/24 1/3 -1/24
      1 | 1/6 2/3 1/6
        | 1/6 2/3 1/6

    lobatto_iiia4 | Lobatto IIIA, four stages | 6 | hairer-wanner-1996, IV.5
                 0 |
    (5-sqrt(5))/10 | (11+sqrt(5))/120 (25-sqrt(5))/120 (25-13*sqrt(5))/120 (-1+sqrt(5))/120
    (5+sqrt(5))/10 | (11-sqrt(5))/120 (25+13*sqrt(5))/120 (25+sqrt(5))/120 (-1-sqrt(5))/120
                 1 | 1/12 5/12 5/12 1/12
                   | 1/12 5/12 5/12 1/12

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

    lobatto_iiib4 | Lobatto IIIB, four stages | 6 | hairer-wanner-1996, IV.5
                 0 | 1/12 (-1-sqrt(5))/24 (-1+sqrt(5))/24
    (5-sqrt(5))/10 | 1/12 (25+sqrt(5))/120 (25-13*sqrt(5))/120
    (5+sqrt(5))/10 | 1/12 (25+13*sqrt(5))/120 (25-sqrt(5))/120
                 1 | 1/12 (11-sqrt(5))/24 (11+sqrt(5))/24
                   | 1/12 5/12 5/12 1/12

    lobatto_iiic2 | Lobatto IIIC, two stages | 2 | hairer-wanner-1996, IV.5
    0 | 1/2 -1/2
    1 | 1/2 1/2
      | 1/2 1/2

    lobatto_iiic3 | Lobatto IIIC, three stages | 4 | hairer-wanner-1996, IV.5
      0 | 1/6 -1/3 1/6
    1/2 | 1/6 5/12 -1/12
      1 | 1/6 2/3 1/6
        | 1/6 2/3 1/6

    lobatto_iiic4 | Lobatto IIIC, four stages | 6 | hairer-wanner-1996, IV.5
                 0 | 1/12 -sqrt(5)/12 sqrt(5)/12 -1/12
    (5-sqrt(5))/10 | 1/12 1/4 (10-7*sqrt(5))/60 sqrt(5)/60
    (5+sqrt(5))/10 | 1/12 (10+7*sqrt(5))/60 1/4 -sqrt(5)/60
                 1 | 1/12 5/12 5/12 1/12
                   | 1/12 5/12 5/12 1/12
    """
)

ENTRIES: tuple[Method, ...] = (*_ONE_STEP, *_GAUSS, *_RADAU, *_LOBATTO)
