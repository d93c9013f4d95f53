"""Comparison of a stepper with a method: rounding errors against a derived bound, nonlinear steps, and the order."""
