"""CasADi: one step of `simpleRK`, and of its integrator plugins `rk` and `collocation`, through callbacks."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _callback(size):
    """A function of (t, y) that CasADi calls, and the place of the Python function behind it."""
    import casadi
    import numpy as np

    place = [None]

    class Callback(casadi.Callback):
        def __init__(self):
            super().__init__()
            self.construct("f", {"enable_fd": True})

        def get_n_in(self):
            return 2

        def get_sparsity_in(self, number):
            return casadi.Sparsity.dense(size if number else 1, 1)

        def get_sparsity_out(self, number):
            return casadi.Sparsity.dense(size, 1)

        def eval(self, arguments):
            t, y = arguments
            return [casadi.DM(np.asarray(place[0](float(t), np.array(y).ravel()), dtype=float))]

    return Callback(), place


@cache
def _simple(size):
    import casadi

    callback, place = _callback(size)
    y, nothing = casadi.MX.sym("y", size), casadi.MX.sym("p", 0)
    return casadi.simpleRK(casadi.Function("ode", [y, nothing], [callback(0.0, y)]), 1, 4), place


def simple_rk4(f, y, h):
    """One step of `simpleRK`, which knows the order 4 only."""
    import numpy as np

    function, place = _simple(len(y))
    place[0] = lambda t, y: f(y)
    return np.array(function(y, [], h)).ravel()


def _plugin(name, **options):
    def step(f, t, y, h):
        import casadi
        import numpy as np

        callback, place = _callback(len(y))
        place[0] = f
        state, time = casadi.MX.sym("y", len(y)), casadi.MX.sym("t")
        system = {"x": state, "t": time, "ode": callback(time, state)}
        settings = {"number_of_finite_elements": 1, **options}
        return np.array(casadi.integrator("one", name, system, t, [t + h], settings)(x0=y)["xf"]).ravel()

    return step


def _collocation(scheme, points):
    return _plugin("collocation", interpolation_order=points, collocation_scheme=scheme)


TARGETS = targets(
    __name__,
    "casadi",
    field={
        "simple_rk4": ("explicit Runge-Kutta of order 4", 4, "rk4"),
        "rk": (_plugin("rk"), "Runge-Kutta 4", 4, "rk4"),
        "legendre1": (_collocation("legendre", 1), "collocation, one Legendre point", 2, "implicit_midpoint"),
        "legendre2": (_collocation("legendre", 2), "collocation, two Legendre points", 4, "gauss2"),
        "legendre3": (_collocation("legendre", 3), "collocation, three Legendre points", 6, "gauss3"),
        "radau1": (_collocation("radau", 1), "collocation, one Radau point", 1, "backward_euler"),
        "radau2": (_collocation("radau", 2), "collocation, two Radau points", 3, "radau_iia2"),
        "radau3": (_collocation("radau", 3), "collocation, three Radau points", 5, "radau_iia3"),
    },
)
