"""BrainPy: one step of each method of `odeint` for right-hand sides without special structure."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_jax import field_step


def _method(method):
    def make(f):
        import brainpy

        brainpy.math.enable_x64()
        integral = brainpy.odeint(lambda y, t: f(t, y), method=method, dt=1.0)
        return lambda t, y, h: integral(y, t, dt=h)

    return field_step(make)


TARGETS = targets(
    __name__,
    "brainpy",
    field={
        "euler": (_method("euler"), "Euler", 1, "forward_euler"),
        "midpoint": (_method("midpoint"), "explicit midpoint", 2, "midpoint2"),
        "heun2": (_method("heun2"), "Heun", 2, "heun2"),
        "ralston2": (_method("ralston2"), "Ralston", 2, "ralston2"),
        "rk2": (_method("rk2"), "generic second order, beta = 2/3", 2, "ralston2"),
        "rk3": (_method("rk3"), "classical third order", 3, "kutta3"),
        "heun3": (_method("heun3"), "Heun, third order", 3, "heun3"),
        "ralston3": (_method("ralston3"), "Ralston, third order", 3, "ralston3"),
        "ssprk3": (_method("ssprk3"), "strong stability preserving, third order", 3, "ssprk33"),
        "rk4": (_method("rk4"), "classical fourth order", 4, "rk4"),
        "ralston4": (_method("ralston4"), "Ralston, fourth order", 4, "ralston4"),
        "rk4_38rule": (_method("rk4_38rule"), "3/8 rule", 4, "rk38"),
        "rkf12": (_method("rkf12"), "Fehlberg RK1(2)", 1),
        "rkf45": (_method("rkf45"), "Runge-Kutta-Fehlberg, order 4", 4),
        "rkdp": (_method("rkdp"), "Dormand-Prince", 5, "dormand_prince54"),
        "ck": (_method("ck"), "Cash-Karp", 4),
        "bs": (_method("bs"), "Bogacki-Shampine", 3, "bogacki_shampine32"),
        "heun_euler": (_method("heun_euler"), "Heun-Euler, order 1", 1),
    },
)
