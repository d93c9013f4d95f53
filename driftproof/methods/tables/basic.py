"""The methods that every text begins with: the Euler methods, Verlet, Heun, midpoint, RK4 and the 3/8 rule."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.schemes import Method, RungeKutta, Splitting

ENTRIES: tuple[Method, ...] = (
    RungeKutta(
        key="forward_euler",
        title="Forward Euler",
        claimed_order=1,
        source="hairer-norsett-wanner-1993, I.7",
        a=((Q(0),),),
        b=(Q(1),),
        c=(Q(0),),
    ),
    # Not `symplectic_euler_position_first`, which is its adjoint; both are called "the" symplectic Euler.
    Splitting(
        key="symplectic_euler",
        title="Symplectic Euler",
        claimed_order=1,
        source="hairer-lubich-wanner-2006, I.1.2",
        parts=(("kick", Q(1)), ("drift", Q(1))),
    ),
    Splitting(
        key="symplectic_euler_position_first",
        title="Symplectic Euler, position first",
        claimed_order=1,
        source="hairer-lubich-wanner-2006, I.1.2",
        parts=(("drift", Q(1)), ("kick", Q(1))),
    ),
    Splitting(
        key="velocity_verlet",
        title="Velocity Verlet",
        claimed_order=2,
        source="hairer-lubich-wanner-2006, I.1.4",
        parts=(("kick", Q(1, 2)), ("drift", Q(1)), ("kick", Q(1, 2))),
    ),
    Splitting(
        key="position_verlet",
        title="Position Verlet",
        claimed_order=2,
        source="hairer-lubich-wanner-2006, I.1.4",
        parts=(("drift", Q(1, 2)), ("kick", Q(1)), ("drift", Q(1, 2))),
    ),
    RungeKutta(
        key="heun2",
        title="Heun's second-order method",
        claimed_order=2,
        source="butcher-2016, 231",
        a=((Q(0), Q(0)), (Q(1), Q(0))),
        b=(Q(1, 2), Q(1, 2)),
        c=(Q(0), Q(1)),
    ),
    # The explicit midpoint rule; not `implicit_midpoint`, and not the two-step leapfrog of the same nickname.
    RungeKutta(
        key="midpoint2",
        title="Explicit midpoint",
        claimed_order=2,
        source="butcher-2016, 231",
        a=((Q(0), Q(0)), (Q(1, 2), Q(0))),
        b=(Q(0), Q(1)),
        c=(Q(0), Q(1, 2)),
    ),
    RungeKutta(
        key="rk4",
        title="Classical RK4",
        claimed_order=4,
        source="hairer-norsett-wanner-1993, II.1 Table 1.2",
        a=(
            (Q(0), Q(0), Q(0), Q(0)),
            (Q(1, 2), Q(0), Q(0), Q(0)),
            (Q(0), Q(1, 2), Q(0), Q(0)),
            (Q(0), Q(0), Q(1), Q(0)),
        ),
        b=(Q(1, 6), Q(1, 3), Q(1, 3), Q(1, 6)),
        c=(Q(0), Q(1, 2), Q(1, 2), Q(1)),
    ),
    RungeKutta(
        key="rk38",
        title="Kutta's 3/8 rule",
        claimed_order=4,
        source="hairer-norsett-wanner-1993, II.1 Table 1.2",
        a=(
            (Q(0), Q(0), Q(0), Q(0)),
            (Q(1, 3), Q(0), Q(0), Q(0)),
            (Q(-1, 3), Q(1), Q(0), Q(0)),
            (Q(1), Q(-1), Q(1), Q(0)),
        ),
        b=(Q(1, 8), Q(3, 8), Q(3, 8), Q(1, 8)),
        c=(Q(0), Q(1, 3), Q(2, 3), Q(1)),
    ),
)
