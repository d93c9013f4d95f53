"""Somebody's trajectory: the true solution beside it, enclosed, and so its error."""
