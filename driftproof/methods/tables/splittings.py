"""Compositions of kicks and drifts with exact coefficients: Ruth, Forest-Ruth, Suzuki, McLachlan."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction as Q
from itertools import pairwise

from driftproof.methods.numbers.number_field import Exact, NumberField, cube_root, square_root
from driftproof.methods.schemes import Method, Splitting
from driftproof.methods.tables.notation import numbers, splitting

Parts = tuple[tuple[str, Exact], ...]
OTHER = {"kick": "drift", "drift": "kick"}


def alternating(first: str, coefficients: Sequence[Exact]) -> Parts:
    """Alternating kicks and drifts, beginning with the kind named `first`."""
    return tuple((first if i % 2 == 0 else OTHER[first], c) for i, c in enumerate(coefficients))


def palindrome(half: Sequence[Exact]) -> tuple[Exact, ...]:
    """The coefficients, followed by all but the last of them in reverse order."""
    return (*half, *reversed(half[:-1]))


def verlet_composition(first: str, weights: Sequence[Exact]) -> Parts:
    """Verlet steps of sizes w₁h, ..., with half a sub-step `first` at both ends of each; adjacent halves are joined."""
    halves = [w * Q(1, 2) for w in weights]
    outer = [halves[0], *(x + y for x, y in pairwise(halves)), halves[-1]]
    coefficients = [outer[0]]
    for w, x in zip(weights, outer[1:], strict=True):
        coefficients += [w, x]
    return alternating(first, coefficients)


_W2 = cube_root(2)
_TRIPLE_JUMP = palindrome((1 / (2 - _W2), -_W2 / (2 - _W2)))

_W4 = cube_root(4)
_FRACTAL = palindrome((1 / (4 - _W4), 1 / (4 - _W4), -_W4 / (4 - _W4)))

_S2, _S19, _S471 = square_root(2), square_root(19), square_root(471)
# w = 1/2 - λ, where λ = 0.1931... is the first kick of the best symmetric order-2 composition with two forces.
_W = NumberField("w", (-1, 1, 0, 24), Q(0), Q(1, 2)).generator
_S4_FIRST, _S4_SECOND = (642 + _S471) / 3924, 121 * (12 - _S471) / 3924
_S5_FIRST, _S5_SECOND = (14 - _S19) / 108, (20 - 7 * _S19) / 108

_MCLACHLAN: tuple[Splitting, ...] = (
    splitting(
        "mclachlan_atela2 | McLachlan-Atela optimal method of order 2 | 2 | mclachlan-atela-1992, Table 2, order 2",
        alternating("kick", (1 - _S2 / 2, _S2 / 2, _S2 / 2, 1 - _S2 / 2)),
    ),
    splitting(
        "mclachlan2 | McLachlan's optimal symmetric method of order 2, two forces | 2"
        " | mclachlan-1995, the symmetric methods of order 2",
        alternating("drift", palindrome(numbers(Q(1, 2) - _W, Q(1, 2), 2 * _W))),
    ),
    splitting(
        "mclachlan4_four_forces | McLachlan's symmetric method of order 4, four forces | 4"
        " | mclachlan-1995, the symmetric methods of order 4, m = 4",
        alternating(
            "drift", palindrome((_S4_FIRST, Q(6, 11), _S4_SECOND, Q(-1, 22), 1 - 2 * (_S4_FIRST + _S4_SECOND)))
        ),
    ),
    splitting(
        "mclachlan4 | McLachlan's symmetric method of order 4, five forces | 4"
        " | mclachlan-1995, Table 2, type S of order 4, m = 5",
        alternating(
            "drift", palindrome((_S5_FIRST, Q(2, 5), _S5_SECOND, Q(-1, 10), Q(1, 2) - _S5_FIRST - _S5_SECOND, Q(2, 5)))
        ),
    ),
)

ENTRIES: tuple[Method, ...] = (
    splitting(
        "ruth3 | Ruth's method of order 3 | 3 | ruth-1983, the third-order method",
        alternating("kick", (Q(7, 24), Q(2, 3), Q(3, 4), Q(-2, 3), Q(-1, 24), Q(1))),
    ),
    # The same weights as `yoshida4`, around drifts: the coefficients of Forest and Ruth, and of Candy and Rozmus.
    splitting(
        "forest_ruth | Forest-Ruth, which is Yoshida's order 4, position first | 4 | forest-ruth-1990, section 4",
        verlet_composition("drift", _TRIPLE_JUMP),
    ),
    splitting(
        "yoshida4 | Yoshida's order 4, the triple jump of velocity Verlet | 4 | hairer-lubich-wanner-2006, II.4",
        verlet_composition("kick", _TRIPLE_JUMP),
    ),
    splitting(
        "suzuki4 | Suzuki's fractal of order 4, five steps of velocity Verlet | 4 | hairer-lubich-wanner-2006, II.4",
        verlet_composition("kick", _FRACTAL),
    ),
    splitting(
        "suzuki4_position_first | Suzuki's fractal of order 4, five steps of position Verlet | 4"
        " | hairer-lubich-wanner-2006, II.4",
        verlet_composition("drift", _FRACTAL),
    ),
    *_MCLACHLAN,
)
