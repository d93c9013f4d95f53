"""sdeint: one step of each of its algorithms, its noise zero: what its drift term alone goes through."""

from __future__ import annotations

from examples.gallery.entry import targets


def _algorithm(name):
    def step(f, t, y, h):
        import numpy as np
        import sdeint

        zero = np.zeros((len(y), 1))
        return getattr(sdeint, name)(lambda y, t: f(t, y), lambda y, t: zero, y, np.array([t, t + h]))[-1]

    return step


TARGETS = targets(
    __name__,
    "sdeint",
    field={
        "ito_euler": (_algorithm("itoEuler"), "Euler-Maruyama", 1, "forward_euler"),
        "ito_sri2": (_algorithm("itoSRI2"), "Rößler's SRI2, order 2 without noise", 2),
        "strat_heun": (_algorithm("stratHeun"), "Stratonovich Heun", 2, "heun2"),
        "strat_srs2": (_algorithm("stratSRS2"), "Rößler's SRS2, order 2 without noise", 2),
        "strat_kp2is": (_algorithm("stratKP2iS"), "Kloeden and Platen's two-step implicit, order 1.0", 1),
    },
)
