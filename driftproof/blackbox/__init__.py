"""Somebody's float stepper, seen from outside: what it is, and whether it is right to roundoff."""
