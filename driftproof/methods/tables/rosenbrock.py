"""Rosenbrock and W methods: ROS2, ode23s, ROS3P, GRK4T, RODAS3 and RODAS."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction as Q

from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.tables.notation import heading, numbers, padded, row, square


def _product(u: Sequence[Q], rows: Sequence[Sequence[Q]]) -> tuple[Q, ...]:
    return tuple(sum((x * r[j] for x, r in zip(u, rows, strict=True)), Q(0)) for j in range(len(u)))


def _from_transformed(names: str, gamma: Q, a: str, c: str, m: str, *, decimal: bool = False) -> Rosenbrock:
    """The method from the matrices that programs store, A = αΓ⁻¹, C = I/γ - Γ⁻¹ and m = bΓ⁻¹.

    Γ = γ (I - γC)⁻¹ follows row by row, because C is strictly lower triangular (hairer-wanner-1996, IV.7 (7.25)). The
    last stage is the error estimate.
    """
    below = [row(line) for line in c.strip().splitlines()]
    size = len(below)
    inverse: list[tuple[Q, ...]] = []
    for i, entries in enumerate(below):
        unit = [gamma if j == i else Q(0) for j in range(size)]
        for x, known in zip(entries, inverse, strict=False):
            unit = [y + gamma * x * z for y, z in zip(unit, known, strict=True)]
        inverse.append(tuple(unit))
    stages = [_product((*row(line), *[Q(0)] * (size - len(row(line)))), inverse) for line in a.strip().splitlines()]
    weights = row(m)
    return Rosenbrock(
        **heading(names),
        alpha=tuple(stages),
        gamma=tuple(inverse),
        b=_product(weights, inverse),
        b_embedded=_product((*weights[:-1], Q(0)), inverse),
        decimal=decimal,
        places=14 if decimal else None,
    )


_SQRT2, _SQRT3 = square_root(2), square_root(3)
_G2, _G3 = 1 - _SQRT2 / 2, Q(1, 2) + _SQRT3 / 6

ENTRIES: tuple[Rosenbrock, ...] = (
    Rosenbrock(
        **heading("ros2 | ROS2 | 2(1) | verwer-spee-blom-hundsdorfer-1999, 3.1"),
        alpha=square("0\n 1"),
        gamma=padded((_G2,), (-2 * _G2, _G2)),
        b=row("1/2 1/2"),
        b_embedded=row("1 0"),
    ),
    Rosenbrock(  # e32 of its program is 6 + sqrt(2), and d is 1/(2 + sqrt(2))
        **heading("ode23s | Modified Rosenbrock pair of ode23s | 2(3) | shampine-reichelt-1997, 3.1"),
        alpha=square("0\n 1/2\n 0 1"),
        gamma=padded((_G2,), (-_G2, _G2), (_G2 * (4 + _SQRT2), -_G2 * (6 + _SQRT2), _G2)),
        b=row("0 1 0"),
        b_embedded=row("1/6 2/3 1/6"),
    ),
    Rosenbrock(
        **heading("ros3p | ROS3P | 3(2) | lang-verwer-2001, 4"),
        alpha=square("0\n 1\n 1 0"),
        gamma=padded((_G3,), (-1, _G3), (-_G3, Q(1, 2) - 2 * _G3, _G3)),
        b=row("2/3 0 1/3"),
        b_embedded=numbers(Q(1, 3), Q(1, 3), Q(1, 3)),
    ),
    Rosenbrock(
        **heading("grk4t | GRK4T | 4(3) | kaps-rentrop-1979, Table 1"),
        alpha=square("0\n 0.462\n -0.0815668168327 0.961775150166\n -0.0815668168327 0.961775150166"),
        gamma=square(
            "0.231\n -0.270629667752 0.231\n 0.311254483294 0.00852445628482 0.231\n"
            " 0.282816832044 -0.457959483281 -0.111208333333 0.231"
        ),
        b=row("0.217487371653 0.486229037990 0 0.296283590357"),
        b_embedded=row("-0.717088504499 1.77617912176 -0.0590906172617 0"),
        decimal=True,
    ),
    _from_transformed(
        "rodas3 | RODAS3 | 3(2) | sandu-verwer-blom-et-al-1997, 3.2",
        Q(1, 2),
        "0\n 0\n 2 0\n 2 0 1",
        "0\n 4\n 1 -1\n 1 -1 -8/3",
        "2 0 1 1",
    ),
    _from_transformed(
        "rodas4 | RODAS | 4(3) | hairer-wanner-1996, IV.10",
        Q(1, 4),
        """0
        1.544
        0.9466785280815826 0.2557011698983284
        3.314825187068521 2.896124015972201 0.9986419139977817
        1.221224509226641 6.019134481288629 12.53708332932087 -0.6878860361058950
        1.221224509226641 6.019134481288629 12.53708332932087 -0.6878860361058950 1""",
        """0
        -5.6688
        -2.430093356833875 -0.2063599157091915
        -0.1073529058151375 -9.594562251023355 -20.47028614809616
        7.496443313967647 -10.24680431464352 -33.99990352819905 11.70890893206160
        8.083246795921522 -7.981132988064893 -31.52159432874371 16.31930543123136 -6.058818238834054""",
        "1.221224509226641 6.019134481288629 12.53708332932087 -0.6878860361058950 1 1",
        decimal=True,
    ),
)
