"""PathSim: one step of each of its one-step solvers, explicit and diagonally implicit."""

from __future__ import annotations

from examples.gallery.entry import targets


def _solver(name):
    """One step; if implicit, with differences of f for the Jacobian matrix, and it may iterate until it rests."""

    def step(f, t, y, h):
        import numpy as np
        from pathsim import solvers

        def jacobian(y, t):
            return np.array([(f(t, y + e) - f(t, y - e)) / 2 for e in np.eye(len(y))]).T

        solver, slope = getattr(solvers, name)(y), lambda y, t: f(t, y)
        if isinstance(solver, solvers.ImplicitSolver):
            solver.integrate_singlestep(slope, jacobian, t, h, tolerance_fpi=1e-14)
        else:
            solver.integrate_singlestep(slope, t, h)
        return solver.get()

    return step


TARGETS = targets(
    __name__,
    "pathsim",
    field={
        "euf": (_solver("EUF"), "explicit Euler", 1, "forward_euler"),
        "ssprk22": (_solver("SSPRK22"), "SSPRK22, Heun", 2, "heun2"),
        "ssprk33": (_solver("SSPRK33"), "SSPRK33", 3, "ssprk33"),
        "ssprk34": (_solver("SSPRK34"), "SSPRK34", 3, "ssprk43"),
        "rk4": (_solver("RK4"), "classical fourth order", 4, "rk4"),
        "rkf21": (_solver("RKF21"), "Fehlberg 2(1)", 2),
        "rkbs32": (_solver("RKBS32"), "Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "rkf45": (_solver("RKF45"), "Fehlberg 5(4)", 5),
        "rkck54": (_solver("RKCK54"), "Cash-Karp 5(4)", 5, "cash_karp54"),
        "rkdp54": (_solver("RKDP54"), "Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "rkv65": (_solver("RKV65"), "Verner 6(5)", 6),
        "rkf78": (_solver("RKF78"), "Fehlberg 7(8)", 7, "fehlberg78"),
        "rkdp87": (_solver("RKDP87"), "Dormand-Prince 8(7), 'DOP853'", 8, "prince_dormand87"),
        "eub": (_solver("EUB"), "backward Euler", 1, "backward_euler"),
        "dirk2": (_solver("DIRK2"), "DIRK2, L-stable, symplectic", 2, "qin_zhang2"),
        "dirk3": (_solver("DIRK3"), "DIRK3", 3),
        "esdirk32": (_solver("ESDIRK32"), "ESDIRK32", 3),
        "esdirk4": (_solver("ESDIRK4"), "ESDIRK4", 4),
        "esdirk43": (_solver("ESDIRK43"), "ESDIRK43", 4),
        "esdirk54": (_solver("ESDIRK54"), "ESDIRK54", 5),
        "esdirk85": (_solver("ESDIRK85"), "ESDIRK85", 8),
    },
)
