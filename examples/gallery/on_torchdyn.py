"""torchdyn: the `step` of each of its explicit solvers."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_torch import TENSOR, tensor


def _solver(name):
    def step(f, t, y, h):
        import torch
        from torchdyn.numerics.solvers.ode import str_to_solver

        solver = str_to_solver(name, torch.float64)
        return solver.step(f, y, tensor(t), tensor(h), k1=f(tensor(t), y))[1]

    return step


def leapfrog(f, t, y, h):
    """The asynchronous leapfrog method, whose velocity begins as f(t, y), as its authors begin it."""
    import torch
    from torchdyn.numerics.solvers.ode import AsynchronousLeapfrog

    k1 = f(tensor(t), y)
    _, state, _ = AsynchronousLeapfrog(dtype=torch.float64).step(f, torch.cat([y, k1]), tensor(t), tensor(h), k1=k1)
    return state[: len(y)]


TARGETS = targets(
    __name__,
    "torchdyn",
    field={
        "euler": (_solver("euler"), "explicit Euler", 1, "forward_euler"),
        "midpoint": (_solver("midpoint"), "explicit midpoint", 2, "midpoint2"),
        "rk4": (_solver("rk4"), "Runge-Kutta 4", 4, "rk4"),
        "dopri5": (_solver("dopri5"), "Dormand-Prince 5", 5, "dormand_prince54"),
        "tsit5": (_solver("tsit5"), "Tsitouras 5", 5, "tsitouras54"),
    },
    array=TENSOR,
) | targets(
    __name__,
    "torchdyn",
    field={"leapfrog": ("leapfrog, symplectic", 2)},
    array=TENSOR,
    rounds="half a step with the first slope goes in, and out again",
)
