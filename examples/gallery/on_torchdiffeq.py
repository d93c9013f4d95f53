"""torchdiffeq: one step of each fixed-grid method and of each adaptive Runge-Kutta method of `odeint`."""

from __future__ import annotations

from math import inf

from examples.gallery.entry import targets
from examples.gallery.through_torch import TENSOR, tensor


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


TARGETS = targets(
    __name__,
    "torchdiffeq",
    field={
        "euler": (_fixed("euler"), "Euler", 1, "forward_euler"),
        "midpoint": (_fixed("midpoint"), "midpoint", 2, "midpoint2"),
        "heun2": (_fixed("heun2"), "Heun", 2, "heun2"),
        "heun3": (_fixed("heun3"), "Heun, third order", 3, "heun3"),
        "rk4": (_fixed("rk4"), "fourth-order Runge-Kutta, 3/8 rule", 4, "rk38"),
    },
    array=TENSOR,
) | targets(
    __name__,
    "torchdiffeq",
    field={
        "adaptive_heun": (_adaptive("adaptive_heun"), "Runge-Kutta of order 2", 2, "heun2"),
        "fehlberg2": (_adaptive("fehlberg2"), "Runge-Kutta-Fehlberg of order 2", 2),
        "bosh3": (_adaptive("bosh3"), "Bogacki-Shampine 3", 3, "bogacki_shampine32"),
        "dopri5": (_adaptive("dopri5"), "Dormand-Prince-Shampine 5", 5, "dormand_prince54"),
        "dopri8": (_adaptive("dopri8"), "Dormand-Prince-Shampine 8", 8, "prince_dormand87"),
    },
    array=TENSOR,
    rounds="the answer is read off a polynomial of degree 4 through the ends and the middle of the step",
)
