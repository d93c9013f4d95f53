"""Answers of named parts are read by the names: positions and velocities, or a state, its time and its error."""

from dataclasses import make_dataclass
from types import SimpleNamespace

import pytest

from driftproof import verify
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.states.named_answers import clock_of, goes_on, part_pair, run_parts


@pytest.mark.parametrize(
    "answer", [lambda q, v: {"velocity": v, "x": q}, lambda q, v: {"a": q, "b": v}], ids=["names", "order"]
)
def test_what_is_returned_is_read_by_its_names_or_in_its_order(answer):
    assert opened(lambda q, v, h: answer(q + h * v, v - h * q)).step(1.0, 0.75, 0.25) == (1.1875, 0.5)


def test_what_is_new_goes_before_what_was_and_a_clock_is_one_number():
    assert part_pair({"q": 1.0, "q_new": 2.0, "v": 3.0, "v_next": 4.0}) == [2.0, 4.0]
    assert run_parts({"nfev": 6}) == {"nfev": 6}
    assert (clock_of({"q": 1.0, "t": 0.5}), clock_of({"t": [0.5, 1.0]}), clock_of({"q": 1.0})) == (0.5, None, None)
    assert [goes_on(2.0, after, 0.25) for after in (2.0, 2.25, 2.125)] == [True, True, False]


def pair_of_heun(f, t, y, h):
    k1 = f(t, y)
    k2 = f(t + h, y + h * k1)
    return y + h / 2 * (k1 + k2), h / 2 * (k2 - k1)


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("named", [dict, SimpleNamespace, make_dataclass("Result", ["y_new", "err", "nfev"])])
@pytest.mark.parametrize(
    ("share", "said"), [(1.0, "is heun_euler21 to roundoff"), (2.0, "the error estimate is 2 times")]
)
def test_a_state_and_an_error_by_name_are_read_as_they_are_in_a_tuple(named, share, said):
    def step(f, t, y, h):
        y_new, err = pair_of_heun(f, t, y, h)
        return named(y_new=y_new, err=share * err, nfev=2)

    assert said in verify(step, "heun_euler21", examples=30, isolate=False).verdict


def verlet_run(acc, x0, v0, dt, steps, stale=False):
    x, v, a = [x0], [v0], acc(x0)
    for _ in range(steps):
        x.append(x[-1] + v[-1] * dt + a * dt**2 / 2)
        after = acc(x[-1])
        v.append(v[-1] + (a + after) * dt / 2)
        a = a if stale else after
    return x, v


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize("stale", [False, True])
@pytest.mark.parametrize("names", ["x v t", "t x v", "x v"])
@pytest.mark.parametrize("rows", [True, False])
def test_a_run_may_return_its_positions_and_velocities_by_name(names, rows, stale):
    def run(acc, x0, v0, dt, steps):
        x, v = verlet_run(acc, x0, v0, dt, steps, stale)
        found = {"x": x, "v": v, "t": [dt * i for i in range(steps + 1)]}
        return {name: found[name] if rows else found[name][-1] for name in names.split()}

    assert verify(run, "velocity_verlet", examples=20, isolate=False).passed is (not stale)
