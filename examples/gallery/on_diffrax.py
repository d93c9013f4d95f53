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


def _make_semi_implicit(force):
    import diffrax

    terms = (diffrax.ODETerm(lambda t, v, args: v), diffrax.ODETerm(lambda t, q, args: force(q)))

    def step(q, v, h):
        return diffrax.SemiImplicitEuler().step(terms, 0.0, h, (q, v), None, None, made_jump=False)[0]

    return step


euler, heun, midpoint, ralston = map(_solver, ("Euler", "Heun", "Midpoint", "Ralston"))
bosh3, tsit5, dopri5, dopri8 = map(_solver, ("Bosh3", "Tsit5", "Dopri5", "Dopri8"))
leapfrog_midpoint, reversible_heun = _solver("LeapfrogMidpoint"), _solver("ReversibleHeun")
semi_implicit_euler = force_step(_make_semi_implicit)

TARGETS = targets(
    __name__,
    "diffrax",
    "field",
    {
        "euler": ("Euler", 1, "forward_euler"),
        "heun": ("Heun", 2, "heun2"),
        "midpoint": ("midpoint", 2, "midpoint2"),
        "ralston": ("Ralston", 2, "ralston2"),
        "bosh3": ("Bogacki-Shampine 3(2)", 3, "bogacki_shampine32"),
        "tsit5": ("Tsitouras 5(4)", 5, "tsitouras54"),
        "dopri5": ("Dormand-Prince 5(4)", 5, "dormand_prince54"),
        "dopri8": ("Dormand-Prince 8(7)", 8, "prince_dormand87"),
        "leapfrog_midpoint": ("leapfrog/midpoint, two steps, first step Euler", 2),
        "reversible_heun": ("reversible Heun", 2, "heun2"),
    },
) | targets(
    __name__,
    "diffrax",
    "force",
    {"semi_implicit_euler": ("semi-implicit Euler", 1, "symplectic_euler_position_first")},
)
