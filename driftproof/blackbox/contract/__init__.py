"""What a stepper does at the edges of its domain and with its arguments, clause by clause, whatever its method."""
