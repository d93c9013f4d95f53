"""A stepper held to a method: its rounding errors to a derived bound, its order to the pendulum."""
