"""Somebody's stepper, opened: how it is called, the numbers it takes and what comes back."""
