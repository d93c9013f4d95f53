"""torchode: one step of each of its single-step methods."""

from __future__ import annotations

from examples.gallery.entry import targets


def tensor(numbers):
    """A tensor of double precision."""
    import torch

    return torch.tensor(numbers, dtype=torch.float64)


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


euler, heun, dopri5, tsit5 = map(_method, ("Euler", "Heun", "Dopri5", "Tsit5"))

TARGETS = targets(
    __name__,
    "torchode",
    "field",
    {
        "euler": ("Euler", 1, "forward_euler"),
        "heun": ("Heun", 2, "heun2"),
        "dopri5": ("Dormand-Prince 5", 5, "dormand_prince54"),
        "tsit5": ("Tsitouras 5", 5, "tsitouras54"),
    },
    array="tensor",
)
