"""The program text of a step: what a method's step is in Python, written from its exact coefficients."""
