"""Coordinates for errors: some in which a stiff Jacobian is nearly diagonal, some in which boxes do not wrap.

No proof depends on the choice: whatever the coordinates are, the errors are enclosed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, arb_mat

from driftproof.enclosure.arithmetic.evaluations import Refused

# An error that grows or decays by more than e² in a step is fast. 18 stages resolve e² to the digits of a double.
FAST = 2.0
# An eigenvalue with a smaller imaginary part, relative to its size, is taken for real.
REAL = 1e-12
# Directions with at least this condition number are nearly dependent. chosen: 10 and 30 leave smaller radii than 1000.
DEPENDENT = 30


@dataclass(frozen=True)
class Coordinates:
    """Coordinates z = T e, T thin: the first `slow` columns of T⁻¹ are slow directions, the others fast ones."""

    T: arb_mat
    inverse: arb_mat
    slow: int

    def slow_part(self, m: arb_mat) -> arb_mat:
        """T⁻¹ m without the parts in the fast directions."""
        rows = m.tolist()
        return self.inverse * arb_mat([row if i < self.slow else [0] * len(row) for i, row in enumerate(rows)])

    @property
    def fast(self) -> arb_mat:
        """The fast directions, as columns."""
        columns = self.inverse.transpose().tolist()[self.slow :]
        return arb_mat(columns).transpose() if columns else arb_mat(self.inverse.nrows(), 0)


def nearly_diagonal(jacobian: Sequence[Sequence[arb]], step: arb, sizes: Sequence[float]) -> Coordinates:
    """Coordinates whose fast directions are eigenvectors; slow ones are orthogonal to the fast left eigenvectors.

    Components are in units of the sizes. Slow eigenvalues may coincide. Raises Refused if errors grow fast.
    """
    rows = [[x * b * step / a for x, b in zip(row, sizes, strict=True)] for row, a in zip(jacobian, sizes, strict=True)]
    scaled = arb_mat(rows).mid()
    try:
        fast = _fast_directions(scaled)
        columns = [*_complement(_fast_directions(scaled.transpose()), len(sizes)), *fast]
        T = arb_mat([[x * a for x, a in zip(column, sizes, strict=True)] for column in columns]).transpose().inv().mid()
        return Coordinates(T, T.inv(), len(sizes) - len(fast))
    except ZeroDivisionError:
        raise Refused("no coordinates make the Jacobian nearly diagonal") from None


def _fast_directions(m: arb_mat) -> list[list[arb]]:
    """The fast eigenvectors: real ones, and the real and imaginary part of one of each conjugate pair."""
    found = []
    values, vectors = m.eig(right=True, algorithm="approx")
    for value, column in zip(values, vectors.transpose().tolist(), strict=True):
        if float(value.real) > FAST:
            raise Refused("errors grow too fast there for implicit steps")
        turning = float(value.imag) / max(float(abs(value)), FAST)
        if float(abs(value)) > FAST and turning > -REAL:
            largest = max(column, key=lambda x: float(abs(x)))  # a real vector has some complex factor
            found.append([(x / largest).real.mid() for x in column])
            if turning > REAL:
                found.append([(x / largest).imag.mid() for x in column])
    return found


def _complement(columns: list[list[arb]], n: int) -> Any:
    """Vectors orthogonal to the columns, in Arb's precision: doubles, which find them, fail beside fast directions."""
    whole = arb_mat(n, n, 1)
    if not columns:
        return whole.tolist()
    C = arb_mat(columns).transpose()
    C = C * arb_mat(np.linalg.inv(np.linalg.qr(_floats(C, [1] * n), mode="r")).tolist())  # nearly orthonormal
    projection = (whole - C * ((C.transpose() * C).inv() * C.transpose())).mid()
    vectors = np.linalg.eigh(_floats(projection, [1] * n))[1][:, len(columns) :]
    found = (projection * arb_mat(vectors.tolist())).mid() if len(columns) < n else arb_mat(n, 0)
    return found.transpose().tolist()


def basis_around(image: arb_mat, widths: arb_mat, fast: arb_mat, sizes: Sequence[float | arb]) -> arb_mat:
    """A basis for the set image·z, |z| <= widths: its longest directions, as many as are slow, and the fast ones.

    It does not widen a set that only rotates. The orthogonal directions of QR factors would, by |R| in every step; they
    are used only for directions that are nearly dependent, the longest first (lohner-1987).
    """
    widest = max(widths.entries(), key=arb.mid)
    lengths = np.array([float(x / widest) if widest > 0 else 1.0 for x in widths.entries()])
    directions = _floats(image, sizes)
    weighted = directions * lengths
    if not np.isfinite(weighted).all():
        raise Refused("the error bound is not finite")
    rest, chosen = weighted.copy(), list[int]()
    for _ in range(len(sizes) - fast.ncols()):
        norms = np.linalg.norm(rest, axis=0)
        longest = max({*range(len(norms))} - {*chosen}, key=norms.item)
        chosen.append(longest)
        along = rest[:, longest] / max(norms[longest], 1e-300)
        rest = rest - np.outer(along, along @ rest)
    found = np.column_stack([directions[:, chosen], _floats(fast, sizes)])
    found = found / np.maximum(np.linalg.norm(found, axis=0), 1e-300)
    if not np.linalg.cond(found) < DEPENDENT:
        order = np.argsort(-np.linalg.norm(weighted, axis=0), kind="stable")
        found, _ = np.linalg.qr(weighted[:, order] + 1e-300 * np.eye(len(sizes)))
    return arb_mat([[arb(x) * a for x in row] for row, a in zip(found.tolist(), sizes, strict=True)])


def _floats(m: arb_mat, sizes: Sequence[float | arb]) -> Any:
    """The matrix in doubles, with rows in units of the sizes."""
    return np.array([[float(x / a) for x in row] for row, a in zip(m.tolist(), sizes, strict=True)])
