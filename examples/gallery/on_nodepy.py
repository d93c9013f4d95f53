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


fe, heun22, mid22, mte22, ssp22star = map(_method, ("FE", "Heun22", "Mid22", "MTE22", "SSP22star"))
ssp33, heun33, nssp32, nssp33, ssp43 = map(_method, ("SSP33", "Heun33", "NSSP32", "NSSP33", "SSP43"))
ssp53, ssp54, ssp63, ssp75, ssp85, ssp95 = map(_method, ("SSP53", "SSP54", "SSP63", "SSP75", "SSP85", "SSP95"))
ssp104, rk44, burk65, lambert65 = map(_method, ("SSP104", "RK44", "BuRK65", "Lambert65"))
merson43, zonneveld43, fehlberg43, fehlberg45 = map(_method, ("Merson43", "Zonneveld43", "Fehlberg43", "Fehlberg45"))
tsit5, ck5, hh5, hh5s, dp5, bs3, bs5 = map(_method, ("Tsit5", "CK5", "HH5", "HH5S", "DP5", "BS3", "BS5"))
ss3, cmr6, pd8 = map(_method, ("SS3", "CMR6", "PD8"))

TARGETS = targets(
    __name__,
    "nodepy",
    "field",
    {
        "fe": ("forward Euler", 1, "forward_euler"),
        "heun22": ("Heun", 2, "heun2"),
        "mid22": ("midpoint", 2, "midpoint2"),
        "mte22": ("minimal truncation error 22", 2, "ralston2"),
        "ssp22star": ("SSPRK22 star", 2),
        "ssp33": ("SSPRK33", 3, "ssprk33"),
        "heun33": ("Heun 33", 3, "heun3"),
        "nssp32": ("non-SSPRK 32", 2),
        "nssp33": ("non-SSPRK 33", 3),
        "ssp43": ("SSPRK43", 3, "ssprk43"),
        "ssp53": ("SSP 53", 3),
        "ssp54": ("SSP 54", 4),
        "ssp63": ("SSP 63", 3),
        "ssp75": ("SSP 75", 5),
        "ssp85": ("SSP 85", 5),
        "ssp95": ("SSP 95", 5),
        "ssp104": ("SSPRK104", 4, "ssprk104"),
        "rk44": ("classical RK4", 4, "rk4"),
        "burk65": ("Butcher's RK65", 5),
        "lambert65": ("Lambert's RK65", 5),
        "merson43": ("Merson 4(3)", 4, "merson45"),
        "zonneveld43": ("Zonneveld 4(3)", 4, "zonneveld43"),
        "fehlberg43": ("Fehlberg 4(3)", 4),
        "fehlberg45": ("Fehlberg 5(4)", 5),
        "tsit5": ("Tsitouras 5(4)", 5, "tsitouras54"),
        "ck5": ("Cash-Karp 5(4)", 5, "cash_karp54"),
        "hh5": ("Higham-Hall 5(4)", 5),
        "hh5s": ("Higham-Hall 5(4) S", 5),
        "dp5": ("Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "bs3": ("Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "bs5": ("Bogacki-Shampine 5(4)", 5, "bogacki_shampine54"),
        "ss3": ("Sharp-Smart 3(2)", 3),
        "cmr6": ("Calvo-Montijano-Randez 6(5)", 6),
        "pd8": ("Prince-Dormand 8(7)", 8, "prince_dormand87"),
    },
)
