"""Templates with questions in them, rendered by a Jinja sandbox in a separate process."""
