"""Small adaptive solvers, right as they stand, and each with one thing wrong where a switch says so."""

from __future__ import annotations

from collections import namedtuple
from math import isfinite

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from tests.plain_algebra import product

Answer = namedtuple("Answer", "t y success message")


def of_scipy(method, **options):
    """SciPy's solver, which takes no rtol much below 1e-13."""
    solve = pytest.importorskip("scipy.integrate").solve_ivp
    return lambda f, t_span, y0, rtol, atol: solve(f, t_span, y0, method, rtol=max(rtol, 1e-13), atol=atol, **options)


def adaptive(
    key="bogacki_shampine32",
    *,
    safety=0.8,
    exponent=1 / 3,
    memory=0.0,
    filtered=0.0,
    least=0.25,
    most=4.0,
    estimate=lambda e: e,
    stale=False,
    carried=-1,
    clock=float,
    ending="cut",
    on_nan="fail",
    tolerances=lambda rtol, atol: (rtol, atol),
    grows_after_rejection=False,
    changed=lambda factor, rejections: factor,
    growth_at_zero=None,
    first_step=1e-3,
    shortest=0.0,
    stepped=lambda h: h,
    norm=np.max,
    accepted=1.0,
    size=abs,
    first_error=1.0,
    longest=float("inf"),
    per_unit=False,
    plain_after_rejection=None,
    chooses_first_step=False,
    raises=False,
    state=lambda stage, y, moved: moved,
):
    """The solver of a pair whose last stage is the first of the next step, with a controller of that law.

    Wrong: `stale`, k1 after a rejection is the last slope of the rejected attempt; `carried`, which slope it is after a
    step; `clock`, another number format of t;
    `ending` "beyond" or "tiny"; `on_nan` "silent" or "retry"; `growth_at_zero` of an estimate that is 0;
    `stepped`, the length by which t advances; `changed`, the factor after so many rejections in a row; `norm` of the
    errors; `accepted`, the largest error of a step that is taken; `size` of the numbers in the scale of errors.
    `shortest`, the length of a step that is taken whatever its error; `state` is where a stage is evaluated.
    `first_error` is the one that the first step remembers. With `per_unit` the estimate is divided by h.
    `plain_after_rejection` is the exponent, without memory, after a rejected step; `chooses_first_step` asks for one
    slope first, a little later than the start; `raises` where the step size is too small.
    """
    pair = METHODS[key] if isinstance(key, str) else key
    a, c = [[float(x) for x in row] for row in pair.a], [float(x) for x in pair.c]
    b = np.array([*map(float, pair.b)])
    e = np.array(estimate([float(x - y) for x, y in zip(pair.b, pair.b_embedded, strict=True)]))
    first_same_as_last = c[-1] == 1 and a[-1] == [*b]

    def solve(f, t_span, y0, rtol, atol):
        rtol, atol = tolerances(rtol, atol)
        sign = 1.0 if t_span[1] > t_span[0] else -1.0
        t, end, y = clock(t_span[0]), clock(t_span[1]), np.array(y0, dtype=float)
        times, states, h, before, rejections, failure = (
            [float(t)], [y], sign * first_step, (first_error, sign * first_step), 0, "",
        )  # fmt: skip
        first = f(float(t), y)
        if chooses_first_step:
            f(float(t) + sign * first_step / 100, y + sign * first_step / 100 * first)
        while sign * (end - t) > 0:
            if sign * (t + h - end) > 0 and ending != "beyond":
                h = float(end - t)
            k = [first]
            for i in range(1, len(c)):
                moved = y + h * sum(a[i][j] * k[j] for j in range(i))
                k.append(f(float(t) + c[i] * h, state(i, y, moved)))
            y1 = y + h * product(b, k)
            scale = atol + rtol * np.maximum(size(y), size(y1))
            r = float(norm(abs((sign if per_unit else h) * product(e, k)) / scale))
            if not isfinite(r):
                if on_nan == "fail":
                    failure = "the error is not finite"
                    break
                if on_nan == "silent":
                    break
                r = 1e9
            if r == 0.0:
                factor = most if growth_at_zero is None else growth_at_zero
            else:
                remembered = before[0] ** memory * (h / before[1]) ** filtered
                factor = min(most, max(least, safety * r**-exponent * remembered))
            if r > accepted and plain_after_rejection:
                factor = max(least, safety * r**-plain_after_rejection)
            factor = changed(factor, rejections + (r > accepted))
            if r <= accepted or abs(h) <= shortest:
                t, y, before = clock(t + stepped(h)), y1, (max(r, 1e-4), h)
                first = k[carried] if first_same_as_last else f(float(t), y)
                factor = min(1.0, factor) if rejections and not grows_after_rejection else factor
                rejections = 0
                times.append(float(t))
                states.append(y)
            else:
                rejections, first = rejections + 1, k[-1] if stale else first
                if abs(h) < 1e-13 and on_nan != "retry":
                    failure = "the step size is too small"
                    if raises:
                        raise ArithmeticError(failure)
                    break
            h = sign * min(max(abs(h * factor), shortest), longest)
            if ending != "beyond" and sign * (t + h - end) > 0 and abs(float(end - t)) > 0:
                h = float(end - t)
        if ending == "tiny":
            times.append(float(end) + 1e-15 * 1024)
            states.append(y)
        return Answer(np.array(times), np.array(states), not failure, failure)

    return solve


def fixed(steps=100, *, extra=0, clock=float, order="heun", ratio=1.0):
    """Heun's method, or Euler's, with so many steps of one length; with `extra` ones beyond the end.

    With another `ratio`, every second step is so much longer.
    """

    def solve(f, t_span, y0, rtol, atol):
        average, t, y = clock((t_span[1] - t_span[0]) / steps), clock(t_span[0]), np.array(y0, dtype=float)
        times, states = [float(t)], [y]
        for n in range(steps + extra):
            h = average * (ratio if n % 2 else 1)
            slope = f(float(t), y)
            slope = slope if order == "euler" else (slope + f(float(t + h), y + float(h) * slope)) / 2
            t, y = t + h, y + float(h) * slope
            times.append(float(t))
            states.append(y)
        return times, states

    return solve


def run(make, f, t_span, y0, steps):
    """Steps of one length of a stepper that is made for this run."""
    step, h, states = make(), (t_span[1] - t_span[0]) / steps, [np.array(y0)]
    times = [t_span[0] + n * h for n in range(steps + 1)]
    for t in times[:-1]:
        states.append(step(f, t, states[-1], h))
    return times, states


def in_steps_of_h(ending):
    """The midpoint rule in steps of h; `ending` is what it does where h does not divide the span."""
    memory = []

    def grid(start, end, h):
        steps = (end - start) / h
        if ending == "refused" and abs(steps - round(steps)) > 1e-9:
            raise ValueError("h does not divide the span")
        counts = {"divided anew": np.ceil(steps), "stretched": round(steps), "truncated": int(steps), "deaf": 100}
        if (count := counts.get(ending)) is not None:
            h = h if ending in ("stretched", "truncated") else (end - start) / count
            return [(start + n * h, h) for n in range(int(count))]
        whole = int(steps * (1 + 1e-12))
        begun = [(start + n * h, h) for n in range(whole)]
        left = end - (start + whole * h)
        if left < 1e-9:
            return begun
        return [*begun, (start + whole * h, left if ending in ("cut", "cut late", "cut, with memory") else h)]

    def solve(f, t_span, y0, h):
        times, states = [t_span[0]], [np.array(y0, dtype=float)]
        memory.clear()
        for t, step in grid(*t_span, h):
            first, inner = f(t, states[-1]), h if ending == "cut late" else step
            slope = f(t + inner / 2, states[-1] + inner / 2 * first)
            if ending == "cut, with memory" and memory:
                slope = 1.5 * first - 0.5 * memory[-1]
            memory.append(first)
            times.append(t + step)
            states.append(states[-1] + step * slope)
        if ending in ("stretched", "relabelled"):
            times = [*np.linspace(*t_span, len(times))] if ending == "stretched" else [*times[:-1], t_span[1]]
        return times, states

    return solve


def refusing(refused, words):
    """A solver that gives up at once, and says so, where `refused(t_span, y0, rtol)`."""

    def solve(f, t_span, y0, rtol, atol):
        if refused(t_span, y0, rtol):
            return Answer(np.array(t_span[:1]), np.array([y0]), False, words)
        return adaptive()(f, t_span, y0, rtol, atol)

    return solve
