"""Coordinates separate what is slow from what is fast, and bases hold the sets that they are made for."""

from __future__ import annotations

from math import cos, sin

import pytest
from flint import arb, arb_mat

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.solution import coordinates
from driftproof.enclosure.solution.comparison import sizes_of
from driftproof.enclosure.solution.coordinates import Coordinates, basis_around, nearly_diagonal


def jacobian(rows):
    return [[arb(x) for x in row] for row in rows]


def test_slow_and_fast_directions_are_separated():
    """Eigenvalues -1 and -1000 of (998, 1998; -999, -1999), to (2, -1) and (1, -1), in any units."""
    found = nearly_diagonal(jacobian([[998, 1998], [-999, -1999]]), arb(0.5), [1.0, 0.125])
    assert found.slow == 1
    slow = found.slow_part(found.T * arb_mat([[3], [-2]]))  # (2, -1) + (1, -1)
    assert all(abs(x - y) < 1e-9 for x, y in zip(slow.entries(), (2, -1), strict=True))


def test_pairs_of_conjugates_are_two_real_directions():
    found = nearly_diagonal(jacobian([[-100, 50], [-50, -100]]), arb(1), [1.0, 1.0])
    diagonal = found.T * arb_mat([[-100, 50], [-50, -100]]) * found.inverse
    assert found.slow == 0
    assert abs(diagonal[0, 0] + 100) < 1e-9
    assert abs(abs(diagonal[0, 1]) - 50) < 1e-9


def test_directions_that_grow_fast_are_refused():
    """By more than e² in a step; and what decays by more is fast."""
    with pytest.raises(Refused, match="errors grow too fast there for implicit steps"):
        nearly_diagonal(jacobian([[2.0625, 0], [0, -1]]), arb(1), [1.0, 1.0])
    for decay, slow in ((-2, 2), (-2.0625, 1)):
        assert nearly_diagonal(jacobian([[2, 0], [0, decay]]), arb(1), [1.0, 1.0]).slow == slow


def test_directions_that_are_dependent_are_refused():
    with pytest.raises(Refused, match="no coordinates make the Jacobian nearly diagonal"):
        nearly_diagonal(jacobian([[-100, 0], [0, -100]]), arb("inf"), [1.0, 1.0])
    with pytest.raises(Refused, match="the error bound is not finite"):
        basis_around(arb_mat([["nan"]]), arb_mat([[1]]), arb_mat(1, 0), [1.0])


def test_slow_directions_need_no_eigenvectors():
    """A Jordan block of 0 beside what is fast."""
    J = [[0, 1, 0], [0, 0, 0], [1, 1, -1e6]]
    found = nearly_diagonal(jacobian(J), arb(1), [1.0, 1.0, 1.0])
    across = (found.T * arb_mat(J) * found.inverse).tolist()
    assert found.slow == 2
    assert all(abs(x) < 1e-9 for x in (across[0][2], across[1][2], *across[2][:2]))


@pytest.mark.parametrize(
    ("image", "widths", "slow", "wanted"),
    [
        ([[8, 0.5], [0, 1]], (2.0**-600, 2.0**-595), 2, [(0.5, 1), (8, 0)]),  # its own directions, the wider first
        ([[1, -0.5], [3, 1]], (1, 0), 2, [(1, 3), (-0.5, 1)]),  # however narrow the other one is
        ([[-0.5, 1], [1, 3]], (0, 0), 2, [(1, 3), (-0.5, 1)]),  # of a point
        ([[1, 1], [1, 1 + 2.0**-30]], (1, 2), 2, None),  # nearly dependent: orthogonal ones
        ([[1, 0], [1, 0]], (1, 2), 1, [(1, 1), (0, 1)]),  # one, and the fast one
        ([[0, 0], [0, 0]], (1, 2), 2, None),  # any directions
    ],
)
def test_basis_is_near_to_the_set(image, widths, slow, wanted):
    end = Coordinates(arb_mat([[1, 0], [0, 1]]), arb_mat([[1, 0], [0, 1]]), slow)
    basis = basis_around(arb_mat(image), arb_mat([[x] for x in widths]), end.fast, [1.0, 1.0])
    columns = basis.transpose().tolist()
    if wanted is None:
        assert abs(sum((x * y for x, y in zip(*columns, strict=True)), arb(0))) < 1e-12
    else:
        assert all(abs(x * w - y * v) < 1e-11 for (x, y), (v, w) in zip(columns, wanted, strict=True))
    back = basis.inv()
    assert all(x.is_finite() for x in back.entries())
    rows = (back * arb_mat(image)).tolist()
    assert max(float(sum((abs(x) * w for x, w in zip(row, widths, strict=True)), arb(0))) for row in rows) < 5


def test_directions_are_chosen_by_what_is_left_of_them_in_any_units():
    """Of (4, 0), (3, 1/2) and (1, 1), in units of 2⁻⁴⁰ and 2⁻⁶⁰ and beside a fast one, the first and the last."""
    rows = [[4, 3, 1], [0, 2.0**-21, 2.0**-20], [0, 0, 0]]
    fast, widths = arb_mat([[0], [0], [1]]), arb_mat([[1]] * 3)
    basis = basis_around(arb_mat(rows) * arb(2.0**-40), widths, fast, [1.0, 2.0**-20, 1.0])
    assert (basis[1, 0], abs(basis[1, 1] / basis[0, 1] - 2.0**-20) < 1e-12, basis[2, 2]) == (0, True, 1)


def widened(steps):
    """How wide the unit box becomes that turns in three skewed planes, by the angles 1, 2 and 3 in each step."""
    turn = arb_mat([[0] * 6 for _ in range(6)])
    for k, angle in enumerate((1, 2, 3)):
        for i, row in enumerate([(cos(angle), -sin(angle)), (sin(angle), cos(angle))]):
            turn[2 * k + i, 2 * k], turn[2 * k + i, 2 * k + 1] = row
    skew = arb_mat([[1 / (1 + abs(i - j)) for j in range(6)] for i in range(6)])
    flow, no_fast_ones = skew * turn * skew.inv(), arb_mat(6, 0)
    basis, widths = arb_mat(6, 6, 1), arb_mat([[1]] * 6)
    for _ in range(steps):
        image = flow * basis
        basis = basis_around(image, widths, no_fast_ones, [1.0] * 6)
        widths = sizes_of(basis.inv() * image) * widths
    return max(float(x) for x in (sizes_of(basis) * widths).entries())


def test_what_only_turns_is_not_widened_as_orthogonal_bases_would(monkeypatch):
    assert widened(200) < 20
    monkeypatch.setattr(coordinates, "DEPENDENT", 1)
    assert widened(200) > 1e4
