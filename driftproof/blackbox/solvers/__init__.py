"""Whole solvers of initial value problems: their steps, their step size control, their clock."""
