"""Fast loops over many steps: a method's program text run by Python, NumPy or numba, for one state or an ensemble.

All of them execute the same text and give the same bits: numba is not allowed to reassociate operations, or to fuse a
product and a sum into one. That holds for + - * / and square roots, which IEEE 754 defines; sin, cos, exp and log are
those of the library at hand: one for Python floats and compiled loops, another for arrays. Where Python raises, as in a
division by zero, compiled loops and arrays go on with infinities and NaN.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.number_field import Exact
from driftproof.methods.program_text import indented, maker, maker_text
from driftproof.methods.schemes import Method
from driftproof.methods.stepping import Source, step_source
from driftproof.methods.vector_fields import FUNCTIONS, FieldSource, VectorField, field_source
from driftproof.numeric.array_text import UFUNCS, array_run

# The force F(x) = -x as program text, {} standing for x.
OSCILLATOR = "(-{})"
FloatArray: TypeAlias = NDArray[np.floating[Any]]
# np.float16, float32, float64 or longdouble; Any, because for type checkers NumPy's types cannot be keys of a cache.
Format: TypeAlias = Any
# run(q, v, h, steps) -> (q, v)
Run: TypeAlias = Callable[[Any, Any, Any, int], tuple[Any, Any]]
# run(q, v, h, steps) overwrites the arrays q and v with the states after `steps` steps.
EnsembleRun: TypeAlias = Callable[[FloatArray, FloatArray, float, int], None]
# run(y, h, first, last) overwrites the array y with the states after steps first to last - 1.
FieldEnsembleRun: TypeAlias = Callable[[FloatArray, float, int, int], None]
# run(y, h, first, last) -> y after steps first to last - 1.
FieldRun: TypeAlias = Callable[[tuple[float, ...], float, int, int], tuple[float, ...]]

# How many states of an ensemble are stepped together. A compiled block stays in the fastest cache. In NumPy, where each
# operation is a pass over a block, the second cache holds the block and its stages, and a pass outweighs its call.
BLOCK, ARRAY_BLOCK = 512, 4096
# The number formats that compiled loops support.
COMPILED = (np.float32, np.float64)
OF_FLOATS = {name: getattr(math, name) for name in FUNCTIONS}
_ARRAY_FUNCTIONS = {name: getattr(np, name) for name in (*FUNCTIONS, *UFUNCS.values(), "negative", "copyto")}


@cache
def runner(method: Method, force: str = OSCILLATOR, *, compensated: bool = False) -> Run:
    """Return run(q, v, h, steps) of `method` in plain Python floats: `steps` steps of `stepping.stepper` in one loop.

    `force` is the text of F(x) with {} for x, of names, numbers, operators and `vector_fields.FUNCTIONS`. It is
    executed, so no user's text may get there. `compensated` carries along what additions to the state round off
    (bounded in `tests/witnesses/compensated.py`). A negative h runs back in time. Raises MethodError for implicit
    methods.
    """
    source = step_source(method, force, compensated=compensated)
    return program_function(source.run(), method.key, source.coefficients)


@cache
def compiled_runner(method: Method, force: str = OSCILLATOR, *, compensated: bool = False) -> Run:
    """Return the loop of `runner` compiled by numba: the same bits, at the processor's latency. Needs the extra `fast`.

    The first call compiles, which takes from half a second to some seconds; `compiled_runner(m)(0.0, 0.0, 0.0, 0)` does
    nothing else. Raises ImportError without numba.
    """
    return compiled_function(runner(method, force, compensated=compensated))


def ensemble_runner(method: Method, force: str = OSCILLATOR, *, compensated: bool = False) -> EnsembleRun:
    """Return run(q, v, h, steps) on arrays in NumPy. Each block of states takes all its steps while it is in the cache.

    q and v are one-dimensional, of one length and one format, in which everything is computed, h included. Overflow
    gives infinities, silently. Raises ValueError for other arrays, MethodError for an implicit method.
    """
    source = step_source(method, force, compensated=compensated)

    def run_blocks(q: FloatArray, v: FloatArray, h: float, steps: int) -> None:
        number = _format_of(q, v)
        (run, count), size = _array_run(source, number), number(h)
        buffers = np.empty((count, min(len(q), ARRAY_BLOCK)), number)
        with np.errstate(all="ignore"):
            for start in range(0, len(q), ARRAY_BLOCK):
                block = slice(start, start + ARRAY_BLOCK)
                buffers[:2] = 0  # what additions have lost, in a compensated run
                run(q[block], v[block], size, steps, buffers[:, : len(q[block])])

    return run_blocks


def compiled_ensemble_runner(method: Method, force: str = OSCILLATOR, *, compensated: bool = False) -> EnsembleRun:
    """Return the loop of `ensemble_runner` compiled by numba: its innermost loop runs over states and is vectorised.

    Needs the extra `fast`. Raises ValueError for formats other than binary32 and binary64.
    """
    source = step_source(method, force, compensated=compensated)

    def run_blocks(q: FloatArray, v: FloatArray, h: float, steps: int) -> None:
        number = _format_of(q, v)
        if number not in COMPILED:
            raise ValueError(f"compiled runs take float32 or float64, not {q.dtype}; use ensemble_runner")
        _compiled_blocks(source, number)(q, v, number(h), steps, 0, len(q))

    return run_blocks


def compiled_field_ensemble_runner(method: Method, field: VectorField, *, threads: int = 1) -> FieldEnsembleRun:
    """Return run(y, h, first, last) on many systems: y has a row for each component and a column for each system.

    y, of binary64, is overwritten with the states after steps first to last - 1, step i from t = i h, with the bits of
    `field_runner`. `threads` threads share the systems. Needs the extra `fast`. Raises ValueError for another y.
    """
    source = field_source(method, field)

    def run_blocks(y: FloatArray, h: float, first: int, last: int) -> None:
        demand_ensemble(y, len(source.components))
        run = _compiled_field_blocks(source)
        in_threads(lambda start, stop: run(y, h, first, last, start, stop), y.shape[1], threads, BLOCK)

    return run_blocks


def in_threads(run: Callable[[int, int], None], members: int, threads: int, block: int = 1) -> None:
    """Call run(start, stop) over all members, in up to `threads` parts of whole blocks; a single part runs here."""
    part = block * max(1, -(-members // (block * threads)))
    starts = range(0, members, part)
    if len(starts) < 2:
        run(0, members)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda start: run(start, min(start + part, members)), starts))


def demand_ensemble(y: FloatArray, rows: int) -> None:
    """Raise ValueError unless y consists of `rows` rows of float64, one after another in memory."""
    if y.ndim != 2 or len(y) != rows or y.dtype != np.float64 or not y.flags.c_contiguous:
        raise ValueError(f"y is {y.dtype}{list(y.shape)}; an ensemble is a C-contiguous float64 array with {rows} rows")


def array_field_runner(method: Method, field: VectorField, library: Any) -> FieldRun:
    """Return run(y, h, first, last) on a tuple of arrays of any library with the functions of the array API standard.

    It executes the text of `field_runner`, one operation at a time on whole arrays. In NumPy, torch and JAX the four
    operations have the same bits; if `jax.jit` fuses products into sums, results differ within the derived bound.
    """
    source = field_source(method, field)
    functions = {name: getattr(library, name) for name in FUNCTIONS}
    return program_function(source.run(), method.key, source.coefficients, functions)


@cache
def field_runner(method: Method, field: VectorField, *, compensated: bool = False) -> FieldRun:
    """Return run(y, h, first, last) of an explicit method for y' = f(t, y), in plain Python floats.

    y is a tuple: any state for a Runge-Kutta method; positions, then velocities, of a second-order system for a
    splitting or a Nyström method. Steps first to last - 1 are taken, step i from t = i h. Splitting a run changes no
    bit: run(run(y, h, 0, n), h, n, m) is run(y, h, 0, m), unless `compensated`, where what additions lost is forgotten
    in between. Raises MethodError as `field_source` does.
    """
    source = field_source(method, field, compensated=compensated)
    return program_function(source.run(), method.key, source.coefficients)


@cache
def compiled_field_runner(method: Method, field: VectorField, *, compensated: bool = False) -> FieldRun:
    """Return the loop of `field_runner` compiled by numba, with the same bits. Needs the extra `fast`."""
    return compiled_function(field_runner(method, field, compensated=compensated))


def lifted(c: Exact, number: Format) -> Any:
    """The coefficient c in the format `number`: the nearest double, rounded once more for a narrower format.

    A wider format adds the double nearest to the remainder, which gives c to 2⁻¹⁰⁶ relatively, and rounds the sum once.
    For binary64 the result is a Python float, which is faster in scalar arithmetic and gives the same bits with arrays.
    """
    nearest = float(c)
    if np.finfo(number).nmant <= np.finfo(np.float64).nmant:
        return nearest if number is np.float64 else number(nearest)
    return number(nearest) + number(float(c - Fraction(nearest)))


def program_function(
    text: str,
    key: str,
    coefficients: Iterable[tuple[str, Exact]],
    functions: Mapping[str, Any] = OF_FLOATS,
    number: Format = np.float64,
) -> Callable[..., Any]:
    """Build the function of a program text with its coefficients in the format `number`; see `maker`."""
    made: Callable[..., Any] = maker(text, key, functions)(*[lifted(c, number) for _, c in coefficients])
    return made


def _format_of(q: FloatArray, v: FloatArray) -> Format:
    """The common format. Raises ValueError unless both are one-dimensional float arrays of one length and format."""
    if q.shape != v.shape or q.ndim != 1 or q.dtype != v.dtype or not issubclass(q.dtype.type, np.floating):
        shown = f"{q.dtype}{list(q.shape)} and {v.dtype}{list(v.shape)}"
        raise ValueError(f"q and v are {shown}; both must be float vectors of the same length and type")
    return q.dtype.type


@cache
def _array_run(source: Source, number: Format) -> tuple[Callable[..., None], int]:
    text, buffers = array_run(source)
    return program_function(text, "ensemble", source.coefficients, _ARRAY_FUNCTIONS, number), buffers


@cache
def _compiled_blocks(source: Source, number: Format) -> Callable[..., Any]:
    text = _blocks_text(source)
    return compiled_function(program_function(text, "ensemble", source.coefficients, number=number))


def _blocks_text(source: Source) -> str:
    """The text of make(coefficients...) -> run(qs, vs, h, steps, begin, end), which steps members begin to end - 1."""
    arrays = {"q": ("qs", "q1"), "v": ("vs", "v1")}
    prepare = []
    if source.compensated:
        arrays |= {"e_q": ("lost_q", "e_q"), "e_v": ("lost_v", "e_v")}
        prepare = ["lost_q, lost_v = qs - qs, vs - vs"]
    lines = [*prepare, *_blocks_lines(arrays, ["for _ in range(steps):"], source.lines)]
    return maker_text(source.names, "run", ["def run(qs, vs, h, steps, begin_, end_):", *indented(lines)])


@cache
def _compiled_field_blocks(source: FieldSource) -> Callable[..., Any]:
    """Compile run(y, h, first, last, begin, end), which steps columns begin to end - 1 of y."""
    arrays = {name: (f"y[{k}]", f"{name}_new") for k, name in enumerate(source.components)}
    lines = _blocks_lines(arrays, ["for i in range(first, last):", *indented(["t = i * h"])], source.lines)
    names = [name for name, _ in source.coefficients]
    text = maker_text(names, "run", ["def run(y, h, first, last, begin_, end_):", *indented(lines)])
    return compiled_function(program_function(text, "ensemble", source.coefficients))


def _blocks_lines(arrays: Mapping[str, tuple[str, str]], steps: Sequence[str], lines: Iterable[str]) -> list[str]:
    """The lines of a loop over blocks, in it over steps, and in it over members, each of which is advanced by `lines`.

    `arrays` maps each variable in `lines` to its array and to the variable that holds its new value. The inner loop
    counts from zero over a slice: over part of the whole array it would not be vectorised.
    """
    stop = f"min(start_ + {BLOCK}, end_)"
    cut = [f"{x}_block = {array}[start_:{stop}]" for x, (array, _) in arrays.items()]
    read = [f"{x} = {x}_block[member_]" for x in arrays]
    write = [f"{x}_block[member_] = {end}" for x, (_, end) in arrays.items()]
    one = [f"for member_ in range(len({next(iter(arrays))}_block)):", *indented([*read, *lines, *write])]
    return [f"for start_ in range(begin_, end_, {BLOCK}):", *indented([*cut, *steps, *indented(one)])]


def compiled_function(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile the function by numba in its order of operations; 1/0 is infinite. Raises ImportError without numba."""
    try:
        from numba import njit
    except ImportError:
        raise ImportError("compiled runs need numba; install the extra: pip install 'driftproof[fast]'") from None
    compiled: Callable[..., Any] = njit(fastmath=False, error_model="numpy", nogil=True)(function)
    return compiled
