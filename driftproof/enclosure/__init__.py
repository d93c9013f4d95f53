"""Proved errors of a float trajectory, by enclosures of the true solution."""
