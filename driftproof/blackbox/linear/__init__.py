"""The linear fit in parts: a stepper's one-step matrix read, explained by methods and relatives, or recovered."""
