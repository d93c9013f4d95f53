"""desolver: one step of each of its explicit, implicit and symplectic integrator classes."""

from __future__ import annotations

from examples.gallery.entry import targets


def _integrator(name):
    """One step of the class, straight: without the loop around it that repeats a step for its error."""

    def step(f, t, y, h):
        import numpy as np
        from desolver.differential_system import DiffRHS
        from desolver.integrators import available_methods

        integrator = available_methods(False)[name](y.shape, np.dtype(np.float64), rtol=0.0, atol=1e-15)
        if integrator.is_implicit:
            integrator.final_rhs = integrator.initial_rhs = f(t, y)
        _, (_, change) = integrator.step(DiffRHS(f), np.float64(t), y, {}, np.float64(h))
        return y + change

    return step


euler, midpoint, heun, ralston = map(_integrator, ("EulerSolver", "MidpointSolver", "HeunsSolver", "RalstonsSolver"))
euler_trap, heun_euler = _integrator("EulerTrapSolver"), _integrator("HeunEulerSolver")
rk4, rk5, rk45ck, dopri45 = map(_integrator, ("RK4Solver", "RK5Solver", "RK45CKSolver", "DOPRI45"))
rk8713m, rk108, rk1412 = map(_integrator, ("RK8713MSolver", "RK108Solver", "RK1412Solver"))
symplectic_euler, bab_s9o7h, aba_s5o6h = map(_integrator, ("SymplecticEulerSolver", "BABs9o7HSolver", "ABAs5o6HSolver"))
gauss4, gauss6 = _integrator("GaussLegendre4"), _integrator("GaussLegendre6")
backward_euler, implicit_midpoint, crank_nicolson = map(
    _integrator, ("BackwardEuler", "ImplicitMidpoint", "CrankNicolson")
)
lobatto_iiia2, lobatto_iiia4, lobatto_iiib2 = map(_integrator, ("LobattoIIIA2", "LobattoIIIA4", "LobattoIIIB2"))
lobatto_iiib4, lobatto_iiic2, lobatto_iiic4 = map(_integrator, ("LobattoIIIB4", "LobattoIIIC2", "LobattoIIIC4"))
radau_ia3, radau_ia5, radau_iia3, radau_iia5 = map(_integrator, ("RadauIA3", "RadauIA5", "RadauIIA3", "RadauIIA5"))

TARGETS = targets(
    __name__,
    "desolver",
    "field",
    {
        "euler": ("Euler", 1, "forward_euler"),
        "midpoint": ("midpoint", 2, "midpoint2"),
        "heun": ("Heun", 2, "heun2"),
        "ralston": ("Ralston", 2, "ralston2"),
        "euler_trap": ("Euler-Trapezoidal", 2),
        "heun_euler": ("adaptive Heun-Euler", 2, "heun2"),
        "rk4": ("classic 4th order Runge-Kutta", 4, "rk4"),
        "rk5": ("5th order method of RK45CK", 5, "cash_karp54"),
        "rk45ck": ("Cash-Karp", 5, "cash_karp54"),
        "dopri45": ("Dormand-Prince", 5, "dormand_prince54"),
        "rk8713m": ("Runge-Kutta 8(7)13M", 8, "prince_dormand87"),
        "rk108": ("Runge-Kutta 10(8), Feagin", 10),
        "rk1412": ("Runge-Kutta 14(12), Feagin", 14),
        "symplectic_euler": ("symplectic Euler", 1, "symplectic_euler"),
        "bab_s9o7h": ("BAB's9o7H", 7),
        "aba_s5o6h": ("ABAs5o6H", 6),
        "gauss4": ("Gauss-Legendre 4", 4, "gauss2"),
        "gauss6": ("Gauss-Legendre 6", 6, "gauss3"),
        "backward_euler": ("backward Euler", 1, "backward_euler"),
        "implicit_midpoint": ("implicit midpoint", 2, "implicit_midpoint"),
        "crank_nicolson": ("Crank-Nicolson", 2, "trapezoid"),
        "lobatto_iiia2": ("Lobatto IIIA 2", 2, "trapezoid"),
        "lobatto_iiia4": ("Lobatto IIIA 4", 4, "lobatto_iiia3"),
        "lobatto_iiib2": ("Lobatto IIIB 2", 2, "lobatto_iiib2"),
        "lobatto_iiib4": ("Lobatto IIIB 4", 4, "lobatto_iiib3"),
        "lobatto_iiic2": ("Lobatto IIIC 2", 2, "lobatto_iiic2"),
        "lobatto_iiic4": ("Lobatto IIIC 4", 4, "lobatto_iiic3"),
        "radau_ia3": ("Radau IA 3", 3, "radau_ia2"),
        "radau_ia5": ("Radau IA 5", 5, "radau_ia3"),
        "radau_iia3": ("Radau IIA 3", 3, "radau_iia2"),
        "radau_iia5": ("Radau IIA 5", 5, "radau_iia3"),
    },
)
