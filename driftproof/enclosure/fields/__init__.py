"""Right-hand sides on enclosed numbers: Python functions and texts, as they stand and traced into text."""
