"""extensisq: one step of its explicit Runge-Kutta and Runge-Kutta-Nyström solvers for `solve_ivp`."""

from __future__ import annotations

from math import inf

from examples.gallery.entry import targets


def _solver(name):
    """The first step of a solver, its error control out of the way: no error is too large."""

    def step(f, t, y, h):
        import extensisq

        solver = getattr(extensisq, name)(f, t, y, t + 2 * h, first_step=abs(h), atol=inf)
        solver.step()
        return solver.y

    return step


def _nystrom(name):
    """The same for a method that takes second-order equations only."""
    step_of_system = _solver(name)

    def step(force, q, v, h):
        import numpy as np

        return tuple(step_of_system(lambda t, y: np.array([y[1], force(y[0])]), 0.0, np.array([q, v]), h))

    return step


ts5, bs5, ck5, ckdisc = map(_solver, ("Ts5", "BS5", "CK5", "CKdisc"))
me4, cfmr7osc, pr7, pr8, pr9 = map(_solver, ("Me4", "CFMR7osc", "Pr7", "Pr8", "Pr9"))
fi4n, fi5n, mu5nmb, mr6nn = map(_nystrom, ("Fi4N", "Fi5N", "Mu5Nmb", "MR6NN"))

TARGETS = targets(
    __name__,
    "extensisq",
    "field",
    {
        "ts5": ("Tsitouras 5(4)", 5, "tsitouras54"),
        "bs5": ("Bogacki-Shampine 5(4)", 5, "bogacki_shampine54"),
        "ck5": ("Cash-Karp 5(4)", 5, "cash_karp54"),
        "ckdisc": ("Cash-Karp, variable order", 5, "cash_karp54"),
        "me4": ("Merson 4", 4, "merson45"),
        "cfmr7osc": ("Calvo-Franco-Montijano-Randez 7(5)", 7),
        "pr7": ("Prince 7", 7),
        "pr8": ("Prince 8", 8),
        "pr9": ("Prince 9", 9),
    },
) | targets(
    __name__,
    "extensisq",
    "force",
    {
        "fi4n": ("Fine's Nyström method 4", 4),
        "fi5n": ("Fine's Nyström method 5", 5),
        "mu5nmb": ("Murua's Nyström method 5", 5),
        "mr6nn": ("El-Mikkawy and Rahmo's Nyström method 6", 6),
    },
)
