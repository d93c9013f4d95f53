"""Is an integer polynomial irreducible over Q? Decided by factoring it modulo one prime above every factor's size.

Zassenhaus's method without lifting: a factor over Z, times the leading coefficient, is a product of factors modulo p,
and it can be read off there if p is more than twice as large as any of its coefficients.
References: cohen-1993, 3.5; mignotte-1974.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import isqrt

from driftproof.methods.polynomials import divide, is_square_free, primitive

LARGEST_DEGREE = 12
# 2**e - 1 is prime for each of these e.
MERSENNE_EXPONENTS = (61, 89, 107, 127, 521, 607, 1279, 2203)
_MOST_TRIALS = 500


class UndecidedError(ValueError):
    """The polynomial is too large to be factored here: its degree or its coefficients."""


def is_irreducible(coefficients: Sequence[int]) -> bool:
    """True when the polynomial, constant term first, is no product of two over Q of positive degree.

    Exact. Raises UndecidedError for a degree above 12 or coefficients of more than some 1000 bits, ValueError for a
    constant.
    """
    f = primitive(coefficients)
    if len(f) < 2:
        raise ValueError("a constant is neither reducible nor irreducible")
    if len(f) == 2:
        return True
    if len(f) == 3:
        discriminant = f[1] ** 2 - 4 * f[0] * f[2]
        return discriminant < 0 or isqrt(discriminant) ** 2 != discriminant
    if len(f) - 1 > LARGEST_DEGREE:
        raise UndecidedError(f"degree {len(f) - 1}: irreducibility is decided up to degree {LARGEST_DEGREE}")
    return is_square_free(f) and not any(_divides(f, factor) for factor in _candidates(f))


def _candidates(f: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """The polynomials of positive degree, at most half that of f or cofactors of such, that may divide f over Z."""
    p = _prime_for(f)
    factors = _factors_modulo(f, p)
    for size in range(1, len(factors) // 2 + 1):
        for chosen in combinations(factors, size):
            product = [f[-1] % p]
            for factor in chosen:
                product = _times(product, factor, p)
            yield primitive([x - p if x > p // 2 else x for x in product])


def _divides(f: tuple[int, ...], factor: tuple[int, ...]) -> bool:
    return len(factor) < len(f) and not divide(f, factor)[1]


def _prime_for(f: tuple[int, ...]) -> int:
    """A prime p with p > 2 |c| for each coefficient c of lead(f)/lead(g) g, g | f, and f square-free modulo p."""
    # Mignotte: a factor's coefficients are at most 2**degree times the Euclidean norm of f.
    bound = 2 * abs(f[-1]) * 2 ** (len(f) - 1) * (isqrt(sum(x * x for x in f)) + 1)
    for exponent in MERSENNE_EXPONENTS:
        p = (1 << exponent) - 1
        slope = [k * x for k, x in enumerate(f)][1:]
        if p > bound and len(_common_divisor([x % p for x in f], [x % p for x in slope], p)) == 1:
            return p
    raise UndecidedError("the coefficients are too large to decide irreducibility")


def _factors_modulo(f: tuple[int, ...], p: int) -> list[list[int]]:
    """The monic irreducible factors modulo p of f, which is square-free there (cohen-1993, 3.4)."""
    rest, found = _monic([x % p for x in f], p), []  # type: list[int], list[list[int]]
    power, degree = [0, 1], 0
    while len(rest) - 1 >= 2 * (degree + 1):
        degree += 1
        power = _power(power, p, rest, p)  # x ** (p ** degree)
        together = _common_divisor(_minus(power, [0, 1], p), rest, p)
        if len(together) > 1:
            found += _equal_degree(together, degree, p)
            rest = _quotient(rest, together, p)
            power = _rest(power, rest, p)
    return found + ([rest] if len(rest) > 1 else [])


def _equal_degree(f: list[int], degree: int, p: int) -> list[list[int]]:
    """The factors of a product of monic irreducibles of one degree: x + a is a square modulo about half of them."""
    if len(f) - 1 == degree:
        return [f]
    for a in range(_MOST_TRIALS):
        symbol = _power([a, 1], (p**degree - 1) // 2, f, p)
        part = _common_divisor(_minus(symbol, [1], p), f, p)
        if 1 < len(part) < len(f):
            return _equal_degree(part, degree, p) + _equal_degree(_quotient(f, part, p), degree, p)
    raise UndecidedError("the factors modulo a prime were not separated")


def _trim(a: list[int]) -> list[int]:
    while a and not a[-1]:
        a.pop()
    return a


def _monic(a: list[int], p: int) -> list[int]:
    inverse = pow(a[-1], -1, p)
    return [x * inverse % p for x in a]


def _minus(a: list[int], b: list[int], p: int) -> list[int]:
    size = max(len(a), len(b))
    pad = [*a, *[0] * (size - len(a))], [*b, *[0] * (size - len(b))]
    return _trim([(x - y) % p for x, y in zip(*pad, strict=True)])


def _times(a: list[int], b: list[int], p: int) -> list[int]:
    result = [0] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] += x * y
    return _trim([x % p for x in result])


def _divided(a: list[int], b: list[int], p: int) -> tuple[list[int], list[int]]:
    """Quotient and remainder modulo p; b is monic."""
    rest, quotient = list(a), [0] * max(len(a) - len(b) + 1, 0)
    for i in reversed(range(len(quotient))):
        factor = quotient[i] = rest[i + len(b) - 1] % p
        for j, y in enumerate(b):
            rest[i + j] = (rest[i + j] - factor * y) % p
    return quotient, _trim(rest)


def _quotient(a: list[int], b: list[int], p: int) -> list[int]:
    return _divided(a, b, p)[0]


def _rest(a: list[int], b: list[int], p: int) -> list[int]:
    return _divided(a, b, p)[1]


def _common_divisor(a: list[int], b: list[int], p: int) -> list[int]:
    a, b = _trim(list(a)), _trim(list(b))
    while b:
        a, b = b, _rest(a, _monic(b, p), p)
    return _monic(a, p) if a else a


def _power(base: list[int], exponent: int, modulus: list[int], p: int) -> list[int]:
    result, square = [1], _rest(base, modulus, p)
    while exponent:
        if exponent & 1:
            result = _rest(_times(result, square, p), modulus, p)
        square = _rest(_times(square, square, p), modulus, p)
        exponent >>= 1
    return result
