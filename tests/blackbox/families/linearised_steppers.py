"""Rosenbrock methods as people write them: with k or with stored u, with df/dt in each way; right ones, wrong twins."""

from __future__ import annotations

import numpy as np

from driftproof.methods.catalogue import FURTHER_METHODS


def floats(rows):
    return np.array([[float(x) for x in row] for row in rows])


def rosenbrock(key, *, time_slope="function", reuse=False, stored=False, at_end=False, estimate=(), **changed):
    """The step of a method of the catalogue; `changed` gives entries of gamma, alpha or b other values.

    With the weights eᵢ of an `estimate` it returns h Σ eᵢ kᵢ as well.
    """
    method = FURTHER_METHODS[key]
    alpha, gamma, b = floats(method.alpha), floats(method.gamma), floats([method.b])[0]
    for name, (place, value) in changed.items():
        {"alpha": alpha, "gamma": gamma, "b": b}[name][place] = value
    sums = gamma.sum(axis=1)

    def slopes_at(f, dfdt, t, y):
        if time_slope == "differences":
            return (f(t + 1e-8, y) - f(t, y)) / 1e-8
        if time_slope == "twice":
            return (f(t + 1e-8, y) - f(t, y)) / 5e-9
        return dfdt(t, y) if time_slope == "function" else 0 * y

    def stages(f, t, y, h):
        """f at the place of stage i, once for equal places where `reuse`."""
        known = {}

        def at(i, moved):
            place = tuple(alpha[i])
            if not reuse or place not in known:
                known[place] = np.asarray(f(t + alpha[i].sum() * h, y + moved))
            return known[place]

        return at

    def plain(f, jac, dfdt, t, y, h):
        slope, at, k = slopes_at(f, dfdt, t, y), stages(f, t, y, h), []
        matrix = np.asarray(jac(t + at_end * h, y))
        for i, row in enumerate(gamma):
            moved = h * sum((x * z for x, z in zip(alpha[i], k, strict=False)), 0 * y)
            push = at(i, moved) + h * sums[i] * slope
            push = push + h * matrix @ sum((x * z for x, z in zip(row, k, strict=False)), 0 * y)
            k.append(np.linalg.solve(np.eye(len(y)) - h * row[i] * matrix, push))
        y1, error = (h * sum(x * z for x, z in zip(row, k, strict=True)) for row in (b, estimate or 0 * b))
        return (y + y1, error) if estimate else y + y1

    def transformed(f, jac, dfdt, t, y, h):
        inverse, slope, at, u = np.linalg.inv(gamma), slopes_at(f, dfdt, t, y), stages(f, t, y, h), []
        system = np.eye(len(y)) / (h * gamma[0, 0]) - np.asarray(jac(t, y))
        for i, (row, c) in enumerate(zip(alpha @ inverse, -inverse, strict=True)):
            moved = sum((x * z for x, z in zip(row, u, strict=False)), 0 * y)
            push = at(i, moved) + h * sums[i] * slope
            u.append(np.linalg.solve(system, push + sum((x * z for x, z in zip(c, u, strict=False)), 0 * y) / h))
        return y + sum(x * z for x, z in zip(b @ inverse, u, strict=True))

    body = transformed if stored else plain
    if time_slope == "function":
        return lambda f, jac, dfdt, t, y, h: body(f, jac, dfdt, t, y, h)
    return lambda f, jac, t, y, h: body(f, jac, None, t, y, h)


def ros2_by_hand(y, f, jac, h, g=1 - 2**-0.5):
    """ROS2 as its paper has it, without times."""
    system = np.eye(len(y)) - g * h * jac(y)
    k1 = np.linalg.solve(system, f(y))
    k2 = np.linalg.solve(system, f(y + h * k1) - 2 * k1)
    return y + 3 / 2 * h * k1 + 1 / 2 * h * k2


def linearly_implicit_euler(f, jac, t, y, h):
    """One stage with the whole of h J: order 1, with any J."""
    return y + h * np.linalg.solve(np.eye(len(y)) - h * np.asarray(jac(t, y)), f(t, y))
