"""Exact numbers: rationals, real algebraic numbers in their fields, and what joins two fields."""
