"""Collocation methods by their node polynomials, for any number of stages: Gauss, Radau I and IIA, Lobatto IIIA."""

from __future__ import annotations

from fractions import Fraction
from math import comb, perm

from driftproof.methods.schemes import Collocation, Method

BOOK = "hairer-wanner-1996, IV.5"


def gauss_nodes(stages: int) -> tuple[Fraction, ...]:
    """The shifted Legendre polynomial of degree s >= 1, monic: the s-th derivative of x^s (x - 1)^s."""
    return _rodrigues("gauss_nodes", stages, 1, stages, stages)


def radau_left_nodes(stages: int) -> tuple[Fraction, ...]:
    """The polynomial of the Radau nodes with 0, s >= 1, monic: the (s-1)-st derivative of x^s (x - 1)^(s-1)."""
    return _rodrigues("radau_left_nodes", stages, 1, stages, stages - 1)


def radau_right_nodes(stages: int) -> tuple[Fraction, ...]:
    """The polynomial of the Radau nodes with 1, s >= 1, monic: the (s-1)-st derivative of x^(s-1) (x - 1)^s."""
    return _rodrigues("radau_right_nodes", stages, 1, stages - 1, stages)


def lobatto_nodes(stages: int) -> tuple[Fraction, ...]:
    """The polynomial of the Lobatto nodes, s >= 2, monic: the (s-2)-nd derivative of x^(s-1) (x - 1)^(s-1)."""
    return _rodrigues("lobatto_nodes", stages, 2, stages - 1, stages - 1)


def _rodrigues(name: str, stages: int, fewest: int, at_zero: int, at_one: int) -> tuple[Fraction, ...]:
    """The polynomial x**at_zero (x - 1)**at_one, differentiated down to degree `stages` and made monic."""
    if stages < fewest:
        raise ValueError(f"{name}({stages}): at least {fewest} stages are needed")
    times = at_zero + at_one - stages
    terms = [(k, (-1) ** k * comb(at_one, k) * perm(at_zero + k, times)) for k in range(at_one + 1)]
    by_power = {at_zero + k - times: Fraction(c, terms[-1][1]) for k, c in terms}
    return tuple(by_power.get(power, Fraction(0)) for power in range(stages + 1))


def gauss(stages: int) -> Collocation:
    """The Gauss method of order 2s."""
    return Collocation(f"gauss{stages}", f"Gauss, {stages} stages", 2 * stages, BOOK, gauss_nodes(stages))


def radau_i(stages: int) -> Collocation:
    """The Radau I method of order 2s - 1: collocation at the left Radau nodes. Radau IA has another A."""
    return Collocation(
        key=f"radau_i{stages}",
        title=f"Radau I, {stages} stages",
        claimed_order=2 * stages - 1,
        source="butcher-2016, 344",
        node_polynomial=radau_left_nodes(stages),
    )


def radau_iia(stages: int) -> Collocation:
    """The Radau IIA method of order 2s - 1."""
    return Collocation(
        f"radau_iia{stages}", f"Radau IIA, {stages} stages", 2 * stages - 1, BOOK, radau_right_nodes(stages)
    )


def lobatto_iiia(stages: int) -> Collocation:
    """The Lobatto IIIA method of order 2s - 2."""
    return Collocation(
        f"lobatto_iiia{stages}", f"Lobatto IIIA, {stages} stages", 2 * stages - 2, BOOK, lobatto_nodes(stages)
    )


# The methods with fewer stages are in driftproof/methods/tables/implicit.py, as tableaux.
ENTRIES: tuple[Method, ...] = (
    *(gauss(stages) for stages in range(4, 11)),
    radau_i(2),
    radau_i(3),
    *(radau_iia(stages) for stages in range(4, 8)),
    *(lobatto_iiia(stages) for stages in range(5, 8)),
)
