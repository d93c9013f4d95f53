"""Probes that read a stepper's own coefficients by answering its right-hand side or its force."""
