"""Eigenvalues of rational matrices: Jordan blocks by SymPy, places by their roots."""

from __future__ import annotations

from typing import Any

import pytest
import sympy
from flint import acb_poly, arb, ctx

from driftproof.methods.formulas.expressions import parse_system
from driftproof.symbolic.algebra.real_roots import RealRoot
from driftproof.symbolic.linear.eigenvalues import Complex, Imaginary, eigenvalues, root_places
from driftproof.texts.writing.records import record
from tests.symbolic.linear.linear_examples import DAMPED, SPRINGS, STUCK

BLOCKS = {
    "-1 1; 0 -1": [("-1", 2, 2)], "-1 0; 0 -1": [("-1", 2, 1)], "0 1; 0 0": [("0", 2, 2)], "0 1; -1 0": [("I", 1, 1)],
    DAMPED: [("-1/20 + sqrt(399)/20*I", 1, 1)], SPRINGS: [("I", 1, 1), ("sqrt(3)*I", 1, 1)], STUCK: [("I", 2, 2)],
    "2 0 0; 0 2 1; 0 0 2": [("2", 3, 2)],
    "1 2; 3 4": [("5/2 - sqrt(33)/2", 1, 1), ("5/2 + sqrt(33)/2", 1, 1)],
    "-4 4 0 0; -9 8 0 0; 0 0 2 0; 0 0 0 1/2": [("2", 3, 2), ("1/2", 1, 1)],
}  # fmt: skip


@pytest.mark.parametrize("linear", [0, 1])
def test_pairs_that_nearly_coincide_are_told_apart_at_any_precision(linear: int) -> None:
    """(x² + 1)² + 2⁻²⁰⁰ (1 + x): two pairs that are 2⁻¹⁰⁰ apart, on either side of the imaginary axis."""
    size = 2**200
    minimal = (size + 1, linear, 2 * size, 0, size)
    left, right = root_places(minimal)
    assert isinstance(left, Complex)
    assert isinstance(right, Complex)
    with ctx.workprec(300):
        assert left.ball().real < 0 < right.ball().real
        for root in (left, right):
            assert abs(sum(c * root.ball() ** k for k, c in enumerate(minimal)) / size) < arb(2) ** -250
    with pytest.raises(ValueError, match="are not rational"):
        left.sum_and_product()


@pytest.mark.parametrize("text", BLOCKS)
def test_eigenvalues_with_their_jordan_blocks(text: str) -> None:
    shown = [(value_text(record(e.place)), e.multiplicity, e.block) for e in eigenvalues(parse_system(text))]
    assert shown == BLOCKS[text]
    assert _jordan(text) == sorted((m, block) for e in eigenvalues(parse_system(text)) for m, block in _counted(e))


def value_text(value: Any) -> str:
    return value if isinstance(value, str) else value["exact"]


def _counted(eigenvalue: Any) -> list[tuple[int, int]]:
    return [(eigenvalue.multiplicity, eigenvalue.block)] * (1 if isinstance(eigenvalue.place, RealRoot) else 2)


def _jordan(text: str) -> list[tuple[int, int]]:
    """(multiplicity, largest block) of each eigenvalue, from SymPy's Jordan form."""
    _, form = sympy.Matrix([[sympy.Rational(x) for x in row] for row in parse_system(text)]).jordan_form()
    found: dict[Any, list[int]] = {}
    for k in range(form.rows):
        sizes = found.setdefault(form[k, k], [])
        if k and form[k - 1, k] == 1:
            sizes[-1] += 1
        else:
            sizes.append(1)
    return sorted((sum(sizes), max(sizes)) for sizes in found.values())


@pytest.mark.parametrize(
    "minimal",
    [
        (5, 1, 2, 1), (1, 0, 0, 0, 1), (250, 35, 251, 15, 50), (2, 0, 2, 0, 1), (-2, 0, 0, 0, 1), (1, -3, 0, 0, 0, 1),
        (5, 4, 20), (1, 0, 4), (-1, 0, 2),
        (1, 0, 4096, *[0] * 18, 1),  # one is near i/64, 2**-133 to the left of the axis
    ],
)  # fmt: skip
def test_places_are_the_roots_and_keep_their_order_at_every_precision(minimal: tuple[int, ...]) -> None:
    found = root_places(minimal)
    wanted = sympy.Poly(list(reversed(minimal)), sympy.Symbol("x")).nroots(30)
    assert len(wanted) == sum(1 if isinstance(p, RealRoot) else 2 for p in found)
    for place in found:
        middles = []
        for bits in (64, 100, 400):
            with ctx.workprec(bits):
                ball = place.ball() if not isinstance(place, Imaginary) else place.size.ball() * acb_poly([0, 1])(1j)
                middles.append(complex(ball.mid()))
        assert max(abs(m - middles[0]) for m in middles) < 1e-12
        assert any(abs(complex(w) - middles[0]) < 1e-12 for w in wanted)
