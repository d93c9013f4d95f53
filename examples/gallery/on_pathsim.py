"""PathSim: one step of each of its one-step solvers, explicit and diagonally implicit."""

from __future__ import annotations

from examples.gallery.entry import targets


def _solver(name):
    def step(f, t, y, h):
        from pathsim import solvers

        solver = getattr(solvers, name)(y)
        solver.integrate_singlestep(lambda y, t: f(t, y), t, h)
        return solver.get()

    return step


def _implicit(name):
    """The same; the Jacobian matrix that the solver wants is made of differences, and it may iterate until it rests."""

    def step(f, t, y, h):
        import numpy as np
        from pathsim import solvers

        solver = getattr(solvers, name)(y)

        def jacobian(y, t):
            return np.array([(f(t, y + e) - f(t, y - e)) / 2 for e in np.eye(len(y))]).T

        solver.integrate_singlestep(lambda y, t: f(t, y), jacobian, t, h, tolerance_fpi=1e-14)
        return solver.get()

    return step


euf, ssprk22, ssprk33, ssprk34, rk4 = map(_solver, ("EUF", "SSPRK22", "SSPRK33", "SSPRK34", "RK4"))
rkf21, rkbs32, rkf45, rkck54, rkdp54 = map(_solver, ("RKF21", "RKBS32", "RKF45", "RKCK54", "RKDP54"))
rkv65, rkf78, rkdp87 = map(_solver, ("RKV65", "RKF78", "RKDP87"))
eub, dirk2, dirk3, esdirk32, esdirk4 = map(_implicit, ("EUB", "DIRK2", "DIRK3", "ESDIRK32", "ESDIRK4"))
esdirk43, esdirk54, esdirk85 = map(_implicit, ("ESDIRK43", "ESDIRK54", "ESDIRK85"))

TARGETS = targets(
    __name__,
    "pathsim",
    "field",
    {
        "euf": ("explicit Euler", 1, "forward_euler"),
        "ssprk22": ("SSPRK22, Heun", 2, "heun2"),
        "ssprk33": ("SSPRK33", 3, "ssprk33"),
        "ssprk34": ("SSPRK34", 3, "ssprk43"),
        "rk4": ("classical fourth order", 4, "rk4"),
        "rkf21": ("Fehlberg 2(1)", 2),
        "rkbs32": ("Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "rkf45": ("Fehlberg 5(4)", 5),
        "rkck54": ("Cash-Karp 5(4)", 5, "cash_karp54"),
        "rkdp54": ("Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "rkv65": ("Verner 6(5)", 6),
        "rkf78": ("Fehlberg 7(8)", 7, "fehlberg78"),
        "rkdp87": ("Dormand-Prince 8(7), 'DOP853'", 8, "prince_dormand87"),
        "eub": ("backward Euler", 1, "backward_euler"),
        "dirk2": ("DIRK2, L-stable, symplectic", 2, "qin_zhang2"),
        "dirk3": ("DIRK3", 3),
        "esdirk32": ("ESDIRK32", 3),
        "esdirk4": ("ESDIRK4", 4),
        "esdirk43": ("ESDIRK43", 4),
        "esdirk54": ("ESDIRK54", 5),
        "esdirk85": ("ESDIRK85", 8),
    },
)
