"""Diagonally implicit Runge-Kutta methods, whose stages are solved one after the other."""

from __future__ import annotations

from fractions import Fraction as Q

from driftproof.methods.numbers.number_field import NumberField, square_root
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import numbers, padded, tableaux

S2 = square_root(2)
# Roots of γ³ - 3γ² + 3γ/2 - 1/6 and of γ³ - 3γ²/2 + γ/2 - 1/24: orders 3 and 4 with three stages and one eigenvalue.
ALEXANDER_GAMMA = NumberField("gamma3", (-1, 9, -18, 6), Q(2, 5), Q(1, 2)).generator
CROUZEIX_GAMMA = NumberField("gamma4", (-1, 12, -36, 24), Q(1), Q(3, 2)).generator


def _alexander3() -> RungeKutta:
    gamma = ALEXANDER_GAMMA
    b1 = -(6 * gamma**2 - 16 * gamma + 1) / 4
    b2 = (6 * gamma**2 - 20 * gamma + 5) / 4
    return RungeKutta(
        key="alexander3",
        title="Alexander's L-stable SDIRK method of order 3",
        claimed_order=3,
        source="alexander-1977, the strongly S-stable method with three stages",
        c=numbers(gamma, (1 + gamma) / 2, 1),
        a=padded((gamma,), ((1 - gamma) / 2, gamma), (b1, b2, gamma)),
        b=(b1, b2, gamma),
    )


def _crouzeix4() -> RungeKutta:
    gamma = CROUZEIX_GAMMA
    delta = 1 / (6 * (2 * gamma - 1) ** 2)
    return RungeKutta(
        key="crouzeix4",
        title="Crouzeix's A-stable SDIRK method of order 4",
        claimed_order=4,
        source="hairer-norsett-wanner-1993, II.7",
        c=(gamma, Q(1, 2), 1 - gamma),
        a=padded((gamma,), (Q(1, 2) - gamma, gamma), (2 * gamma, 1 - 4 * gamma, gamma)),
        b=(delta, 1 - 2 * delta, delta),
    )


def _tr_bdf2() -> RungeKutta:
    d, w = 1 - S2 / 2, S2 / 4
    return RungeKutta(
        key="tr_bdf2",
        title="TR-BDF2",
        claimed_order=2,
        source="hosea-shampine-1996, the method as a Runge-Kutta pair",
        c=numbers(0, 2 - S2, 1),
        a=padded((0,), (d, d), (w, w, d)),
        b=(w, w, d),
        b_embedded=((1 - w) / 3, (3 * w + 1) / 3, d / 3),
        embedded_order=3,
    )


ENTRIES: tuple[Method, ...] = (
    *tableaux(
        """
    # L-stable for γ = 1 ± sqrt(2)/2; this is the minus sign, because the other γ has a far larger error.
    sdirk2 | L-stable SDIRK method of order 2 | 2 | alexander-1977, the strongly S-stable method with two stages
    1-sqrt(2)/2 | 1-sqrt(2)/2
              1 | sqrt(2)/2 1-sqrt(2)/2
                | sqrt(2)/2 1-sqrt(2)/2

    qin_zhang2 | Qin-Zhang symplectic SDIRK method | 2 | qin-zhang-1992, the symplectic method with two equal half steps
    1/4 | 1/4
    3/4 | 1/2 1/4
        | 1/2 1/2

    crouzeix3 | Crouzeix's A-stable SDIRK method of order 3 (Nørsett) | 3 | hairer-norsett-wanner-1993, II.7
    (3+sqrt(3))/6 | (3+sqrt(3))/6
    (3-sqrt(3))/6 | -sqrt(3)/3 (3+sqrt(3))/6
                  | 1/2 1/2
    """
    ),
    _alexander3(),
    _crouzeix4(),
    *tableaux(
        """
    sdirk4 | Hairer-Wanner SDIRK4 | 4(3) | hairer-wanner-1996, IV.6, page 100
      1/4 | 1/4
      3/4 | 1/2 1/4
    11/20 | 17/50 -1/25 1/4
      1/2 | 371/1360 -137/2720 15/544 1/4
        1 | 25/24 -49/48 125/16 -85/12 1/4
          | 25/24 -49/48 125/16 -85/12 1/4
          | 59/48 -17/96 225/32 -85/12 0
    """
    ),
    _tr_bdf2(),
    *tableaux(
        """
    esdirk43 | Kennedy-Carpenter ESDIRK 4(3), the implicit half of ARK4(3)6L[2]SA | 4(3) | \
        kennedy-carpenter-2003, ARK4(3)6L[2]SA-ESDIRK
         0 |
       1/2 | 1/4 1/4
    83/250 | 8611/62500 -1743/31250 1/4
     31/50 | 5012029/34652500 -654441/2922500 174375/388108 1/4
     17/20 | 15267082809/155376265600 -71443401/120774400 730878875/902184768 2285395/8070912 1/4
         1 | 82889/524892 0 15625/83664 69875/102672 -2260/8211 1/4
           | 82889/524892 0 15625/83664 69875/102672 -2260/8211 1/4
           | 4586570599/29645900160 0 178811875/945068544 814220225/1159782912 -3700637/11593932 61727/225920
    """
    ),
)
