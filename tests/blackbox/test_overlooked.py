"""Mistakes that once passed, misled or were blamed on right code, each beside its right twin."""

import ctypes
import itertools
import re
import warnings
from dataclasses import dataclass

import numpy as np
import pytest

from driftproof import Allowance, Domain, assert_verified, field_stepper_of, identify, verify
from tests.blackbox.families.remembering_steppers import Remembering
from tests.blackbox.families.split_steppers import imex
from tests.blackbox.handwritten_steppers import euler, rk4
from tests.blackbox.implicit_steppers import all_at_once, fixed_point, table


@dataclass
class Clock:
    t: float
    q: float
    v: float


def kick_and_drift(x, v, dt, force):
    v = v + dt * force
    return x + dt * v, v


def spring(force_of=lambda x, k, m: k / m * x):
    return lambda x, v, dt, k, m: kick_and_drift(x, v, dt, -force_of(x, k, m))


def verlet(force_of=lambda force, m: force / m, ended=lambda v, x: v):
    def step(force, x, v, m, dt):
        v = v + dt / 2 * force_of(force(x), m)
        x = x + dt * v
        return x, ended(v + dt / 2 * force(x) / m, x)

    return step


def heavy(masses_of):
    return lambda force, x, v, masses, dt: verlet()(force, x, v, masses_of(np.asarray(masses), x), dt)


def kicked(change):
    """Velocity Verlet, whose velocities are changed at its end."""
    return lambda acc, x, v, dt: verlet(ended=change)(acc, x, v, 1.0, dt)


def heun(slope_of=lambda slope: slope, length=lambda h: h, ended=lambda end, y: end, at=lambda t: t):
    """Heun's method, of changed slopes in steps of another length, asked at other times; its end is changed."""

    def step(f, t, y, h):
        slope, h = slope_of(f(at(t), y)), length(h)
        return ended(y + h / 2 * (slope + slope_of(f(at(t) + h, y + h * slope))), y)

    return step


def on_times(intervals):
    def step(f, y0, t):
        rows = [np.array(y0)]
        for at, h in zip(t[:-1], intervals(t), strict=True):
            rows.append(heun()(f, at, rows[-1], h))
        return np.array(rows)

    return step


def later(place):
    def step(x0, v0, dt, n_steps):
        xs, vs = [x0], [v0]
        for _ in range(n_steps):
            vs.append(vs[-1] - dt * xs[place(len(xs))])
            xs.append(xs[-1] + dt * vs[-1])
        return xs, vs

    return step


def end_of(run):
    def step(x0, v0, dt, n_steps):
        xs, vs = run(x0, v0, dt, n_steps)
        return xs[-1], vs[-1]

    return step


def timed(ahead):
    return lambda f, t, y, h: (t + ahead * h, heun()(f, t, y, h))


def record(ahead):
    def step(state: Clock, h: float) -> Clock:
        return Clock(state.t + ahead * h, state.q + h * state.v, state.v - h * state.q)

    return step


def weighted(sixth):
    def step(force, q, v, h):
        a = force(q)
        b = force(q + h / 2 * v + h * h / 8 * a)
        c = force(q + h * v + h * h / 2 * b)
        return q + h * v + h * h * (sixth * (a + 2 * b)), v + h * (sixth * (a + 4 * b + c))

    return step


def cast(form):
    return lambda q, v, h: (q + h * float(form(v - h * q)), form(v - h * q))


def called(turn):
    """Heun's method, or Euler's in the calls of these numbers."""
    count = itertools.count(1)
    return lambda f, t, y, h: y + h * f(t, y) if turn(next(count)) else heun()(f, t, y, h)


def nearly(apart, kept=None):
    def length(h):
        nonlocal kept
        kept = kept if kept is not None and abs(h - kept) <= apart * abs(h) else h
        return kept

    return length


def rows(of_row):
    return lambda states, dt: np.stack(kick_and_drift(*states.T, dt, -of_row(states[:, 0])), axis=1)


def out_of(written):
    def step(f, t, y, n, h, out):
        k = np.empty(n)
        f(t, y, k)
        written(out, y + h * k)

    return step


def held(stiffness):
    def step(state, dt):
        v = state["v"] - dt * stiffness(state) * state["x"]
        return {**state, "v": v, "x": state["x"] + dt * v}

    return step


def pushed(before):
    def step(bodies, force, dt):
        for body in bodies:
            body.acc = before(body) + force(body, bodies) / body.mass
        for body in bodies:
            body.vel = body.vel + dt * body.acc
            body.pos = body.pos + dt * body.vel

    return step


def in_place(kept):
    def step(n, x, v, a, dt):
        for i in range(n):
            x[i] += dt * v[i] + dt * dt / 2 * a[i]
            v[i] += dt / 2 * (a[i] - x[i])
            a[i] = kept(a[i], -x[i])

    return step


def leap(last):
    def step(acc, x, v, dt, n):
        for i in range(n):
            v += dt / 2 * acc(x)
            x += dt * v
            v += dt / 2 * acc(x) if last or i < n - 1 else 0 * x

    return step


def split(turn):
    return lambda f_explicit, f_implicit, t, y, h: imex("ars222")(*turn(f_explicit, f_implicit), t, y, h)


def ros2(share):
    def step(f, jac, dfdt, t, y, h):
        gamma = 1 - 2**-0.5
        system, slope = np.eye(len(y)) - gamma * h * np.asarray(jac(t, y)), share(h) * gamma * np.asarray(dfdt(t, y))
        k1 = np.linalg.solve(system, np.asarray(f(t, y)) + slope)
        k2 = np.linalg.solve(system, np.asarray(f(t + h, y + h * k1)) - 2 * k1 - slope)
        return y + 3 / 2 * h * k1 + h / 2 * k2

    return step


def sampled(kick):
    def step(grad_U, q, p, eps, L):
        for _ in range(L):
            p = p - eps / 2 * grad_U(q)
            q = q + eps * p
            p = p - kick * eps * grad_U(q)
        return q, p

    return step


def on_equal_steps(most):
    """Heun's method; Adams' of two steps after so many equal steps."""
    before = []

    def step(f, t, y, h):
        if not before or before[-1][:2] != (t, h):
            before.clear()
        slope, end = f(t, y), heun()(f, t, y, h)
        if len(before) > most:
            end = y + h * (1.5 * slope - 0.5 * before[-1][2])
        before.append((t + h, h, slope))
        return end

    return step


@dataclass
class Particle:
    x: float
    v: float
    t: float = 0.0
    m: float = 1.0


def particle(ended):
    def step(p: Particle, dt: float) -> Particle:
        return ended(p, *kick_and_drift(p.x, p.v, dt, -p.x / p.m), dt)

    return step


def remembered(new):
    """Velocity Verlet of a dict, which finds its acceleration there from the second step on."""

    def step(state, dt):
        v = state["v"] + dt / 2 * state.get("a", -state["x"])
        x = state["x"] + dt * v
        return {"x": x, "v": v - dt / 2 * x, "a": new(state["x"], x)}

    return step


def handed_on(last):
    """Nyström's method, which hands on its last force, or that at its end."""

    def step(force, q, v, a, h):
        b = force(q + h / 2 * v + h * h / 8 * a)
        c = force(q + h * v + h * h / 2 * b)
        end = q + h * v + h * h * (a + 2 * b) / 6
        return end, v + h * (a + 4 * b + c) / 6, c if last else force(end)

    return step


def estimated(late):
    def step(f, t, y, h):
        k1 = f(t, y)
        k2 = f(t + h / 2, y + h / 2 * k1)
        k3 = f(t + 3 * h / 4, y + 3 * h / 4 * k2)
        end = y + h * (2 * k1 + 3 * k2 + 4 * k3) / 9
        k4 = f(t + late * h, end)
        return end, h * (-5 / 72 * k1 + k2 / 12 + k3 / 9 - k4 / 8)

    return step


class Advancing:
    def __init__(self, f, share):
        self.f, self.share, self.t, self.y = f, share, 0.0, None

    def step(self, h):
        self.y, self.t = self.y + h * self.f(self.t, self.y), self.t + self.share * h


def advancing(share):
    return field_stepper_of(lambda f: Advancing(f, share), state="y", time="t")


def of_rows(change):
    def step(f, t, y, h):
        rows, _ = y.shape
        return change(y + h * f(t, y), rows, y)

    return step


def springs(change):
    return lambda x, v, dt: spring(lambda x, k, m: change(np.array(x, float)))(x, v, dt, 1.0, 1.0)


def scaling(slope_of):
    def step(f, t, y, h):
        slope = slope_of(f(t, y))
        slope *= h
        return y + slope

    return step


def in_memory(state):
    """Forward Euler from the numbers that lie in memory from where the state begins."""

    def step(f, t, y, h):
        y = state(y)
        y = np.array((ctypes.c_double * y.size).from_address(y.ctypes.data)).reshape(y.shape)
        return y + h * f(t, y)

    return step


def of_objects(known):
    """Forward Euler from the numbers of a state, which are read again unless it is known."""
    kept = []

    def step(f, t, y, h):
        if not (kept and known(*kept, y)):
            kept[:] = y, np.array(y)
        return kept[1] + h * f(t, kept[1])

    return step


def moving(moves):
    """Heun's method, unless nothing seems to move."""
    return lambda f, t, y, h: heun()(f, t, y, h) if np.any(moves(f(t, y))) else y


def stopping(stops, moved=0.0):
    """Heun's method, unless its second slope is of no size."""

    def step(f, t, y, h):
        k = f(t, y)
        k2 = f(t + h, y + h * k)
        return y + moved * h * k if stops(k2) else y + h / 2 * (k + k2)

    return step


def pushed_twice(stops):
    """Velocity Verlet, unless its second force is of no size."""

    def step(force, x, v, dt):
        a = force(x)
        x = x + dt * v + dt**2 / 2 * a
        b = force(x)
        return x, v if stops(b) else v + dt / 2 * (a + b)

    return step


def pulled(near):
    """Velocity Verlet, which begins with the acceleration at the end of the step before if x is near to that end."""
    kept = []

    def step(force, x, v, dt):
        goes_on = kept and np.shape(kept[0]) == np.shape(x) and near(kept[0], x)
        v = v + dt / 2 * (kept[1] if goes_on else force(x))
        x = x + dt * v
        kept[:] = np.copy(x), force(x)
        return x, v + dt / 2 * kept[1]

    return step


def sprung(near):
    step = pulled(near)
    return lambda x, v, dt: step(np.negative, x, v, dt)


def resisted(change):
    return lambda force, x, v, dt: kick_and_drift(x, v, dt, force(x, change(v)))


RUN = later(lambda n: n - 1)
FORWARD, COARSE = "forward_euler", lambda x, y: np.allclose(x, y, rtol=1e-11, atol=0)
STILL, MOVES = (lambda slope: not np.any(slope)), lambda slope: False
EULER, VERLET, FIRST = "symplectic_euler", "velocity_verlet", "its first step ended at"
WRONG = [
    (spring(lambda x, k, m: x / m), spring(), "symplectic_euler", "not for all parameters: with m = 2, k = 8"),
    (heavy(lambda m, x: m), heavy(lambda m, x: m[:, None] if x.ndim > 1 else m), VERLET, "9 positions of unequal"),
    (heavy(lambda m, x: m.mean()), heavy(lambda m, x: (m * x.T**0).T), "velocity_verlet", "q[0], q[2], v[0], v[2]"),
    (on_times(lambda t: [t[1] - t[0]] * (len(t) - 1)), on_times(np.diff), "heun2", "times of its grid are unequally"),
    (later(lambda n: max(n - 2, 0)), RUN, "symplectic_euler", "for its first step only"),
    (end_of(later(lambda n: max(n - 2, 0))), end_of(RUN), "symplectic_euler", "for its first step only"),
    (timed(0.5), timed(1), "heun2", "known method: it returns the time t + 0.125 with the state at its end, t + 0.25"),
    (record(2), record(1), "forward_euler", "it returns the time t + 0.5 with the state at its end, t + 0.25"),
    (weighted(np.float32(1 / 6)), weighted(1 / 6), "nystrom4", "is not nystrom4"),
    (cast(np.float32), cast(np.float64), "symplectic_euler", "the simplest step beyond the bound"),
    (called(lambda n: n == 1), called(lambda n: False), "heun2", f"is heun2, but not in every call: {FIRST}"),
    (called(lambda n: n > 150), heun(), "heun2", f"is heun2, but not in every call: {FIRST}"),
    (called(lambda n: n % 10 == 0), heun(), "heun2", f"is not heun2: its answers change from call to call: {FIRST}"),
    (heun(length=nearly(1e-3)), heun(length=nearly(0)), "heun2", "is heun2, but not everywhere"),
    (heun(length=lambda h: h if h > -1 else -1), heun(), "heun2", "is heun2 for h > 0 only: a step with"),
    (heun(lambda slope: np.clip(slope, -1e4, 1e4)), heun(), "heun2", "is heun2, but not everywhere: in"),
    (verlet(lambda force, m: force * m / 4), verlet(), VERLET, "but not for all parameters: with m = 0.5"),
    (verlet(ended=lambda v, x: v - np.mean(v, axis=0) if np.ndim(v) > 1 else v), verlet(), VERLET, "in space"),
    (rows(lambda q: q[0]), rows(lambda q: q), EULER, "at once: of 3 oscillators together, number 1"),
    (later(lambda n: n - 1 - (n % 10 == 9)), RUN, EULER, "for its first step only"),
    (out_of(lambda out, y: np.add(out, y, out)), out_of(lambda out, y: np.copyto(out, y)), "forward_euler", "0.59375"),
    (held(lambda s: s["k"] + 0 * s["m"]), held(lambda s: s["k"] / s["m"]), EULER, "with m = 2, k = 8"),
    (pushed(lambda body: getattr(body, "acc", 0)), pushed(lambda body: 0), EULER, "a second step with the acc that"),
    (in_place(lambda old, new: old), in_place(lambda old, new: new), VERLET, "a second step with the a that"),
    (split(lambda f, g: (g, f)), split(lambda f, g: (f, g)), "ars222", "its tables alone have order 1 and 2"),
    (ros2(lambda h: 1), ros2(lambda h: h), "ros2", "is not ros2: order 1 is observed where f depends on t"),
    (sampled(1), sampled(0.5), VERLET, "kick 2: 1 instead of 1/2"),
    (leap(False), leap(True), VERLET, "is not velocity_verlet"),
    (heun(ended=lambda end, y: end * (1 + 1e-6 * (len(y) == 13))), heun(), "heun2", "with 13 components it takes"),
    (heun(ended=lambda end, y: np.r_[end[:-4], y[-4:]] if len(y) % 8 == 0 else end), heun(), "heun2", "with 8 comp"),
    (heun(ended=lambda end, y: end.astype(np.float32) if len(y) > 30 else end), heun(), "heun2", "with 32 components"),
    (heun(at=lambda t: t or 1.0), heun(), "heun2", "is heun2, but not everywhere: at t = 0 it takes"),
    (heun(at=lambda t: np.float32(t) if t > 1e5 else t), heun(), "heun2", "at t = 2.45154e+06 it takes"),
    (on_equal_steps(3), on_equal_steps(99), "heun2", "a step that continues from the previous one differs"),
    (heun(ended=lambda end, y: end if y.ndim < 2 else end[::-1]), heun(), "heun2", "arrays of two dimensions it takes"),
    (heun(ended=lambda end, y: end if np.ndim(y) else y), heun(), "heun2", "with Python floats it takes a different"),
    (kicked(lambda v, x: v * (1 - (np.shape(x)[1:] == (2,)) / 9)), kicked(lambda v, x: v), VERLET, "in the plane"),
    (kicked(lambda v, x: v * (1 - (np.shape(x) == (1, 3)) / 9)), kicked(lambda v, x: v), VERLET, "bodies in space"),
    (kicked(lambda v, x: np.float32(v) if np.max(x) > 999 else v), kicked(lambda v, x: v), VERLET, "of 8 oscillators"),
    (springs(lambda x: x * (1 + 1e-9 * (np.arange(x.size) == 1))), springs(lambda x: x), EULER, "number 1 goes"),
    (springs(lambda x: x if x.size < 9 else x * x.dtype.type(1 + 1e-9)), springs(lambda x: x), EULER, "of 9 osc"),
    (of_rows(lambda end, rows, y: end if rows < 2 else y), of_rows(lambda end, rows, y: end), "forward_euler", "of 3"),
    (particle(lambda p, x, v, h: Particle(x, v, p.t + abs(h), p.m)),
     particle(lambda p, x, v, h: Particle(x, v, p.t, p.m)), EULER, "its clock goes from"),
    (remembered(lambda old, new: -old), remembered(lambda old, new: -new), VERLET, "the previous step returned is"),
    (handed_on(True), handed_on(False), "nystrom4", "it passes on -1.15356 as the slope at its end, not -1.15446"),
    (estimated(0), estimated(1), "bogacki_shampine32", "call 3, which the error estimate alone uses, is made at t + 0"),
    (in_memory(lambda y: y), in_memory(np.ascontiguousarray), FORWARD, "with arrays with gaps such as y[::2] it takes"),
    (of_objects(lambda old, x, y: old is y), of_objects(lambda old, x, y: old is y and np.array_equal(x, y)), FORWARD,
     "with one object overwritten between steps it takes a different step"),
    (moving(lambda slope: slope), moving(lambda slope: [1]), "heun2", "with 6 components, y[5] is"),
    (stopping(STILL), stopping(MOVES), "heun2", "but not everywhere: where the slope of one stage is exactly 0"),
    (stopping(STILL, 1.0), stopping(MOVES), "heun2", "where the slope of one stage is exactly 0, in a step of"),
    (pushed_twice(STILL), pushed_twice(MOVES), VERLET, "where the slope of one stage is exactly 0, in a step of"),
    (on_times(lambda t: np.full(len(t) - 1, t[1] - t[0]) if np.allclose(np.diff(t), t[1] - t[0], 0.09) else np.diff(t)),
     on_times(np.diff), "heun2", "times of its grid are unequally"),
    (on_times(lambda t: np.diff(t) * (1 + 1e-9 * (np.arange(1, len(t)) == 40))), on_times(np.diff), "heun2",
     "for its first step only: a step in a run differs"),
    (pulled(COARSE), pulled(np.array_equal), VERLET, "when the previous one ended, in almost its state, differs"),
    (sprung(COARSE), sprung(np.array_equal), VERLET, "a step that begins in almost the state where one ended is wrong"),
    (resisted(lambda v: v * (np.arange(np.size(v)) < 3)), resisted(lambda v: v), EULER, "number 3 goes from"),
    (advancing(0.5), advancing(1), "forward_euler", "its clock goes from 0.0 to 0.125 in a step of 0.25"),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("wrong", "right", "method", "cause"), WRONG, ids=range(len(WRONG)))
def test_the_mistake_is_caught_and_its_twin_passes(wrong, right, method, cause):
    assert verify(right, method, examples=60, isolate=False).passed
    found = verify(wrong, method, examples=60, isolate=False)
    assert found.passed is False
    assert cause in found.verdict


def of_the_first_stage(residual, x):
    """Plain iteration, until the slope of the first of two stages settles."""
    for _ in range(200):
        change = residual(x)
        x = x - change
        if not np.abs(change)[: len(x) // 2].max() > 1e-13:
            break
    return x


def guessed(residual, x):
    """Plain iteration, unless the first guess is right for the first of two stages."""
    return x if np.abs(residual(x)[: len(x) // 2]).max() < 1e-13 else fixed_point(residual, x)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["gauss2", "radau_iia2"])
def test_an_iteration_that_looks_at_one_stage_alone_is_caught_where_that_needs_none(key):
    settings = {"allowance": Allowance(solver_tolerance=1e-10), "domain": Domain(largest_step=0.5), "examples": 60}
    right, *wrong = (
        verify(all_at_once(table(key), solver), key, isolate=False, **settings)
        for solver in (fixed_point, of_the_first_stage, guessed)
    )
    assert right.passed
    for found in wrong:
        assert found.passed is False
        assert "where the slope of one stage is exactly 0, in a step of 0.05" in found.text()


def test_a_time_that_is_left_to_the_caller_or_a_step_size_is_no_wrong_time():
    def proposing(f, t, y, h):
        return 2 * h, y + h * f(t, y)

    assert verify(timed(0), "heun2", examples=60, isolate=False).passed
    assert verify(proposing, "forward_euler", examples=60, isolate=False).passed


def test_a_momentum_is_one_if_the_position_moves_by_p_over_m():
    def of(power):
        def step(force, x, p, m, dt):
            p = p + dt / 2 * force(x)
            x = x + dt * p / m**power
            return x, p + dt / 2 * force(x)

        return step

    assert verify(of(1), "velocity_verlet", examples=60, isolate=False).passed
    assert verify(of(0), "velocity_verlet", examples=60, isolate=False).passed is False


def test_a_remark_on_a_step_that_passes_is_warned_of():
    narrow = lambda f, t, y, h: (y + h * f(t, y)).astype(np.float32)
    cut = lambda f, t, y, h: np.add(y, h * f(t, y), out=np.zeros_like(y), casting="unsafe")
    for step, remark in ((narrow, "answers are rounded to binary32"), (cut, "integers truncate the answer")):
        with pytest.warns(UserWarning, match=remark):
            assert_verified(step, "forward_euler", examples=60, isolate=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_verified(narrow, "forward_euler", array=np.float32, examples=60, isolate=False)


def test_slopes_that_are_written_into_are_remarked_on():
    with pytest.warns(UserWarning, match="it writes into the arrays that its function returns"):
        assert_verified(scaling(lambda slope: slope), "forward_euler", examples=60, isolate=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_verified(scaling(np.copy), "forward_euler", examples=60, isolate=False)


def test_the_object_of_a_method_is_left_as_it_is():
    """It would begin its next examination with the slopes of this one, and be told that its start is inaccurate."""
    own = Remembering("adams_bashforth2", euler)
    said = {verify(own.step, "adams_bashforth2", isolate=False).verdict for _ in range(2)}
    across = "the first step after a change of h has order 1"
    assert said == {f"is adams_bashforth2 in steps of equal length, started by forward_euler; {across}"}
    assert not own.states


def test_a_factorisation_that_is_kept_is_told_by_numbers_that_differ():
    kept = []

    def ros2(f, jac, t, y, h):
        gamma = 1 - 2**-0.5
        if not kept or len(kept[0]) != len(y):
            kept[:] = [np.linalg.inv(np.eye(len(y)) - gamma * h * np.asarray(jac(t, y)))]
        k1 = kept[0] @ np.asarray(f(t, y))
        return y + 3 / 2 * h * k1 + h / 2 * (kept[0] @ (np.asarray(f(t + h, y + h * k1)) - 2 * k1))

    report = verify(ros2, "ros2", isolate=False)
    seen, said = re.search(r"it ends at (\S+), where the coefficients read give (\S+):", report.verdict).groups()
    assert (report.passed, seen == said) == (None, False)
    assert "or remembers another step" in report.verdict


def test_headlines_say_what_was_seen():
    inverse = np.linalg.inv([[1, -0.25], [0.25, 1]])

    def ignoring(q, v, h):
        return tuple(inverse @ [q, v])

    def nearly(force, x, v, dt):
        a = force(x)
        x = x + dt * v + 0.499999 * dt * dt * a
        return x, v + 0.5 * dt * (a + force(x))

    def slowed(force, x, v, dt):
        v = (v + dt / 2 * force(x)) * (1 - 1e-9)
        x = x + dt * v
        return x, v + dt / 2 * force(x)

    for step, headline in (
        (ignoring, "it is not a known method: h is ignored"),
        (nearly, "it is velocity_verlet except for a[1][0]: 499999/1000000 instead of 1/2"),
        (cast(np.float32), "it is symplectic_euler in numbers of few bits, not in all numbers"),
    ):
        report = identify(step, isolate=False)
        assert headline in report.verdict
        assert "damping" not in report.text()
    assert re.search(r"multiplied by 1 -1e-09 in each step", identify(slowed, isolate=False).text())
    (fault,) = identify(called(lambda n: n % 10 == 0), isolate=False).section("Faults").lines
    assert fault.startswith(f"its answers change from call to call: {FIRST}")


def test_doubles_that_are_computed_in_binary32_show_no_order_in_their_noise():
    def narrow(f, t, y, h):
        rate = lambda t, y: np.asarray(f(t, y), np.float32)
        return rk4(rate, t, np.asarray(y, np.float32), np.float32(h)).astype(float)

    assert "order -1" not in identify(narrow, isolate=False).text()
