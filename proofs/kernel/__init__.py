"""Coq certificates of the ledger's claims: hand-written theory, and statements generated from exact objects."""
