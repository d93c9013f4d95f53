"""What the integrators are: exact data, one program text each, one parser of exact numbers."""
