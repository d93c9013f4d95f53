"""Coefficients that were read: the methods and relatives that have them, and the order that they give."""
