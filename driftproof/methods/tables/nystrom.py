"""Explicit Runge-Kutta-Nyström methods for q'' = F(q)."""

from __future__ import annotations

from driftproof.methods.schemes import Method, Nystrom
from driftproof.methods.tables.notation import heading, row, square

ENTRIES: tuple[Method, ...] = (
    Nystrom(
        **heading("nystrom4 | Nyström's method of order 4 | 4 | hairer-norsett-wanner-1993, II.14"),
        c=row("0 1/2 1"),
        a=square("0\n 1/8\n 0 1/2"),
        b_position=row("1/6 1/3 0"),
        b_velocity=row("1/6 2/3 1/6"),
    ),
    # Not `kutta_nystrom5`, which is a Runge-Kutta method.
    Nystrom(
        **heading("nystrom5 | Nyström's method of order 5 | 5 | hairer-norsett-wanner-1993, II.14"),
        c=row("0 1/5 2/3 1"),
        a=square("0\n 1/50\n -1/27 7/27\n 3/10 -2/35 9/35"),
        b_position=row("1/24 25/84 9/56 0"),
        b_velocity=row("1/24 125/336 27/56 5/48"),
    ),
    # The higher-order half of the pair RKN4(3)4FM.
    Nystrom(
        **heading(
            "dormand_elmikkawy_prince4 | Dormand-El-Mikkawy-Prince Nyström method of order 4 | 4"
            " | dormand-elmikkawy-prince-1987, Table 3, RKN4(3)4FM"
        ),
        c=row("0 1/4 7/10 1"),
        a=square("0\n 1/32\n 7/1000 119/500\n 1/14 8/27 25/189"),
        b_position=row("1/14 8/27 25/189 0"),
        b_velocity=row("1/14 32/81 250/567 5/54"),
    ),
)
