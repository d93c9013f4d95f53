"""What the additions q ← q + dq of a run round off, plainly and compensated: bounds, derived.

Of N additions with moves d₁, ..., d_N, which are the floats that the program computes, let q_N be the result and
s = q₀ + Σ dₙ the exact sum; |qₙ| <= Q for all n, D = Σ |dₙ|. Nothing is said of the moves themselves, whose own
rounding is that of a step; barring overflow.

Plainly, fl(q + d) differs from q + d by at most u|fl(q + d)|, so |q_N - s| <= N u Q.

Compensated, e₀ = 0 and in each addition
    y  = fl(e + d)            = (e + d)(1 + δ), |δ| <= u,
    q⁺ = fl(q + y),
    e⁺ = q + y - q⁺           exactly, by Knuth's sum (muller-2018, 4.3.2), so |e⁺| <= u|q⁺|.
Hence q⁺ + e⁺ = q + e + d + δ(e + d): what was rounded off comes back, and only δ(e + d) is lost. Over N additions
    |q_N + e_N - s| <= u Σ (|e| + |d|) <= u (N u Q + D),    |q_N - s| <= u (Q + N u Q + D).
As D is about the length of the path, which does not grow with N, neither does this bound until N u nears 1.
"""

from __future__ import annotations

from fractions import Fraction


def plain_bound(additions: int, largest: Fraction, u: Fraction) -> Fraction:
    """N u Q: a bound on what N additions round off, of results that are at most `largest`."""
    return additions * u * largest


def compensated_bound(additions: int, largest: Fraction, moved: Fraction, u: Fraction) -> Fraction:
    """u (Q + N u Q + D): the same for compensated additions, `moved` being the sum D of the sizes of the moves."""
    return u * (largest + additions * u * largest + moved)
