"""Certificates of the ledger's claims for Coq: theory by hand, statements written from the project's exact objects."""
