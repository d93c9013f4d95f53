"""Runs of a method in balls or Fractions: the steps that a float run took, without its rounding errors."""
