"""A stepper's own coefficients, read by answering its right-hand side or its force."""
