"""What a refusal shows is pasted, and works; an increment is told apart from a step."""

import re

import pytest

from driftproof import verify
from driftproof.blackbox.findings import BadInput, Increment, Misbehaviour
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.stepper.styles import STYLES, keys_of, namespace
from tests.blackbox.transcripts import summed


@pytest.mark.parametrize("style", [s for s in STYLES if s.wrapper], ids=lambda style: style.title)
def test_a_style_that_is_refused_shows_a_wrapper_which_works_when_it_is_pasted(style):
    names = namespace(style.code)
    with pytest.raises((ValueError, Misbehaviour)) as caught:
        opened(list(names.values())[-1])
    message = str(caught.value)
    assert "\n" not in message
    assert message.endswith(f": {style.wrapper.rstrip()}")
    exec(style.wrapper, names)
    assert style.key in keys_of(names["wrapped"])


def test_an_increment_of_position_and_velocity_is_told_apart_from_a_step_that_is_damped():
    with pytest.raises(Increment, match=re.escape("def wrapped(q, v, h): dq, dv =")):
        opened(lambda q, v, h: (h * v, -h * q))
    with pytest.raises(Increment, match=re.escape("(q, v, lambda x: -force(x), h); return q + dq, v + dv")):
        opened(lambda q, p, grad_U, h: (h * p, -h * grad_U(q)))
    assert opened(lambda q, v, h: (0.25 * q, 0.25 * v)).step(1.0, 1.0, 0.5) == (0.25, 0.25)


def verlet_velocity_first(force, v, q, h):
    v = v + h / 2 * force(q)
    q = q + h * v
    return v + h / 2 * force(q), q


def verlet_of_an_array(f, t, y, h):
    """Of y = (v, q)."""
    v, q = y
    v = v + h / 2 * f(t, [v, q])[0]
    q = q + h * v
    return [v + h / 2 * f(t + h, [v, q])[0], q]


def verlet_of_a_state(state, h):
    return verlet_of_an_array(lambda t, y: [-y[1], y[0]], 0.0, state, h)


def exchanged(force, q, v, h):
    return verlet_velocity_first(force, v, q, h)


def test_a_step_of_velocities_first_is_read_so_where_its_arguments_say_it_and_else_shown_how_to_turn_them(as_before):
    first = verify(verlet_velocity_first, "velocity_verlet", examples=50, isolate=False)
    assert first.passed
    assert "and comes back as (v1, q1)" in first.section("State: passed").lines[0]
    said = [*summed(first)]
    for step in (exchanged, verlet_of_an_array, verlet_of_a_state):
        report = verify(step, "velocity_verlet", examples=50, isolate=False)
        assert report.passed is False
        said += summed(report)
        names = {step.__name__: step}
        exec("def wrapped(" + report.verdict.partition("write: def wrapped(")[2].partition("; the state is")[0], names)
        assert verify(names["wrapped"], "velocity_verlet", examples=50, isolate=False).passed
    as_before(*said)


@pytest.mark.parametrize(("code", "shown"), [
    ("class Bare:\n    def run(self, dt): pass", 'velocity="VELOCITY", advance="run")  # attributes'),
    ("class Bare:\n    pass", 'velocity="VELOCITY", advance="STEP")'),
    ("def bare(one, two): pass", "write: wrapped = lambda y, h: bare(y, h)  # where one is its state and two its step"),
    ("def bare(one, rhs, mesh, dt): pass", "of your own that calls it with its state"),
])  # fmt: skip
def test_a_refusal_without_a_known_wrapper_is_short_and_shows_what_to_fill_in(code, shown):
    with pytest.raises(BadInput, match=re.escape(shown)) as caught:
        opened(list(namespace(code).values())[-1])
    assert len(str(caught.value)) < 250


@pytest.mark.parametrize("last", [0.5, 1.0])
def test_a_sampler_that_turns_its_velocity_around_is_shown_how_to_turn_it_back(last):
    def sampler(q, p, grad_U, eps, L):
        p = p - eps / 2 * grad_U(q)
        for i in range(L):
            q = q + eps * p
            p = p - (eps if i < L - 1 else last * eps) * grad_U(q)
        return q, -p

    refused = verify(sampler, "velocity_verlet", isolate=False)
    assert refused.passed is False
    line = refused.verdict.partition("turned around; write: ")[2]
    exec(line, names := {"sampler": sampler})
    assert verify(names["wrapped"], "velocity_verlet", examples=30, isolate=False).passed is (last == 0.5)
