"""SciPy: one step of each explicit solver of `solve_ivp`, and of the compiled dopri5 and dop853 behind `ode`."""

from __future__ import annotations

from math import inf

from examples.gallery.entry import targets


def _solver(name):
    """The first step of a solver, its error control out of the way: no error is too large."""

    def step(f, t, y, h):
        from scipy import integrate

        solver = getattr(integrate, name)(f, t, y, t + 2 * h, first_step=abs(h), atol=inf)
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


rk23, rk45, dop853 = _solver("RK23"), _solver("RK45"), _solver("DOP853")
ode_dopri5, ode_dop853 = _compiled("dopri5"), _compiled("dop853")

TARGETS = targets(
    __name__,
    "scipy",
    "field",
    {
        "rk23": ("Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "rk45": ("Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "dop853": ("DOP853", 8, "dop853"),
        "ode_dopri5": ("Dormand-Prince 5(4), Hairer's code", 5, "dormand_prince54"),
        "ode_dop853": ("DOP853, Hairer's code", 8, "dop853"),
    },
)
