"""Pyro: the velocity Verlet step of its Hamiltonian samplers."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _potential():
    """A potential whose derivative is minus a force; its value is 0."""
    import torch

    class Potential(torch.autograd.Function):
        @staticmethod
        def forward(context, q, force):
            context.slope = -force(q.item())
            return torch.zeros((), dtype=q.dtype)

        @staticmethod
        def backward(context, outer):
            return outer * context.slope, None

    return Potential.apply


def velocity_verlet(force, q, v, h):
    """One step of `pyro.ops.integrator.velocity_verlet`, with unit mass."""
    import torch
    from pyro.ops import integrator

    position, momentum = ({"q": torch.tensor(x, dtype=torch.float64)} for x in (q, v))
    q1, v1, *_ = integrator.velocity_verlet(
        position, momentum, lambda z: _potential()(z["q"], force), lambda r: r, step_size=h, num_steps=1
    )
    return q1["q"].item(), v1["q"].item()


TARGETS = targets(
    __name__, "pyro-ppl", force={"velocity_verlet": ("second order symplectic velocity Verlet", 2, "velocity_verlet")}
)
