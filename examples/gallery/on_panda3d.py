"""Panda3D: one step of its particle physics, whose integrator is called linear Euler."""

from __future__ import annotations

from examples.gallery.entry import targets


def linear_euler(force, q, v, h):
    """A force of ours as a constant vector force, read before the step."""
    from panda3d.core import NodePath
    from panda3d.physics import (
        ActorNode,
        ForceNode,
        LinearEulerIntegrator,
        LinearVectorForce,
        PhysicsManager,
    )

    manager, actor, forces = PhysicsManager(), ActorNode("body"), ForceNode("forces")
    NodePath("root").attachNewNode(forces)
    manager.attachLinearIntegrator(LinearEulerIntegrator())
    push = LinearVectorForce(force(q), 0.0, 0.0, 1.0, True)
    forces.addForce(push)
    body = actor.getPhysicsObject()
    body.setMass(1.0)
    body.setPosition(q, 0.0, 0.0)
    body.setLastPosition((q, 0.0, 0.0))
    body.setVelocity(v, 0.0, 0.0)
    manager.attachPhysicalNode(actor)
    actor.getPhysical(0).addLinearForce(push)
    manager.doPhysics(h)
    return body.getPosition().x, body.getVelocity().x


TARGETS = targets(__name__, "panda3d", force={"linear_euler": ("linear Euler", 1, "forward_euler")})
