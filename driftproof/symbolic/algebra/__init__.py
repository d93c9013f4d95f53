"""Exact algebra with FLINT: polynomials, their real roots, matrices, number fields, certified digits."""
