"""diffrax: the `step` of its explicit solvers, each from a fresh start."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.through_jax import field_step, force_step


def _solver(name):
    def make(f):
        import diffrax

        solver, terms = getattr(diffrax, name)(), diffrax.ODETerm(lambda t, y, args: f(t, y))

        def step(t, y, h):
            state = solver.init(terms, t, t + h, y, None)
            return solver.step(terms, t, t + h, y, None, state, made_jump=False)[0]

        return step

    return field_step(make)


@force_step
def semi_implicit_euler(force):
    """One step of `SemiImplicitEuler`."""
    import diffrax

    terms = (diffrax.ODETerm(lambda t, v, args: v), diffrax.ODETerm(lambda t, q, args: force(q)))

    def step(q, v, h):
        return diffrax.SemiImplicitEuler().step(terms, 0.0, h, (q, v), None, None, made_jump=False)[0]

    return step


TARGETS = targets(
    __name__,
    "diffrax",
    field={
        "euler": (_solver("Euler"), "Euler", 1, "forward_euler"),
        "heun": (_solver("Heun"), "Heun", 2, "heun2"),
        "midpoint": (_solver("Midpoint"), "midpoint", 2, "midpoint2"),
        "ralston": (_solver("Ralston"), "Ralston", 2, "ralston2"),
        "bosh3": (_solver("Bosh3"), "Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "tsit5": (_solver("Tsit5"), "Tsitouras 5(4)", 5, "tsitouras54"),
        "dopri5": (_solver("Dopri5"), "Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "dopri8": (_solver("Dopri8"), "Dormand-Prince 8(7)", 8, "prince_dormand87"),
        "leapfrog_midpoint": (_solver("LeapfrogMidpoint"), "leapfrog/midpoint, two steps, first step Euler", 2),
        "reversible_heun": (_solver("ReversibleHeun"), "reversible Heun", 2, "heun2"),
    },
    force={"semi_implicit_euler": ("semi-implicit Euler", 1, "symplectic_euler_position_first")},
)
