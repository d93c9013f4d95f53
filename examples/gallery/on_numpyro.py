"""NumPyro: the velocity Verlet step of its Hamiltonian samplers."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_jax import force_step, jax64, potential_of


def _make(force):
    jax = jax64()
    from numpyro.infer.hmc_util import velocity_verlet as integrator

    init, update = integrator(potential_of(force), lambda inverse_mass, p: 0.5 * jax.numpy.sum(inverse_mass * p**2))

    def step(q, v, h):
        stepped = update(h, 1.0, init(q, v))
        return stepped.z, stepped.r

    return step


TARGETS = targets(
    __name__, "numpyro", force={"velocity_verlet": (force_step(_make), "velocity Verlet", 2, "velocity_verlet")}
)
