"""Drake: one step of fixed size of each of its integration schemes, on a second-order system with a force of ours."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets


@cache
def _field_simulator(size):
    """A simulator of y' = f(t, y), and the place of f."""
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import LeafSystem

    place = [None]

    class System(LeafSystem):
        def __init__(self):
            super().__init__()
            self.DeclareContinuousState(size)

        def DoCalcTimeDerivatives(self, context, derivatives):
            state = context.get_continuous_state_vector().CopyToVector()
            derivatives.get_mutable_vector().SetFromVector(place[0](context.get_time(), state))

    return Simulator(System()), place


@cache
def _force_simulator():
    """A simulator of q' = v, v' = force(q), its state divided into positions and velocities, and the place of force."""
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import LeafSystem

    place = [None]

    class System(LeafSystem):
        def __init__(self):
            super().__init__()
            self.DeclareContinuousState(1, 1, 0)

        def DoCalcTimeDerivatives(self, context, derivatives):
            q, v = context.get_continuous_state_vector().CopyToVector()
            derivatives.get_mutable_vector().SetFromVector([v, place[0](q)])

    return Simulator(System()), place


def _stepped(simulator, scheme, t, state, h):
    """The state after one step of a new integrator, which remembers nothing."""
    from pydrake.systems.analysis import ResetIntegratorFromFlags

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
        simulator, place = _field_simulator(len(y))
        place[0] = f
        return _stepped(simulator, scheme, t, y, h)

    return step


def _force(scheme):
    def step(force, q, v, h):
        simulator, place = _force_simulator()
        place[0] = force
        return tuple(_stepped(simulator, scheme, 0.0, [q, v], h))

    return step


explicit_euler, runge_kutta2, runge_kutta3 = map(_field, ("explicit_euler", "runge_kutta2", "runge_kutta3"))
runge_kutta5, bogacki_shampine3 = _field("runge_kutta5"), _field("bogacki_shampine3")
implicit_euler, radau1, radau3 = map(_field, ("implicit_euler", "radau1", "radau3"))
semi_explicit_euler, velocity_implicit_euler = _force("semi_explicit_euler"), _force("velocity_implicit_euler")

TARGETS = targets(
    __name__,
    "drake",
    "field",
    {
        "explicit_euler": ("explicit Euler", 1, "forward_euler"),
        "runge_kutta2": ("second-order Runge-Kutta", 2, "heun2"),
        "runge_kutta3": ("third-order Runge-Kutta", 3, "kutta3"),
        "runge_kutta5": ("fifth-order Runge-Kutta, Dormand-Prince", 5, "dormand_prince54"),
        "bogacki_shampine3": ("Bogacki-Shampine 3", 3, "bogacki_shampine32"),
        "implicit_euler": ("implicit Euler", 1, "backward_euler"),
        "radau1": ("Radau IIA, one stage", 1, "backward_euler"),
        "radau3": ("Radau IIA, two stages", 3, "radau_iia2"),
    },
) | targets(
    __name__,
    "drake",
    "force",
    {
        "semi_explicit_euler": ("semi-explicit Euler", 1, "symplectic_euler"),
        "velocity_implicit_euler": ("velocity-implicit Euler", 1, "backward_euler"),
    },
)
