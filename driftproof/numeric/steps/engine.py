"""Fast loops over many steps: a method's program text run by Python, NumPy or numba, for one state or an ensemble.

All of them execute the same text and give the same bits: numba is not allowed to reassociate operations, or to fuse a
product and a sum into one. That holds for + - * / and square roots, which IEEE 754 defines; sin, cos, exp and log are
those of the library at hand: one for Python floats and compiled loops, another for arrays. Where Python raises, as in a
division by zero, compiled loops and arrays go on with infinities and NaN.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.formulas.vector_fields import FLOOR, FUNCTIONS, OF_DERIVATIVES, VectorField
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.explicit_steps import FieldSource, field_source
from driftproof.methods.programs.program_text import indented, maker, maker_text
from driftproof.methods.schemes import Method

FloatArray: TypeAlias = NDArray[np.floating[Any]]
# run(y, h, first, last) overwrites the array y with the states after steps first to last - 1.
EnsembleRun: TypeAlias = Callable[[FloatArray, float, int, int], None]
# run(y, h, first, last) -> y after steps first to last - 1.
Run: TypeAlias = Callable[[Sequence[float], float, int, int], tuple[float, ...]]

# How many states of an ensemble are stepped together: such a block stays in the fastest cache.
BLOCK = 512
FLOAT_FUNCTIONS = {"abs": abs} | {
    name: getattr(math, name) for name in (*FUNCTIONS, *OF_DERIVATIVES, FLOOR) if name != "abs"
}


def compiled_ensemble_runner(method: Method, field: VectorField) -> EnsembleRun:
    """Return run(y, h, first, last) on many systems: y has a row for each component and a column for each system.

    y, of binary64, is overwritten with the states after steps first to last - 1, step i from t = i h, with the bits of
    `runner`. Needs the extra `fast`. Raises ValueError for another y.
    """
    source = field_source(method, field)

    def run_blocks(y: FloatArray, h: float, first: int, last: int) -> None:
        require_ensemble(y, len(source.components))
        _compiled_blocks(source)(y, h, first, last)

    return run_blocks


def require_ensemble(y: FloatArray, rows: int) -> None:
    """Raise ValueError unless y consists of `rows` rows of float64, one after another in memory."""
    if y.ndim != 2 or len(y) != rows or y.dtype != np.float64 or not y.flags.c_contiguous:
        raise ValueError(f"y is {y.dtype}{list(y.shape)}; an ensemble is a C-contiguous float64 array with {rows} rows")


def array_runner(method: Method, field: VectorField) -> Run:
    """Return run(y, h, first, last) on a tuple of NumPy's arrays: the text of `runner`, one operation at a time."""
    source = field_source(method, field)
    return program_function(elementwise(source.run()), method.key, source.coefficients, functions_of(np))


def functions_of(library: Any) -> dict[str, Any]:
    """The functions that the text of `elementwise` may call, as a library has them."""
    return {name: getattr(library, name) for name in (*FUNCTIONS, FLOOR, "where")}


def elementwise(text: str) -> str:
    """The program text with each choice as where(test, one, other), which arrays have."""
    return ast.unparse(_Elementwise().visit(ast.parse(text))) if " if " in text else text


class _Elementwise(ast.NodeTransformer):
    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        self.generic_visit(node)
        return ast.Call(ast.Name("where", ast.Load()), [node.test, node.body, node.orelse], [])


@cache
def runner(method: Method, field: VectorField, *, compensated: bool = False) -> Run:
    """Return run(y, h, first, last) of an explicit method for y' = f(t, y), in plain Python floats.

    y is a tuple: any state for a Runge-Kutta method; positions, then velocities, of a second-order system for a
    splitting or a Nyström method. Steps first to last - 1 are taken, step i from t = i h. Splitting a run changes no
    bit: run(run(y, h, 0, n), h, n, m) is run(y, h, 0, m), unless `compensated`, where what additions lost is forgotten
    in between. Raises MethodError as `field_source` does.
    """
    source = field_source(method, field, compensated=compensated)
    return program_function(source.run(), method.key, source.coefficients)


@cache
def compiled_runner(method: Method, field: VectorField, *, compensated: bool = False) -> Run:
    """Return the loop of `runner` compiled by numba, with the same bits. Needs the extra `fast`."""
    return compiled_function(runner(method, field, compensated=compensated))


def program_function(
    text: str, key: str, coefficients: Iterable[tuple[str, Exact]], functions: Mapping[str, Any] = FLOAT_FUNCTIONS
) -> Callable[..., Any]:
    """Build the function of a program text with its coefficients as the nearest floats; see `maker`."""
    made: Callable[..., Any] = maker(text, key, functions)(*(float(c) for _, c in coefficients))
    return made


@cache
def _compiled_blocks(source: FieldSource) -> Callable[..., Any]:
    return compiled_function(program_function(_blocks_text(source), "ensemble", source.coefficients))


def _blocks_text(source: FieldSource) -> str:
    """The text of make(coefficients...) -> run(y, h, first, last), which steps every column.

    It loops over blocks of columns, in them over steps, and in these over the columns of the block. The inner loop
    counts from zero over a slice: over part of the whole array it would not be vectorised.
    """
    cut = [f"{name}_block = y[{k}][start_ : start_ + {BLOCK}]" for k, name in enumerate(source.components)]
    read = [f"{name} = {name}_block[member_]" for name in source.components]
    write = [f"{name}_block[member_] = {name}_new" for name in source.components]
    members = [f"for member_ in range(len({source.components[0]}_block)):", *indented([*read, *source.lines, *write])]
    steps = ["for i in range(first, last):", *indented(["t = i * h", *members])]
    blocks = [f"for start_ in range(0, len(y[0]), {BLOCK}):", *indented([*cut, *steps])]
    names = [name for name, _ in source.coefficients]
    return maker_text(names, "run", ["def run(y, h, first, last):", *indented(blocks)])


def compiled_function(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile the function by numba in its order of operations; 1/0 is infinite. Raises ImportError without numba."""
    try:
        from numba import njit
    except ImportError:
        raise ImportError("compiled runs need numba; install the extra: pip install 'driftproof[fast]'") from None
    compiled: Callable[..., Any] = njit(fastmath=False, error_model="numpy", nogil=True)(function)
    return compiled
