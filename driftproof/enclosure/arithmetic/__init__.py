"""Enclosed numbers: balls, Taylor series and Taylor models with derivatives, and the functions that take them."""
