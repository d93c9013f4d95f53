"""Coefficients that were read: the methods and variants that have them, and the order that they give."""
