"""torchdiffeq: one step of each fixed-grid method and of each adaptive Runge-Kutta method of `odeint`."""

from __future__ import annotations

from math import inf

from examples.gallery.entry import targets


def tensor(numbers):
    """A tensor of double precision."""
    import torch

    return torch.tensor(numbers, dtype=torch.float64)


def _fixed(method):
    def step(f, t, y, h):
        from torchdiffeq import odeint

        return odeint(f, y, tensor([t, t + h]), method=method)[-1]

    return step


def _adaptive(method):
    """The same, the adaptive solver told that h is its first step and that no error is too large."""

    def step(f, t, y, h):
        from torchdiffeq import odeint

        return odeint(f, y, tensor([t, t + h]), method=method, atol=inf, options={"first_step": abs(h)})[-1]

    return step


euler, midpoint, heun2, heun3, rk4 = map(_fixed, ("euler", "midpoint", "heun2", "heun3", "rk4"))
adaptive_heun, fehlberg2, bosh3 = map(_adaptive, ("adaptive_heun", "fehlberg2", "bosh3"))
dopri5, dopri8 = map(_adaptive, ("dopri5", "dopri8"))

TARGETS = targets(
    __name__,
    "torchdiffeq",
    "field",
    {
        "euler": ("Euler", 1, "forward_euler"),
        "midpoint": ("midpoint", 2, "midpoint2"),
        "heun2": ("Heun", 2, "heun2"),
        "heun3": ("Heun, third order", 3, "heun3"),
        "rk4": ("fourth-order Runge-Kutta, 3/8 rule", 4, "rk38"),
    },
    array="tensor",
) | targets(
    __name__,
    "torchdiffeq",
    "field",
    {
        "adaptive_heun": ("Runge-Kutta of order 2", 2, "heun2"),
        "fehlberg2": ("Runge-Kutta-Fehlberg of order 2", 2),
        "bosh3": ("Bogacki-Shampine 3", 3, "bogacki_shampine32"),
        "dopri5": ("Dormand-Prince-Shampine 5", 5, "dormand_prince54"),
        "dopri8": ("Dormand-Prince-Shampine 8", 8, "prince_dormand87"),
    },
    array="tensor",
    rounds="the answer is read off a polynomial of degree 4 through the ends and the middle of the step",
)
