"""extensisq: one step of its explicit Runge-Kutta and Runge-Kutta-Nyström solvers for `solve_ivp`."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.on_scipy import solver_of


def _nystrom(name):
    """One step of a method that takes second-order equations only."""
    step_of_system = solver_of("extensisq", name)

    def step(force, q, v, h):
        import numpy as np

        return tuple(step_of_system(lambda t, y: np.array([y[1], force(y[0])]), 0.0, np.array([q, v]), h))

    return step


TARGETS = targets(
    __name__,
    "extensisq",
    field={
        "ts5": (solver_of("extensisq", "Ts5"), "Tsitouras 5(4)", 5, "tsitouras54"),
        "bs5": (solver_of("extensisq", "BS5"), "Bogacki-Shampine 5(4)", 5, "bogacki_shampine54"),
        "ck5": (solver_of("extensisq", "CK5"), "Cash-Karp 5(4)", 5, "cash_karp54"),
        "ckdisc": (solver_of("extensisq", "CKdisc"), "Cash-Karp, variable order", 5, "cash_karp54"),
        "me4": (solver_of("extensisq", "Me4"), "Merson 4", 4, "merson45"),
        "cfmr7osc": (solver_of("extensisq", "CFMR7osc"), "Calvo-Franco-Montijano-Randez 7(5)", 7),
        "pr7": (solver_of("extensisq", "Pr7"), "Prince 7", 7),
        "pr8": (solver_of("extensisq", "Pr8"), "Prince 8", 8),
        "pr9": (solver_of("extensisq", "Pr9"), "Prince 9", 9),
    },
    force={
        "fi4n": (_nystrom("Fi4N"), "Fine's Nyström method 4", 4),
        "fi5n": (_nystrom("Fi5N"), "Fine's Nyström method 5", 5),
        "mu5nmb": (_nystrom("Mu5Nmb"), "Murua's Nyström method 5", 5),
        "mr6nn": (_nystrom("MR6NN"), "El-Mikkawy and Rahmo's Nyström method 6", 6),
    },
)
