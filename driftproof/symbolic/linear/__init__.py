"""What a method does on linear problems: one-step matrices, stability, phase, invariants."""
