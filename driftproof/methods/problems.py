"""Right-hand sides that run over any kind of number."""

from __future__ import annotations

from driftproof.methods.stepping import Number


def oscillator(q: Number) -> Number:
    """F(q) = -q, the acceleration of the normalised oscillator q' = v, v' = -q."""
    return -q
