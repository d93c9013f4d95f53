"""Python right-hand sides inside compiled JAX code, in double precision: called back, one after the other, in order."""

from __future__ import annotations


def jax64():
    """JAX, told to keep double precision."""
    import jax

    jax.config.update("jax_enable_x64", True)
    return jax


class Callback:
    """A function of floats that compiled code calls; it is set anew at each step, so that nothing compiles again."""

    def __init__(self):
        """Nothing to call yet."""
        self.function = None

    def __call__(self, *arguments):
        """The answer, of the shape and type of the last argument."""
        jax = jax64()
        from jax.experimental import io_callback

        last = jax.numpy.asarray(arguments[-1])
        return io_callback(self._answer, jax.ShapeDtypeStruct(last.shape, last.dtype), *arguments, ordered=True)

    def _answer(self, *arguments):
        import numpy as np

        plain = [np.asarray(x).item() if np.ndim(x) == 0 else np.asarray(x) for x in arguments]
        return np.asarray(self.function(*plain), dtype=np.float64).reshape(np.shape(arguments[-1]))


def _compiled(make):
    """A call of what `make` builds of a callback, compiled once; its first argument is the function called back."""
    callback, compiled = Callback(), []

    def call(function, *arguments):
        if not compiled:
            compiled.append(jax64().jit(make(callback)))
        callback.function = function
        return compiled[0](*arguments)

    return call


def field_step(make):
    """The step `f, t, y, h` of a compiled one; `make(f)` builds `(t, y, h) -> y1` in JAX, once."""
    call = _compiled(make)

    def step(f, t, y, h):
        import numpy as np

        return np.array(call(f, float(t), np.asarray(y, dtype=np.float64), float(h)))

    return step


def force_step(make):
    """The step `force, q, v, h` of a compiled one; `make(force)` builds `(q, v, h) -> (q1, v1)` in JAX, once."""
    call = _compiled(make)

    def step(force, q, v, h):
        q1, v1 = call(force, float(q), float(v), float(h))
        return float(q1), float(v1)

    return step


def map_step(make):
    """The step `q, v, h` of a compiled one; `make()` builds `(q, v, h) -> (q1, v1)` in JAX, once."""
    step_of_force = force_step(lambda _: make())

    def step(q, v, h):
        return step_of_force(None, q, v, h)

    return step


def potential_of(force):
    """A function whose derivative is minus the force, for codes that differentiate a potential; its value is 0."""
    jax = jax64()

    @jax.custom_vjp
    def potential(q):
        return jax.numpy.zeros((), dtype=jax.numpy.float64)

    potential.defvjp(lambda q: (potential(q), force(q)), lambda f, outer: (-outer * f,))
    return potential
