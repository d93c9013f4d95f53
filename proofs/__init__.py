"""Proofs of the lesson's claims: one test per claim, a ledger of the evidence, and the values that texts may print."""
