"""IMEX Runge-Kutta methods: the Euler pair, ARS(2,2,2), ARS(4,4,3), and ARK3(2)4L[2]SA."""

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
)
