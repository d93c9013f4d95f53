"""Public bugs of steps that remember or take a Jacobian: starts, values that are used too early, a missing df/dt.

Each is a small twin in our own words, with its mistake and mended, as in `public_solver_bugs`.
"""

from __future__ import annotations

from tests.blackbox.families.linearised_steppers import rosenbrock
from tests.blackbox.families.remembering_steppers import Remembering, implicit_euler
from tests.blackbox.handwritten_steppers import euler, rk4
from tests.blackbox.implicit_steppers import newton
from tests.campaigns.public_solver_bugs import Replay
from tests.campaigns.public_step_bugs import of_method


class Early(Remembering):
    """A three-step formula from the second step on, the value that is not there yet being the first one."""

    def step(self, f, t, y, h):
        """One step."""
        if not self.states:
            self.states, self.slopes = [y], [0 * y]
        return super().step(f, t, y, h)


def repeated(f, t, y, h):
    """The formula of BDF2 with the first value for the one before it: 2/3 h of backward Euler."""
    return newton(lambda x: x - y - 2 / 3 * h * f(t + h, x), y)


def without_before(f, t, y, h):
    """The formula of Adams-Bashforth with the slope 0 before the first one."""
    return y + 1.5 * h * f(t, y)


def at_one_time(f, t, y, h):
    """A start whose clock stands still: the stages of a step are all asked at its start."""
    return rk4(lambda _, z: f(t, z), t, y, h)


_START = "its start is too inaccurate: first errors are like h^1"
FAMILIES = (
    Replay("CliMA/Oceananigans.jl#127", "Adams-Bashforth from the first step on, the slope before it 0",
           of_method("adams_bashforth2"), Remembering("adams_bashforth2", without_before).step,
           Remembering("adams_bashforth2", euler).step, _START),
    Replay("KratosMultiphysics/Kratos#5515", "BDF2 from the first step on, the value before it the first one",
           of_method("bdf2"), Remembering("bdf2", repeated).step, Remembering("bdf2", implicit_euler).step, _START),
    Replay("SciML/OrdinaryDiffEq.jl#4329", "a three-step formula before there are three values",
           of_method("bdf3"), Early("bdf3", rk4).step, Remembering("bdf3", rk4).step, _START),
    Replay("headmyshoulder/odeint-v2#215", "the time does not advance in the stepper that starts it",
           of_method("adams_bashforth4"), Remembering("adams_bashforth4", at_one_time).step,
           Remembering("adams_bashforth4", rk4).step, "called at wrong times"),
    Replay("AMReX-Astro/Microphysics#2061", "a Rosenbrock method without df/dt", of_method("rodas4"),
           rosenbrock("rodas4", time_slope="none"), rosenbrock("rodas4"), "df/dt is left out"),
)  # fmt: skip
