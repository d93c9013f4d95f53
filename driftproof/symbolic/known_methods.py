"""Which method of the catalogue a table is, from its exact coefficients, or which one it is but for a few of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from driftproof.methods.catalogue import EMBEDDED_SUFFIX, FURTHER_METHODS, METHODS, Entry
from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.common_field import in_one_field
from driftproof.methods.numbers.number_field import Algebraic, Exact, UndecidedError, total
from driftproof.methods.schemes import SUBSTEPS, Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.support.plain_text import shortened
from driftproof.symbolic.algebra.rational_functions import exact_text
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.linear.printed_digits import roundings
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, matchings, reduced_stages_of, reduced_word
from driftproof.symbolic.trees.order_conditions import simplifying_assumptions

# Chosen: a method that differs in more than three coefficients, or in more than a third of all, is another method.
# Two exchanged weights and a wrong node of theirs are three. Three that are all of A say nothing of the method.
FEW_DIFFERENCES = 3
ADJOINT, EXCHANGED = "its adjoint", "kicks and drifts exchanged"
# Chosen: of more methods with one stability function, as all of three explicit stages and order 3, some are named.
_MOST_NAMED = 4
# Chosen: longer fractions are shown as decimals, if these are shorter.
_LONGEST = 6


class KnownAs(NamedTuple):
    """What a table is in the catalogue: `words`, the methods that it is, and those that it is but for `differences`."""

    words: str
    methods: tuple[str, ...] = ()
    near: tuple[str, ...] = ()
    differences: tuple[str, ...] = ()


def known_as(method: Entry) -> KnownAs:
    """The method of the catalogue that has these coefficients, or takes these steps; else the nearest ones.

    Coefficients are compared exactly; finite decimals also with what may have been rounded to them.

    >>> from dataclasses import replace
    >>> from fractions import Fraction
    >>> from driftproof import METHODS
    >>> from driftproof.symbolic.known_methods import known_as
    >>> b = (Fraction(2, 9), Fraction(1, 3), Fraction(1, 3))
    >>> known_as(replace(METHODS["ralston3"], key="mine", b=b)).words
    'ralston3 except for b[2]: 1/3 instead of 4/9'
    """
    if same := _same(method):
        return same
    near = [(known.key, tuple(found)) for known, found, _ in _compared(method) if _is_few(method, known, found)]
    mine = reduced_stages_of(method) if isinstance(method, Nystrom | RungeKutta) else None
    steps = [known.key for known in _of_its_kind(method) if _steps_alike(method, mine, known)]
    if steps and not any("embedded" in each for _, found in near for each in found):
        return KnownAs(f"{steps[0]}: the same steps, written with other stages", (steps[0],))
    if near:
        fewest = min(len(found) for _, found in near)
        near = [each for each in near if len(each[1]) == fewest]
        return KnownAs("; or ".join(except_for(near)), (), tuple(key for key, _ in near), near[0][1])
    for change, other in turned_over(method):
        if same := _same(other):
            return KnownAs(f"{same.words}, {change}", same.methods)
    alike = [*_alike_on_the_oscillator(method)]
    if not alike:
        return KnownAs("")
    both = isinstance(method, RungeKutta | Collocation) and all(isinstance(x, RungeKutta | Collocation) for x in alike)
    more = f" and {len(alike) - _MOST_NAMED} more" if len(alike) > _MOST_NAMED else ""
    keys = ", ".join(each.key for each in alike[:_MOST_NAMED]) + more
    what = "the stability function" if both else "the steps on linear oscillators"
    return KnownAs(f"{what} of {keys}, another table")


def _same(method: Any) -> KnownAs | None:
    """The method whose coefficients are these, exactly or but for their rounding; None without one."""
    same = [(known, rounded) for known, differences, rounded in _compared(method) if not differences]
    if not same:
        return None
    known, rounded = min(same, key=lambda pair: (pair[1], _beside(method, pair[0])))
    return KnownAs(known.key + (" but for rounded digits" if rounded else _beside(method, known)), (known.key,))


def _compared(method: Any) -> list[tuple[Any, list[str], bool]]:
    mine, known = _numbers(method), _of_its_kind(method)
    return [found for each in known if (found := _differences(method, mine, each)) is not None]


def _of_its_kind(method: Entry) -> Iterator[Any]:
    """The methods of the catalogue of one family, and those of the embedded weights of pairs after them."""
    known: Any = METHODS if isinstance(method, Method) else FURTHER_METHODS
    kind = RungeKutta | Collocation if isinstance(method, RungeKutta | Collocation) else type(method)
    found = [each for each in known.values() if isinstance(each, kind)]
    yield from found
    if isinstance(method, RungeKutta):
        yield from (known[each.key + EMBEDDED_SUFFIX] for each in found if getattr(each, "b_embedded", None))


def _numbers(method: Any) -> dict[str, Any]:
    """The coefficients by their names in a table; those that a step does not depend on are left out."""
    if isinstance(method, Splitting):
        return {f"{kind} {i}": x for i, (kind, x) in enumerate(reduced_word(method))}
    if isinstance(method, Collocation):
        return {f"node_polynomial[{i}]": x for i, x in enumerate(method.node_polynomial)}
    if isinstance(method, Multistep):
        rows = {name: [x / method.rho[-1] for x in getattr(method, name)] for name in ("rho", "sigma")}
        rows["derivative"] = [Fraction(method.derivative)]
    else:
        rows = {name: getattr(method, name) for name in method.rows if getattr(method, name) is not None}
        for matrix in method.matrices:
            rows |= {f"{matrix}[{i}]": row for i, row in enumerate(getattr(method, matrix))}
    return {f"{name}[{i}]": x for name, row in rows.items() for i, x in enumerate(row)}


def _differences(method: Any, mine: dict[str, Any], known: Any) -> tuple[Any, list[str], bool] | None:
    """The method known, the coefficients that differ from `mine`, as text, and whether others are rounded.

    None for tables of other shapes.
    """
    its = _numbers(known)
    if any("embedded" not in name for name in {*mine} ^ {*its}):
        return None
    radius: Any = None if isinstance(method, Collocation) or getattr(method, "field", None) else roundings(method)
    sums = isinstance(method, RungeKutta) and _have_row_sums(method, known)
    found, rounded = list[str](), False
    for name, x in mine.items():
        if name in its and not (sums and name[0] == "c") and not _is(x, its[name]):
            if radius and _is_within(x, its[name], radius(x)):
                rounded = True
            else:
                found.append(f"{name}: {_shown(x)} instead of {_shown(its[name])}")
    return known, found, rounded


def _is(x: Exact, y: Exact) -> bool:
    """True if the numbers are equal, which may be written in fields of other names."""
    if x == y or not (isinstance(x, Algebraic) and isinstance(y, Algebraic)) or x.field == y.field:
        return x == y
    if abs(float(x) - float(y)) * 2**40 > 1 + abs(float(x)):
        return False
    try:
        one, other = in_one_field([x, y])
    except UndecidedError:
        return False
    return one == other


def _is_within(x: Exact, y: Exact, radius: Exact) -> bool:
    """True if y may have been rounded to the decimal x, or to a double that x stands for."""
    return bool(radius) and (-radius <= y - x <= radius or abs(float(y) - float(x)) * 2**52 <= abs(float(x)))


def _shown(x: Exact) -> str:
    """The number in short: a fraction of many digits as the decimal that it is, one with roots with its decimal."""
    text = exact_text(x)
    if isinstance(x, Fraction):
        decimal = Decimal(x.numerator) / x.denominator
        exact = str(decimal) if len(text) > _LONGEST and Fraction(decimal) == x else text
        return shortened(min(exact, text, key=len), 40)
    return f"{text} = {float(x)}" if len(text) <= 4 * _LONGEST else str(float(x))


def _beside(method: Any, known: Any) -> str:
    """What else a pair, or a method without embedded weights, has or lacks of them."""
    mine, its = (getattr(each, "embedded_order", None) is not None for each in (method, known))
    return "" if mine == its else ", with embedded weights beside it" if mine else ", without its embedded weights"


def except_for(near: Iterable[tuple[str, Sequence[str]]]) -> list[str]:
    """The methods with what they differ in, in words, those of the same differences together."""
    found: dict[tuple[str, ...], list[str]] = {}
    for key, differences in near:
        found.setdefault(tuple(differences), []).append(key)
    return [f"{' or '.join(keys)} except for {'; '.join(differences)}" for differences, keys in found.items()]


def are_few(differing: Sequence[str], numbers: int, of_a: int) -> bool:
    """True if so few of the `numbers` of a method differ, of which `of_a` are those of A, that it may be the method."""
    wrong = sum(name.startswith("a[") for name in differing)
    return len(differing) <= min(FEW_DIFFERENCES, max(1, numbers // 3)) and not 2 < wrong >= of_a


def _is_few(method: Any, known: Any, differences: list[str]) -> bool:
    mine, its = _numbers(method), _numbers(known)
    counted = [name for name in mine if mine[name] or its.get(name)]
    return are_few(differences, len(counted), sum(name.startswith("a[") for name in counted))


def _steps_alike(method: Any, mine: StageCoefficients | None, known: Any) -> bool:
    """True if the irreducible stages are the same in some order, or the nodes of a collocation."""
    if isinstance(method, Collocation) != isinstance(known, Collocation):
        table, nodes = (known, method) if isinstance(method, Collocation) else (method, known)
        return isinstance(table, RungeKutta) and _collocates(table, nodes)
    if mine is None:
        return False
    its = reduced_stages_of(known)
    if len(mine.a) != len(its.a) or not (isinstance(method, Nystrom) or _have_row_sums(method, known)):
        return False
    return next(matchings(mine, its), None) is not None


def _have_row_sums(*methods: Any) -> bool:
    return all(each.c == tuple(map(total, each.a)) for each in methods)


def _collocates(table: RungeKutta, known: Collocation) -> bool:
    """True if the table is that of collocation: its c are the nodes, and B(s) and C(s) then leave one A and one b."""
    if len(table.b) != known.stages or len({*map(float, table.c)}) < known.stages:
        return False
    if any(total(x * c**k for k, x in enumerate(known.node_polynomial)) for c in table.c):
        return False
    found = simplifying_assumptions(table)
    return found.b >= known.stages and (found.c is None or found.c >= known.stages)


def turned_over(method: Any) -> Iterator[tuple[str, Any]]:
    """A splitting in reverse, with kicks for drifts, and both, a multistep method newest first; what they are of it."""
    if isinstance(method, Multistep) and method.rho[0]:
        yield "with rho and sigma newest first", replace(method, rho=method.rho[::-1], sigma=method.sigma[::-1])
    if isinstance(method, Splitting):
        other = dict(zip(SUBSTEPS, reversed(SUBSTEPS), strict=True))
        exchanged = replace(method, parts=tuple((other[kind], x) for kind, x in method.parts))
        yield ADJOINT, replace(method, parts=method.parts[::-1])
        yield EXCHANGED, exchanged
        yield f"{ADJOINT}, {EXCHANGED}", replace(method, parts=exchanged.parts[::-1])


def _alike_on_the_oscillator(method: Entry) -> Iterator[Method]:
    """The methods with the same step of q' = v, v' = -q, and so, of two Runge-Kutta methods, with the same R(z)."""
    if isinstance(method, Method):
        matrix = _written(method)
        yield from (known for known in METHODS.values() if _written(known) == matrix)


@cache
def _written(method: Method) -> str:
    return str([entry.data() for row in oscillator_matrix(method) for entry in row])
