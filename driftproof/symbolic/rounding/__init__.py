"""Bounds on the rounding error of a step and of a run, derived by running the program, for any format and any N."""
