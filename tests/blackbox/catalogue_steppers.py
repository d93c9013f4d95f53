"""Steppers for the linear fit: the catalogue's, the exact step rounded once, and one with a coefficient changed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction as Q
from functools import cache

from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.runs import Entries


def float_subject(method: Method) -> ForeignStepper:
    """The method as a stepper of floats; of an implicit one, the exact step rounded once."""
    if not method.explicit:
        return opened(rounded_step(method))
    step = stepper(method, float)
    return opened(lambda force, q, v, h: step(force, q, v, h))


def rounded_step(method: Method) -> Callable[[float, float, float], tuple[float, float]]:
    """The exact step on the oscillator, each component rounded once."""
    matrix = oscillator_matrix(method)

    @cache
    def at(h: float) -> Entries:
        qq, qv, vq, vv = (exact(entry(scalar(Q(h)))) for row in matrix for entry in row)
        return qq, qv, vq, vv

    def step(q: float, v: float, h: float, k: int = 1) -> tuple[float, float]:
        qq, qv, vq, vv = at(h)
        return float(qq * Q(q) + qv * Q(v)), float(vq * Q(q) + vv * Q(v))

    return step


def with_one_changed(method: Method, change: Callable[[Exact], Exact]) -> Method:
    """The method with one coefficient changed: the first, from the middle on, that its one-step matrix depends on."""
    places = list(_places(method))
    middle = len(places) // 2
    for place in (*places[middle:], *places[:middle]):
        other = _changed(method, place, change)
        if oscillator_matrix(other) != oscillator_matrix(method):
            return other
    raise AssertionError(f"{method.key} depends on none of its coefficients")


def _places(method: Method) -> Iterator[tuple[str, tuple[int, ...]]]:
    names = {
        Collocation: ("node_polynomial",), Splitting: ("parts",), RungeKutta: ("a", "b"),
        Nystrom: ("a", "c", "b_position", "b_velocity"),
    }  # fmt: skip
    for name in names[type(method)]:
        for i, row in enumerate(getattr(method, name)):
            if name == "a":
                yield from (("a", (i, j)) for j, c in enumerate(row) if c != 0)
            elif row not in (0, ("kick", 0), ("drift", 0)):
                yield name, (i,)


def _changed(method: Method, place: tuple[str, tuple[int, ...]], change: Callable[[Exact], Exact]) -> Method:
    name, (i, *rest) = place
    values = list(getattr(method, name))
    if name == "parts":
        values[i] = (values[i][0], change(values[i][1]))
    elif rest:
        row = list(values[i])
        row[rest[0]] = change(row[rest[0]])
        values[i] = tuple(row)
    else:
        values[i] = change(values[i])
    return replace(method, key="changed", **{name: tuple(values)})
