"""Formulas from users' text: expressions as trees, numbers, and right-hand sides, parsed and never evaluated."""
