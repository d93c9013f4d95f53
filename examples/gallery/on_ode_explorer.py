"""ode-explorer: its one-step methods, and the two symplectic Euler methods that it calls A and B."""

from __future__ import annotations

from examples.gallery.entry import targets


def _method(name, answer=lambda result: result):
    def step(f, t, y, h):
        from ode_explorer.stepfunctions import stepfunctions

        return answer(getattr(stepfunctions, name)().forward(f, (t, y), h))

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


forward_euler, heun, rk4 = map(_method, ("ForwardEulerMethod", "HeunMethod", "RungeKutta4"))
backward_euler = _method("BackwardEulerMethod")
dopri45_4, dopri45_5 = _method("DOPRI45", lambda pair: pair[0]), _method("DOPRI45", lambda pair: pair[1])
euler_a, euler_b = _hamiltonian("EulerA"), _hamiltonian("EulerB")

TARGETS = targets(
    __name__,
    "ode-explorer",
    "field",
    {
        "forward_euler": ("forward Euler", 1, "forward_euler"),
        "heun": ("Heun", 2, "heun2"),
        "rk4": ("classic Runge-Kutta of order 4", 4, "rk4"),
        "backward_euler": ("implicit Euler", 2, "backward_euler"),
        "dopri45_4": ("Dormand-Prince, 4th order solution", 4),
        "dopri45_5": ("Dormand-Prince, 5th order solution", 5, "dormand_prince54"),
    },
) | targets(
    __name__,
    "ode-explorer",
    "force",
    {
        "euler_a": ("Euler A", 1, "symplectic_euler_position_first"),
        "euler_b": ("Euler B", 1, "symplectic_euler"),
    },
)
