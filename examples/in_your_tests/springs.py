"""Somebody's physics: a step that is called velocity Verlet, and is not."""


def velocity_verlet(q, v, h):
    """One step of a unit mass on a unit spring."""
    v = v - h * q
    return q + h * v, v
