"""Steppers that no single tableau describes: those that remember, that take a Jacobian, that take two functions."""
