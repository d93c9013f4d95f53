"""Explicit Runge-Kutta methods without an embedded row, from Ralston's to eleven stages of order 8."""

from __future__ import annotations

from driftproof.methods.schemes import Method, RungeKutta
from driftproof.methods.tables.notation import tableaux

_LOW_ORDER: tuple[RungeKutta, ...] = tableaux(
    """
    ralston2 | Ralston's second-order method | 2 | ralston-1962, equation 3.5
      0 |
    2/3 | 2/3
        | 1/4 3/4

    heun3 | Heun's third-order method | 3 | hairer-norsett-wanner-1993, II.1 Table 1.1
      0 |
    1/3 | 1/3
    2/3 | 0 2/3
        | 1/4 0 3/4

    # This method has one stage more than order 3 needs.
    runge3 | Runge's third-order method, four stages | 3 | hairer-norsett-wanner-1993, II.1 Table 1.1
      0 |
    1/2 | 1/2
      1 | 0 1
      1 | 0 0 1
        | 1/6 2/3 0 1/6

    ralston3 | Ralston's third-order method | 3 | ralston-1962, equation 4.10
      0 |
    1/2 | 1/2
    3/4 | 0 3/4
        | 2/9 1/3 4/9

    kutta3 | Kutta's third-order method | 3 | butcher-2016, 233
      0 |
    1/2 | 1/2
      1 | -1 2
        | 1/6 2/3 1/6

    # RK4 rearranged so that storage of three numbers per component suffices.
    gill4 | Gill's fourth-order method | 4 | gill-1951, the process with three storage registers
      0 |
    1/2 | 1/2
    1/2 | (sqrt(2)-1)/2 1-sqrt(2)/2
      1 | 0 -sqrt(2)/2 1+sqrt(2)/2
        | 1/6 (2-sqrt(2))/6 (2+sqrt(2))/6 1/6

    ralston4 | Ralston's fourth-order method | 4 | ralston-1962, the fourth-order method of least error bound
                   0 |
                 2/5 | 2/5
    7/8-3*sqrt(5)/16 | (-2889+1428*sqrt(5))/1024 (3785-1620*sqrt(5))/1024
                   1 | (-3365+2094*sqrt(5))/6040 (-975-3046*sqrt(5))/2552 (467040+203968*sqrt(5))/240845
                      | (263+24*sqrt(5))/1812 (125-1000*sqrt(5))/3828 (3426304+1661952*sqrt(5))/5924787 \
        (30-4*sqrt(5))/123
    """
)

_HIGHER_ORDER: tuple[RungeKutta, ...] = tableaux(
    """
    # Not one of the Nyström methods for q'' = F(q): this one is Nyström's repair of Kutta's fifth-order method.
    kutta_nystrom5 | Kutta-Nyström fifth-order method | 5 | nystrom-1925, the corrected fifth-order method of Kutta
      0 |
    1/3 | 1/3
    2/5 | 4/25 6/25
      1 | 1/4 -3 15/4
    2/3 | 2/27 10/9 -50/81 8/81
    4/5 | 2/25 12/25 2/15 8/75
        | 23/192 0 125/192 0 -27/64 125/192

    butcher5 | Butcher's fifth-order method | 5 | butcher-2016, 236
      0 |
    1/4 | 1/4
    1/4 | 1/8 1/8
    1/2 | 0 0 1/2
    3/4 | 3/16 -3/8 3/8 9/16
      1 | -3/7 8/7 6/7 -12/7 8/7
        | 7/90 0 16/45 2/15 16/45 7/90

    lawson5 | Lawson's fifth-order method | 5 | lawson-1966, the process with extended region of stability
       0 |
    1/12 | 1/12
     1/4 | -1/8 3/8
     1/2 | 3/5 -9/10 4/5
     3/4 | 39/80 -9/20 3/20 9/16
       1 | -59/35 66/35 48/35 -12/7 8/7
         | 7/90 0 16/45 2/15 16/45 7/90

    luther6 | Luther's sixth-order method | 6 | luther-1968, the explicit sixth-order formula
                  0 |
                  1 | 1
                1/2 | 3/8 1/8
                2/3 | 8/27 2/27 8/27
    (7-sqrt(21))/14 | (9*sqrt(21)-21)/392 (8*sqrt(21)-56)/392 (336-48*sqrt(21))/392 (3*sqrt(21)-63)/392
    (7+sqrt(21))/14 | (-1155-255*sqrt(21))/1960 (-280-40*sqrt(21))/1960 -320*sqrt(21)/1960 \
        (63+363*sqrt(21))/1960 (2352+392*sqrt(21))/1960
                   1 | (330+105*sqrt(21))/180 2/3 (280*sqrt(21)-200)/180 (126-189*sqrt(21))/180 \
        (-686-126*sqrt(21))/180 (490-70*sqrt(21))/180
                    | 1/20 0 16/45 0 49/180 49/180 1/20

    butcher6 | Butcher's sixth-order method | 6 | butcher-high-order-1964, the sixth-order processes with seven stages
      0 |
    1/3 | 1/3
    2/3 | 0 2/3
    1/3 | 1/12 1/3 -1/12
    1/2 | -1/16 9/8 -3/16 -3/8
    1/2 | 0 9/8 -3/8 -3/4 1/2
      1 | 9/44 -9/11 63/44 18/11 0 -16/11
        | 11/120 0 27/40 27/40 -4/15 -4/15 11/120

    butcher7 | Butcher's seventh-order method | 7 | butcher-2016, 327
       0 |
     1/6 | 1/6
     1/3 | 0 1/3
     1/2 | 1/8 0 3/8
    2/11 | 148/1331 0 150/1331 -56/1331
     2/3 | -404/243 0 -170/27 4024/1701 10648/1701
     6/7 | 2466/2401 0 1242/343 -19176/16807 -51909/16807 1053/2401
       0 | 5/154 0 0 96/539 -1815/20384 -405/2464 49/1144
       1 | -113/32 0 -195/22 32/7 29403/3584 -729/512 1029/1408 21/16
         | 0 0 0 32/105 1771561/6289920 243/2560 16807/74880 77/1440 11/270

    cooper_verner8 | Cooper-Verner eighth-order method | 8 | cooper-verner-1972, the eighth-order method with \
        eleven stages
                  0 |
                1/2 | 1/2
                1/2 | 1/4 1/4
    (7+sqrt(21))/14 | 1/7 (-7-3*sqrt(21))/98 (21+5*sqrt(21))/49
    (7+sqrt(21))/14 | (11+sqrt(21))/84 0 (18+4*sqrt(21))/63 (21-sqrt(21))/252
                1/2 | (5+sqrt(21))/48 0 (9+sqrt(21))/36 (-231+14*sqrt(21))/360 (63-7*sqrt(21))/80
    (7-sqrt(21))/14 | (10-sqrt(21))/42 0 (-432+92*sqrt(21))/315 (633-145*sqrt(21))/90 (-504+115*sqrt(21))/70 \
        (63-13*sqrt(21))/35
    (7-sqrt(21))/14 | 1/14 0 0 0 (14-3*sqrt(21))/126 (13-3*sqrt(21))/63 1/9
                1/2 | 1/32 0 0 0 (91-21*sqrt(21))/576 11/72 (-385-75*sqrt(21))/1152 (63+13*sqrt(21))/128
    (7+sqrt(21))/14 | 1/14 0 0 0 1/9 (-733-147*sqrt(21))/2205 (515+111*sqrt(21))/504 (-51-11*sqrt(21))/56 \
        (132+28*sqrt(21))/245
                   1 | 0 0 0 0 (-42+7*sqrt(21))/18 (-18+28*sqrt(21))/45 (-273-53*sqrt(21))/72 \
        (301+53*sqrt(21))/72 (28-28*sqrt(21))/45 (49-7*sqrt(21))/18
                    | 1/20 0 0 0 0 0 0 49/180 16/45 49/180 1/20
    """
)

ENTRIES: tuple[Method, ...] = (*_LOW_ORDER, *_HIGHER_ORDER)
