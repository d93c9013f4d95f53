"""Compositions of kicks and drifts whose sources print decimals: the coefficients are exactly those decimals.

Where a source leaves the last coefficients to Σ kicks = Σ drifts = 1, so does this file, and the sums are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction as Q
from itertools import zip_longest

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Method, Splitting
from driftproof.methods.tables.notation import row, splitting
from driftproof.methods.tables.splittings import Parts, alternating, palindrome, verlet_composition


def _verlet_weights(outside_in: str) -> tuple[Exact, ...]:
    """The weights, the one that makes all of them add to 1, and the weights backwards."""
    weights = row(outside_in)
    return palindrome((*weights, 1 - 2 * sum(weights, Q(0))))


def _symmetric(first: str, outer: Sequence[Q], inner: Sequence[Q]) -> Parts:
    """A palindrome of sub-steps `first` and the others in turn; the last coefficient of each kind follows from the sum.

    One kind has one sub-step in the middle, the other one the two beside it.
    """
    single, double = (outer, inner) if len(outer) > len(inner) else (inner, outer)
    middle, beside = 1 - 2 * sum(single, Q(0)), Q(1, 2) - sum(double, Q(0))
    full = ((*outer, middle), (*inner, beside)) if single is outer else ((*outer, beside), (*inner, middle))
    return alternating(first, palindrome([x for pair in zip_longest(*full) for x in pair if x is not None]))


_YOSHIDA6A = _verlet_weights("0.784513610477560 0.235573213359357 -0.117767998417887E1")
_YOSHIDA8D = _verlet_weights(
    """0.914844246229740 0.253693336566229 -0.144485223686048E1 -0.158240635368243
    0.193813913762276E1 -0.196061023297549E1 0.102799849391985"""
)

_YOSHIDA: tuple[Splitting, ...] = (
    splitting(
        "yoshida6 | Yoshida's order 6, solution A | 6 | yoshida-1990, Table 1, solution A",
        verlet_composition("kick", _YOSHIDA6A),
    ),
    Splitting(
        key="yoshida6_position_first",
        title="Yoshida's order 6, solution A, position first",
        claimed_order=6,
        source="yoshida-1990, Table 1, solution A",
        parts=verlet_composition("drift", _YOSHIDA6A),
    ),
    splitting(
        "yoshida6_b | Yoshida's order 6, solution B | 6 | yoshida-1990, Table 1, solution B",
        verlet_composition("kick", _verlet_weights("0.143984816797678E1 0.426068187079180E-2 -0.213228522200144E1")),
    ),
    splitting(
        "yoshida6_c | Yoshida's order 6, solution C | 6 | yoshida-1990, Table 1, solution C",
        verlet_composition("kick", _verlet_weights("0.144778256239930E1 -0.214403531630539E1 0.152886228424922E-2")),
    ),
    splitting(
        "yoshida8 | Yoshida's order 8, solution D | 8 | yoshida-1990, Table 2, solution D",
        verlet_composition("kick", _YOSHIDA8D),
    ),
    Splitting(
        key="yoshida8_position_first",
        title="Yoshida's order 8, solution D, position first",
        claimed_order=8,
        source="yoshida-1990, Table 2, solution D",
        parts=verlet_composition("drift", _YOSHIDA8D),
    ),
    splitting(
        "yoshida8_a | Yoshida's order 8, solution A | 8 | yoshida-1990, Table 2, solution A",
        verlet_composition(
            "kick",
            _verlet_weights(
                """0.104242620869991E1 0.182020630970714E1 0.157739928123617 0.244002732616735E1
                -0.716989419708120E-2 -0.244699182370524E1 -0.161582374150097E1"""
            ),
        ),
    ),
)

# Here the middle weight is printed, too.
_COMPOSITIONS: tuple[Splitting, ...] = (
    splitting(
        "kahan_li6 | Kahan-Li order 6, nine steps of velocity Verlet | 6 | hairer-lubich-wanner-2006, V.3.2",
        verlet_composition(
            "kick",
            palindrome(
                row(
                    """0.39216144400731413927925056 0.33259913678935943859974864 -0.70624617255763935980996482
                    0.08221359629355080023149045 0.79854399093482996339895035"""
                )
            ),
        ),
    ),
    Splitting(
        key="suzuki_umeno8",
        title="Suzuki-Umeno order 8, fifteen steps of velocity Verlet",
        claimed_order=8,
        source="hairer-lubich-wanner-2006, V.3.2",
        parts=verlet_composition(
            "kick",
            palindrome(
                row(
                    """0.74167036435061295344822780 -0.40910082580003159399730010 0.19075471029623837995387626
                    -0.57386247111608226665638773 0.29906418130365592384446354 0.33462491824529818378495798
                    0.31529309239676659663205666 -0.79688793935291635401978884"""
                )
            ),
        ),
    ),
    splitting(
        "kahan_li8 | Kahan-Li order 8, seventeen steps of velocity Verlet | 8 | hairer-lubich-wanner-2006, V.3.2",
        verlet_composition(
            "kick",
            palindrome(
                row(
                    """0.13020248308889008087881763 0.56116298177510838456196441 -0.38947496264484728640807860
                    0.15884190655515560089621075 -0.39590389413323757733623154 0.18453964097831570709183254
                    0.25837438768632204729397911 0.29501172360931029887096624 -0.60550853383003451169892108"""
                )
            ),
        ),
    ),
)

_KICK_DRIFT: tuple[Splitting, ...] = (
    # Table 2 of the source is reported to have the first two kicks of this one swapped (principia-2026).
    splitting(
        "mclachlan_atela3 | McLachlan-Atela optimal method of order 3 | 3 | mclachlan-atela-1992, equation 3.3",
        alternating(
            "kick",
            row(
                """0.2683300957817599250 0.9196615230173998571 -0.1879916187991597820
                -0.1879916187991597820 0.9196615230173998571 0.2683300957817599250"""
            ),
        ),
    ),
    splitting(
        "mclachlan_atela4 | McLachlan-Atela optimal method of order 4 | 4 | mclachlan-atela-1992, Table 2, order 4",
        alternating(
            "kick",
            row(
                """0.1344961992774310892 0.5153528374311229364 -0.2248198030794208058 -0.085782019412973646
                0.7563200005156682911 0.4415830236164665242 0.3340036032863214255 0.1288461583653841854"""
            ),
        ),
        quadratic_kinetic=True,
    ),
    splitting(
        "mclachlan_atela5 | McLachlan-Atela optimal method of order 5 | 5 | mclachlan-atela-1992, Table 2, order 5",
        alternating(
            "kick",
            row(
                """0.1193900292875672758 0.339839625839110000 0.6989273703824752308 -0.088601336903027329
                -0.1713123582716007754 0.5858564768259621188 0.4012695022513534480 -0.603039356536491888
                0.0107050818482359840 0.3235807965546976394 -0.0589796254980311632 0.4423637942197494587"""
            ),
        ),
        quadratic_kinetic=True,
    ),
)


def _omelyan(first: str, xi: str, lam: str, chi: str) -> Parts:
    """ξ, (1-2λ)/2, χ, λ, 1-2(χ+ξ), λ, ..., ξ: the extended Forest-Ruth form, of which ξ, λ and χ are printed."""
    return _symmetric(first, (Q(xi), Q(chi)), (Q(1, 2) - Q(lam),))


_SYMMETRIC: tuple[Splitting, ...] = (
    Splitting(
        key="pefrl",
        title="PEFRL, the position-extended Forest-Ruth-like method",
        claimed_order=4,
        source="omelyan-mryglod-folk-2002, the position-extended algorithm",
        parts=_omelyan("drift", "0.1786178958448091", "-0.2123418310626054", "-0.6626458266981849E-1"),
    ),
    Splitting(
        key="vefrl",
        title="VEFRL, the velocity-extended Forest-Ruth-like method",
        claimed_order=4,
        source="omelyan-mryglod-folk-2002, the velocity-extended algorithm",
        parts=_omelyan("kick", "0.1644986515575760", "-0.2094333910398989E-1", "0.1235692651138917E1"),
    ),
    splitting(
        "blanes_moan4 | Blanes-Moan S6, order 4 | 4 | blanes-moan-2002, the partitioned method S6 of order 4",
        _symmetric(
            "drift",
            row("0.0792036964311957 0.353172906049774 -0.0420650803577195"),
            row("0.209515106613362 -0.143851773179818"),
        ),
    ),
    splitting(
        "blanes_moan6 | Blanes-Moan S10, order 6 | 6 | blanes-moan-2002, the partitioned method S10 of order 6",
        _symmetric(
            "drift",
            row("0.0502627644003922 0.413514300428344 0.0450798897943977 -0.188054853819569 0.541960678450780"),
            row("0.148816447901042 -0.132385865767784 0.067307604692185 0.432666402578175"),
        ),
    ),
    Splitting(
        key="blanes_moan_rkn4",
        title="Blanes-Moan SRKN6b, order 4",
        claimed_order=4,
        source="blanes-moan-2002, the Nystrom method of order 4 with six stages, kick first",
        parts=_symmetric(
            "kick",
            row("0.0829844064174052 0.396309801498368 -0.0390563049223486"),
            row("0.245298957184271 0.604872665711080"),
        ),
        quadratic_kinetic=True,
    ),
    Splitting(
        key="blanes_moan_rkn6b",
        title="Blanes-Moan SRKN11b, order 6",
        claimed_order=6,
        source="blanes-moan-2002, the Nystrom method of order 6 with eleven stages, kick first",
        parts=_symmetric(
            "kick",
            row(
                """0.0414649985182624 0.198128671918067 -0.0400061921041533 0.0752539843015807
                -0.0115113874206879"""
            ),
            row(
                """0.123229775946271 0.290553797799558 -0.127049212625417 -0.246331761062075
                0.357208872795928"""
            ),
        ),
        quadratic_kinetic=True,
    ),
    Splitting(
        key="blanes_moan_rkn6a",
        title="Blanes-Moan SRKN14a, order 6",
        claimed_order=6,
        source="blanes-moan-2002, the Nystrom method of order 6 with fourteen stages, drift first",
        parts=_symmetric(
            "drift",
            row(
                """0.0378593198406116 0.102635633102435 -0.0258678882665587 0.314241403071447
                -0.130144459517415 0.106417700369543 -0.00879424312851058"""
            ),
            row(
                """0.09171915262446165 0.183983170005006 -0.05653436583288827 0.004914688774712854
                0.143761127168358 0.328567693746804"""
            ),
        ),
        quadratic_kinetic=True,
    ),
)

ENTRIES: tuple[Method, ...] = tuple(
    replace(method, decimal=True) for method in (*_YOSHIDA, *_COMPOSITIONS, *_KICK_DRIFT, *_SYMMETRIC)
)
