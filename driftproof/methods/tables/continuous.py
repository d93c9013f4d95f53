"""Continuous extensions of codes in use, with the coefficients that their sources print.

The digits of DOP853's are those of the program dop853.f of hairer-norsett-wanner-1993, Appendix.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import cast

from driftproof.methods.continuous import ContinuousExtension, PolynomialInTheta, hermite
from driftproof.methods.schemes import RungeKutta
from driftproof.methods.tables.basic import ENTRIES as BASIC
from driftproof.methods.tables.decimal_pairs import DOP853
from driftproof.methods.tables.decimal_pairs import ENTRIES as DECIMAL_PAIRS
from driftproof.methods.tables.embedded import ENTRIES as PAIRS
from driftproof.methods.tables.notation import row

_METHODS = {method.key: method for method in (*BASIC, *PAIRS, *DECIMAL_PAIRS) if isinstance(method, RungeKutta)}


def _quartic(key: str, title: str, source: str, method: str, weights: str) -> ContinuousExtension:
    """An extension of order 4 without further stages, by the coefficients of θ, θ², θ³, θ⁴ in a line for each stage."""
    polynomials = tuple((Fraction(0), *row(line)) for line in weights.strip().splitlines())
    base = _METHODS[method]
    return ContinuousExtension(key, title, 4, source, base, base.a, base.c, polynomials)


# Among the quartics with this continuity, the one with the least error at θ = 1/2; ode45, dopri5 and RK45 use it.
_SHAMPINE = _quartic(
    "dormand_prince54_shampine",
    "Dormand-Prince 5(4), Shampine's quartic",
    "shampine-1986, the interpolant of order 4",
    "dormand_prince54",
    """1 -8048581381/2820520608 8663915743/2820520608 -12715105075/11282082432
    0 0 0 0
    0 131558114200/32700410799 -68118460800/10900136933 87487479700/32700410799
    0 -1754552775/470086768 14199869525/1410260304 -10690763975/1880347072
    0 127303824393/49829197408 -318862633887/49829197408 701980252875/199316789632
    0 -282668133/205662961 2019193451/616988883 -1453857185/822651844
    0 40617522/29380423 -110615467/29380423 69997945/29380423""",
)

# The source prints products of factors; here they are multiplied out, with the digits that programs use.
_TSITOURAS = _quartic(
    "tsitouras54_quartic",
    "Tsitouras 5(4), its quartic",
    "tsitouras-2011, the interpolant, multiplied out",
    "tsitouras54",
    """1 -2.763706197274826 2.9132554618219126 -1.0530884977290216
    0 0.1317 -0.2234 0.1017
    0 3.9302962368947516 -5.941033872131505 2.490627285651253
    0 -12.411077166933676 30.33818863028232 -16.548102889244902
    0 37.50931341651104 -88.1789048947664 47.37952196281928
    0 -27.896526289197286 65.09189467479366 -34.87065786149661
    0 1.5 -4 2.5""",
)


def _paragraphs(text: str) -> tuple[tuple[Fraction, ...], ...]:
    """A row of numbers for each paragraph."""
    return tuple(row(paragraph) for paragraph in text.split("\n\n"))


# Stages 14 to 16; stage 13 is the slope at the end of the step.
_FURTHER_STAGES = _paragraphs(
    """
    5.61675022830479523392909219681E-2 0 0 0 0 0 2.53500210216624811088794765333E-1
    -2.46239037470802489917441475441E-1 -1.24191423263816360469010140626E-1
    1.5329179827876569731206322685E-1 8.20105229563468988491666602057E-3 7.56789766054569976138603589584E-3
    -8.298E-3 0 0 0

    3.18346481635021405060768473261E-2 0 0 0 0 2.83009096723667755288322961402E-2
    5.35419883074385676223797384372E-2 -5.49237485713909884646569340306E-2 0 0
    -1.08347328697249322858509316994E-4 3.82571090835658412954920192323E-4
    -3.40465008687404560802977114492E-4 1.41312443674632500278074618366E-1 0 0

    -4.28896301583791923408573538692E-1 0 0 0 0 -4.69762141536116384314449447206
    7.68342119606259904184240953878 4.06898981839711007970213554331 3.56727187455281109270669543021E-1 0 0 0
    -1.39902416515901462129418009734E-3 2.9475147891527723389556272149 -9.15095847217987001081870187138 0
    """
)
_FURTHER_NODES = row("1 0.1 0.2 0.777777777777777777777777777778")
# The last four of the program's seven differences, of all 16 stages.
_LAST_DIFFERENCES = _paragraphs(
    """
    -0.84289382761090128651353491142E1 0 0 0 0 0.56671495351937776962531783590
    -0.30689499459498916912797304727E1 0.23846676565120698287728149680E1 0.21170345824450282767155149946E1
    -0.87139158377797299206789907490 0.22404374302607882758541771650E1 0.63157877876946881815570249290
    -0.88990336451333310820698117400E-1 0.18148505520854727256656404962E2 -0.91946323924783554000451984436E1
    -0.44360363875948939664310572000E1

    0.10427508642579134603413151009E2 0 0 0 0 0.24228349177525818288430175319E3
    0.16520045171727028198505394887E3 -0.37454675472269020279518312152E3 -0.22113666853125306036270938578E2
    0.77334326684722638389603898808E1 -0.30674084731089398182061213626E2 -0.93321305264302278729567221706E1
    0.15697238121770843886131091075E2 -0.31139403219565177677282850411E2 -0.93529243588444783865713862664E1
    0.35816841486394083752465898540E2

    0.19985053242002433820987653617E2 0 0 0 0 -0.38703730874935176555105901742E3
    -0.18917813819516756882830838328E3 0.52780815920542364900561016686E3 -0.11573902539959630126141871134E2
    0.68812326946963000169666922661E1 -0.10006050966910838403183860980E1 0.77771377980534432092869265740
    -0.27782057523535084065932004339E1 -0.60196695231264120758267380846E2 0.84320405506677161018159903784E2
    0.11992291136182789328035130030E2

    -0.25693933462703749003312586129E2 0 0 0 0 -0.15418974869023643374053993627E3
    -0.23152937917604549567536039109E3 0.35763911791061412378285349910E3 0.93405324183624310003907691704E2
    -0.37458323136451633156875139351E2 0.10409964950896230045147246184E3 0.29840293426660503123344363579E2
    -0.43533456590011143754432175058E2 0.96324553959188282948394950600E2 -0.39177261675615439165231486172E2
    -0.14972683625798562581422125276E3
    """
)


def _dop853() -> ContinuousExtension:
    """The extension y + θ(F₁ + (1-θ)(F₂ + θ(F₃ + (1-θ)(F₄ + θ(F₅ + (1-θ)(F₆ + θF₇)))))), nested as in the program.

    F₁ = y₁ - y, F₂ = h k₁ - F₁ and F₃ = 2 F₁ - h (k₁ + k₁₃); the other four are h times rows of coefficients.
    """
    blank = [Fraction(0)] * 4
    b = [*cast("tuple[Fraction, ...]", DOP853.b), *blank]
    first, last = ([Fraction(i == j) for i in range(16)] for j in (0, 12))
    differences: list[Sequence[Fraction]] = [
        b,
        [x - y for x, y in zip(first, b, strict=True)],
        [2 * y - x - z for x, y, z in zip(first, b, last, strict=True)],
        *_LAST_DIFFERENCES,
    ]
    a = (*((*entries, *blank) for entries in DOP853.a), tuple(b), *_FURTHER_STAGES)
    weights = tuple(_nested([difference[i] for difference in differences]) for i in range(16))
    source = "hairer-norsett-wanner-1993, Appendix, Subroutine DOP853"
    title = "DOP853, its continuous extension"
    return ContinuousExtension("dop853_dense", title, 7, source, DOP853, a, (*DOP853.c, *_FURTHER_NODES), weights)


def _nested(values: Sequence[Fraction]) -> PolynomialInTheta:
    """The polynomial θ(v₁ + (1-θ)(v₂ + θ(v₃ + ...))), multiplied out."""
    polynomial: list[Fraction] = [Fraction(0)]
    for i in range(len(values) - 1, -1, -1):
        polynomial[0] += values[i]
        shifted = [Fraction(0), *polynomial]
        polynomial = (
            shifted if i % 2 == 0 else [x - y for x, y in zip([*polynomial, Fraction(0)], shifted, strict=True)]
        )
    return tuple(polynomial)


ENTRIES: tuple[ContinuousExtension, ...] = (
    hermite(_METHODS["bogacki_shampine32"], "bogacki-shampine-1989, the 3(2) pair"),
    hermite(_METHODS["rk4"]),
    _SHAMPINE,
    hermite(_METHODS["dormand_prince54"]),
    _TSITOURAS,
    _dop853(),
)
