"""Box2D: one step of its world on one free body, the force applied before the step as its users do."""

from __future__ import annotations

from examples.gallery.entry import targets


def applied_force(force, q, v, h):
    """One step without sleeping bodies; Box2D computes in single precision."""
    import Box2D

    world = Box2D.b2World(gravity=(0.0, 0.0), doSleep=False)
    body = world.CreateDynamicBody(position=(q, 0.0), linearVelocity=(v, 0.0))
    body.CreateCircleFixture(radius=1.0, density=1.0)
    body.massData = Box2D.b2MassData(mass=1.0, center=(0.0, 0.0), I=1.0)
    body.ApplyForceToCenter((force(q), 0.0), True)
    world.Step(h, 8, 3)
    return body.position[0], body.linearVelocity[0]


TARGETS = targets(__name__, "Box2D", "force", {"applied_force": ("semi-implicit Euler", 1, "symplectic_euler")})
