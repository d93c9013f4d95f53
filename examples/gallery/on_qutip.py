"""QuTiP: one step of its own Runge-Kutta methods, on a real state written as a complex one."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _system_class():
    import qutip

    class System(qutip.QobjEvo):
        """What the solver multiplies the state by, replaced by a function."""

        function = None

        def matmul_data(self, t, state, out=None, scale=1.0):
            from qutip import data

            rate = scale * self.function(t, state.to_array().real.ravel()).reshape(-1, 1)
            return data.Dense(rate if out is None else out.to_array() + rate)

    return System


def _method(name):
    def step(f, t, y, h):
        import numpy as np
        import qutip
        from qutip import data
        from qutip.solver.integrator import qutip_integrator
        from qutip.solver.integrator.explicit_rk import Explicit_RungeKutta

        system = _system_class()(qutip.Qobj(np.zeros((len(y), len(y)))))
        system.function = f
        solver = Explicit_RungeKutta(
            system, getattr(qutip_integrator, name), rtol=1e300, atol=1e300, first_step=2 * h, interpolate=False
        )
        solver.set_initial_value(data.Dense(y.reshape(-1, 1).astype(complex)), t)
        solver.integrate(t + h)
        return solver.y.to_array().real.ravel()

    return step


TARGETS = targets(
    __name__,
    "qutip",
    field={
        "euler": (_method("euler_coeff"), "Euler", 1, "forward_euler"),
        "rk4": (_method("rk4_coeff"), "Runge-Kutta 4", 4, "rk4"),
        "tsit5": (_method("tsit5_coeff"), "Tsitouras 5", 5, "tsitouras54"),
        "vern7": (_method("vern7_coeff"), "Verner, most efficient 7", 7),
        "vern9": (_method("vern9_coeff"), "Verner, most efficient 9", 9),
    },
)
