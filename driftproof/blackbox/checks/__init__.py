"""Checks that every stepper should pass, whatever its method: arguments, step sizes, domain, repeatability."""
