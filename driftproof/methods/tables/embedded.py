"""Explicit pairs with rational coefficients, both rows of weights; `b` is the one that the source propagates."""

from __future__ import annotations

from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import row, square

_LOW_ORDER: tuple[RungeKutta, ...] = (
    RungeKutta(
        key="heun_euler21",
        title="Heun-Euler 2(1)",
        claimed_order=2,
        source="hairer-norsett-wanner-1993, chapter II",
        c=row("0 1"),
        a=square("0\n 1"),
        b=row("1/2 1/2"),
        b_embedded=row("1 0"),
        embedded_order=1,
    ),
    RungeKutta(
        key="fehlberg12",
        title="Fehlberg 1(2)",
        claimed_order=1,
        source="fehlberg-1969, the RK1(2) formula",
        c=row("0 1/2 1"),
        a=square("0\n 1/2\n 1/256 255/256"),
        b=row("1/256 255/256 0"),
        b_embedded=row("1/512 255/256 1/512"),
        embedded_order=2,
    ),
    RungeKutta(
        key="fehlberg23",
        title="Fehlberg 2(3) B",
        claimed_order=2,
        source="hairer-norsett-wanner-1993, II.4",
        c=row("0 1/4 27/40 1"),
        a=square(
            """0
            1/4
            -189/800 729/800
            214/891 1/33 650/891"""
        ),
        b=row("214/891 1/33 650/891 0"),
        b_embedded=row("533/2106 0 800/1053 -1/78"),
        embedded_order=3,
    ),
    RungeKutta(
        key="bogacki_shampine32",
        title="Bogacki-Shampine 3(2)",
        claimed_order=3,
        source="bogacki-shampine-1989, the 3(2) pair",
        c=row("0 1/2 3/4 1"),
        a=square(
            """0
            1/2
            0 3/4
            2/9 1/3 4/9"""
        ),
        b=row("2/9 1/3 4/9 0"),
        b_embedded=row("7/24 1/4 1/3 1/8"),
        embedded_order=2,
    ),
    # The second row has order 5 where F is linear with constant coefficients, hence Merson's name 4("5"); else 3.
    RungeKutta(
        key="merson45",
        title='Merson 4("5")',
        claimed_order=4,
        source="hairer-norsett-wanner-1993, II.4 Table 4.1",
        c=row("0 1/3 1/3 1/2 1"),
        a=square(
            """0
            1/3
            1/6 1/6
            1/8 0 3/8
            1/2 0 -3/2 2"""
        ),
        b=row("1/6 0 0 2/3 1/6"),
        b_embedded=row("1/10 0 3/10 2/5 1/5"),
        embedded_order=3,
    ),
    RungeKutta(
        key="zonneveld43",
        title="Zonneveld 4(3)",
        claimed_order=4,
        source="hairer-norsett-wanner-1993, II.4 Table 4.2",
        c=row("0 1/2 1/2 1 3/4"),
        a=square(
            """0
            1/2
            0 1/2
            0 0 1
            5/32 7/32 13/32 -1/32"""
        ),
        b=row("1/6 1/3 1/3 1/6 0"),
        b_embedded=row("-1/2 7/3 7/3 13/6 -16/3"),
        embedded_order=3,
    ),
)

_ORDERS_FOUR_AND_FIVE: tuple[RungeKutta, ...] = (
    RungeKutta(
        key="england45",
        title="England 4(5)",
        claimed_order=4,
        source="england-1969, the fourth-order method with a fifth-order estimate",
        c=row("0 1/2 1/2 1 2/3 1/5"),
        a=square(
            """0
            1/2
            1/4 1/4
            0 -1 2
            7/27 10/27 0 1/27
            28/625 -1/5 546/625 54/625 -378/625"""
        ),
        b=row("1/6 0 2/3 1/6 0 0"),
        b_embedded=row("1/24 0 0 5/48 27/56 125/336"),
        embedded_order=5,
    ),
    RungeKutta(
        key="fehlberg45",
        title="Fehlberg 4(5)",
        claimed_order=4,
        source="hairer-norsett-wanner-1993, II.5 Table 5.1",
        c=row("0 1/4 3/8 12/13 1 1/2"),
        a=square(
            """0
            1/4
            3/32 9/32
            1932/2197 -7200/2197 7296/2197
            439/216 -8 3680/513 -845/4104
            -8/27 2 -3544/2565 1859/4104 -11/40"""
        ),
        b=row("25/216 0 1408/2565 2197/4104 -1/5 0"),
        b_embedded=row("16/135 0 6656/12825 28561/56430 -9/50 2/55"),
        embedded_order=5,
    ),
    RungeKutta(
        key="cash_karp54",
        title="Cash-Karp 5(4)",
        claimed_order=5,
        source="cash-karp-1990, the method and its embedded row of order 4",
        c=row("0 1/5 3/10 3/5 1 7/8"),
        a=square(
            """0
            1/5
            3/40 9/40
            3/10 -9/10 6/5
            -11/54 5/2 -70/27 35/27
            1631/55296 175/512 575/13824 44275/110592 253/4096"""
        ),
        b=row("37/378 0 250/621 125/594 0 512/1771"),
        b_embedded=row("2825/27648 0 18575/48384 13525/55296 277/14336 1/4"),
        embedded_order=4,
    ),
    RungeKutta(
        key="dormand_prince54",
        title="Dormand-Prince 5(4)",
        claimed_order=5,
        source="hairer-norsett-wanner-1993, II.5 Table 5.2",
        c=row("0 1/5 3/10 4/5 8/9 1 1"),
        a=square(
            """0
            1/5
            3/40 9/40
            44/45 -56/15 32/9
            19372/6561 -25360/2187 64448/6561 -212/729
            9017/3168 -355/33 46732/5247 49/176 -5103/18656
            35/384 0 500/1113 125/192 -2187/6784 11/84"""
        ),
        b=row("35/384 0 500/1113 125/192 -2187/6784 11/84 0"),
        b_embedded=row("5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40"),
        embedded_order=4,
    ),
    # The source has a second embedded row, with seven stages; this is the one that reuses the next step's slope.
    RungeKutta(
        key="bogacki_shampine54",
        title="Bogacki-Shampine 5(4)",
        claimed_order=5,
        source="bogacki-shampine-1996, the 5(4) pair",
        c=row("0 1/6 2/9 3/7 2/3 3/4 1 1"),
        a=square(
            """0
            1/6
            2/27 4/27
            183/1372 -162/343 1053/1372
            68/297 -4/11 42/143 1960/3861
            597/22528 81/352 63099/585728 58653/366080 4617/20480
            174197/959244 -30942/79937 8152137/19744439 666106/1039181 -29421/29068 482048/414219
            587/8064 0 4440339/15491840 24353/124800 387/44800 2152/5985 7267/94080"""
        ),
        b=row("587/8064 0 4440339/15491840 24353/124800 387/44800 2152/5985 7267/94080 0"),
        b_embedded=row("2479/34992 0 123/416 612941/3411720 43/1440 2272/6561 79937/1113912 3293/556956"),
        embedded_order=4,
    ),
)

ENTRIES: tuple[Method, ...] = (*_LOW_ORDER, *_ORDERS_FOUR_AND_FIVE)
