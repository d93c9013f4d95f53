"""Linear multistep methods: Adams, BDF, NDF, Nyström, Milne-Simpson; Störmer and Cowell for y'' = F(y)."""

from __future__ import annotations

from driftproof.methods.multistep import Multistep
from driftproof.methods.tables.notation import heading, row

# Key | title | order | rho | sigma: both from the oldest value to the new one, over a common denominator as "/12: ...".
# BDF with one step is backward_euler, Adams-Bashforth forward_euler, Adams-Moulton `trapezoid`. Adams-Moulton methods
# are numbered by their steps k, and have order k + 1; other authors number them by order. NDF of order k is BDF of k
# steps less kappa (1 + ... + 1/k) times the backward difference of order k + 1, with kappa = -0.185, -1/9, -0.0823,
# -0.0415.
_FIRST_ORDER = """
adams_bashforth2   | Adams-Bashforth, 2 steps | 2 | 0 -1 1         | /2: -1 3 0
adams_bashforth3   | Adams-Bashforth, 3 steps | 3 | 0 0 -1 1       | /12: 5 -16 23 0
adams_bashforth4   | Adams-Bashforth, 4 steps | 4 | 0 0 0 -1 1     | /24: -9 37 -59 55 0
adams_bashforth5   | Adams-Bashforth, 5 steps | 5 | 0 0 0 0 -1 1   | /720: 251 -1274 2616 -2774 1901 0
adams_bashforth6   | Adams-Bashforth, 6 steps | 6 | 0 0 0 0 0 -1 1 | /1440: -475 2877 -7298 9982 -7923 4277 0
adams_moulton2     | Adams-Moulton, 2 steps   | 3 | 0 -1 1         | /12: -1 8 5
adams_moulton3     | Adams-Moulton, 3 steps   | 4 | 0 0 -1 1       | /24: 1 -5 19 9
adams_moulton4     | Adams-Moulton, 4 steps   | 5 | 0 0 0 -1 1     | /720: -19 106 -264 646 251
adams_moulton5     | Adams-Moulton, 5 steps   | 6 | 0 0 0 0 -1 1   | /1440: 27 -173 482 -798 1427 475
adams_moulton6     | Adams-Moulton, 6 steps   | 7 | 0 0 0 0 0 -1 1 | /60480: -863 6312 -20211 37504 -46461 65112 19087
bdf2               | BDF, 2 steps             | 2 | /2: 1 -4 3     | 0 0 1
bdf3               | BDF, 3 steps             | 3 | /6: -2 9 -18 11            | 0 0 0 1
bdf4               | BDF, 4 steps             | 4 | /12: 3 -16 36 -48 25       | 0 0 0 0 1
bdf5               | BDF, 5 steps             | 5 | /60: -12 75 -200 300 -300 137         | 0 0 0 0 0 1
bdf6               | BDF, 6 steps             | 6 | /60: 10 -72 225 -400 450 -360 147     | 0 0 0 0 0 0 1
ndf1               | NDF of order 1           | 1 | /200: 37 -274 237 | 0 0 1
ndf2               | NDF of order 2           | 2 | /6: -1 6 -15 10   | 0 0 0 1
ndf3               | NDF of order 3           | 3 | /60000: 9053 -56212 144318 -216212 119053 | 0 0 0 0 1
ndf4               | NDF of order 4           | 4 | /960: -83 655 -2110 3710 -4255 2083       | 0 0 0 0 0 1
two_step_leapfrog  | Leapfrog of two steps    | 2 | -1 0 1         | 0 2 0
nystrom_multistep3 | Nyström's multistep method, 3 steps | 3 | 0 -1 0 1   | /3: 1 -2 7 0
nystrom_multistep4 | Nyström's multistep method, 4 steps | 4 | 0 0 -1 0 1 | /3: -1 4 -5 8 0
milne_simpson      | Milne-Simpson            | 4 | -1 0 1         | /3: 1 4 1
"""

# For y'' = F(y). `stormer2` gives the positions of velocity_verlet; `cowell2` is Numerov's method.
_SECOND_ORDER = """
stormer2 | Störmer, 2 steps | 2 | 1 -2 1     | 0 1 0
stormer3 | Störmer, 3 steps | 3 | 0 1 -2 1   | /12: 1 -2 13 0
stormer4 | Störmer, 4 steps | 4 | 0 0 1 -2 1 | /12: -1 4 -5 14 0
cowell2  | Cowell, 2 steps  | 4 | 1 -2 1     | /12: 1 10 1
cowell4  | Cowell, 4 steps  | 5 | 0 0 1 -2 1 | /240: -1 4 14 204 19
"""


def _entry(line: str, derivative: int) -> Multistep:
    names, *polynomials = line.rsplit(" | ", 2)
    read = []
    for text in polynomials:
        over, _, numerators = text.rpartition(": ")
        common = int(over.removeprefix("/") or 1)
        read.append(tuple(x / common for x in row(numerators)))
    source = f"hairer-norsett-wanner-1993, {'III.1' if derivative == 1 else 'III.10'}"
    source = "shampine-reichelt-1997, (4) and Table 1" if names.startswith("ndf") else source
    return Multistep(**heading(f"{names} | {source}"), rho=read[0], sigma=read[1], derivative=derivative)


ENTRIES: tuple[Multistep, ...] = tuple(
    _entry(line, derivative)
    for derivative, lines in enumerate((_FIRST_ORDER, _SECOND_ORDER), 1)
    for line in lines.strip().splitlines()
)
