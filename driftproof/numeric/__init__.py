"""Everything in floats: steps, runs and readouts, with NumPy and without SymPy."""
