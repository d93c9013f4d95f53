"""NodePy: one step of the explicit Runge-Kutta methods that `loadRKM` knows."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _methods():
    from nodepy import rk

    return rk.loadRKM()


def _method(name):
    """One step with the coefficients as floats; with the exact ones most methods cannot add to an array of floats."""

    def step(f, t, y, h):
        return _methods()[name].__num__().__step__(f, t, y, h)

    return step


TARGETS = targets(
    __name__,
    "nodepy",
    field={
        "fe": (_method("FE"), "forward Euler", 1, "forward_euler"),
        "heun22": (_method("Heun22"), "Heun", 2, "heun2"),
        "mid22": (_method("Mid22"), "midpoint", 2, "midpoint2"),
        "mte22": (_method("MTE22"), "minimal truncation error 22", 2, "ralston2"),
        "ssp22star": (_method("SSP22star"), "SSPRK22 star", 2),
        "ssp33": (_method("SSP33"), "SSPRK33", 3, "ssprk33"),
        "heun33": (_method("Heun33"), "Heun 33", 3, "heun3"),
        "nssp32": (_method("NSSP32"), "non-SSPRK 32", 2),
        "nssp33": (_method("NSSP33"), "non-SSPRK 33", 3),
        "ssp43": (_method("SSP43"), "SSPRK43", 3, "ssprk43"),
        "ssp53": (_method("SSP53"), "SSP 53", 3),
        "ssp54": (_method("SSP54"), "SSP 54", 4),
        "ssp63": (_method("SSP63"), "SSP 63", 3),
        "ssp75": (_method("SSP75"), "SSP 75", 5),
        "ssp85": (_method("SSP85"), "SSP 85", 5),
        "ssp95": (_method("SSP95"), "SSP 95", 5),
        "ssp104": (_method("SSP104"), "SSPRK104", 4, "ssprk104"),
        "rk44": (_method("RK44"), "classical RK4", 4, "rk4"),
        "burk65": (_method("BuRK65"), "Butcher's RK65", 5),
        "lambert65": (_method("Lambert65"), "Lambert's RK65", 5),
        "merson43": (_method("Merson43"), "Merson 4(3)", 4, "merson45"),
        "zonneveld43": (_method("Zonneveld43"), "Zonneveld 4(3)", 4, "zonneveld43"),
        "fehlberg43": (_method("Fehlberg43"), "Fehlberg 4(3)", 4),
        "fehlberg45": (_method("Fehlberg45"), "Fehlberg 5(4)", 5),
        "tsit5": (_method("Tsit5"), "Tsitouras 5(4)", 5, "tsitouras54"),
        "ck5": (_method("CK5"), "Cash-Karp 5(4)", 5, "cash_karp54"),
        "hh5": (_method("HH5"), "Higham-Hall 5(4)", 5),
        "hh5s": (_method("HH5S"), "Higham-Hall 5(4) S", 5),
        "dp5": (_method("DP5"), "Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "bs3": (_method("BS3"), "Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "bs5": (_method("BS5"), "Bogacki-Shampine 5(4)", 5, "bogacki_shampine54"),
        "ss3": (_method("SS3"), "Sharp-Smart 3(2)", 3),
        "cmr6": (_method("CMR6"), "Calvo-Montijano-Randez 6(5)", 6),
        "pd8": (_method("PD8"), "Prince-Dormand 8(7)", 8, "prince_dormand87"),
    },
)
