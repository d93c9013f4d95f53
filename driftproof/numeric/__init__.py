"""What floats do: step, run and read out, with NumPy and without SymPy."""
