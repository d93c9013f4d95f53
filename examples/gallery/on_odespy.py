"""odespy (Andasari's, not Langtangen's): one step of each pair, with the weights that `rkexplicit` goes on with."""

from __future__ import annotations

from examples.gallery.entry import targets


def _pair(name):
    def step(f, t, y, h):
        from odespy.estimation import Approximation, Variables

        approximation = Approximation(lambda t, y, parameters: f(t, y), t, y, (), h, name)
        return approximation.y_approx(Variables(name).bt)

    return step


TARGETS = targets(
    __name__,
    "odespy",
    field={
        "rk45": (_pair("rk45"), "Dormand-Prince RK5(4)", 5, "dormand_prince54"),
        "rk78": (_pair("rk78"), "Dormand-Prince RK8(7)13M", 8, "prince_dormand87"),
        "rkf45": (_pair("rkf45"), "Fehlberg 4th-order RK4(5)", 4),
        "rkf78": (_pair("rkf78"), "Fehlberg 7th-order RK7(8)", 7, "fehlberg78"),
        "rkck": (_pair("rkck"), "Cash-Karp RK5(4)", 5, "cash_karp54"),
        "rkv": (_pair("rkv"), "Verner RK6(5)", 6),
    },
)
