"""What a stepper does at the edges of its domain and with its arguments, check by check, whatever its method."""
