"""The derivations that a reader can follow, in SymPy: the only folder that loads it."""
