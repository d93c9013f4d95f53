"""Explicit methods whose additional stages increase stability: strong-stability-preserving, Chebyshev of order 1."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import padded, row, tableaux


def ssprk_second_order(stages: int) -> RungeKutta:
    """The optimal SSP method of order 2 with s >= 2 stages, which averages forward Euler steps of size h/(s-1).

    Its SSP coefficient is s-1. For s = 2 it is Heun's second-order method. Raises ValueError for fewer stages.
    """
    if stages < 2:
        raise ValueError(f"ssprk_second_order({stages}): two stages or more are needed for order 2")
    step = Q(1, stages - 1)
    return RungeKutta(
        key=f"ssprk{stages}2" if stages < 10 else f"ssprk{stages}_2",
        title=f"SSPRK({stages},2)",
        claimed_order=2,
        source="kraaijevanger-1991, the optimal second-order methods",
        c=tuple(i * step for i in range(stages)),
        a=padded(*(i * (step,) for i in range(stages))),
        b=stages * (Q(1, stages),),
    )


def chebyshev_first_order(stages: int) -> RungeKutta:
    """The undamped method of order 1 with s >= 1 stages and R(z) = T_s(1 + z/s²), so that |R| <= 1 on [-2s², 0].

    Written as Y₁ = Y₀ + h/s² F₀, Yⱼ = 2Yⱼ₋₁ - Yⱼ₋₂ + 2h/s² Fⱼ₋₁. Raises ValueError for no stage.
    """
    if stages < 1:
        raise ValueError(f"chebyshev_first_order({stages}): one stage or more is needed")
    step = Q(1, stages**2)
    rows: list[tuple[Q, ...]] = [(), (step,)]
    for _ in range(stages - 1):
        (*before, last), older = (*rows[-1], 2 * step), rows[-2]
        rows.append((*(2 * x - y for x, y in zip(before, (*older, Q(0)), strict=True)), last))
    return RungeKutta(
        key=f"chebyshev{stages}_1",
        title=f"Chebyshev method of order 1, {stages} stages",
        claimed_order=1,
        source="hairer-wanner-1996, IV.2",
        c=tuple(Q(j**2, stages**2) for j in range(stages)),
        a=padded(*rows[:-1]),
        b=rows[-1],
    )


_SSPRK104_ROWS = (*(i * (Q(1, 6),) for i in range(5)), *((*5 * (Q(1, 15),), *i * (Q(1, 6),)) for i in range(5)))

ENTRIES: tuple[Method, ...] = (
    ssprk_second_order(2),
    ssprk_second_order(3),
    *tableaux(
        """
    ssprk33 | SSPRK(3,3), Shu-Osher | 3 | shu-osher-1988, equation 2.18
      0 |
      1 | 1
    1/2 | 1/4 1/4
        | 1/6 1/6 2/3

    ssprk43 | SSPRK(4,3) | 3 | kraaijevanger-1991, the optimal third-order method with four stages
      0 |
    1/2 | 1/2
      1 | 1/2 1/2
    1/2 | 1/6 1/6 1/6
        | 1/6 1/6 1/6 1/2
    """
    ),
    RungeKutta(
        key="ssprk104",
        title="SSPRK(10,4)",
        claimed_order=4,
        source="ketcheson-2008, the fourth-order method with ten stages",
        c=row("0 1/6 1/3 1/2 2/3 1/3 1/2 2/3 5/6 1"),
        a=padded(*_SSPRK104_ROWS),
        b=10 * (Q(1, 10),),
    ),
    ssprk_second_order(40),
    chebyshev_first_order(10),
)
