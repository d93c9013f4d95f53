"""Python functions inside compiled JAX code: called back, one after the other, in the order of the program."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np


class CompiledCallback:
    """A function that compiled code calls. It is one object, whatever it calls at present: nothing compiles again.

    A step that is compiled with its right-hand side as a static argument, `jax.jit(step, static_argnums=0)`, is
    compiled for each new one; and its calls of it hold no numbers, but names of numbers, which no function of ours
    understands.
    """

    def __init__(self) -> None:
        """Nothing to call yet."""
        self.function: Callable[..., Any] | None = None

    def calling(self, function: Callable[..., Any]) -> CompiledCallback:
        """This object, which calls the function from now on."""
        self.function = function
        return self

    def __call__(self, *arguments: Any) -> Any:
        """What the function answers, in the shape and the type of the largest of the arguments: the state."""
        jax: Any = import_module("jax")
        callbacks: Any = import_module("jax.experimental")
        state = max(map(jax.numpy.asarray, arguments), key=lambda array: array.size)
        shape = jax.ShapeDtypeStruct(state.shape, jax.numpy.result_type(state, jax.numpy.float32))
        return callbacks.io_callback(lambda *given: self._answer(shape, *given), shape, *arguments, ordered=True)

    def _answer(self, shape: Any, *arguments: Any) -> np.ndarray[Any, Any]:
        assert self.function is not None
        plain = [np.asarray(x).item() if np.ndim(x) == 0 else np.asarray(x) for x in arguments]
        return np.asarray(self.function(*plain), dtype=shape.dtype).reshape(shape.shape)
