"""Matching of what was read from a stepper to methods of the catalogue, and the order of the coefficients read."""
