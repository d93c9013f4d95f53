"""Derivations step by step in SymPy, for people to read; no other folder imports SymPy."""
