"""Coordinates for errors: in which a stiff Jacobian is nearly diagonal, and in which boxes do not wrap.

How they are chosen proves nothing; whatever is chosen, what it stands for is enclosed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, arb_mat

from driftproof.enclosure.numbers import Refused

# What grows or decays by more than e² in a step is fast. 18 stages resolve e² to the digits of a double.
FAST = 2.0
# An eigenvalue of which less is imaginary is taken for real.
REAL = 1e-12
# Directions with this condition number, and above, are nearly dependent; 10 and 30 leave smaller radii than 1000.
DEPENDENT = 30


@dataclass(frozen=True)
class Coordinates:
    """z = T e, T thin: of T⁻¹ the first `slow` columns span what changes slowly, the others are fast directions."""

    T: arb_mat
    inverse: arb_mat
    slow: int

    def slow_part(self, m: arb_mat) -> arb_mat:
        """T⁻¹ m without what belongs to the fast directions."""
        rows = m.tolist()
        return self.inverse * arb_mat([row if i < self.slow else [0] * len(row) for i, row in enumerate(rows)])

    @property
    def fast(self) -> arb_mat:
        """The fast directions, as columns."""
        columns = self.inverse.transpose().tolist()[self.slow :]
        return arb_mat(columns).transpose() if columns else arb_mat(self.inverse.nrows(), 0)


def nearly_diagonal(jacobian: Sequence[Sequence[arb]], step: arb, sizes: Sequence[float]) -> Coordinates:
    """Fast directions are eigenvectors, slow ones orthogonal to the fast left ones, where components have the sizes.

    So it does not matter how eigenvalues of slow ones coincide. Raises Refused where errors grow fast.
    """
    rows = [[x * b * step / a for x, b in zip(row, sizes, strict=True)] for row, a in zip(jacobian, sizes, strict=True)]
    scaled = arb_mat(rows).mid()
    try:
        fast = _fast_directions(scaled)
        columns = [*_complement(_fast_directions(scaled.transpose()), len(sizes)), *fast]
        T = arb_mat([[x * a for x, a in zip(column, sizes, strict=True)] for column in columns]).transpose().inv().mid()
        return Coordinates(T, T.inv(), len(sizes) - len(fast))
    except ZeroDivisionError:
        raise Refused("the Jacobian has no coordinates in which it is nearly diagonal") from None


def _fast_directions(m: arb_mat) -> list[list[arb]]:
    """Real eigenvectors of what is fast, and both parts of one of each pair of conjugates."""
    found = []
    values, vectors = m.eig(right=True, algorithm="approx")
    for value, column in zip(values, vectors.transpose().tolist(), strict=True):
        if float(value.real) > FAST:
            raise Refused("errors grow fast there")
        turning = float(value.imag) / max(float(abs(value)), FAST)
        if float(abs(value)) > FAST and turning > -REAL:
            largest = max(column, key=lambda x: float(abs(x)))  # a real vector has some complex factor
            found.append([(x / largest).real.mid() for x in column])
            if turning > REAL:
                found.append([(x / largest).imag.mid() for x in column])
    return found


def _complement(columns: Sequence[Sequence[arb]], n: int) -> list[list[arb]]:
    """Orthonormal vectors, orthogonal to the columns, in Arb's precision: next to what is fast, doubles fail."""
    made: list[list[arb]] = []
    left = [[arb(int(i == j)) for j in range(n)] for i in range(n)]
    for k in range(n):
        rests = [_orthogonal(x, made) for x in (columns[k : k + 1] or left)]
        lengths = [sum((x * x for x in rest), arb(0)).sqrt().mid() for rest in rests]
        longest = max(range(len(rests)), key=lambda i: float(lengths[i]))
        made.append([(x / lengths[longest]).mid() for x in rests[longest]])
    return made[len(columns) :]


def _orthogonal(column: Sequence[arb], others: Sequence[Sequence[arb]]) -> list[arb]:
    """By Gram and Schmidt, twice."""
    rest = list(column)
    for other in (*others, *others):
        along = sum((x * y for x, y in zip(rest, other, strict=True)), arb(0))
        rest = [(x - along * y).mid() for x, y in zip(rest, other, strict=True)]
    return rest


def basis_around(image: arb_mat, widths: arb_mat, fast: arb_mat, sizes: Sequence[float | arb]) -> arb_mat:
    """For a set image·z, |z| <= widths: its longest directions, as many as are slow, and the fast ones.

    What only turns stays as it is so. Orthogonal directions, of QR factors, would widen it by |R| step after step: they
    are for directions that are nearly dependent, the longest first (lohner-1987).
    """
    widest = max(widths.entries(), key=arb.mid)
    lengths = np.array([float(x / widest) if widest > 0 else 1.0 for x in widths.entries()])
    directions = _floats(image, sizes)
    weighted = directions * lengths
    if not np.isfinite(weighted).all():
        raise Refused("the bound of the errors is not finite")
    rest, chosen = weighted.copy(), list[int]()
    for _ in range(len(sizes) - fast.ncols()):
        norms = np.linalg.norm(rest, axis=0)
        norms[chosen] = -1
        chosen.append(int(np.argmax(norms)))
        along = rest[:, chosen[-1]] / max(norms.max(), 1e-300)
        rest = rest - np.outer(along, along @ rest)
    found = np.column_stack([directions[:, chosen], _floats(fast, sizes)])
    found = found / np.maximum(np.linalg.norm(found, axis=0), 1e-300)
    if not np.linalg.cond(found) < DEPENDENT:
        order = np.argsort(-np.linalg.norm(weighted, axis=0), kind="stable")
        found, _ = np.linalg.qr(weighted[:, order] + 1e-300 * np.eye(len(sizes)))
    return arb_mat([[arb(x) * a for x in row] for row, a in zip(found.tolist(), sizes, strict=True)])


def _floats(m: arb_mat, sizes: Sequence[float | arb]) -> Any:
    """Rows in units of the sizes."""
    return np.array([[float(x / a) for x in row] for row, a in zip(m.tolist(), sizes, strict=True)])
