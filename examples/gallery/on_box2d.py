"""Box2D: one step of its world on one free body, the force applied before the step as its users do."""

from __future__ import annotations

from types import SimpleNamespace

from driftproof.blackbox.stepper.states.objects import stepper_of
from examples.gallery.entry import targets


def _world():
    """A world without sleeping bodies, and one body; Box2D computes in single precision."""
    import Box2D

    world = Box2D.b2World(gravity=(0.0, 0.0), doSleep=False)
    body = world.CreateDynamicBody()
    body.CreateCircleFixture(radius=1.0, density=1.0)
    body.massData = Box2D.b2MassData(mass=1.0, center=(0.0, 0.0), I=1.0)
    return SimpleNamespace(world=world, body=body)


applied_force = stepper_of(
    _world,
    position="body.position",
    velocity="body.linearVelocity",
    push=lambda its, force: its.body.ApplyForceToCenter((force, 0.0), True),
    advance=lambda its, h: its.world.Step(h, 8, 3),
)

TARGETS = targets(__name__, "Box2D", force={"applied_force": ("semi-implicit Euler", 1, "symplectic_euler")})
