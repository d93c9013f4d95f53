"""A function inside compiled code, seen without JAX by a stand-in of what it calls."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.blackbox.stepper.jax_callbacks import CompiledCallback


@pytest.fixture
def numpy_for_jax(monkeypatch):
    """JAX with NumPy's arrays, which calls back at once."""
    fake = SimpleNamespace(numpy=np, ShapeDtypeStruct=lambda shape, dtype: SimpleNamespace(shape=shape, dtype=dtype))
    called = SimpleNamespace(io_callback=lambda function, shape, *given, ordered: function(*given))
    monkeypatch.setitem(sys.modules, "jax", fake)
    monkeypatch.setitem(sys.modules, "jax.experimental", called)


@pytest.mark.usefixtures("numpy_for_jax")
def test_it_answers_in_the_shape_and_type_of_the_state_wherever_that_stands():
    callback = CompiledCallback()
    field = callback.calling(lambda *given: [2 * x for x in max(given, key=np.size)])
    assert field is callback
    for arguments in ((0.5, np.array([1.0, 2.0])), (np.array([1.0, 2.0]), 0.5)):
        assert field(*arguments).tolist() == [2.0, 4.0]
    assert field(np.array([1.0], np.float32)).dtype == np.float32
    assert callback.calling(lambda t, y: [y])(0.5, 3.0).shape == ()
