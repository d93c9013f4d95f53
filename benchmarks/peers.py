"""NodePy, kauri and RKkit: a method of ours as theirs, and their answers as texts that can be compared with ours.

Each is imported only where it is installed; `installed` says which are. NodePy gets SymPy numbers, which it keeps
exact where it can, kauri floats, RKkit elements of Sage's field of real algebraic numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction as Q
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

from driftproof.methods.numbers.number_field import Algebraic, Exact
from driftproof.methods.schemes import RungeKutta

# The import name of each, and the name under which it is distributed.
PEERS = {"nodepy": "nodepy", "kauri": "kauri", "RKkit": "RKkit"}


def installed() -> dict[str, str]:
    """The peers that this interpreter can import, with their versions."""
    return {name: version(name) for name in PEERS if find_spec(name) and (name != "RKkit" or find_spec("sage"))}


def nodepy_method(method: RungeKutta, *, embedded: bool = False, exact: bool = True) -> Any:
    """The tableau as NodePy's object, in SymPy's rationals if it is rational and `exact`, else in floats."""
    import numpy as np
    from nodepy import rk

    rational = exact and method.field is None
    number = _sympy_rational if rational else float
    rows = [[number(x) for x in row] for row in (*method.a, _weights(method, embedded))]
    kind = object if rational else float
    made = rk.ExplicitRungeKuttaMethod if method.explicit else rk.RungeKuttaMethod
    return made(np.array(rows[:-1], dtype=kind), np.array(rows[-1], dtype=kind))


def kauri_method(method: RungeKutta, *, embedded: bool = False) -> Any:
    """The tableau as kauri's object, made anew, because kauri keeps what a method has answered before."""
    import kauri

    return kauri.RK([[float(x) for x in row] for row in method.a], [float(x) for x in _weights(method, embedded)])


def rkkit_method(method: RungeKutta) -> Any:
    """The tableau as RKkit's object, made anew for the same reason."""
    import sage.all__sagemath_symbolics  # noqa: F401  without it the field has no imaginary unit
    from RKkit.RKformula import RKformula
    from RKkit.RKRungeKutta import RungeKutta as Given
    from sage.matrix.constructor import matrix
    from sage.modules.free_module_element import vector
    from sage.rings.qqbar import AA

    rows = [[_algebraic_real(x) for x in row] for row in method.a]
    return RKformula(Given(matrix(AA, rows), vector(AA, [_algebraic_real(x) for x in method.b]), method.key))


def _weights(method: RungeKutta, embedded: bool) -> Sequence[Exact]:
    return (method.b_embedded or ()) if embedded else method.b


def _sympy_rational(x: Any) -> Any:
    import sympy

    return sympy.Rational(x.numerator, x.denominator)


def _algebraic_real(x: Exact) -> Any:
    """The number in Sage's field AA: a root of its generator's minimal polynomial, in powers."""
    from sage.rings.qqbar import AA
    from sage.rings.rational_field import QQ
    from sage.rings.real_mpfi import RIF

    def rational(y: Q) -> Any:
        return QQ((y.numerator, y.denominator))

    if not isinstance(x, Algebraic):
        return AA(rational(Q(x)))
    field, z = x.field, AA["z"]
    root = AA.polynomial_root(z(list(field.minimal)), RIF(rational(field.low), rational(field.high)))
    return sum((AA(rational(c)) * root**k for k, c in enumerate(x.coefficients)), AA(0))


def rational_function(numerator: Iterable[Any], denominator: Iterable[Any]) -> str:
    """Both ascending, numbers as fractions, the constant of the denominator made 1."""
    num, den = ([Q(str(c)) for c in side] for side in (numerator, denominator))
    return " / ".join(", ".join(str(c / den[0]) for c in side) for side in (num, den))


def read_nodepy(pair: Any) -> str:
    """NodePy's R(z), a pair of NumPy polynomials."""
    return rational_function(pair[0].c[::-1], pair[1].c[::-1])


def read_rkkit(r: Any) -> str:
    """RKkit's R(z), a quotient in Sage."""
    return rational_function(*(map(_sage_rational, side.list()) for side in (r.numerator(), r.denominator())))


def _sage_rational(c: Any) -> str:
    from sage.rings.rational_field import QQ

    return str(QQ(c))


def six_digits(read: Callable[[Any], Any] = lambda value: value) -> Callable[[Any], str]:
    """A reader of real numbers, to the digits in which floats are compared here."""
    return lambda value: f"{float(read(value)):.6g}"
