"""Drake: one step of fixed size of each of its integration schemes, on a second-order system with a force of ours."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _simulator(*sizes):
    """A simulator of z' = f(t, z) for z of one size, or of positions, velocities and others, and the place of f."""
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import LeafSystem

    place = [None]

    class System(LeafSystem):
        def __init__(self):
            super().__init__()
            self.DeclareContinuousState(*sizes)

        def DoCalcTimeDerivatives(self, context, derivatives):
            state = context.get_continuous_state_vector().CopyToVector()
            derivatives.get_mutable_vector().SetFromVector(place[0](context.get_time(), state))

    return Simulator(System()), place


def _stepped(sizes, f, scheme, t, state, h):
    """The state after one step of a new integrator, which remembers nothing."""
    from pydrake.systems.analysis import ResetIntegratorFromFlags

    simulator, place = _simulator(*sizes)
    place[0] = f
    ResetIntegratorFromFlags(simulator, scheme, h)
    simulator.get_mutable_integrator().set_fixed_step_mode(True)
    context = simulator.get_mutable_context()
    context.SetTime(t)
    context.SetContinuousState(state)
    simulator.Initialize()
    simulator.AdvanceTo(t + h)
    return context.get_continuous_state_vector().CopyToVector()


def _field(scheme):
    def step(f, t, y, h):
        return _stepped((len(y),), f, scheme, t, y, h)

    return step


def _force(scheme):
    def step(force, q, v, h):
        return tuple(_stepped((1, 1, 0), lambda t, z: [z[1], force(z[0])], scheme, 0.0, [q, v], h))

    return step


TARGETS = targets(
    __name__,
    "drake",
    field={
        "explicit_euler": (_field("explicit_euler"), "explicit Euler", 1, "forward_euler"),
        "runge_kutta2": (_field("runge_kutta2"), "second-order Runge-Kutta", 2, "heun2"),
        "runge_kutta3": (_field("runge_kutta3"), "third-order Runge-Kutta", 3, "kutta3"),
        "runge_kutta5": (_field("runge_kutta5"), "fifth-order Runge-Kutta, Dormand-Prince", 5, "dormand_prince54"),
        "bogacki_shampine3": (_field("bogacki_shampine3"), "Bogacki-Shampine 3", 3, "bogacki_shampine32"),
        "implicit_euler": (_field("implicit_euler"), "implicit Euler", 1, "backward_euler"),
        "radau1": (_field("radau1"), "Radau IIA, one stage", 1, "backward_euler"),
        "radau3": (_field("radau3"), "Radau IIA, two stages", 3, "radau_iia2"),
    },
    force={
        "semi_explicit_euler": (_force("semi_explicit_euler"), "semi-explicit Euler", 1, "symplectic_euler"),
        "velocity_implicit_euler": (_force("velocity_implicit_euler"), "velocity-implicit Euler", 1, "backward_euler"),
    },
)
