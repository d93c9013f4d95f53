"""gala: one step of its integrators of fixed step, run by their own loop."""

from __future__ import annotations

from examples.gallery.entry import targets


def _run(name, derivative, w0, t, h):
    """The state, as a column, after one step of an integrator from the time t."""
    import gala.integrate
    import numpy as np

    orbit = getattr(gala.integrate, name)(derivative)(w0, t=np.array([t, t + h]))
    return np.concatenate([orbit.pos.xyz.value[:, -1], orbit.vel.d_xyz.value[:, -1]])


def rk5(f, t, y, h):
    """The integrator wants positions and velocities; a state of odd length travels with a zero."""
    import numpy as np

    size = len(y)
    padded = np.append(y, 0.0) if size % 2 else y

    def derivative(t, w):
        return np.append(f(t, w[:size, 0]), [0.0] * (len(padded) - size))[:, None]

    return _run("RK5Integrator", derivative, padded, t, h)[:size]


def _splitting(name):
    def step(force, q, v, h):
        import numpy as np

        def derivative(t, w):
            return np.array([[w[1, 0]], [force(w[0, 0])]])

        return tuple(_run(name, derivative, np.array([float(q), float(v)]), 0.0, h))

    return step


TARGETS = targets(
    __name__,
    "gala",
    field={"rk5": ("classical fifth-order Runge-Kutta, Dormand-Prince coefficients", 5, "dormand_prince54")},
    force={
        "leapfrog": (_splitting("LeapfrogIntegrator"), "leapfrog", 2, "velocity_verlet"),
        "ruth4": (_splitting("Ruth4Integrator"), "Ruth, 4th order", 4, "forest_ruth"),
    },
)
