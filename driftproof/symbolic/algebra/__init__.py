"""Exact algebra on FLINT: polynomials, their real roots, matrices, number fields, certified digits."""
