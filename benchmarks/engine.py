"""Many steps, beside loops by hand, C compiled here, and SciPy: about a minute.

All contestants of a subject take the same steps of the same size from the same start, and each step does the same
operations in the same order. C is compiled with -O3, once without fused multiply-adds, which gives our bits, and once
with all that the processor has, which does not. C, numba and SciPy are left out where they cannot be had.
"""

from __future__ import annotations

import ctypes
import hashlib
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.harness import Contestant, Section, Subject, timed
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.programs.explicit_steps import FieldSource, field_source
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.steps.engine import BLOCK, compiled_ensemble_runner, compiled_runner, runner

RK4, PAIR = METHODS["rk4"], METHODS["dormand_prince54"]
H, START = 0.01, (0.6, -0.8)
# Steps of one trajectory in Python and compiled; members and steps of an ensemble.
FEW, MANY, SYSTEMS, SYSTEM_STEPS = 2_000, 200_000, 10_000, 20
OSCILLATOR = VectorField(("y1", "-y0"))
LORENZ = VectorField(("10 * (y1 - y0)", "y0 * (28 - y2) - y1", "y0 * y1 - 8 * y2 / 3"))
LORENZ_START = (1.0, 1.5, 20.0)

C_SOURCE = """
static const double half = 1.0 / 2.0, third = 1.0 / 3.0, sixth = 1.0 / 6.0;

#define STEP(q, v) \\
    double k1_v = -q; \\
    double k2_q = v + h * (half * k1_v), q_2 = q + h * (half * v), k2_v = -q_2; \\
    double k3_q = v + h * (half * k2_v), q_3 = q + h * (half * k2_q), k3_v = -q_3; \\
    double k4_q = v + h * k3_v, q_4 = q + h * k3_q, k4_v = -q_4; \\
    double q1 = q + h * (sixth * v + third * k2_q + third * k3_q + sixth * k4_q); \\
    double v1 = v + h * (sixth * k1_v + third * k2_v + third * k3_v + sixth * k4_v);

void trajectory(double *z, double h, long steps) {
    double q = z[0], v = z[1];
    for (long n = 0; n < steps; n++) { STEP(q, v) q = q1; v = v1; }
    z[0] = q; z[1] = v;
}
"""


def by_hand(q: float, v: float, h: float, steps: int) -> tuple[float, float]:
    """The loop as one would write it for speed: everything in one body, weights as numbers."""
    half, third, sixth = 1 / 2, 1 / 3, 1 / 6
    for _ in range(steps):
        k1_v = -q
        k2_q, k2_v = v + h * (half * k1_v), -(q + h * (half * v))
        k3_q, k3_v = v + h * (half * k2_v), -(q + h * (half * k2_q))
        k4_q, k4_v = v + h * k3_v, -(q + h * k3_q)
        q, v = (
            q + h * (sixth * v + third * k2_q + third * k3_q + sixth * k4_q),
            v + h * (sixth * k1_v + third * k2_v + third * k3_v + sixth * k4_v),
        )
    return q, v


def by_steps(q: float, v: float, h: float, steps: int) -> tuple[float, float]:
    """The loop with a step function that takes a state and returns a tuple."""
    for _ in range(steps):
        q, v = by_hand(q, v, h, 1)
    return q, v


def lorenz_by_hand(state: tuple[float, float, float], h: float, steps: int) -> tuple[float, ...]:
    """RK4 with a right-hand side that is a function of a tuple, stages as lists."""

    def rate(x: float, y: float, z: float) -> tuple[float, float, float]:
        return 10 * (y - x), x * (28 - z) - y, x * y - 8 * z / 3

    weights = (1 / 6, 1 / 3, 1 / 3, 1 / 6)
    for _ in range(steps):
        k1 = rate(*state)
        k2 = rate(*(x + h * (0.5 * k) for x, k in zip(state, k1, strict=True)))
        k3 = rate(*(x + h * (0.5 * k) for x, k in zip(state, k2, strict=True)))
        k4 = rate(*(x + h * k for x, k in zip(state, k3, strict=True)))
        state = tuple(
            x + h * (weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d)
            for x, a, b, c, d in zip(state, k1, k2, k3, k4, strict=True)
        )  # type: ignore[assignment]
    return state


def bits(numbers: Any) -> str:
    """A short name of the bits of the floats."""
    return hashlib.sha256(np.asarray(numbers, np.float64).tobytes()).hexdigest()[:12]


def compiled_c(*flags: str, text: str = C_SOURCE) -> Any:
    """The C above, or another, as a library; None without a compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    folder = Path(tempfile.mkdtemp())
    source, library = folder / "steps.c", folder / "steps.so"
    source.write_text(f"#define BLOCK {BLOCK}\n{text}", encoding="utf-8")
    subprocess.run([compiler, "-O3", *flags, "-shared", "-fPIC", "-o", library, source], check=True, timeout=60)
    loaded = ctypes.CDLL(str(library))
    shutil.rmtree(folder)
    return loaded


def c_trajectory(library: Any) -> Callable[[], Any]:
    """So many steps of one trajectory in C."""
    state = ctypes.c_double * 2

    def run() -> Any:
        z = state(*START)
        library.trajectory(z, ctypes.c_double(H), ctypes.c_long(MANY))
        return tuple(z)

    return run


def with_scipy() -> dict[str, Contestant]:
    """solve_ivp, its step held at h by its own limits, so that it takes as many steps: what a step costs there."""
    if find_spec("scipy") is None:
        return {}
    from scipy.integrate import solve_ivp

    held = {"first_step": H, "max_step": H, "rtol": 1e-3, "atol": 1e-3}
    run = lambda: solve_ivp(lambda t, y: (y[1], -y[0]), (0, FEW * H), START, "RK45", **held)
    return {"scipy, RK45": Contestant(run, lambda found: f"in {len(found.t) - 1} steps")}


def by_us(run: Callable[..., Any], *arguments: Any, our_bits: bool = False) -> Contestant:
    """A run whose bits are compared, compiled if it is to be: the last of its arguments is the number of steps."""
    run(*arguments[:-1], 0)
    return Contestant(lambda: run(*arguments), bits, our_bits=our_bits)


def same(task: Callable[[], Any]) -> Contestant:
    """Another program with the same operations."""
    return Contestant(task, bits, our_bits=True)


def c_text_of(source: FieldSource) -> str:
    """The program text of a step in C: the same lines, of doubles, around the same blocks."""
    given = [f"static const double {name} = {float(c).hex()};" for name, c in source.coefficients]
    read = [f"double {x} = y[{k} * members + i];" for k, x in enumerate(source.components)]
    write = [f"y[{k} * members + i] = {x}_new;" for k, x in enumerate(source.components)]
    lines = [
        *("#include <math.h>", *given),
        "void systems(double *restrict y, long members, double h, long steps) {",
        f"for (long start = 0; start < members; start += {BLOCK}) {{",
        f"long stop = start + {BLOCK} < members ? start + {BLOCK} : members;",
        "for (long n = 0; n < steps; n++) for (long i = start; i < stop; i++) {",
        *(*read, *(f"double {line};" for line in source.lines), *write, "} } }"),
    ]
    return "\n".join([*lines, ""])


def systems(name: str, field: VectorField, start: Sequence[float]) -> Subject:
    """SYSTEMS of them, each from its own start: ours in one thread, and C, compiled from the same text."""
    starts = np.ascontiguousarray(np.array(start)[:, None] * np.linspace(1.0, 1.05, SYSTEMS))
    run, source = compiled_ensemble_runner(RK4, field), field_source(RK4, field)
    run(starts.copy(), H, 0, 0)

    def ours() -> Any:
        y = starts.copy()
        run(y, H, 0, SYSTEM_STEPS)
        return y

    def c_task(library: Any) -> Callable[[], Any]:
        def task() -> Any:
            y = starts.copy()
            place = y.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
            library.systems(place, ctypes.c_long(SYSTEMS), ctypes.c_double(H), ctypes.c_long(SYSTEM_STEPS))
            return y

        return task

    text = c_text_of(source)
    plain, fused = (
        compiled_c("-march=native", "-fno-math-errno", f"-ffp-contract={contract}", text=text)
        for contract in ("off", "fast")
    )
    contestants = {"ours": Contestant(ours, bits)}
    if plain is not None:
        contestants["C"] = same(c_task(plain))
        contestants["C, fused"] = Contestant(c_task(fused), bits)
    return Subject(f"rk4, {SYSTEMS} {name}, {SYSTEM_STEPS} steps", contestants, None, {("ours", "C, fused"): 1.6})


def subjects() -> Iterator[Subject]:
    """What can be had here, with the most that our minimum may be of another's; numba compiles beforehand."""
    numba = find_spec("numba") is not None
    plain = compiled_c("-ffp-contract=off")
    by_hand_too = {
        "by hand, one loop": same(lambda: by_hand(*START, H, FEW)),
        "by hand, a step function": same(lambda: by_steps(*START, H, FEW)),
    }
    shares = {("ours", "by hand, one loop"): 1.05, ("ours", "scipy, RK45"): 1 / 75}
    ours = by_us(runner(RK4, OSCILLATOR), START, H, 0, FEW)
    yield Subject(f"rk4, one trajectory, {FEW} steps", {"ours": ours, **by_hand_too, **with_scipy()}, None, shares)
    if numba:
        others = {} if plain is None else {"C": same(c_trajectory(plain))}
        by_c = {"ours": by_us(compiled_runner(RK4, OSCILLATOR), START, H, 0, MANY), **others}
        yield Subject(f"rk4, one trajectory, {MANY} steps", by_c, None, {("ours", "C"): 1.05})
        yield systems("Kepler orbits", PROBLEMS["kepler"].field, (0.4, 0.1, 0.1, 1.6))
        yield systems("Lorenz systems", LORENZ, LORENZ_START)
    lorenz = {"ours": by_us(runner(RK4, LORENZ), LORENZ_START, H, 0, FEW)}
    pair = {"ours": by_us(runner(PAIR, OSCILLATOR), START, H, 0, FEW)}
    if numba:
        lorenz["ours, numba"] = by_us(compiled_runner(RK4, LORENZ), LORENZ_START, H, 0, FEW, our_bits=True)
        pair["ours, numba"] = by_us(compiled_runner(PAIR, OSCILLATOR), START, H, 0, FEW, our_bits=True)
    lorenz["by hand, tuples"] = same(lambda: lorenz_by_hand(LORENZ_START, H, FEW))
    yield Subject(f"rk4, Lorenz's system, {FEW} steps", lorenz)
    slower = {("ours, numba", "scipy, RK45"): 1 / 75}
    yield Subject(f"dormand_prince54, {FEW} steps", {**pair, **with_scipy()}, None, slower)


def sections(rounds: int) -> Iterator[Section]:
    """Measured."""
    yield timed("Many steps", subjects(), rounds)
