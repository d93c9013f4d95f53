"""Numbers go in and come out as floats, lists, arrays and other people's arrays, each by its adapter."""

import numpy as np
import pytest

from driftproof.blackbox.stepper.array_adapters import ARRAYS, LISTS, SCALARS
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64

STATE, H = (1.0, 0.75), 0.25


EULER = (1.1875, 0.5)


class Tensor:
    """As much of somebody's array type as a stepper and a reader touch; it records a gradient, and says so."""

    dtype = "torch.float32"

    def __init__(self, data):
        self.data = np.array(data, dtype=np.float32)

    def __mul__(self, other):
        return Tensor(self.data * getattr(other, "data", other))

    def __add__(self, other):
        return Tensor(self.data + getattr(other, "data", other))

    __rmul__, __radd__ = __mul__, __add__

    def __iadd__(self, other):
        self.data += getattr(other, "data", other)
        return self

    def __neg__(self):
        return Tensor(-self.data)

    def __getitem__(self, place):
        return Tensor(self.data[place])

    def __bool__(self):
        raise RuntimeError("the truth of a tensor is ambiguous")

    def __eq__(self, other):
        return Tensor(self.data == other.data)

    __hash__ = None

    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("can't call numpy() on a tensor that requires grad; use detach()")

    def clone(self):
        return Tensor(self.data)

    def detach(self):
        return self.data

    def size(self):
        return self.data.shape


def map_of_numbers(q, v, h):
    return q + h * v, v - h * q


def map_of_a_state(state, dt):
    q, v = state
    return np.array([q + dt * v, v - dt * q])


def map_of_a_list(state, dt):
    assert state.index(state[0]) >= 0  # as lists alone can
    return [state[0] + dt * state[1], state[1] - dt * state[0]]


def force_of_numbers(force, q, v, h):
    return q + h * v, v + h * force(q)


def force_of_arrays(x, v, acceleration, dt):
    a = acceleration(x)
    assert a.shape == (1,)
    return np.stack([x + dt * v, v + dt * a])


def field(f, t, y, h):
    return y + h * f(t, y)


@pytest.mark.parametrize(
    ("step", "adapter"),
    [(map_of_numbers, SCALARS), (map_of_a_state, ARRAYS), (map_of_a_list, LISTS), (force_of_arrays, ARRAYS)],
)
def test_the_adapter_is_the_first_in_which_it_answers(step, adapter):
    assert opened(step).adapter is adapter


def map_of_a_tensor(y, dt):
    return y + dt * Tensor([y.data[1], -y.data[0]])


@pytest.mark.parametrize(
    "step",
    [lambda q, v, h: (q + h * v, v + h * -q), force_of_numbers, field, map_of_a_tensor],
    ids=lambda f: f.__name__,
)
def test_other_peoples_arrays_are_written_and_read(step):
    subject = opened(step, array=Tensor)
    assert subject.step(*STATE, H) == EULER
    assert subject.format is BINARY32
    assert subject.log.types == {"torch.float32"}
    assert not subject.log.changes_its_arguments


def test_a_tensor_changed_in_place_is_seen():
    def in_place(y, dt):
        y += dt * Tensor([y.data[1], -y.data[0]])

    subject = opened(in_place, array=Tensor)
    assert subject.step(*STATE, H) == EULER
    assert subject.log.works_in_place


def test_a_tensor_beside_the_time_is_read():
    subject = opened(lambda t, y, h: (t + h, map_of_a_tensor(y, h)), array=Tensor)
    assert subject.step(*STATE, H) == EULER


@pytest.mark.parametrize(
    ("array", "fmt"), [(np.float64, BINARY64), (np.float32, BINARY32), (np.float16, BINARY16)], ids=str
)
def test_the_format_is_that_of_the_answer(array, fmt):
    assert opened(map_of_numbers, array=array).format is fmt
    assert opened(field, array=array).format is fmt
