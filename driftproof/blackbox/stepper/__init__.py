"""Somebody's stepper, opened: its door, the numbers it takes, how it is called and what comes back."""
