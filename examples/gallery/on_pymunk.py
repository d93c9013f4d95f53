"""Pymunk: one step of its space, the force given before the step, as a velocity function, or as a spring of its own."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

from driftproof.blackbox.stepper.states.objects import stepper_of
from examples.gallery.entry import targets


def _body():
    import pymunk

    space, body = pymunk.Space(), pymunk.Body(mass=1.0, moment=1.0)
    space.add(body)
    return SimpleNamespace(space=space, body=body)


def _with_velocity_function(force):
    import pymunk

    def update(body, gravity, damping, dt):
        pymunk.Body.update_velocity(body, (force(body.position.x), 0.0), damping, dt)

    its = _body()
    its.body.velocity_func = update
    return its


def _on_a_spring():
    """A damped spring of rest length 0 and stiffness 1, its damping 0, with one iteration of the solver."""
    import pymunk

    its = _body()
    anchor = its.space.static_body
    its.space.add(pymunk.DampedSpring(anchor, its.body, (0.0, 0.0), (0.0, 0.0), 0.0, 1.0, 0.0))
    return its


def _push(its, force):
    its.body.apply_force_at_local_point((force, 0.0))


_stepper = partial(
    stepper_of, position="body.position", velocity="body.velocity", advance=lambda its, h: its.space.step(h)
)

TARGETS = targets(
    __name__,
    "pymunk",
    force={
        "applied_force": (_stepper(_body, push=_push), "(nothing)", None),
        "velocity_function": (_stepper(_with_velocity_function), "(nothing)", None),
    },
    map={"spring": (_stepper(_on_a_spring), "(nothing)", None)},
)
