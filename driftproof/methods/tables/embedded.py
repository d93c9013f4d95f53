"""Explicit pairs with rational coefficients, both rows of weights; `b` is the one that the source propagates."""

from __future__ import annotations

from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import tableaux

_LOW_ORDER: tuple[RungeKutta, ...] = tableaux(
    """
    heun_euler21 | Heun-Euler 2(1) | 2(1) | hairer-norsett-wanner-1993, chapter II
    0 |
    1 | 1
      | 1/2 1/2
      | 1 0

    fehlberg12 | Fehlberg 1(2) | 1(2) | fehlberg-1969, the RK1(2) formula
      0 |
    1/2 | 1/2
      1 | 1/256 255/256
        | 1/256 255/256 0
        | 1/512 255/256 1/512

    fehlberg23 | Fehlberg 2(3) B | 2(3) | hairer-norsett-wanner-1993, II.4
        0 |
      1/4 | 1/4
    27/40 | -189/800 729/800
        1 | 214/891 1/33 650/891
          | 214/891 1/33 650/891 0
          | 533/2106 0 800/1053 -1/78

    bogacki_shampine32 | Bogacki-Shampine 3(2) | 3(2) | bogacki-shampine-1989, the 3(2) pair
      0 |
    1/2 | 1/2
    3/4 | 0 3/4
      1 | 2/9 1/3 4/9
        | 2/9 1/3 4/9 0
        | 7/24 1/4 1/3 1/8

    # The second row has order 5 where F is linear with constant coefficients, hence Merson's name 4("5"); else 3.
    merson45 | Merson 4("5") | 4(3) | hairer-norsett-wanner-1993, II.4 Table 4.1
      0 |
    1/3 | 1/3
    1/3 | 1/6 1/6
    1/2 | 1/8 0 3/8
      1 | 1/2 0 -3/2 2
        | 1/6 0 0 2/3 1/6
        | 1/10 0 3/10 2/5 1/5

    zonneveld43 | Zonneveld 4(3) | 4(3) | hairer-norsett-wanner-1993, II.4 Table 4.2
      0 |
    1/2 | 1/2
    1/2 | 0 1/2
      1 | 0 0 1
    3/4 | 5/32 7/32 13/32 -1/32
        | 1/6 1/3 1/3 1/6 0
        | -1/2 7/3 7/3 13/6 -16/3
    """
)

_ORDERS_FOUR_AND_FIVE: tuple[RungeKutta, ...] = tableaux(
    """
    england45 | England 4(5) | 4(5) | england-1969, the fourth-order method with a fifth-order estimate
      0 |
    1/2 | 1/2
    1/2 | 1/4 1/4
      1 | 0 -1 2
    2/3 | 7/27 10/27 0 1/27
    1/5 | 28/625 -1/5 546/625 54/625 -378/625
        | 1/6 0 2/3 1/6 0 0
        | 1/24 0 0 5/48 27/56 125/336

    fehlberg45 | Fehlberg 4(5) | 4(5) | hairer-norsett-wanner-1993, II.5 Table 5.1
        0 |
      1/4 | 1/4
      3/8 | 3/32 9/32
    12/13 | 1932/2197 -7200/2197 7296/2197
        1 | 439/216 -8 3680/513 -845/4104
      1/2 | -8/27 2 -3544/2565 1859/4104 -11/40
          | 25/216 0 1408/2565 2197/4104 -1/5 0
          | 16/135 0 6656/12825 28561/56430 -9/50 2/55

    cash_karp54 | Cash-Karp 5(4) | 5(4) | cash-karp-1990, the method and its embedded row of order 4
       0 |
     1/5 | 1/5
    3/10 | 3/40 9/40
     3/5 | 3/10 -9/10 6/5
       1 | -11/54 5/2 -70/27 35/27
     7/8 | 1631/55296 175/512 575/13824 44275/110592 253/4096
         | 37/378 0 250/621 125/594 0 512/1771
         | 2825/27648 0 18575/48384 13525/55296 277/14336 1/4

    dormand_prince54 | Dormand-Prince 5(4) | 5(4) | hairer-norsett-wanner-1993, II.5 Table 5.2
       0 |
     1/5 | 1/5
    3/10 | 3/40 9/40
     4/5 | 44/45 -56/15 32/9
     8/9 | 19372/6561 -25360/2187 64448/6561 -212/729
       1 | 9017/3168 -355/33 46732/5247 49/176 -5103/18656
       1 | 35/384 0 500/1113 125/192 -2187/6784 11/84
         | 35/384 0 500/1113 125/192 -2187/6784 11/84 0
         | 5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40

    # A step and two half steps of RK4: the first row extrapolates both (Richardson), the second is that of the halves.
    rk4_doubling54 | RK4 with step doubling 5(4) | 5(4) | hairer-norsett-wanner-1993, II.4 (4.1) to (4.5)
      0 |
    1/2 | 1/2
    1/2 | 0 1/2
      1 | 0 0 1
    1/4 | 1/4
    1/4 | 0 0 0 0 1/4
    1/2 | 0 0 0 0 0 1/2
    1/2 | 1/12 0 0 0 1/6 1/6 1/12
    3/4 | 1/12 0 0 0 1/6 1/6 1/12 1/4
    3/4 | 1/12 0 0 0 1/6 1/6 1/12 0 1/4
      1 | 1/12 0 0 0 1/6 1/6 1/12 0 0 1/2
        | 7/90 -1/45 -1/45 -1/90 8/45 8/45 4/45 4/45 8/45 8/45 4/45
        | 1/12 0 0 0 1/6 1/6 1/12 1/12 1/6 1/6 1/12

    # The source has a second embedded row, with seven stages; this is the one that reuses the next step's slope.
    bogacki_shampine54 | Bogacki-Shampine 5(4) | 5(4) | bogacki-shampine-1996, the 5(4) pair
      0 |
    1/6 | 1/6
    2/9 | 2/27 4/27
    3/7 | 183/1372 -162/343 1053/1372
    2/3 | 68/297 -4/11 42/143 1960/3861
    3/4 | 597/22528 81/352 63099/585728 58653/366080 4617/20480
      1 | 174197/959244 -30942/79937 8152137/19744439 666106/1039181 -29421/29068 482048/414219
      1 | 587/8064 0 4440339/15491840 24353/124800 387/44800 2152/5985 7267/94080
        | 587/8064 0 4440339/15491840 24353/124800 387/44800 2152/5985 7267/94080 0
        | 2479/34992 0 123/416 612941/3411720 43/1440 2272/6561 79937/1113912 3293/556956
    """
)

ENTRIES: tuple[Method, ...] = (*_LOW_ORDER, *_ORDERS_FOUR_AND_FIVE)
