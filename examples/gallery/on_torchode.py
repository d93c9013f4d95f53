"""torchode: one step of each of its single-step methods."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_torch import TENSOR, tensor


def _method(name):
    """The method's own `step`, on a batch of one."""

    def step(f, t, y, h):
        import torch
        import torchode

        term = torchode.ODETerm(lambda t, y: f(t[0], y[0])[None])
        t0, dt, y0 = tensor([t]), tensor([h]), y[None]
        problem = torchode.InitialValueProblem(y0, t0, t0 + dt)
        method = getattr(torchode, name)(term)
        stats: dict[str, object] = {}
        term.init(problem, stats)
        state = method.init(None, problem, None, stats=stats, args=None)
        running = torch.tensor([True])
        result, *_ = method.step(None, running, y0, t0, dt, state, stats=stats, args=None)
        return result.y[0]

    return step


TARGETS = targets(
    __name__,
    "torchode",
    field={
        "euler": (_method("Euler"), "Euler", 1, "forward_euler"),
        "heun": (_method("Heun"), "Heun", 2, "heun2"),
        "dopri5": (_method("Dopri5"), "Dormand-Prince 5", 5, "dormand_prince54"),
        "tsit5": (_method("Tsit5"), "Tsitouras 5", 5, "tsitouras54"),
    },
    array=TENSOR,
)
