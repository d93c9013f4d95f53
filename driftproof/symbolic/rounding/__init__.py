"""What rounding does to a step and to a run: bounds derived by running the very program, for any format and any N."""
