"""galpy: one step of its compiled integrators of fixed step on an oscillator, and of its leapfrog in Python."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _oscillator():
    """The potential q**2/2, a case of the one that galpy has for vertical motion in a disc."""
    from galpy.potential import KGPotential

    return KGPotential(K=0.0, F=0.5, D=1.0)


def _compiled(method):
    def step(q, v, h):
        import numpy as np
        from galpy.orbit import Orbit

        orbit = Orbit([q, v])
        orbit.integrate(np.array([0.0, h]), _oscillator(), method=method, dt=h, progressbar=False)
        return float(orbit.orbit[0, -1, 0]), float(orbit.orbit[0, -1, 1])

    return step


def leapfrog(force, q, v, h):
    """The leapfrog in Python, told that any error will do, so that it keeps the step it is given."""
    import numpy as np
    from galpy.util import symplecticode

    def push(position, t=0.0):
        return np.array([force(position[0])])

    states = symplecticode.leapfrog(push, np.array([q, v]), np.array([0.0, h]), rtol=1e300, atol=1e300)
    return states[-1, 0], states[-1, 1]


TARGETS = targets(
    __name__,
    "galpy",
    force={"leapfrog": ("leapfrog", 2, "position_verlet")},
    map={
        "leapfrog_c": (_compiled("leapfrog_c"), "leapfrog", 2, "position_verlet"),
        "rk4_c": (_compiled("rk4_c"), "4th-order Runge-Kutta", 4, "rk4"),
        "rk6_c": (_compiled("rk6_c"), "6th-order Runge-Kutta", 6),
        "symplec4_c": (_compiled("symplec4_c"), "4th-order symplectic", 4, "forest_ruth"),
        "symplec6_c": (_compiled("symplec6_c"), "6th-order symplectic", 6, "yoshida6_position_first"),
    },
)
