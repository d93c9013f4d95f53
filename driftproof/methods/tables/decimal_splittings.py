"""Compositions of kicks and drifts whose sources print decimals, which are taken as the exact coefficients.

If a source determines the last coefficients by Σ kicks = Σ drifts = 1, so does this file, and the sums are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction as Q
from itertools import zip_longest

from driftproof.methods.schemes import Method, Splitting
from driftproof.methods.tables.notation import row, splitting
from driftproof.methods.tables.splittings import Parts, alternating, palindrome, verlet_composition


def _read(build: Callable[..., Parts], text: str, *, quadratic_kinetic: bool = False) -> tuple[Splitting, ...]:
    """The decimal splittings of a text, separated by blank lines: a line of names, the first sub-step, and numbers.

    `build` makes the parts from the first sub-step and the rows of numbers, which semicolons separate.
    """
    found = []
    for entry in text.strip().split("\n\n"):
        names, _, given = entry.partition("\n")
        first, _, numbers = given.partition(":")
        parts = build(first.strip(), *map(row, numbers.split(";")))
        found.append(replace(splitting(names, parts, quadratic_kinetic=quadratic_kinetic), decimal=True))
    return tuple(found)


def _composition(first: str, outside_in: Sequence[Q]) -> Parts:
    """The symmetric composition of Verlet steps with these weights, of which the last is in the middle."""
    return verlet_composition(first, palindrome(outside_in))


def _completed(first: str, outside_in: Sequence[Q]) -> Parts:
    """The symmetric composition of Verlet steps with these outer weights; the middle one makes the sum 1."""
    return _composition(first, (*outside_in, 1 - 2 * sum(outside_in, Q(0))))


def _symmetric(first: str, outer: Sequence[Q], inner: Sequence[Q]) -> Parts:
    """A palindrome of alternating sub-steps that begins with `first`; the innermost ones make the sums of each kind 1.

    One kind has the single sub-step in the middle, the other kind the two next to it.
    """
    single, double = (outer, inner) if len(outer) > len(inner) else (inner, outer)
    middle, beside = 1 - 2 * sum(single, Q(0)), Q(1, 2) - sum(double, Q(0))
    full = ((*outer, middle), (*inner, beside)) if single is outer else ((*outer, beside), (*inner, middle))
    return alternating(first, palindrome([x for pair in zip_longest(*full) for x in pair if x is not None]))


def _omelyan(first: str, printed: Sequence[Q]) -> Parts:
    """ξ, (1-2λ)/2, χ, λ, 1-2(χ+ξ), λ, ..., ξ: the extended Forest-Ruth form, of which ξ, λ and χ are printed."""
    xi, lam, chi = printed
    return _symmetric(first, (xi, chi), (Q(1, 2) - lam,))


_YOSHIDA = _read(
    _completed,
    """
    yoshida6 | Yoshida's order 6, solution A | 6 | yoshida-1990, Table 1, solution A
    kick: 0.784513610477560 0.235573213359357 -0.117767998417887E1

    yoshida6_position_first | Yoshida's order 6, solution A, position first | 6 | yoshida-1990, Table 1, solution A
    drift: 0.784513610477560 0.235573213359357 -0.117767998417887E1

    yoshida6_b | Yoshida's order 6, solution B | 6 | yoshida-1990, Table 1, solution B
    kick: 0.143984816797678E1 0.426068187079180E-2 -0.213228522200144E1

    yoshida6_c | Yoshida's order 6, solution C | 6 | yoshida-1990, Table 1, solution C
    kick: 0.144778256239930E1 -0.214403531630539E1 0.152886228424922E-2

    yoshida8 | Yoshida's order 8, solution D | 8 | yoshida-1990, Table 2, solution D
    kick: 0.914844246229740 0.253693336566229 -0.144485223686048E1 -0.158240635368243
    0.193813913762276E1 -0.196061023297549E1 0.102799849391985

    yoshida8_position_first | Yoshida's order 8, solution D, position first | 8 | yoshida-1990, Table 2, solution D
    drift: 0.914844246229740 0.253693336566229 -0.144485223686048E1 -0.158240635368243
    0.193813913762276E1 -0.196061023297549E1 0.102799849391985

    yoshida8_a | Yoshida's order 8, solution A | 8 | yoshida-1990, Table 2, solution A
    kick: 0.104242620869991E1 0.182020630970714E1 0.157739928123617 0.244002732616735E1
    -0.716989419708120E-2 -0.244699182370524E1 -0.161582374150097E1
    """,
)

# In these sources the middle weight is printed, too.
_COMPOSITIONS = _read(
    _composition,
    """
    kahan_li6 | Kahan-Li order 6, nine steps of velocity Verlet | 6 | hairer-lubich-wanner-2006, V.3.2
    kick: 0.39216144400731413927925056 0.33259913678935943859974864 -0.70624617255763935980996482
    0.08221359629355080023149045 0.79854399093482996339895035

    suzuki_umeno8 | Suzuki-Umeno order 8, fifteen steps of velocity Verlet | 8 | hairer-lubich-wanner-2006, V.3.2
    kick: 0.74167036435061295344822780 -0.40910082580003159399730010 0.19075471029623837995387626
    -0.57386247111608226665638773 0.29906418130365592384446354 0.33462491824529818378495798
    0.31529309239676659663205666 -0.79688793935291635401978884

    kahan_li8 | Kahan-Li order 8, seventeen steps of velocity Verlet | 8 | hairer-lubich-wanner-2006, V.3.2
    kick: 0.13020248308889008087881763 0.56116298177510838456196441 -0.38947496264484728640807860
    0.15884190655515560089621075 -0.39590389413323757733623154 0.18453964097831570709183254
    0.25837438768632204729397911 0.29501172360931029887096624 -0.60550853383003451169892108
    """,
)

# In Table 2 of the source the first two kicks of this method are swapped, according to principia-2026.
_THIRD_ORDER = _read(
    alternating,
    """
    mclachlan_atela3 | McLachlan-Atela optimal method of order 3 | 3 | mclachlan-atela-1992, equation 3.3
    kick: 0.2683300957817599250 0.9196615230173998571 -0.1879916187991597820
    -0.1879916187991597820 0.9196615230173998571 0.2683300957817599250
    """,
)

_FOR_QUADRATIC = _read(
    alternating,
    """
    mclachlan_atela4 | McLachlan-Atela optimal method of order 4 | 4 | mclachlan-atela-1992, Table 2, order 4
    kick: 0.1344961992774310892 0.5153528374311229364 -0.2248198030794208058 -0.085782019412973646
    0.7563200005156682911 0.4415830236164665242 0.3340036032863214255 0.1288461583653841854

    mclachlan_atela5 | McLachlan-Atela optimal method of order 5 | 5 | mclachlan-atela-1992, Table 2, order 5
    kick: 0.1193900292875672758 0.339839625839110000 0.6989273703824752308 -0.088601336903027329
    -0.1713123582716007754 0.5858564768259621188 0.4012695022513534480 -0.603039356536491888
    0.0107050818482359840 0.3235807965546976394 -0.0589796254980311632 0.4423637942197494587
    """,
    quadratic_kinetic=True,
)

_OMELYAN = _read(
    _omelyan,
    """
    pefrl | PEFRL, the position-extended Forest-Ruth-like method | 4 \
        | omelyan-mryglod-folk-2002, the position-extended algorithm
    drift: 0.1786178958448091 -0.2123418310626054 -0.6626458266981849E-1

    vefrl | VEFRL, the velocity-extended Forest-Ruth-like method | 4 \
        | omelyan-mryglod-folk-2002, the velocity-extended algorithm
    kick: 0.1644986515575760 -0.2094333910398989E-1 0.1235692651138917E1
    """,
)

_BLANES_MOAN = _read(
    _symmetric,
    """
    blanes_moan4 | Blanes-Moan S6, order 4 | 4 | blanes-moan-2002, the partitioned method S6 of order 4
    drift: 0.0792036964311957 0.353172906049774 -0.0420650803577195; 0.209515106613362 -0.143851773179818

    blanes_moan6 | Blanes-Moan S10, order 6 | 6 | blanes-moan-2002, the partitioned method S10 of order 6
    drift: 0.0502627644003922 0.413514300428344 0.0450798897943977 -0.188054853819569 0.541960678450780;
    0.148816447901042 -0.132385865767784 0.067307604692185 0.432666402578175
    """,
)

_BLANES_MOAN_RKN = _read(
    _symmetric,
    """
    blanes_moan_rkn4 | Blanes-Moan SRKN6b, order 4 | 4 \
        | blanes-moan-2002, the Nystrom method of order 4 with six stages, kick first
    kick: 0.0829844064174052 0.396309801498368 -0.0390563049223486; 0.245298957184271 0.604872665711080

    blanes_moan_rkn6b | Blanes-Moan SRKN11b, order 6 | 6 \
        | blanes-moan-2002, the Nystrom method of order 6 with eleven stages, kick first
    kick: 0.0414649985182624 0.198128671918067 -0.0400061921041533 0.0752539843015807
    -0.0115113874206879;
    0.123229775946271 0.290553797799558 -0.127049212625417 -0.246331761062075
    0.357208872795928

    blanes_moan_rkn6a | Blanes-Moan SRKN14a, order 6 | 6 \
        | blanes-moan-2002, the Nystrom method of order 6 with fourteen stages, drift first
    drift: 0.0378593198406116 0.102635633102435 -0.0258678882665587 0.314241403071447
    -0.130144459517415 0.106417700369543 -0.00879424312851058;
    0.09171915262446165 0.183983170005006 -0.05653436583288827 0.004914688774712854
    0.143761127168358 0.328567693746804
    """,
    quadratic_kinetic=True,
)

ENTRIES: tuple[Method, ...] = (
    *(*_YOSHIDA, *_COMPOSITIONS, *_THIRD_ORDER, *_FOR_QUADRATIC),
    *(*_OMELYAN, *_BLANES_MOAN, *_BLANES_MOAN_RKN),
)
