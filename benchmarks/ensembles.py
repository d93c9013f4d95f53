"""Ten thousand systems to a given error, beside heyoka's batches and diffrax under vmap: about two minutes.

The error is the worst of all systems, beside DOP853 in REFERENCE_STEPS steps, from which half as many differ by less
than a ten-thousandth of it. Ours are given steps of one size for all, of the method and the number of steps with which
the error is reached soonest; peers choose the steps of each system, or batch, and have the largest tolerance that
reaches it. Ours and heyoka, in batches as wide as it recommends, run in one thread; diffrax as XLA has it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np

from benchmarks.engine import LORENZ, LORENZ_START
from benchmarks.harness import Contestant, Section, Subject, quiet, timed
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import SMOOTH_FUNCTIONS, VectorField
from driftproof.numeric.advance import field_rate
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.steps.engine import compiled_ensemble_runner, functions_of

SYSTEMS, ERROR, REFERENCE_STEPS = 10_000, 1e-6, 4096
KEPLER = PROBLEMS["kepler"]
# (field, starts, end, our methods): the first system's start, and the last's 2 % further from the origin.
CASES: dict[str, tuple[VectorField, tuple[float, ...], float, tuple[str, ...]]] = {
    "Kepler orbits, t = 10": (
        KEPLER.field,
        tuple(map(float, KEPLER.start)),
        10.0,
        ("blanes_moan_rkn6b", "verner76", "verner87", "dop853"),
    ),
    "Lorenz systems, t = 1": (LORENZ, LORENZ_START, 1.0, ("rk4", "dormand_prince54", "verner87", "dop853")),
}
STEPS = sorted({round(16 * 2 ** (k / 4)) for k in range(28)})
TOLERANCES = tuple(10 ** (-k / 2) for k in range(6, 28))
# The most that our time may be of a peer's.
SHARE = 1.0
Solve = Callable[[], Any]


@cache
def starts_of(name: str) -> Any:
    """A column for each system."""
    return np.ascontiguousarray(np.array(CASES[name][1])[:, None] * np.linspace(1.0, 1.02, SYSTEMS))


def by_steps(name: str, key: str, steps: int) -> Solve:
    """All systems at the end, in so many steps."""
    field, _, end, _ = CASES[name]
    run = compiled_ensemble_runner(METHODS[key], field)

    def solve() -> Any:
        y = starts_of(name).copy()
        run(y, end / steps, 0, steps)
        return y

    return solve


@cache
def reference(name: str) -> Any:
    """All systems at the end."""
    half, found = (by_steps(name, "dop853", steps)() for steps in (REFERENCE_STEPS // 2, REFERENCE_STEPS))
    if np.abs(half - found).max() > ERROR * 1e-4:
        raise ArithmeticError(f"{name}: {REFERENCE_STEPS} steps are no reference for {ERROR:g}")
    return found


def error_of(name: str, found: Any) -> float:
    """The largest distance of a system's state from the reference."""
    off = np.asarray(found) - reference(name)
    return float(np.sqrt((off * off).sum(axis=0)).max())


def ours(name: str) -> tuple[str, Contestant]:
    """The method and the number of steps that reach the error soonest, in processor seconds."""
    tried: list[tuple[float, Solve, str, int]] = []
    for key in CASES[name][3]:
        for steps in STEPS:
            solve = by_steps(name, key, steps)
            if error_of(name, solve()) <= ERROR:
                before = process_time()
                solve()
                tried.append((process_time() - before, solve, key, steps))
                break
    _, solve, key, steps = min(tried, key=lambda one: one[0])
    return key, Contestant(solve, lambda found: f"{error_of(name, found):.1e}, {steps} steps")


def at_its_best(name: str, solver: Callable[[float], Solve]) -> Contestant | None:
    """A peer with the largest tolerance with which it reaches the error; None if none does."""
    with quiet():
        for tolerance in TOLERANCES:
            solve = solver(tolerance)
            if error_of(name, solve()) <= ERROR:
                return Contestant(solve, lambda found, tol=tolerance: f"{error_of(name, found):.1e}, tol {tol:.0e}")
    return None


def heyoka_batches(name: str) -> Callable[[float], Solve]:
    """Taylor series of as many systems at once as an instruction takes."""
    import heyoka

    field, _, end, _ = CASES[name]
    variables = [heyoka.expression(x) for x in field.components]
    rate = field_rate(field, {function: getattr(heyoka, function) for function in SMOOTH_FUNCTIONS})
    system = list(zip(variables, rate(heyoka.time, variables), strict=True))
    starts, width = starts_of(name), heyoka.recommended_simd_size()

    def solver(tolerance: float) -> Solve:
        stepper = heyoka.taylor_adaptive_batch(system, np.ascontiguousarray(starts[:, :width]), tol=tolerance)

        def solve() -> Any:
            y = np.empty_like(starts)
            for first in range(0, SYSTEMS, width):
                stepper.set_time(0.0)
                stepper.state[:] = starts[:, first : first + width]
                stepper.propagate_until(end)
                y[:, first : first + width] = stepper.state
            return y

        return solve

    return solver


def diffrax_mapped(name: str, solver_name: str) -> Callable[[float], Solve]:
    """One solver of diffrax, mapped over the systems, and compiled once."""
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    field, _, end, _ = CASES[name]
    rate = field_rate(field, functions_of(jax.numpy))

    def one(start: Any, tolerance: Any) -> Any:
        term = diffrax.ODETerm(lambda t, y, _: jax.numpy.stack([jax.numpy.asarray(x) for x in rate(t, y)]))
        control = diffrax.PIDController(rtol=tolerance, atol=tolerance)
        given = {"saveat": diffrax.SaveAt(t1=True), "stepsize_controller": control, "max_steps": 10**5}
        return diffrax.diffeqsolve(term, getattr(diffrax, solver_name)(), 0.0, end, None, start, **given).ys[0]

    mapped = jax.jit(jax.vmap(one, in_axes=(1, None), out_axes=1))
    starts = jax.numpy.array(starts_of(name))
    return lambda tolerance: lambda: mapped(starts, tolerance).block_until_ready()


def subjects() -> Iterator[Subject]:
    """What can be had here."""
    for name in CASES:
        peers: dict[str, Callable[[float], Solve]] = {}
        if find_spec("heyoka"):
            peers["heyoka, batches"] = heyoka_batches(name)
        if find_spec("diffrax"):
            peers |= {f"diffrax, {solver}, vmap": diffrax_mapped(name, solver) for solver in ("Tsit5", "Dopri8")}
        found = {who: at_its_best(name, solver) for who, solver in peers.items()}
        others = {who: contestant for who, contestant in found.items() if contestant is not None}
        shares = {("ours", who): SHARE for who in others}
        key, best = ours(name)
        asked = f"{SYSTEMS} {name}, error {ERROR:.0e}; ours: {key}".replace("e-0", "e-")
        yield Subject(asked, {"ours": best, **others}, None, shares)


def sections(rounds: int) -> Iterator[Section]:
    """Measured; nothing without numba."""
    if find_spec("numba") is not None:
        yield timed("Ensembles to a given error", subjects(), rounds, process_time)
