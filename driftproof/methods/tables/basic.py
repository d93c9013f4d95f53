"""The methods that every textbook begins with: the Euler methods, Verlet, Heun, midpoint, RK4 and the 3/8 rule."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.schemes import Method
from driftproof.methods.tables.notation import splitting, tableaux

ENTRIES: tuple[Method, ...] = (
    *tableaux(
        """
    forward_euler | Forward Euler | 1 | hairer-norsett-wanner-1993, I.7
    0 |
      | 1
    """
    ),
    # Not `symplectic_euler_position_first`, which is its adjoint; both are called "the" symplectic Euler.
    splitting(
        "symplectic_euler | Symplectic Euler | 1 | hairer-lubich-wanner-2006, I.1.2", (("kick", Q(1)), ("drift", Q(1)))
    ),
    splitting(
        "symplectic_euler_position_first | Symplectic Euler, position first | 1 | hairer-lubich-wanner-2006, I.1.2",
        (("drift", Q(1)), ("kick", Q(1))),
    ),
    splitting(
        "velocity_verlet | Velocity Verlet | 2 | hairer-lubich-wanner-2006, I.1.4",
        (("kick", Q(1, 2)), ("drift", Q(1)), ("kick", Q(1, 2))),
    ),
    splitting(
        "position_verlet | Position Verlet | 2 | hairer-lubich-wanner-2006, I.1.4",
        (("drift", Q(1, 2)), ("kick", Q(1)), ("drift", Q(1, 2))),
    ),
    *tableaux(
        """
    heun2 | Heun's second-order method | 2 | butcher-2016, 231
    0 |
    1 | 1
      | 1/2 1/2

    # The explicit midpoint rule; not `implicit_midpoint`, and not the two-step leapfrog of the same nickname.
    midpoint2 | Explicit midpoint | 2 | butcher-2016, 231
      0 |
    1/2 | 1/2
        | 0 1

    rk4 | Classical RK4 | 4 | hairer-norsett-wanner-1993, II.1 Table 1.2
      0 |
    1/2 | 1/2
    1/2 | 0 1/2
      1 | 0 0 1
        | 1/6 1/3 1/3 1/6

    rk38 | Kutta's 3/8 rule | 4 | hairer-norsett-wanner-1993, II.1 Table 1.2
      0 |
    1/3 | 1/3
    2/3 | -1/3 1
      1 | 1 -1 1
        | 1/8 3/8 3/8 1/8
    """
    ),
)
