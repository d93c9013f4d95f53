"""Arithmetic on answers: exact for exact operands, else in balls; with units, and with bounds on sizes."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import arb

from driftproof.methods.formulas.expression_tree import LARGEST_POWER
from driftproof.methods.numbers.number_field import Algebraic, cube_root, square_root
from driftproof.symbolic.algebra.certified import LARGEST_BINARY_EXPONENT, CertifiableReal, certified_sign, enclose
from driftproof.symbolic.algebra.radicals import perfect_part
from driftproof.texts.questions.answer import CERTIFIED, EVIDENCE_KINDS, Answer

# Degree -> the exact root of that degree of an integer that is no perfect power of it.
FIELDS = {2: square_root, 3: cube_root}


def _sum(a: Answer, b: Answer, operation: Callable[[Any, Any], Any]) -> Answer:
    """a + b or a - b; a number without a unit takes the other's. Raises ValueError for two different units."""
    if a.unit and b.unit and a.unit != b.unit:
        raise ValueError(f"{a.unit} and {b.unit} cannot be added or subtracted")
    return replace(_combined(a, b, operation), unit=a.unit or b.unit)


def _multiply(a: Answer, b: Answer) -> Answer:
    """a b. Raises ValueError if both have a unit."""
    if a.unit and b.unit:
        raise ValueError(f"{a.unit} times {b.unit} is not a known unit")
    return replace(_combined(a, b, operator.mul), unit=a.unit or b.unit)


def _divide(a: Answer, b: Answer) -> Answer:
    """a / b, dimensionless if both have the same unit. Raises ValueError for b = 0 and for any other unit of b."""
    if b.unit and a.unit != b.unit:
        raise ValueError(f"{a.unit or 'a number without a unit'} over {b.unit} is not a known unit")
    if certified_sign(_number(b)) == 0:
        raise ValueError("division by zero")
    return replace(_combined(a, b, operator.truediv), unit=None if b.unit else a.unit)


def negate(a: Answer) -> Answer:
    """The negative of a."""
    x = _number(a)
    return Answer("", (lambda: -enclose(x)) if callable(x) else -x, a.evidence, a.unit)


def raised(a: Answer, exponent: Fraction) -> Answer:
    """a**exponent, exact for a whole exponent and for roots that `_root` keeps exact.

    Raises ValueError for 0 to a negative power, a root of a negative number, a number with a unit, and a power that is
    too long to write out.
    """
    x = _number(a)
    if a.unit and exponent != 1:
        raise ValueError(f"a power of {a.unit} is not a known unit")
    if exponent < 0 and certified_sign(x) == 0:
        raise ValueError("division by zero")
    if exponent.denominator > 1:
        return _root(raised(a, Fraction(exponent.numerator)), exponent.denominator)
    n = int(exponent)
    if callable(x):
        return Answer("", lambda: enclose(x) ** n, a.evidence, a.unit)
    if _bits(x) * abs(n) > LARGEST_BINARY_EXPONENT:
        if abs(enclose(x)).log() / arb(2).log() * abs(n) < LARGEST_BINARY_EXPONENT:
            return Answer("", lambda: enclose(x) ** n, CERTIFIED, a.unit)
        raise ValueError(f"the power is too long to write out: more than {LARGEST_BINARY_EXPONENT} bits")
    return Answer("", _normalized(x**n), a.evidence, a.unit)


def _number(a: Answer) -> CertifiableReal:
    """The number of an answer. Raises ValueError for a formula and for words."""
    if a.exact is None:
        raise ValueError(f"{a.exact_text} is not a number")
    return a.exact


def _absolute(a: Answer) -> Answer:
    return negate(a) if certified_sign(_number(a)) < 0 else a


def _root(a: Answer, degree: int) -> Answer:
    """The root of this degree: exact if rational or in one of FIELDS, else enclosed. Raises ValueError for a < 0."""
    x = _unitless(a)
    if certified_sign(x) < 0:
        raise ValueError("a root of a negative number is not computed")
    if x == 0:
        return a
    if isinstance(x, Fraction) and degree <= LARGEST_POWER:
        split = perfect_part(x.numerator * x.denominator ** (degree - 1), degree)
        if split is not None and (split[1] == 1 or degree in FIELDS):
            outer, inner = split
            return Answer("", Fraction(outer, x.denominator) * (FIELDS[degree](inner) if inner > 1 else 1), a.evidence)
    return _enclosed(a, lambda ball: ball.root(degree))


def _logarithm(a: Answer, base: int = 0) -> Answer:
    """The logarithm of a to `base` 2 or 10, exact for powers of it, or to e for 0. Raises ValueError for a <= 0."""
    x = _unitless(a)
    if certified_sign(x) <= 0:
        raise ValueError("only a positive number has a logarithm")
    if not base:
        return Answer("", Fraction(0), a.evidence) if x == 1 else _enclosed(a, arb.log, "log")
    if isinstance(x, Fraction) and 1 in (x.numerator, x.denominator):
        size = max(x.numerator, x.denominator)
        # 10^k has floor(k log2(10)) + 1 bits, so its bits times 0.30103, about log10(2), lie between k and k + 1.
        exponent = size.bit_length() - 1 if base == 2 else size.bit_length() * 30103 // 100000
        if base**exponent == size:
            return Answer("", Fraction(exponent if x.denominator == 1 else -exponent), a.evidence)
    return _enclosed(a, lambda ball: ball.log() / arb(base).log())


def _entire(a: Answer, name: str, at_zero: int) -> Answer:
    """exp a, cos a or sin a, with a in radians; rational only for a = 0."""
    return Answer("", Fraction(at_zero), a.evidence) if _unitless(a) == 0 else _enclosed(a, getattr(arb, name), name)


def _percent(a: Answer, b: Answer) -> Answer:
    """100 a / b, in percent. Raises ValueError unless the units cancel."""
    found = _divide(a, b)
    if found.unit:
        raise ValueError(f"percent compares two numbers of the same unit; {found.unit} is left over")
    return replace(_multiply(Answer("", Fraction(100)), found), unit="%")


def _power(a: Answer, b: Answer) -> Answer:
    """a to the power b. Raises ValueError unless b is rational."""
    if not isinstance(exponent := _unitless(b), Fraction):
        raise ValueError("the exponent is not rational")
    return raised(a, exponent)


# Name -> the function and its number of arguments.
NUMBER_FUNCTIONS: dict[str, tuple[Callable[..., Answer], int]] = {
    "abs": (_absolute, 1),
    "sqrt": (lambda a: _root(a, 2), 1),
    "exp": (lambda a: _entire(a, "exp", 1), 1),
    **dict.fromkeys(("ln", "log"), (_logarithm, 1)),
    **{f"log{b}": (lambda a, b=b: _logarithm(a, b), 1) for b in (2, 10)},
    "cos": (lambda a: _entire(a, "cos", 1), 1),
    "sin": (lambda a: _entire(a, "sin", 0), 1),
    "ratio": (lambda a, b: _divide(_absolute(a), _absolute(b)), 2),
    "percent": (_percent, 2),
    "power": (_power, 2),
}

# Name -> the number.
CONSTANTS = {
    "pi": Answer("", arb.pi, CERTIFIED, form="pi"),
    "e": Answer("", lambda: arb(1).exp(), CERTIFIED, form="exp(1)"),
}

# Sign -> the operation.
OPERATIONS: dict[str, Callable[[Answer, Answer], Answer]] = {
    "+": lambda a, b: _sum(a, b, operator.add),
    "-": lambda a, b: _sum(a, b, operator.sub),
    "*": _multiply,
    "/": _divide,
}


def applied(operation: Callable[..., Answer], *operands: Answer) -> Answer:
    """What the operation makes of the operands, with their remarks. Raises what the operation raises."""
    remarks = dict.fromkeys(a.remark for a in operands if a.remark)
    return replace(operation(*operands), remark="; ".join(remarks) or None)


def _unitless(a: Answer) -> CertifiableReal:
    """The number of an answer without a unit. Raises ValueError if it has one."""
    if a.unit:
        raise ValueError(f"functions take numbers without a unit, not {a.unit}; divide by a number of that unit first")
    return _number(a)


def _enclosed(a: Answer, function: Callable[[arb], arb], name: str | None = None) -> Answer:
    x = _number(a)
    form = f"{name}({a.exact_text})" if name and isinstance(x, Fraction) else None
    return Answer("", lambda: function(enclose(x)), CERTIFIED, form=form)


def _combined(a: Answer, b: Answer, operation: Callable[[Any, Any], Any]) -> Answer:
    """The operation, exact if both operands are exact in a common field, else in balls."""
    x, y = _number(a), _number(b)
    evidence = max(a.evidence, b.evidence, key=EVIDENCE_KINDS.index)
    if not (callable(x) or callable(y)):
        try:
            return Answer("", _normalized(operation(x, y)), evidence)
        except TypeError:
            evidence = CERTIFIED
    return Answer("", lambda: operation(enclose(x), enclose(y)), evidence)


def _normalized(x: CertifiableReal) -> CertifiableReal:
    """x, as a Fraction if it is rational. Raises ValueError if it is too long to write out."""
    if isinstance(x, Algebraic) and x.is_rational:
        x = x.as_fraction()
    if _bits(x) > LARGEST_BINARY_EXPONENT:
        raise ValueError(f"the result is too long to write out: more than {LARGEST_BINARY_EXPONENT} bits")
    return x


def _bits(x: Any) -> int:
    """The length of the longest integer in x, a Fraction or an element of a number field."""
    parts = (x,) if isinstance(x, Fraction) else x.coefficients
    return max((n.bit_length() for part in parts for n in (part.numerator, part.denominator)), default=0)
