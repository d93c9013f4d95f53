"""Public bugs of steps: stages, times, implicit stages, masses, magnetic fields, damping, quaternions; and of clocks.

Each is a small twin in our own words, with its mistake and mended, as in `public_solver_bugs`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from driftproof import identify, verify
from driftproof.blackbox.judging.specification import Allowance
from driftproof.methods.catalogue import METHODS
from tests.blackbox.dragged_steppers import of_stages
from tests.blackbox.dragged_steppers import verlet as moved
from tests.blackbox.extension_steppers import extension_step
from tests.blackbox.families.remembering_steppers import Remembering
from tests.blackbox.families.turning_steppers import body, boris, product, quaternion, space, turned_by
from tests.blackbox.implicit_steppers import one_by_one, table
from tests.blackbox.pair_steppers import but_one, pair_step
from tests.blackbox.solvers.planted_solvers import adaptive
from tests.campaigns.planted_bugs import words_of
from tests.campaigns.public_solver_bugs import DP, RIGHT, Replay, Said, of_dense, of_pair, of_solver

EXAMPLES = 60


def of_method(key: str) -> Callable[[Any], Said]:
    """What `verify` says of a step that is to be this method; implicit Runge-Kutta stages are solved to 1e-10."""
    allowance = Allowance(solver_tolerance=1e-10 if key in METHODS and not METHODS[key].explicit else None)

    def examine(step: Any) -> Said:
        report = verify(step, key, examples=EXAMPLES, isolate=False, allowance=allowance)
        return Said("; ".join(words_of(report)), [] if report.passed else [report.verdict])

    return examine


def of_step(step: Any) -> Said:
    """What `identify` says of a step that is no method of ours: its faults, and what small steps follow."""
    report = identify(step, isolate=False)
    faults = list(getattr(report.section("Faults"), "lines", ()))
    built_in = "its system is built in" in report.verdict  # which is no fault
    if report.verdict.startswith(("undecided", "gives no answer")) and not built_in:
        faults.append(report.verdict)
    return Said("; ".join(words_of(report)), faults)


def explicit(key: str, times: Callable[[float, float], float] = lambda c, h: c * h, *, rows: Any = None, b: Any = None):
    """The explicit step of a method's table, or of another one; stages are asked at t + times(c, h)."""
    method: Any = METHODS[key]
    a = [[float(x) for x in row] for row in method.a] if rows is None else rows
    weights = [float(x) for x in method.b] if b is None else b
    nodes = [float(x) for x in method.c]

    def step(f, t, y, h):
        k: list[Any] = []
        for i, c in enumerate(nodes):
            k.append(f(t + times(c, h), y + h * sum((a[i][j] * k[j] for j in range(i)), 0 * y)))
        return y + h * sum(w * slope for w, slope in zip(weights, k, strict=True))

    return step


def entry(key: str, i: int, j: int, value: float) -> list[list[float]]:
    """The stages of a method with one other entry."""
    rows = [[float(x) for x in row] for row in METHODS[key].a]  # type: ignore[union-attr]
    rows[i][j] = value
    return rows


def verlet(position: float = 0.5, old: float = 0.5, new: float = 0.5, drift: float = 1.0):
    """Velocity Verlet with these factors: of dt^2 a in the position, of both accelerations, of dt v."""

    def step(force, x, v, dt):
        a = force(x)
        x = x + drift * dt * v + position * dt**2 * a
        return x, v + dt * (old * a + new * (force(x) if new else 0.0))

    return step


def with_mass(power: int):
    """Symplectic Euler of m q'' = F, the force divided by this power of the mass."""

    def step(force, x, v, mass, dt):
        v = v + dt * force(x) / mass**power
        return x + dt * v, v

    return step


def damped(factor: Callable[[float], float], stiffness: float = 1.0):
    """Symplectic Euler of a spring, or of a free body, the velocity of each step multiplied by the factor."""

    def step(x, v, dt):
        v = (v - dt * stiffness * x) * factor(dt)
        return x + dt * v, v

    return step


def forced_damped(factor: Callable[[float], float]):
    """Symplectic Euler of a force, the old velocity multiplied by the factor."""

    def step(force, x, v, dt):
        v = factor(dt) * v + dt * force(x)
        return x + dt * v, v

    return step


def half_of_half(b: Any, h: float) -> Any:
    """t of two rotations of half the angle each, which make one of Boris' step."""
    size = np.linalg.norm(b)
    return np.tan(np.arctan(h / 2 * size) / 2) * b / size if size else 0 * b


def first_order(real: Callable[[Any], float]):
    """A quaternion moved by the product with (real, omega) dt/2, and made one of length 1."""

    def step(q, omega, dt):
        q = q + dt / 2 * product([real(q), *omega], q)
        return q / np.linalg.norm(q)

    return step


def of_matrix(order: Sequence[int]):
    """Euler's step of a quaternion by a matrix for the scalar last, the numbers taken in this order."""

    def step(q, omega, dt):
        x, y, z = omega
        m = np.array([[0, z, -y, x], [-z, 0, x, y], [y, -x, 0, z], [-x, -y, -z, 0]])[np.ix_(order, order)]
        return q + dt / 2 * m @ np.array(q)

    return step


def euler_fsal(new: bool):
    """Euler's method that is handed its slope, and hands on the one at its end, or the old one."""

    def step(f, t, y, k1, h):
        y1 = y + h * k1
        return y1, f(t + h, y1) if new else k1

    return step


def verlet_handing_on(new: bool):
    """Velocity Verlet that is handed its acceleration, and hands on the one at its end, or the old one."""

    def step(force, x, v, a, dt):
        x = x + dt * v + dt**2 / 2 * a
        fresh = force(x)
        return x, v + dt / 2 * (a + fresh), fresh if new else a

    return step


def adams_bashforth(first: float):
    """The two-step method; its first step is Euler's, this many h long."""
    return Remembering("adams_bashforth2", lambda f, t, y, h: y + first * h * f(t, y)).step


def counting(more: Callable[[float, float, float], bool], cut: bool = False):
    """Heun's method while more(t, end, h), the clock a sum of steps; the last step cut where asked."""

    def solve(f, t_span, y0, rtol, atol):
        t, end = t_span
        h, y, times, states = (end - t) / 100, np.array(y0, float), [t], [np.array(y0, float)]
        sign = 1 if h > 0 else -1
        while more(sign * t, sign * end, abs(h)):
            step = sign * min(abs(h), abs(end - t)) if cut else h
            slope = f(t, y)
            y, t = y + step / 2 * (slope + f(t + step, y + step * slope)), t + step
            times.append(t)
            states.append(y)
        return times, states

    return solve


def eulers(velocity_first: bool, apart: bool = False):
    """Euler's methods of a force; with `apart`, divided by the step."""

    def step(force, x, v, dt):
        v1 = v + (force(x) / dt if apart and dt else dt * force(x))
        return x + dt * (v1 if velocity_first else v), v1

    return step


SE, VV = "symplectic_euler", "velocity_verlet"
V1 = of_method(VV)
STEPS = (
    Replay("headmyshoulder/odeint-v2#150", "half of dt v, and all of dt^2 a", V1, verlet(1.0, drift=0.5), verlet(),
           "step(q=0.0, v=1.0, h=1.0): q is 0.5, exact value 1"),
    Replay("TeamAtomECS/AtomECS#18", "the velocity takes the old force twice", V1, verlet(0.5, 1.0, 0.0), verlet(),
           "forward_euler except for b_position[0]: 1/2"),
    Replay("psi4/psi4numpy#103", "0*5 for 0.5", V1, verlet(0.0), verlet(), "b_position[0]: 0 instead of 1/2"),
    Replay("SciML/OrdinaryDiffEq.jl#577", "the position moves with the old velocity", of_method(SE), eulers(False),
           eulers(True), "it is forward_euler"),
    Replay("ThomasLengeling/traerphysics#2", "divided by the step", of_method(SE), eulers(True, apart=True),
           eulers(True), "does not scale with h"),
    Replay("f1tenth/f1tenth_gym#52", "the last stage takes k2 for k3", of_method("rk4"), explicit("rk4", rows=[[0] * 4,
           [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 1.0, 0, 0]]), explicit("rk4"),
           "a[3][1]: 1 instead of 0; a[3][2]: 0 instead of 1"),
    Replay("FourierFlows/FourierFlows.jl#97", "the last stage goes half a step", of_method("rk4"), explicit("rk4",
           rows=entry("rk4", 3, 2, 0.5)), explicit("rk4"), "a[3][2]: 1/2 instead of 1"),
    Replay("thunil/mantaflow#10", "k1 is left out of the sum", of_method("rk4"), explicit("rk4", b=[0, 1 / 3, 1 / 3,
           1 / 6]), explicit("rk4"), "b[0]: 0 instead of 1/6"),
    Replay("mandli/intro-numerical-methods#36", "t + 1/2 for t + h/2", of_method("rk4"), explicit("rk4", lambda c,
           h: c if c == 0.5 else c * h), explicit("rk4"),
           "the time of call 1 is 0.5 where the coefficients read give 1"),
    Replay("AMReX-Codes/amrex#5326", "the second stage is asked at t", of_method("heun2"), explicit("heun2", lambda c,
           h: 0.0), explicit("heun2"), "c[1]: 0 instead of 1; it is heun2 called at wrong times"),
    Replay("MPAS-Dev/MPAS-Model#375", "a forcing is kept from the start of the step", of_method("rk38"),
           explicit("rk38", lambda c, h: 0.0), explicit("rk38"), "rk38 called at wrong times"),
    Replay("probabilistic-numerics/probnum#252", "no stage advances the time", of_method("rk4"), explicit("rk4",
           lambda c, h: 0.0), explicit("rk4"), "rk4 called at wrong times"),
    Replay("CliMA/Oceananigans.jl#6003", "the clock ticks after the last stage", of_method("kutta3"),
           explicit("kutta3", lambda c, h: 0.0), explicit("kutta3"), "kutta3 called at wrong times: order 1"),
    Replay("NumericalEarth/Breeze.jl#980", "the third stage is evaluated at t + h", of_method("ssprk33"),
           explicit("ssprk33", lambda c, h: h if c else 0.0), explicit("ssprk33"), "c[2]: 1 instead of 1/2"),
    Replay("pathsim/pathsim#232", "a digit of a stage", of_method("fehlberg45"), explicit("fehlberg45",
           rows=entry("fehlberg45", 5, 2, -3554 / 2565)), explicit("fehlberg45"),
           "a[5][2]: -3554/2565 instead of -3544/2565"),
    Replay("openrocket/openrocket#3013", "a stage keeps the last of its terms", of_method("rk38"), explicit("rk38",
           rows=[[0] * 4, [1 / 3, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1.0, 0]]), explicit("rk38"),
           "a[2][0]: 0 instead of -1/3"),
    Replay("headmyshoulder/odeint-v2#235", "1/40 of the estimate has the other sign", of_pair, pair_step(DP,
           estimate=but_one(6, 1 / 40)), pair_step(DP), "e[6]: 1/40 instead of -1/40"),
    Replay("princemahajan/FLINT#14", "coefficients of the interpolation", of_dense, extension_step("dop853_dense",
           weights=lambda rows: [[*row[:-1], 1.01 * row[-1]] for row in rows]), extension_step("dop853_dense"),
           "is not y1 at theta = 1"),
    Replay("SciML/OrdinaryDiffEq.jl#2875", "SDIRK2 is the trapezoidal rule", of_method("sdirk2"),
           one_by_one(table("trapezoid")), one_by_one(table("sdirk2")), "it is trapezoid"),
    Replay("ufz/ogs5#25", "Crank-Nicolson is backward Euler", of_method("trapezoid"),
           one_by_one(table("backward_euler")), one_by_one(table("trapezoid")), "it is backward_euler"),
    Replay("AMReX-Astro/Microphysics#2055", "implicit stages at the old time", of_method("backward_euler"),
           one_by_one(([[1.0]], [1.0], [0.0])), one_by_one(table("backward_euler")), "c[0]: 0 instead of 1"),
    Replay("trilinos/Trilinos#7841", "the model is never evaluated again", of_step, euler_fsal(False),
           euler_fsal(True), "as the slope at its end, not"),
    Replay("SciML/OrdinaryDiffEq.jl#1390", "the acceleration of the start is loaded again", of_step,
           verlet_handing_on(False), verlet_handing_on(True), "passes on -1 as the slope at its end"),
    Replay("erayzesen/godot-quarkphysics#38", "the acceleration grows with the mass", of_method(SE), with_mass(0),
           with_mass(1), "kick 0: 2 instead of 1"),
    Replay("concord-consortium/lab#7", "divided by the mass twice", of_method(SE), with_mass(2), with_mass(1),
           "kick 0: 1/2 instead of 1"),
    Replay("gbogopolsky/boris-method#1", "the size of the rotation by components", of_step,
           boris(size=lambda t: t * t), boris(), "the rotation depends on the direction of B"),
    Replay("OPALX-project/OPAL#1584", "the rotation without its step", of_step, boris(lambda b, h: b / 2), boris(),
           "the rotation is not a function of h B"),
    Replay("BLAST-WarpX/warpx#6886", "two half rotations are not the whole one", of_step,
           boris(lambda b, h: h / 4 * b, turns=2), boris(half_of_half, turns=2), "implicit_midpoint in 2 equal parts"),
    Replay("fmihpc/vlasiator#368", "every charge turns in one sense", of_step, boris(lambda b, h: -h / 2 * b), boris(),
           "it turns the other way"),
    Replay("phaserjs/phaser#5356", "a drag for each step", of_step, damped(lambda h: 0.99),
           damped(lambda h: 0.99 ** (60 * h)), "a damping per step"),
    Replay("pafuhana1213/KawaiiPhysics#81", "world damping in each frame", of_step, damped(lambda h: 0.9, 0.0),
           damped(lambda h: np.exp(-6 * h), 0.0), "a damping per step"),
    Replay("dhewm/dhewm3#585", "half of the momentum in each frame", of_step, forced_damped(lambda h: 0.5),
           forced_damped(lambda h: 0.5 ** (60 * h)), "multiplied by 0.5 in each step"),
    Replay("avianphysics/avian#818", "a character's damping in each frame", of_step, forced_damped(lambda h: 0.92),
           forced_damped(lambda h: 1 / (1 + 5 * h)), "multiplied by 0.92 in each step"),
    Replay("NVIDIAGameWorks/PhysX-3.4#43", "a damping of first order in the step", of_step,
           forced_damped(lambda h: 1 - h / 4), forced_damped(lambda h: 0.75**h), "v is multiplied by 1 - 1/4 h"),
    Replay("cb-geo/mpm#204", "the velocity is assigned, not updated", of_method(SE), forced_damped(lambda h: 0.0),
           forced_damped(lambda h: 1.0), "the velocity is multiplied by 0 in each step"),
    Replay("GDS-Education-Community-of-Practice/DSECOP#15", "the second force is asked at a velocity that is not there "
           "yet", V1, moved(lambda v, a, dt: 0 * v), moved(lambda v, a, dt: v + dt * a),
           "call 1 is given the velocity 0 v, not 1 v"),
    Replay("espressomd/espresso#4930", "the second force is asked at the velocity in the middle", V1,
           moved(lambda v, a, dt: v + dt / 2 * a), moved(lambda v, a, dt: v + dt * a),
           "the position of t + h and the velocity v + 1/2 h F[0]"),
    Replay("o-murphy/py-ballisticcalc#350", "the drag of the start is kept for all stages", of_method("rk4"),
           of_stages("rk4", lambda i, stage, v: v), of_stages("rk4"), "order 1 where the force depends on the"),
    Replay("mit-aera/FlightGoggles#67", "a quaternion's rate without 1/2", of_step,
           quaternion("forward_euler", lambda q, w: 2 * body(q, w)), quaternion("forward_euler"),
           "the factor 1/2 is missing"),
    Replay("sofa-framework/sofa#172", "a turn by arctan of the angle", of_step, turned_by(np.arctan),
           turned_by(lambda x: x), "it turns by atan(phi) = phi - phi^3/3"),
    Replay("w0rm/elm-physics#69", "half of the angle about the axis", of_step, turned_by(lambda x: x / 2),
           turned_by(lambda x: x), "the factor 1/2 appears twice"),
    Replay("avianphysics/avian#488", "a real part beside the angular velocity", of_step, first_order(lambda q: q[0]),
           first_order(lambda q: 0.0), "is not linear in q"),
    Replay("avianphysics/avian#747", "the product in the other order", of_step, quaternion("midpoint2"),
           quaternion("midpoint2", space), "of q' = q omega/2"),
    Replay("sksat/trochia#55", "the matrix for a scalar last, the scalar being first", of_step,
           of_matrix([0, 1, 2, 3]), of_matrix([3, 0, 1, 2]), "(scalar last)"),
    Replay("ben-cassese/jorbit#85", "every step goes forward", V1,
           lambda force, q, v, h: verlet()(force, q, v, abs(h)), verlet(), "a step with h < 0 is wrong"),
    Replay("firedrakeproject/gusto#78", "t < end + h/2", of_solver, counting(lambda t, end, h: t < end + h / 2),
           counting(lambda t, end, h: t < end - h / 2), "one step too many"),
    Replay("pmgbergen/porepy#939", "a whole step more where the sum is short", of_solver, counting(lambda t, end,
           h: t < end), counting(lambda t, end, h: t < end - h / 2),
           "one step too many, or a last one that is not shortened"),
    Replay("idaholab/moose#5590", "a step of 1e-13 more", of_solver, counting(lambda t, end, h: t < end, cut=True),
           counting(lambda t, end, h: t < end - h / 2), "one step too many: the last one is"),
    Replay("Pele-Suite/PelePhysics#300", "the last step goes beyond the end", of_solver, adaptive(ending="beyond"),
           RIGHT, "beyond the end"),
    Replay("OPALX-project/OPAL#1375", "the time is doubled", of_solver, adaptive(stepped=lambda h: 2 * h), RIGHT,
           "that it returns differ"),
    Replay("pyqg/pyqg#6", "the first step of Adams-Bashforth is 3/2 h long", of_step, adams_bashforth(1.5),
           adams_bashforth(1.0), "forward_euler, with the step 3/2 h in place of h"),
)  # fmt: skip
