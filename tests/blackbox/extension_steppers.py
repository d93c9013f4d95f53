"""Steps (f, t, y, h) -> (y1, dense) with the catalogue's continuous extensions, as they are and spoiled."""

from __future__ import annotations

from driftproof.methods.catalogue import EXTENSIONS


def extension_step(key, *, weights=lambda rows: rows, of_time=False, extension=None):
    """The step whose dense output is a function of theta, or of the time; `weights` may spoil its rows of powers."""
    table = extension or EXTENSIONS[key]
    a, c = [[float(x) for x in row] for row in table.a], [float(x) for x in table.c]
    b, rows = [float(x) for x in table.method.b], weights([[float(x) for x in row] for row in table.weights])

    def step(f, t, y, h):
        k = []
        for i, node in enumerate(c):
            k.append(f(t + node * h, y + h * sum((a[i][j] * k[j] for j in range(i)), 0 * y)))

        def dense(place):
            theta = (place - t) / h if of_time else place
            powers = [sum(x * theta**n for n, x in enumerate(row)) for row in rows]
            return y + h * sum((x * slope for x, slope in zip(powers, k, strict=True)), 0 * y)

        return y + h * sum((x * slope for x, slope in zip(b, k, strict=False)), 0 * y), dense

    return step


def first_and_last_exchanged(rows):
    """k1 is overwritten by the last slope before the dense output is used: a stage moved too early."""
    return [[0.0] * len(rows[0]), *rows[1:-1], [x + y for x, y in zip(rows[0], rows[-1], strict=True)]]


def but_the_last(change):
    """The last stage's weight is another one."""
    return lambda rows: [*rows[:-1], change(rows[-1])]
