"""Exact facts about methods on linear problems: one-step matrices, stability, phase, invariants."""
