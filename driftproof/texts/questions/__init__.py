"""A small language of questions about methods and runs: parsing, exact answers, and their decimals."""
