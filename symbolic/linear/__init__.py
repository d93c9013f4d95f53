"""What a method does to linear problems: stability, phase, invariants; exact over Q and over real number fields."""
