"""neuromancer: its integrator blocks for first-order and for second-order autonomous systems."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path

from examples.gallery.entry import targets
from examples.gallery.through_torch import TENSOR


@cache
def _integrators():
    """neuromancer.dynamics.integrators alone: the package would import check trackers and much else."""
    package = find_spec("neuromancer")
    if package is None or package.origin is None:
        raise ModuleNotFoundError("No module named 'neuromancer'", name="neuromancer")
    spec = spec_from_file_location("neuromancer_integrators", Path(package.origin).parent / "dynamics/integrators.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _block(function):
    """A right-hand side as the blocks want it: a module on a batch of one."""
    import torch

    class Block(torch.nn.Module):
        in_features = out_features = 1

        def forward(self, x):
            return function(x[0])[None]

    return Block()


def _integrator(name):
    def step(f, y, h):
        return getattr(_integrators(), name)(_block(f), h=h)(y[None])[0]

    return step


def _second_order(name):
    def step(force, q, v, h):
        import torch

        state = torch.cat([q.reshape(1), v.reshape(1)])[None]
        q1, v1 = getattr(_integrators(), name)(_block(force), h=h)(state)[0]
        return q1, v1

    return step


TARGETS = targets(
    __name__,
    "neuromancer",
    field={
        "euler": (_integrator("Euler"), "Euler", 1, "forward_euler"),
        "euler_trap": (_integrator("Euler_Trap"), "forward Euler, trapezoidal rule", 2, "heun2"),
        "rk2": (_integrator("RK2"), "RK2", 2, "midpoint2"),
        "rk4": (_integrator("RK4"), "RK4", 4, "rk4"),
        "rk4_trap": (_integrator("RK4_Trap"), "RK4 and trapezoidal rule", None),
        "luther": (_integrator("Luther"), "Luther", 6, "luther6"),
        "fehlberg": (_integrator("Runge_Kutta_Fehlberg"), "Runge-Kutta-Fehlberg 5(4)", 5),
    },
    force={
        "leapfrog": (_second_order("LeapFrog"), "leapfrog", 2, "velocity_verlet"),
        "yoshida4": (_second_order("Yoshida4"), "Yoshida, 4th order", 4, "forest_ruth"),
    },
    array=TENSOR,
)
