"""Forward Euler in the ways in which people write it."""

from __future__ import annotations

import numpy as np

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


map_of_numbers = lambda q, v, h: (q + h * v, v - h * q)


def map_of_a_state(state, dt):
    q, v = state
    return np.array([q + dt * v, v - dt * q])


def map_of_a_list(state, dt):
    assert state.index(state[0]) >= 0  # as lists alone can
    return [state[0] + dt * state[1], state[1] - dt * state[0]]


map_with_the_time = lambda t, y, h: (t + h, np.array([y[0] + h * y[1], y[1] - h * y[0]]))
force_of_numbers = lambda force, q, v, h: (q + h * v, v + h * force(q))


def force_of_arrays(x, v, acceleration, dt):
    a = acceleration(x)
    assert a.shape == (1,)
    return np.stack([x + dt * v, v + dt * a])


force_and_time = lambda force, t, q, v, h: (q + h * v, v + h * force(q, v, t))
field = lambda f, t, y, h: y + h * f(t, y)
field_of_lists = lambda f, t, y, h: [a + h * b for a, b in zip(y, f(t, y), strict=True)] if y != 0 else []
field_with_the_time_back = lambda f, t, y, h: (t + h, y + h * f(t, y))
field_state_first = lambda f, y, t, h: y + h * f(y, t)
field_that_calls_the_other_way = lambda f, t, y, h: y + h * f(y, t)
field_without_time = lambda f, y, dt: y + dt * f(y)


def numbers_in_place(x, v, dt):
    x[:], v[:] = x + dt * v, v - dt * x


def state_in_place(y, dt):
    y[:] = [y[0] + dt * y[1], y[1] - dt * y[0]]


def list_in_place(y, dt):
    y.append(y[0] + dt * y[1])
    y.append(y[1] - dt * y[0])
    del y[:2]


def both(q, v, h):
    v0 = +v
    v -= h * q
    q += h * v0
    return q, v


generator = lambda q, v, h: (x for x in map_of_numbers(q, v, h))
ALL = {
    name: step for name, step in vars().items() if getattr(step, "__module__", "") == __name__ and step is not Tensor
}
