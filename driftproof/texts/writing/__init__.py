"""Exact answers and facts in print: text, TeX, MathML and JSON."""
