"""IMEX Runge-Kutta methods: the Euler pair, ARS(2,2,2), ARS(4,4,3), ARK3(2)4L[2]SA and ARK4(3)6L[2]SA."""

from __future__ import annotations

from driftproof.methods.additive import Additive
from driftproof.methods.number_field import square_root
from driftproof.methods.tables.notation import numbers, padded, row, square

_G = 1 - square_root(2) / 2
_D = -square_root(2) / 2
_ARK3 = row(
    "1471266399579/7840856788654 -4482444167858/7529755066697 11266239266428/11593286722821 1767732205903/4055673282236"
)
_ARK3_EMBEDDED = row(
    "2756255671327/12835298489170 -10771552573575/22201958757719 9247589265047/10645013368117"
    " 2193209047091/5459859503100"
)
_ARK4 = row("82889/524892 0 15625/83664 69875/102672 -2260/8211 1/4")
_ARK4_EMBEDDED = row("4586570599/29645900160 0 178811875/945068544 814220225/1159782912 -3700637/11593932 61727/225920")

ENTRIES: tuple[Additive, ...] = (
    Additive(
        "ars111",
        "IMEX Euler, forward and backward: ARS(1,1,1)",
        1,
        "ascher-ruuth-spiteri-1997, 2.1",
        a_explicit=square("0\n 1"),
        a_implicit=square("0\n 0 1"),
        b_explicit=row("1 0"),
        b_implicit=row("0 1"),
    ),
    Additive(
        "ars222",
        "ARS(2,2,2)",
        2,
        "ascher-ruuth-spiteri-1997, 2.6",
        a_explicit=padded((), (_G,), (_D, 1 - _D)),
        a_implicit=padded((), (0, _G), (0, 1 - _G, _G)),
        b_explicit=numbers(_D, 1 - _D, 0),
        b_implicit=numbers(0, 1 - _G, _G),
    ),
    Additive(
        "ars443",
        "ARS(4,4,3)",
        3,
        "ascher-ruuth-spiteri-1997, 2.8",
        a_explicit=square("0\n 1/2\n 11/18 1/18\n 5/6 -5/6 1/2\n 1/4 7/4 3/4 -7/4"),
        a_implicit=square("0\n 0 1/2\n 0 1/6 1/2\n 0 -1/2 1/2 1/2\n 0 3/2 -3/2 1/2 1/2"),
        b_explicit=row("1/4 7/4 3/4 -7/4 0"),
        b_implicit=row("0 3/2 -3/2 1/2 1/2"),
    ),
    Additive(
        "ark324",
        "ARK3(2)4L[2]SA",
        3,
        "kennedy-carpenter-2003, Appendix C",
        a_explicit=square(
            "0\n 1767732205903/2027836641118\n 5535828885825/10492691773637 788022342437/10882634858940\n"
            " 6485989280629/16251701735622 -4246266847089/9704473918619 10755448449292/10357097424841"
        ),
        a_implicit=padded(
            (),
            row("1767732205903/4055673282236 1767732205903/4055673282236"),
            row("2746238789719/10658868560708 -640167445237/6845629431997 1767732205903/4055673282236"),
            _ARK3,
        ),
        b_explicit=_ARK3,
        b_implicit=_ARK3,
        b_explicit_embedded=_ARK3_EMBEDDED,
        b_implicit_embedded=_ARK3_EMBEDDED,
        embedded_order=2,
        decimal=True,
    ),
    Additive(
        "ark436",
        "ARK4(3)6L[2]SA",
        4,
        "kennedy-carpenter-2003, Appendix C",
        a_explicit=square(
            "0\n 1/2\n 13861/62500 6889/62500\n"
            " -116923316275/2393684061468 -2731218467317/15368042101831 9408046702089/11113171139209\n"
            " -451086348788/2902428689909 -2682348792572/7519795681897 12662868775082/11960479115383"
            " 3355817975965/11060851509271\n"
            " 647845179188/3216320057751 73281519250/8382639484533 552539513391/3454668386233"
            " 3354512671639/8306763924573 4040/17871"
        ),
        a_implicit=padded(
            (),
            row("1/4 1/4"),
            row("8611/62500 -1743/31250 1/4"),
            row("5012029/34652500 -654441/2922500 174375/388108 1/4"),
            row("15267082809/155376265600 -71443401/120774400 730878875/902184768 2285395/8070912 1/4"),
            _ARK4,
        ),
        b_explicit=_ARK4,
        b_implicit=_ARK4,
        b_explicit_embedded=_ARK4_EMBEDDED,
        b_implicit_embedded=_ARK4_EMBEDDED,
        embedded_order=3,
        decimal=True,
    ),
)
