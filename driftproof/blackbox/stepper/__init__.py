"""Opening a foreign stepper: its calling convention, its kind of numbers, and reading what it returns."""
