"""ode-explorer: its one-step methods, and the two symplectic Euler methods that it calls A and B."""

from __future__ import annotations

from examples.gallery.entry import targets


def _method(name, answer=None):
    """One step; of a pair of answers one of them."""

    def step(f, t, y, h):
        from ode_explorer.stepfunctions import stepfunctions

        found = getattr(stepfunctions, name)().forward(f, (t, y), h)
        return found if answer is None else found[answer]

    return step


def _hamiltonian(name):
    def step(force, q, v, h):
        from ode_explorer.models import HamiltonianSystem
        from ode_explorer.stepfunctions import stepfunctions

        system = HamiltonianSystem(
            lambda t, q, p: 0.0, q_derivative=lambda t, q: -force(q), p_derivative=lambda t, p: p, is_separable=True
        )
        _, q1, v1 = getattr(stepfunctions, name)().forward(system, (0.0, q, v), h)
        return q1, v1

    return step


TARGETS = targets(
    __name__,
    "ode-explorer",
    field={
        "forward_euler": (_method("ForwardEulerMethod"), "forward Euler", 1, "forward_euler"),
        "heun": (_method("HeunMethod"), "Heun", 2, "heun2"),
        "rk4": (_method("RungeKutta4"), "classic Runge-Kutta of order 4", 4, "rk4"),
        "backward_euler": (_method("BackwardEulerMethod"), "implicit Euler", 2, "backward_euler"),
        "dopri45_4": (_method("DOPRI45", 0), "Dormand-Prince, 4th order solution", 4),
        "dopri45_5": (_method("DOPRI45", 1), "Dormand-Prince, 5th order solution", 5, "dormand_prince54"),
    },
    force={
        "euler_a": (_hamiltonian("EulerA"), "Euler A", 1, "symplectic_euler_position_first"),
        "euler_b": (_hamiltonian("EulerB"), "Euler B", 1, "symplectic_euler"),
    },
)
