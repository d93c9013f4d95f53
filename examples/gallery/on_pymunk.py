"""Pymunk: one step of its space, the force given before the step, as a velocity function, or as a spring of its own."""

from __future__ import annotations

from examples.gallery.entry import targets


def _space_with_body(q, v):
    import pymunk

    space, body = pymunk.Space(), pymunk.Body(mass=1.0, moment=1.0)
    space.add(body)
    body.position, body.velocity = (q, 0.0), (v, 0.0)
    return space, body


def applied_force(force, q, v, h):
    """`apply_force_at_local_point` before each step."""
    space, body = _space_with_body(q, v)
    body.apply_force_at_local_point((force(q), 0.0))
    space.step(h)
    return body.position.x, body.velocity.x


def velocity_function(force, q, v, h):
    """The force evaluated where the library updates the velocity."""
    import pymunk

    space, body = _space_with_body(q, v)

    def update(body, gravity, damping, dt):
        pymunk.Body.update_velocity(body, (force(body.position.x), 0.0), damping, dt)

    body.velocity_func = update
    space.step(h)
    return body.position.x, body.velocity.x


def spring(q, v, h):
    """A damped spring of rest length 0 and stiffness 1, its damping 0, with one iteration of the solver."""
    import pymunk

    space, body = _space_with_body(q, v)
    space.add(pymunk.DampedSpring(space.static_body, body, (0.0, 0.0), (0.0, 0.0), 0.0, 1.0, 0.0))
    space.step(h)
    return body.position.x, body.velocity.x


TARGETS = targets(
    __name__,
    "pymunk",
    "force",
    {
        "applied_force": ("(nothing)", None),
        "velocity_function": ("(nothing)", None),
    },
) | targets(__name__, "pymunk", "map", {"spring": ("(nothing)", None)})
