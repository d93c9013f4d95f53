"""The nine methods whose facts are in print and typed in these tests; a method added later need not be."""

from __future__ import annotations

from methods.catalogue import METHODS
from methods.schemes import RungeKutta, Splitting

NINE: dict[str, RungeKutta | Splitting] = {
    key: method
    for key in (
        "forward_euler",
        "symplectic_euler",
        "symplectic_euler_position_first",
        "velocity_verlet",
        "position_verlet",
        "heun2",
        "midpoint2",
        "rk4",
        "rk38",
    )
    if isinstance(method := METHODS[key], RungeKutta | Splitting)
}
