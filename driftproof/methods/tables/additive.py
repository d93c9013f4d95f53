"""IMEX Runge-Kutta methods: those of Ascher, Ruuth and Spiteri, and the three pairs of Kennedy and Carpenter (2003)."""

from __future__ import annotations

from fractions import Fraction

from driftproof.methods.additive import Additive
from driftproof.methods.tables.diagonally_implicit import ALEXANDER_GAMMA
from driftproof.methods.tables.notation import exact_row, heading, numbers, padded, square


def _imex(text: str) -> tuple[Additive, ...]:
    """The methods of a text, separated by blank lines: each is a line of names, then both tables side by side.

    The explicit table is on the left. Zeros at the end of a row are left out, and the last row has the weights.
    """
    found = []
    for entry in text.strip().split("\n\n"):
        names, *lines = entry.splitlines()
        explicit, implicit = zip(*(map(exact_row, line.split("|")) for line in lines), strict=True)
        found.append(
            Additive(
                **heading(names),
                a_explicit=padded(*explicit[:-1]),
                a_implicit=padded(*implicit[:-1]),
                b_explicit=explicit[-1],
                b_implicit=implicit[-1],
            )
        )
    return tuple(found)


def _ark(names: str, explicit: str, implicit: str) -> Additive:
    """A pair with the same weights in both parts: the last row of the implicit A, before the embedded weights."""
    *rows, b, embedded = (exact_row(line) for line in implicit.splitlines())
    return Additive(
        **heading(names),
        a_explicit=square(explicit),
        a_implicit=padded(*rows, b),
        b_explicit=b,
        b_implicit=b,
        b_explicit_embedded=embedded,
        b_implicit_embedded=embedded,
        decimal=True,
    )


# ARS(3,4,3): Alexander's method with an explicit one that has a free parameter, printed with ten digits; the last entry
# of its third stage follows from the condition b A c = 1/6.
_G4, _FREE = ALEXANDER_GAMMA, Fraction("0.5529291479")
_ALEXANDER = numbers(0, (-6 * _G4 * _G4 + 16 * _G4 - 1) / 4, (6 * _G4 * _G4 - 20 * _G4 + 5) / 4, _G4)
_LAST = (Fraction(1, 6) - _G4 * _FREE * (3 * _G4 + 1) / 2) / (_ALEXANDER[2] * _G4)

ENTRIES: tuple[Additive, ...] = (
    *_imex(
        """
    ars111 | IMEX Euler, forward and backward: ARS(1,1,1) | 1 | ascher-ruuth-spiteri-1997, 2.1
        | 0
    1   | 0 1
    1 0 | 0 1

    ars121 | IMEX Euler, forward at the new state and backward: ARS(1,2,1) | 1 | ascher-ruuth-spiteri-1997, 2.2
        | 0
    1   | 0 1
    0 1 | 0 1

    ars122 | IMEX midpoint: ARS(1,2,2) | 2 | ascher-ruuth-spiteri-1997, 2.3
        | 0
    1/2 | 0 1/2
    0 1 | 0 1

    ars233 | ARS(2,3,3) | 3 | ascher-ruuth-spiteri-1997, 2.4
                              | 0
    (3+sqrt(3))/6             | 0 (3+sqrt(3))/6
    (sqrt(3)-3)/6 1-sqrt(3)/3 | 0 -sqrt(3)/3 (3+sqrt(3))/6
    0 1/2 1/2                 | 0 1/2 1/2

    ars232 | ARS(2,3,2) | 2 | ascher-ruuth-spiteri-1997, 2.5
                                | 0
    1-sqrt(2)/2                 | 0 1-sqrt(2)/2
    -2*sqrt(2)/3 1+2*sqrt(2)/3  | 0 sqrt(2)/2 1-sqrt(2)/2
    0 sqrt(2)/2 1-sqrt(2)/2     | 0 sqrt(2)/2 1-sqrt(2)/2

    ars222 | ARS(2,2,2) | 2 | ascher-ruuth-spiteri-1997, 2.6
                              | 0
    1-sqrt(2)/2               | 0 1-sqrt(2)/2
    -sqrt(2)/2 1+sqrt(2)/2    | 0 sqrt(2)/2 1-sqrt(2)/2
    -sqrt(2)/2 1+sqrt(2)/2 0  | 0 sqrt(2)/2 1-sqrt(2)/2
    """
    ),
    Additive(
        **heading("ars343 | ARS(3,4,3) | 3 | ascher-ruuth-spiteri-1997, 2.7"),
        a_explicit=padded((), (_G4,), ((1 + _G4) / 2 - _LAST, _LAST), (1 - 2 * _FREE, _FREE, _FREE)),
        a_implicit=padded((), (0, _G4), (0, (1 - _G4) / 2, _G4), _ALEXANDER),
        b_explicit=_ALEXANDER,
        b_implicit=_ALEXANDER,
    ),
    *_imex(
        """
    ars443 | ARS(4,4,3) | 3 | ascher-ruuth-spiteri-1997, 2.8
                       | 0
    1/2                | 0 1/2
    11/18 1/18         | 0 1/6 1/2
    5/6 -5/6 1/2       | 0 -1/2 1/2 1/2
    1/4 7/4 3/4 -7/4   | 0 3/2 -3/2 1/2 1/2
    1/4 7/4 3/4 -7/4 0 | 0 3/2 -3/2 1/2 1/2
    """
    ),
    _ark(
        "ark324 | ARK3(2)4L[2]SA | 3(2) | kennedy-carpenter-2003, Appendix C",
        """0
        1767732205903/2027836641118
        5535828885825/10492691773637 788022342437/10882634858940
        6485989280629/16251701735622 -4246266847089/9704473918619 10755448449292/10357097424841""",
        """0
        1767732205903/4055673282236 1767732205903/4055673282236
        2746238789719/10658868560708 -640167445237/6845629431997 1767732205903/4055673282236
        1471266399579/7840856788654 -4482444167858/7529755066697 11266239266428/11593286722821 \
        1767732205903/4055673282236
        2756255671327/12835298489170 -10771552573575/22201958757719 9247589265047/10645013368117 \
        2193209047091/5459859503100""",
    ),
    _ark(
        "ark436 | ARK4(3)6L[2]SA | 4(3) | kennedy-carpenter-2003, Appendix C",
        """0
        1/2
        13861/62500 6889/62500
        -116923316275/2393684061468 -2731218467317/15368042101831 9408046702089/11113171139209
        -451086348788/2902428689909 -2682348792572/7519795681897 12662868775082/11960479115383 \
        3355817975965/11060851509271
        647845179188/3216320057751 73281519250/8382639484533 552539513391/3454668386233 3354512671639/8306763924573 \
        4040/17871""",
        """0
        1/4 1/4
        8611/62500 -1743/31250 1/4
        5012029/34652500 -654441/2922500 174375/388108 1/4
        15267082809/155376265600 -71443401/120774400 730878875/902184768 2285395/8070912 1/4
        82889/524892 0 15625/83664 69875/102672 -2260/8211 1/4
        4586570599/29645900160 0 178811875/945068544 814220225/1159782912 -3700637/11593932 61727/225920""",
    ),
    _ark(
        "ark548 | ARK5(4)8L[2]SA | 5(4) | kennedy-carpenter-2003, Appendix C",
        """0
        41/100
        367902744464/2072280473677 677623207551/8224143866563
        1268023523408/10340822734521 0 1029933939417/13636558850479
        14463281900351/6315353703477 0 66114435211212/5879490589093 -54053170152839/4284798021562
        14090043504691/34967701212078 0 15191511035443/11219624916014 -18461159152457/12425892160975 \
        -281667163811/9011619295870
        19230459214898/13134317526959 0 21275331358303/2942455364971 -38145345988419/4862620318723 -1/8 -1/8
        -19977161125411/11928030595625 0 -40795976796054/6384907823539 177454434618887/12078138498510 \
        782672205425/8267701900261 -69563011059811/9646580694205 7356628210526/4942186776405""",
        """0
        41/200 41/200
        41/400 -567603406766/11931857230679 41/200
        683785636431/9252920307686 0 -110385047103/1367015193373 41/200
        3016520224154/10081342136671 0 30586259806659/12414158314087 -22760509404356/11113319521817 41/200
        218866479029/1489978393911 0 638256894668/5436446318841 -1179710474555/5321154724896 \
        -60928119172/8023461067671 41/200
        1020004230633/5715676835656 0 25762820946817/25263940353407 -2161375909145/9755907335909 \
        -211217309593/5846859502534 -4269925059573/7827059040749 41/200
        -872700587467/9133579230613 0 0 22348218063261/9555858737531 -1143369518992/8141816002931 \
        -39379526789629/19018526304540 32727382324388/42900044865799 41/200
        -975461918565/9796059967033 0 0 78070527104295/32432590147079 -548382580838/3424219808633 \
        -33438840321285/15594753105479 3629800801594/4656183773603 4035322873751/18575991585200""",
    ),
)
