"""The time to a given error, beside scipy, diffrax and heyoka: about a minute.

The oscillator from (1, 0). Of each peer, the tolerance is the one with which it reaches the error in the least time, of
ours the number of steps; both are found here, beforehand. So everybody is measured at his best, and nobody's search,
nor what is compiled, is part of the time. To t = 10 we take steps, of the method of the catalogue that is fastest
there. To t = 1000 we make use of the problem's being linear, which heyoka does not, and form M and its power. Peers
are left out where they are not installed, and so are we without numba.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import version
from importlib.util import find_spec
from math import cos, hypot, sin
from time import perf_counter
from typing import Any

from benchmarks.harness import Contestant, Section, Subject, quiet, timed
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.steps.engine import compiled_runner
from driftproof.reports.work_precision.peers import PEERS, Peer, Solver
from tests.witnesses.matrix_powers import endpoint

START = (1.0, 0.0)
STEPPED, POWERED = METHODS["blanes_moan_rkn6b"], METHODS["gauss5"]
OSCILLATOR = VectorField(("y1", "-y0"))
TOLERANCES = tuple(10 ** (-k / 2) for k in range(6, 31))
# How often our minimum is to fit into that of a peer's solver.
TIMES_FASTER = {
    10.0: {"scipy, DOP853": 500.0, "diffrax, Dopri8": 30.0, "diffrax, Tsit5": 30.0, "heyoka, Taylor": 2.5},
    1000.0: {"heyoka, Taylor": 10.0},
}
SEARCHES = 15


def error_at(t: float, state: Sequence[Any]) -> float:
    """The distance of a state from (cos t, -sin t)."""
    return hypot(float(state[0]) - cos(t), float(state[1]) + sin(t))


def peer_tasks(name: str, solver: Solver, t: float) -> Iterator[tuple[float, Callable[[], Any]]]:
    """By tolerance, a solve, compiled, and with nothing around it that the peer does not need."""
    for tolerance in TOLERANCES:
        solver.solve(tolerance, t)
        yield tolerance, BARE.get(name, _as_it_is)(solver, tolerance, t)


def _as_it_is(solver: Any, tolerance: float, t: float) -> Callable[[], Any]:
    return lambda: solver.solve(tolerance, t)


def _heyoka(solver: Any, tolerance: float, t: float) -> Callable[[], Any]:
    stepper, state = solver.compiled[tolerance], solver.compiled[tolerance].state

    def task() -> Any:
        stepper.time = 0.0
        state[0], state[1] = START
        stepper.propagate_until(t)
        return state

    return task


def _diffrax(solver: Any, tolerance: float, t: float) -> Callable[[], Any]:
    end, allowed, compiled = solver.numpy.array(t), solver.numpy.array(tolerance), solver.compiled
    compiled(end, allowed)
    return lambda: compiled(end, allowed)[0].block_until_ready()


BARE = {"heyoka": _heyoka, "diffrax": _diffrax}


def at_its_best(peer: Peer, name: str, t: float, error: float) -> Contestant | None:
    """The solver with the tolerance with which it reaches the error in the least time; None if none does."""
    solver = peer.on(PROBLEMS["harmonic_oscillator"], name)
    with quiet():
        times: dict[float, tuple[float, Callable[[], Any]]] = {
            tolerance: (_seconds(task), task)
            for tolerance, task in peer_tasks(peer.name, solver, t)
            if error_at(t, task()) <= error
        }
    if not times:
        return None
    best = min(times, key=lambda tolerance: times[tolerance][0])
    return Contestant(times[best][1], lambda state: f"{error_at(t, state):.1e}, tol {best:.0e}")


def _seconds(task: Callable[[], Any]) -> float:
    """The least of some."""
    taken = []
    for _ in range(SEARCHES):
        start = perf_counter()
        task()
        taken.append(perf_counter() - start)
    return min(taken)


def by_steps(t: float, error: float) -> Contestant:
    """Compiled steps, as few as reach the error."""
    run = compiled_runner(STEPPED, OSCILLATOR)
    steps = next(n for n in range(1, 1000) if error_at(t, run(START, t / n, 0, n)) <= error)
    h = t / steps
    return Contestant(lambda: run(START, h, 0, steps), lambda z: f"{error_at(t, z):.1e}, {steps} steps")


def by_powers(t: float, error: float) -> Contestant:
    """M(h) exact and rounded once, and its power; a power of two is all squares."""
    steps = next(n for n in (2**k for k in range(20)) if error_at(t, endpoint(POWERED, START, t / n, n)) <= error)
    h = t / steps
    read = lambda found: f"{error_at(t, found):.1e}, {steps} steps"
    return Contestant(lambda: endpoint(POWERED, START, h, steps), read)


def subjects() -> Iterator[Subject]:
    """What can be had here."""
    for t, error, ours, name in (
        (10.0, 1e-6, by_steps, STEPPED.key),
        (1000.0, 1e-10, by_powers, f"power of {POWERED.key}"),
    ):
        others = {}
        for who in TIMES_FASTER[t]:
            peer, _, solver = who.partition(", ")
            found = at_its_best(PEERS[peer], solver, t, error) if PEERS[peer].installed else None
            others.update({who: found} if found is not None else {})
        shares = {("ours", who): 1 / least for who, least in TIMES_FASTER[t].items()}
        asked = f"t = {t:g}, error {error:.0e}; ours: {name}".replace("e-0", "e-")
        yield Subject(asked, {"ours": ours(t, error), **others}, None, shares)


def sections(rounds: int) -> Iterator[Section]:
    """Measured; nothing without numba."""
    if find_spec("numba") is not None:
        yield timed("Beside other people's integrators", subjects(), rounds)


def installed() -> dict[str, str]:
    """The peers that can be had here, with their versions."""
    asked = {who.partition(",")[0] for faster in TIMES_FASTER.values() for who in faster}
    return {name: version(name) for name, peer in PEERS.items() if name in asked and peer.installed}
