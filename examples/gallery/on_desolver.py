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


TARGETS = targets(
    __name__,
    "desolver",
    field={
        "euler": (_integrator("EulerSolver"), "Euler", 1, "forward_euler"),
        "midpoint": (_integrator("MidpointSolver"), "midpoint", 2, "midpoint2"),
        "heun": (_integrator("HeunsSolver"), "Heun", 2, "heun2"),
        "ralston": (_integrator("RalstonsSolver"), "Ralston", 2, "ralston2"),
        "euler_trap": (_integrator("EulerTrapSolver"), "Euler-Trapezoidal", 2),
        "heun_euler": (_integrator("HeunEulerSolver"), "adaptive Heun-Euler", 2, "heun2"),
        "rk4": (_integrator("RK4Solver"), "classic 4th order Runge-Kutta", 4, "rk4"),
        "rk5": (_integrator("RK5Solver"), "5th order method of RK45CK", 5, "cash_karp54"),
        "rk45ck": (_integrator("RK45CKSolver"), "Cash-Karp", 5, "cash_karp54"),
        "dopri45": (_integrator("DOPRI45"), "Dormand-Prince", 5, "dormand_prince54"),
        "rk8713m": (_integrator("RK8713MSolver"), "Runge-Kutta 8(7)13M", 8, "prince_dormand87"),
        "rk108": (_integrator("RK108Solver"), "Runge-Kutta 10(8), Feagin", 10),
        "rk1412": (_integrator("RK1412Solver"), "Runge-Kutta 14(12), Feagin", 14),
        "symplectic_euler": (_integrator("SymplecticEulerSolver"), "symplectic Euler", 1, "symplectic_euler"),
        "bab_s9o7h": (_integrator("BABs9o7HSolver"), "BAB's9o7H", 7),
        "aba_s5o6h": (_integrator("ABAs5o6HSolver"), "ABAs5o6H", 6),
        "gauss4": (_integrator("GaussLegendre4"), "Gauss-Legendre 4", 4, "gauss2"),
        "gauss6": (_integrator("GaussLegendre6"), "Gauss-Legendre 6", 6, "gauss3"),
        "backward_euler": (_integrator("BackwardEuler"), "backward Euler", 1, "backward_euler"),
        "implicit_midpoint": (_integrator("ImplicitMidpoint"), "implicit midpoint", 2, "implicit_midpoint"),
        "crank_nicolson": (_integrator("CrankNicolson"), "Crank-Nicolson", 2, "trapezoid"),
        "lobatto_iiia2": (_integrator("LobattoIIIA2"), "Lobatto IIIA 2", 2, "trapezoid"),
        "lobatto_iiia4": (_integrator("LobattoIIIA4"), "Lobatto IIIA 4", 4, "lobatto_iiia3"),
        "lobatto_iiib2": (_integrator("LobattoIIIB2"), "Lobatto IIIB 2", 2, "lobatto_iiib2"),
        "lobatto_iiib4": (_integrator("LobattoIIIB4"), "Lobatto IIIB 4", 4, "lobatto_iiib3"),
        "lobatto_iiic2": (_integrator("LobattoIIIC2"), "Lobatto IIIC 2", 2, "lobatto_iiic2"),
        "lobatto_iiic4": (_integrator("LobattoIIIC4"), "Lobatto IIIC 4", 4, "lobatto_iiic3"),
        "radau_ia3": (_integrator("RadauIA3"), "Radau IA 3", 3, "radau_ia2"),
        "radau_ia5": (_integrator("RadauIA5"), "Radau IA 5", 5, "radau_ia3"),
        "radau_iia3": (_integrator("RadauIIA3"), "Radau IIA 3", 3, "radau_iia2"),
        "radau_iia5": (_integrator("RadauIIA5"), "Radau IIA 5", 5, "radau_iia3"),
    },
)
