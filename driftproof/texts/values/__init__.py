"""The values that the proofs publish, in every format, and what changed between two files of them."""
