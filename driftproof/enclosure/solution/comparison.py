"""Bounds of errors by quasi-monotone linear systems z' = Mz + δ, in which off-diagonal entries of M are >= 0.

If |e_i|' <= M_ii |e_i| + Σ over j != i of M_ij |e_j| + δ_i and |e(0)| <= z(0), then |e| <= z (mueller-1927;
walter-1970, II.12).
"""

from __future__ import annotations

from math import log2

import numpy as np
from flint import arb, arb_mat, ctx

from driftproof.enclosure.arithmetic.evaluations import in_bits
from driftproof.enclosure.arithmetic.numbers import size

# The κh that are tried in the bound r e^(κs): the first loses little; a system that grows needs a larger one.
RATES = (0.125, 1, 4, 16)
MOST_SWEEPS = 200
# The bound is found in doubles and then made a little larger, so that balls can verify it.
ROOM = 1 + arb(2) ** -16


def sizes_of(m: arb_mat) -> arb_mat:
    """Upper bounds of the entries' sizes."""
    return arb_mat([[arb(x.abs_upper()) for x in row] for row in m.tolist()])


def quasi_monotone(m: arb_mat) -> arb_mat:
    """Upper bounds of the diagonal entries, and of the sizes of the off-diagonal ones."""
    return arb_mat(
        [[arb(x.upper() if i == j else x.abs_upper()) for j, x in enumerate(row)] for i, row in enumerate(m.tolist())]
    )


def at_the_end(M: arb_mat, sources: arb_mat, step: arb) -> tuple[arb_mat, arb_mat]:
    """Upper bounds of exp(hM), and of ∫ exp(sM) ds over the step times each column of the sources, which are >= 0."""
    n, k = M.nrows(), sources.ncols()
    rows = [[*left, *right] for left, right in zip(M.tolist(), sources.tolist(), strict=True)]
    both = arb_mat([*rows, *[[arb(0)] * (n + k)] * k]) * step
    # Squaring the exponential loses about as many bits as its argument has before the point.
    lost = int(log2(1 + float(size(both.entries()))))
    with in_bits(ctx.prec + lost):
        found = both.exp().tolist()[:n]
    return sizes_of(arb_mat([row[:n] for row in found])), sizes_of(arb_mat([row[n:] for row in found]))


def along_the_step(M: arb_mat, start: arb_mat, source: arb_mat, step: arb) -> arb_mat | None:
    """An upper bound of z on the whole step: r e^(κh) with r >= z(0) and κr >= Mr + δ; None if none is found."""
    A, z, d = (np.array([[float(x) for x in row] for row in m.tolist()]) for m in (M, start, source))
    if not all(np.isfinite(x).all() for x in (A, z, d)):
        return None
    diagonal = np.diag(A)[:, None]
    for rate in RATES:
        kappa = arb(rate) / step
        r, room = z, np.maximum(float(kappa) - diagonal, 0.0)
        with np.errstate(all="ignore"):
            for _ in range(MOST_SWEEPS):
                swept = np.maximum(r, (d + A @ r - diagonal * r) / room)
                if not np.isfinite(swept).all() or np.all(swept <= r * (1 + 2.0**-20)):
                    break
                r = swept
        if not np.isfinite(swept).all():
            continue
        bound = arb_mat([[arb(x) * ROOM + arb(2) ** -1000] for (x,) in swept.tolist()])
        needed = zip(bound.entries(), (M * bound + source).entries(), start.entries(), strict=True)
        if all(kappa * b >= slope and b >= first for b, slope, first in needed):
            return sizes_of(bound * arb(rate).exp())
    return None
