"""What the integrators are: exact data and one generic step per family, standard library only."""
