"""PyBullet: one step of its world on one free body, the force applied before the step as its users do."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _world():
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.1, physicsClientId=client)
    body = pybullet.createMultiBody(baseMass=1.0, baseCollisionShapeIndex=shape, physicsClientId=client)
    return client, body


def _moved(force, q, v, h, **damping):
    import pybullet

    client, body = _world()
    world = {"physicsClientId": client}
    pybullet.changeDynamics(body, -1, **damping, **world)
    pybullet.setTimeStep(h, **world)
    pybullet.resetBasePositionAndOrientation(body, (q, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), **world)
    pybullet.resetBaseVelocity(body, (v, 0.0, 0.0), (0.0, 0.0, 0.0), **world)
    pybullet.applyExternalForce(body, -1, (force(q), 0.0, 0.0), (q, 0.0, 0.0), pybullet.WORLD_FRAME, **world)
    pybullet.stepSimulation(**world)
    return pybullet.getBasePositionAndOrientation(body, **world)[0][0], pybullet.getBaseVelocity(body, **world)[0][0]


def plain(force, q, v, h):
    """As it comes: with a linear damping of 0.04."""
    return _moved(force, q, v, h, linearDamping=0.04)


def undamped(force, q, v, h):
    """Without damping."""
    return _moved(force, q, v, h, linearDamping=0.0)


TARGETS = targets(
    __name__,
    "pybullet",
    force={
        "plain": ("semi-implicit Euler", 1, "symplectic_euler"),
        "undamped": ("semi-implicit Euler", 1, "symplectic_euler"),
    },
)
