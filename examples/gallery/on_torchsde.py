"""torchsde: one step of each method of `sdeint`, its noise zero: what its drift term alone goes through."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_torch import TENSOR, tensor


def _method(method, sde_type, noise_type="diagonal"):
    def step(f, t, y, h):
        import torch
        import torchsde

        class Noiseless(torch.nn.Module):
            def f(self, t, y):
                return f(t, y[0])[None]

            def g(self, t, y):
                return torch.zeros((1, len(y[0])) if noise_type == "diagonal" else (1, len(y[0]), 1), dtype=y.dtype)

        system = Noiseless()
        system.sde_type, system.noise_type = sde_type, noise_type
        return torchsde.sdeint(system, y[None], tensor([t, t + h]), dt=h, method=method)[-1, 0]

    return step


TARGETS = targets(
    __name__,
    "torchsde",
    field={
        "euler": (_method("euler", "ito"), "Euler-Maruyama", 1, "forward_euler"),
        "milstein": (_method("milstein", "ito"), "Milstein", 1, "forward_euler"),
        "srk": (_method("srk", "ito"), "Rößler's SRID2, order (3, 1.5)", 3),
        "srk_additive": (_method("srk", "ito", "additive"), "Rößler's SRA1, order (2, 1.5)", 2),
        "midpoint": (_method("midpoint", "stratonovich"), "midpoint", 2, "midpoint2"),
        "heun": (_method("heun", "stratonovich"), "Heun", 2, "heun2"),
        "euler_heun": (_method("euler_heun", "stratonovich"), "Euler-Heun", 1, "forward_euler"),
        "reversible_heun": (_method("reversible_heun", "stratonovich"), "reversible Heun", 2, "heun2"),
        "log_ode": (_method("log_ode", "stratonovich"), "log-ODE, midpoint", 2, "midpoint2"),
    },
    array=TENSOR,
)
