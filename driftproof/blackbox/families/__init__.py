"""Steppers that no single tableau describes: multistep, Rosenbrock and IMEX methods, rotations, damped steps."""
