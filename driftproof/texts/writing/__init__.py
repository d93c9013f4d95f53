"""Writers of exact answers and facts as text, TeX, MathML and JSON."""
