"""Brax: one step of its pipeline in generalised coordinates on a mass on a spring of stiffness 1."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.on_mujoco import SLIDER
from examples.gallery.through_jax import jax64, map_step


@map_step
def generalized():
    """One step of `brax.generalized.pipeline`."""
    jax = jax64()
    from brax.generalized import pipeline
    from brax.io import mjcf

    system = mjcf.loads(SLIDER.format(integrator="Euler", stiffness=1.0, damping=0.0))

    def step(q, v, h):
        timed = system.tree_replace({"opt.timestep": h})
        state = pipeline.init(timed, jax.numpy.reshape(q, 1), jax.numpy.reshape(v, 1))
        stepped = pipeline.step(timed, state, jax.numpy.zeros(timed.act_size()))
        return stepped.q[0], stepped.qd[0]

    return step


TARGETS = targets(__name__, "brax", map={"generalized": ("semi-implicit Euler", 1, "symplectic_euler")})
