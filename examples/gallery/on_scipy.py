"""SciPy: one step of each explicit solver of `solve_ivp`, and of the compiled dopri5 and dop853 behind `ode`."""

from __future__ import annotations

from importlib import import_module
from math import inf

from examples.gallery.entry import targets


def solver_of(package, name):
    """The first step of a solver for `solve_ivp`, its error control out of the way: no error is too large."""

    def step(f, t, y, h):
        solver = getattr(import_module(package), name)(f, t, y, t + 2 * h, first_step=abs(h), atol=inf)
        solver.step()
        return solver.y

    return step


def _compiled(name):
    """The compiled integrator, told that h is its first step and that any error will do."""

    def step(f, t, y, h):
        from scipy.integrate import ode

        solver = ode(f).set_integrator(name, first_step=h, atol=1e300, rtol=1e300, nsteps=2)
        return solver.set_initial_value(y, t).integrate(t + h)

    return step


TARGETS = targets(
    __name__,
    "scipy",
    field={
        "rk23": (solver_of("scipy.integrate", "RK23"), "Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "rk45": (solver_of("scipy.integrate", "RK45"), "Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "dop853": (solver_of("scipy.integrate", "DOP853"), "DOP853", 8, "dop853"),
        "ode_dopri5": (_compiled("dopri5"), "Dormand-Prince 5(4), Hairer's code", 5, "dormand_prince54"),
        "ode_dop853": (_compiled("dop853"), "DOP853, Hairer's code", 8, "dop853"),
    },
)
