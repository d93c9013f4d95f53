"""Derivations that only proofs of the lesson's claims use, in SymPy: the spring, signs, errors of long runs."""
