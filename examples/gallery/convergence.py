"""The findings at the head of docs/gallery.md, seen once more by plain convergence runs without driftproof.

    python examples/gallery/convergence.py > examples/gallery/findings.md
    python examples/gallery/convergence.py --solvers > examples/gallery/solver_findings.md

the second those of whole solvers, for docs/gallery_solvers.md. It wants desolver, ode-explorer, nodepy, mici, gala,
blackjax and pathsim, in the versions of requirements.txt beside it. Each solver runs a problem whose solution is known,
with ever more steps; the slope of the last errors is the order seen.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from math import exp, log2, sin
from typing import NamedTuple

import numpy as np

# What takes n steps to t = 1 and returns the error there.
Run = Callable[[int], float]


def field(step: Callable[..., object]) -> Run:
    """y' = y cos t + (0 - y₂, 0), with y₁ = exp(sin t) and y₂' = 0: a right-hand side that depends on t."""

    def error(n: int) -> float:
        y, h = np.array([1.0, 0.0]), 1 / n
        for i in range(n):
            y = np.asarray(step(lambda t, y: np.array([y[0] * np.cos(t), 0.0]), i * h, y, h))
        return abs(float(y[0]) - exp(sin(1.0)))

    return error


def force(step: Callable[..., object], acceleration: Callable[[float], float] = lambda q: 2 * q**3) -> Run:
    """q'' = 2q³ from q = 1/2, with q = 1/(2 - t)."""

    def error(n: int) -> float:
        q, v, h = 0.5, 0.25, 1 / n
        for _ in range(n):
            q, v = step(acceleration, q, v, h)  # type: ignore[misc]
        return abs(float(q) - 1.0)

    return error


def ode_explorer_dopri45(f, t, y, h):
    """The first of its two answers."""
    from ode_explorer.stepfunctions.stepfunctions import DOPRI45

    return DOPRI45().forward(f, (t, y), h)[0][1]


def mici_implicit_leapfrog(acceleration, q, v, h):
    """With unit metric."""
    from mici import integrators, states, systems

    system = systems.EuclideanMetricSystem(lambda x: 0.0, grad_neg_log_dens=lambda x: np.array([-acceleration(x[0])]))
    stepped = integrators.ImplicitLeapfrogIntegrator(system, h).step(
        states.ChainState(pos=np.array([float(q)]), mom=np.array([float(v)]), dir=1)
    )
    return stepped.pos[0], stepped.mom[0]


def gala_rk5(n: int) -> float:
    """The loop is gala's own: w' = w cos t, from 1."""
    import gala.integrate

    def derivative(t, w):
        return np.stack([w[0] * np.cos(t), 0 * w[1]])

    orbit = gala.integrate.RK5Integrator(derivative)(np.array([1.0, 0.0]), t=np.linspace(0, 1, n + 1))
    return abs(float(orbit.pos.xyz.value[0, -1]) - exp(sin(1.0)))


def desolver(name: str) -> Callable[..., object]:
    """One step of a class of desolver's."""

    def step(f, t, y, h):
        from desolver.differential_system import DiffRHS
        from desolver.integrators import available_methods

        integrator = available_methods(False)[name](y.shape, np.dtype(np.float64), rtol=0.0, atol=1e-14)
        if integrator.is_implicit:
            integrator.final_rhs = integrator.initial_rhs = f(t, y)
        return y + integrator.step(DiffRHS(lambda t, y, **_: f(t, y)), np.float64(t), y, {}, np.float64(h))[1][1]

    return step


def desolver_splitting(name: str) -> Callable[..., object]:
    """The same on q'' = F(q)."""
    step = desolver(name)
    return lambda acceleration, q, v, h: step(
        lambda t, y: np.array([y[1], acceleration(y[0])]), 0.0, np.array([q, v]), h
    )


def nodepy(name: str) -> Callable[..., object]:
    """A method of `loadRKM`, its coefficients as floats."""
    from nodepy import rk

    method = rk.loadRKM(name).__num__()
    return lambda f, t, y, h: method.__step__(f, t, y, h)


def blackjax_yoshida(acceleration, q, v, h):
    """In binary64, with unit mass; the force is that of its own log density."""
    import jax

    jax.config.update("jax_enable_x64", True)
    from blackjax.mcmc import integrators

    log_density = lambda x: 0.5 * x**4
    one = integrators.yoshida(log_density, lambda p, **_: 0.5 * p**2)
    stepped = one(integrators.new_integrator_state(log_density, jax.numpy.float64(q), jax.numpy.float64(v)), h)
    return stepped.position, stepped.momentum


def pathsim(name: str) -> Run:
    """A whole run of y' = y cos t by a solver of PathSim, with steps of 1/n and Newton's equations solved to 1e-14."""

    def error(n: int) -> float:
        from pathsim import solvers

        t, y = getattr(solvers, name)(np.array([1.0])).integrate(
            lambda y, t: y * np.cos(t), lambda y, t: np.array([[np.cos(t)]]), time_end=1.0, dt=1 / n, adaptive=False,
            tolerance_fpi=1e-14, max_iterations=200,
        )  # fmt: skip
        at = int(np.argmin(np.abs(np.array(t) - 1.0)))
        return abs(float(y[at][0]) - exp(sin(t[at])))

    return error


class Finding(NamedTuple):
    """`promised` is the order that the package's own words give it; `target` is its step, for `driftproof identify`."""

    package: str
    name: str
    target: str
    promised: int
    what: str
    run: Callable[[], Run]


FINDINGS = [
    Finding(
        "mici",
        "ImplicitLeapfrogIntegrator",
        "mici:implicit_leapfrog",
        2,
        "each half step is a whole one: a step of h goes 2h far",
        lambda: force(mici_implicit_leapfrog),
    ),
    Finding(
        "ode-explorer",
        "DOPRI45, the row of order 4",
        "ode_explorer:dopri45_4",
        4,
        "its last stage is y1, not f(y1): it does not converge",
        lambda: field(ode_explorer_dopri45),
    ),
    Finding(
        "gala",
        "RK5Integrator",
        "gala:rk5",
        5,
        "each stage is called one step late: order 1 where the force depends on t",
        lambda: gala_rk5,
    ),
    Finding(
        "desolver",
        "RadauIIA3",
        "desolver:radau_iia3",
        3,
        "1/3 stands for 1/4 in the last row",
        lambda: field(desolver("RadauIIA3")),
    ),
    Finding(
        "nodepy",
        "Lambert65",
        "nodepy:lambert65",
        5,
        "1/8, 1/8 stand for 3/16, 1/16 in a row",
        lambda: field(nodepy("Lambert65")),
    ),
    Finding(
        "blackjax",
        "yoshida",
        "blackjax:yoshida",
        4,
        "the coefficients are of another method, of order 2",
        lambda: force(blackjax_yoshida),
    ),
    Finding("nodepy", "SS3", "nodepy:ss3", 3, "b and its embedded row stand exchanged", lambda: field(nodepy("SS3"))),
    Finding(
        "desolver",
        "BABs9o7HSolver",
        "desolver:bab_s9o7h",
        7,
        "the order holds for the oscillator only",
        lambda: force(desolver_splitting("BABs9o7HSolver")),
    ),
    Finding(
        "desolver",
        "ABAs5o6HSolver",
        "desolver:aba_s5o6h",
        6,
        "the order holds for the oscillator only",
        lambda: force(desolver_splitting("ABAs5o6HSolver")),
    ),
    Finding(
        "desolver",
        "RK8713MSolver",
        "desolver:rk8713m",
        8,
        "the row of order 7 is propagated",
        lambda: field(desolver("RK8713MSolver")),
    ),
]


# Of whole solvers: `target` is what stands after `whole_solvers:`.
SOLVERS = [
    Finding(
        "pathsim",
        name,
        f"pathsim_fixed.{name}",
        order,
        "its start, of order 4, is not good enough",
        lambda name=name: pathsim(name),  # type: ignore[misc]
    )
    for name, order in (("BDF6", 6), ("BDF5", 5))
]


def seen(run: Run) -> tuple[float, list[float]]:
    """The slope between the last two errors above rounding, and the errors at 4, 8, 16, ... steps."""
    errors = [run(4)]
    while len(errors) < 7 and errors[-1] > 1e-12:
        errors.append(run(4 << len(errors)))
    clear = [error for error in errors if error > 1e-12]
    return log2(clear[-2] / clear[-1]), errors


def after_rejections() -> list[float]:
    """The steps of SciPy's `ode("dop853")` after rejected ones, over these: by the times at which it calls f.

    A step asks f at 11 times, the first at c_2 h and the last at h, and an accepted one once more at h.
    """
    from scipy.integrate import ode

    times: list[float] = []

    def stiff_van_der_pol(t: float, y: np.ndarray) -> list[float]:
        times.append(t)
        return [y[1], 50 * (1 - y[0] ** 2) * y[1] - y[0]]

    solver = ode(stiff_van_der_pol).set_integrator("dop853", rtol=1e-9, atol=1e-9, nsteps=100000)
    solver.set_initial_value([2.0, 0.0], 0.0).integrate(100.0)
    c2 = (12 - 2 * 6**0.5) / 135
    start, at, found = 0.0, 2, []
    while at + 11 < len(times):
        h = (times[at] - start) / c2
        accepted = abs(times[at + 11] - times[at + 10]) <= 1e-9 * h
        if accepted:
            start, at = times[at + 11], at + 12
        else:
            at += 11
            found.append((times[at] - start) / c2 / h)
    return found


def main() -> None:
    """Print the table, a line for each finding whose package is installed."""
    whole = sys.argv[1:] == ["--solvers"]
    warnings.simplefilter("ignore")
    print("| package | solver | promised | seen | what it is | errors at t = 1 with 4, 8, 16, ... steps | to see it |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for one in SOLVERS if whole else FINDINGS:
        try:
            at = version(one.package)
        except PackageNotFoundError:
            continue
        slope, errors = seen(one.run())
        shown = ", ".join(f"{x:.1e}" for x in errors)
        named = f"whole_solvers:{one.target} --solver" if whole else f"on_{one.target}"
        asked = f"`driftproof identify examples.gallery.{named}`"
        cells = (f"{one.package} {at}", one.name, one.promised, f"{slope:.1f}", one.what, shown, asked)
        print(f"| {' | '.join(map(str, cells))} |", flush=True)
    if whole:
        ratios = after_rejections()
        count = f"{sum(abs(ratio - 0.3) < 1e-6 for ratio in ratios)} of {len(ratios)}"
        print(
            f"\nSciPy {version('scipy')}, `ode('dop853')`: {count} steps after a rejected one are 0.3 times as long as"
        )
        print("that, whatever its error, on van der Pol's equation with mu = 50 at rtol = atol = 1e-9. The law of its")
        print("other steps, and of the Fortran code that it stands for, is max(0.3, 0.9 r^(-1/8)).")


if __name__ == "__main__":
    main()
