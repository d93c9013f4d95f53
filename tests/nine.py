"""The nine methods whose facts are in print and typed in these tests; a method added later need not be."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method, RungeKutta, Splitting
from driftproof.symbolic.derivation.one_step import RING, H, matrix, one_step_matrix, rational

NINE: dict[str, RungeKutta | Splitting] = {
    key: method
    for key in (
        "forward_euler", "symplectic_euler", "symplectic_euler_position_first", "velocity_verlet", "position_verlet",
        "heun2", "midpoint2", "rk4", "rk38",
    )
    if isinstance(method := METHODS[key], RungeKutta | Splitting)
}  # fmt: skip

# R(z) of the Runge-Kutta methods and the product of shears of the splittings as they stand in the books: the powers of
# h in M_qq, M_qv, M_vq, M_vv, ascending.
PRINTED: dict[str, list[list[Q | int]]] = {
    "forward_euler": [[1], [0, 1], [0, -1], [1]],
    "symplectic_euler": [[1, 0, -1], [0, 1], [0, -1], [1]],
    "symplectic_euler_position_first": [[1], [0, 1], [0, -1], [1, 0, -1]],
    "velocity_verlet": [[1, 0, Q(-1, 2)], [0, 1], [0, -1, 0, Q(1, 4)], [1, 0, Q(-1, 2)]],
    "position_verlet": [[1, 0, Q(-1, 2)], [0, 1, 0, Q(-1, 4)], [0, -1], [1, 0, Q(-1, 2)]],
}
PRINTED["heun2"] = PRINTED["midpoint2"] = [[1, 0, Q(-1, 2)], [0, 1], [0, -1], [1, 0, Q(-1, 2)]]
PRINTED["rk4"] = PRINTED["rk38"] = [
    [1, 0, Q(-1, 2), 0, Q(1, 24)], [0, 1, 0, Q(-1, 6)], [0, -1, 0, Q(1, 6)], [1, 0, Q(-1, 2), 0, Q(1, 24)],
]  # fmt: skip


def polynomial(ascending: list[Q | int]) -> Any:
    return sum((rational(c) * H**k for k, c in enumerate(ascending)), RING.zero)


def is_printed(method: Method) -> bool:
    qq, qv, vq, vv = map(polynomial, PRINTED[method.key])
    return bool(one_step_matrix(method) == matrix([[qq, qv], [vq, vv]]))
