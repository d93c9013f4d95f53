"""The values that the proofs publish, in several formats, and the comparison of two files of values."""
