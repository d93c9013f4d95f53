"""Steps that are handed earlier slopes, one by one or as a history, are read as the multistep methods that they are."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.judging.specification import Domain
from driftproof.blackbox.stepper.states.handed_slopes import with_slopes_kept
from driftproof.blackbox.verify import verify
from tests.blackbox.transcripts import Asked, summed, titles

bashforth2 = lambda f, t, y, h, f_prev: y + h * (1.5 * f(t, y) - 0.5 * f_prev)


def returned(f, t, y, h, f_prev):
    slope = f(t, y)
    return t + h, y + h * (1.5 * slope - 0.5 * f_prev), slope


untimed = lambda y, rhs, dt, rhs_old: y + dt * (1.5 * rhs(y) - 0.5 * rhs_old)
bashforth3 = lambda y, t, f, h, f_nm1, f_nm2: y + h / 12 * (23 * f(y, t) - 16 * f_nm1 + 5 * f_nm2)


def corrected(f, t, y, h, f_prev):
    slope = f(t, y)
    predicted = y + h * (1.5 * slope - 0.5 * f_prev)
    return y + h / 12 * (5 * f(t + h, predicted) + 8 * slope - f_prev)


def of_the_end(f, t, y, h, f_prev):
    after = y + h / 2 * (f_prev + f(t + h, y + h * f_prev))
    return after, f(t + h, after)


stale = lambda f, t, y, h, f_prev: (y + h * (1.5 * f(t, y) - 0.5 * f_prev), f_prev)
exchanged = lambda f, t, y, h, f_prev: y + h * (1.5 * f_prev - 0.5 * f(t, y))


def of_the_end_with_its_time(f, t, y, h, f_prev):
    return t + h, *of_the_end(f, t, y, h, f_prev)


def of_the_middle(f, t, y, h, f_prev):
    middle = f(t + h / 2, y + h / 2 * f(t, y))
    return y + h * (1.5 * middle - 0.5 * f_prev), middle


def of_the_wrong_end(f, t, y, h, f_prev):
    after = y + h * (1.5 * f(t, y) - 0.5 * f_prev)
    return after, f(t + h, after)


NAMED = {name: step for name, step in vars().items() if getattr(step, "__module__", "") == __name__}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", NAMED)
def test_a_step_is_named_by_what_it_makes_of_the_slopes(name, as_before):
    asked = Asked(NAMED[name])
    report = identify(asked.code, isolate=False)
    fitted = name in ("stale", "exchanged")  # to digits that are not those of every machine
    as_before(*((report.verdict, *titles(report)) if fitted else summed(report)), asked)


def test_a_right_one_passes_and_its_start_is_whose_calls_it():
    report = verify(bashforth2, "adams_bashforth2", isolate=False)
    assert report.passed is True
    assert "its start is left to the caller" in report.text(everything=True)
    assert verify(exchanged, "adams_bashforth2", isolate=False).passed is False
    assert verify(of_the_wrong_end, "adams_bashforth2", isolate=False).passed is False


ESTIMATE, OTHER = lambda k, last, y, h: h / 2 * (k - last), lambda k, last, y, h: y + h * k


@pytest.mark.parametrize("beside", [ESTIMATE, OTHER], ids=["an error estimate", "another result"])
def test_what_is_returned_beside_the_result_is_not_taken_for_a_slope_that_is_handed_on(beside):
    def pair(f, t, y, h, f_prev):
        slope = f(t, y)
        return y + h * (1.5 * slope - 0.5 * f_prev), beside(slope, f_prev, y, h)

    alone = identify(bashforth2, isolate=False).verdict
    assert (
        identify(pair, isolate=False).verdict
        == f"{alone}; what it returns besides y1 is not judged: no method defines it"
    )


def verlet(force, x, v, dt, f_old):
    x1 = x + dt * v + dt**2 / 2 * f_old
    return x1, v + dt / 2 * (f_old + (f1 := force(x1))), f1


def test_a_force_that_is_handed_on_is_that_at_the_position():
    def of_q(force, t, q, p, h, f_prev):
        *end, f1 = verlet(lambda x: force(t + h, x), q, p, h, f_prev)
        return *end, f1 * (1 + 2.0**-30)  # of another rounding

    def bashforth_of_a_force(force, x, v, dt, f_old):
        return x + dt * v, v + dt * (1.5 * force(x) - 0.5 * f_old)

    assert identify(verlet, isolate=False).verdict == identify(of_q, isolate=False).verdict == "it is velocity_verlet"
    step = with_slopes_kept(bashforth_of_a_force)
    assert step(lambda x: -x, 1.0, 0.5, 0.25) == (1.125, 0.25)
    assert step(lambda x: -x, 1.125, 0.25, 0.25) == (1.1875, -0.046875)


def test_numbered_slopes_reach_their_names_in_whichever_order_they_are_taken():
    def turned(y, t, f, h, f_nm2, f_nm1):
        return bashforth3(y, t, f, h, f_nm1, f_nm2)

    def walked(step, y=0.0):
        return [y := step(y, t, lambda y, t: t * t, 1.0) for t in map(float, range(5))]

    assert walked(with_slopes_kept(turned)) == walked(with_slopes_kept(bashforth3))


def carried(theta, omega, alpha, dt, stale=False, half=0.5):
    """Velocity Verlet of a pendulum, which takes and hands on its acceleration."""
    moved = theta + dt * omega + dt**2 / 2 * alpha
    new = -9.81 * np.sin(theta if stale else moved)
    return moved, omega + half * dt * (alpha + new), new


@pytest.mark.parametrize(("change", "said"), [
    ({}, "is velocity_verlet on the system given, to"), ({"half": 0.25}, "is not velocity_verlet"),
    ({"stale": True}, "the slope that it hands on as that at its end is that of where its step began"),
])  # fmt: skip
def test_an_acceleration_that_is_handed_on_may_be_that_of_its_own_system(change, said):
    step = lambda theta, omega, alpha, dt: carried(theta, omega, alpha, dt, **change)
    found = verify(step, "velocity_verlet", system=lambda y: [y[1], -9.81 * np.sin(y[0])], isolate=False)
    assert (found.passed is True, said in found.verdict) == (not change, True), found.verdict


def pulled(x):
    """The accelerations of bodies in rows that attract each other."""
    apart = x - x[:, None]
    return (apart / (1 + (apart**2).sum(-1, keepdims=True))).sum(1)


def molecules(x, v, f, dt, late=0.5, kept=False, before=False):
    """Velocity Verlet of bodies in rows, which hands on its forces."""
    v = v + dt / 2 * f
    new = pulled(x if before else x + dt * v)
    x = x + dt * v
    return x, v + dt * late * new, f if kept else new


@pytest.mark.parametrize("start", [None, "0:1,1:2,0:1,2:3,0:1,0:1; " + ",".join(["-1:1"] * 6)])
@pytest.mark.parametrize(("change", "said"), [
    ({}, "is velocity_verlet on the system given"),
    ({"late": 0.25}, "is not velocity_verlet"),
    ({"kept": True}, "is that of the start of its step, which it was given"),
    ({"before": True}, "is not velocity_verlet: the slope that it hands on as that at its end is that of where"),
])  # fmt: skip
def test_forces_of_bodies_that_are_handed_on_are_those_of_its_own_system(change, said, start):
    def system(y):
        q, v = np.reshape(y, (2, -1, 3))
        return [*v.ravel(), *pulled(q).ravel()]

    step = lambda x, v, f, dt: molecules(x, v, f, dt, **change)
    found = verify(step, "velocity_verlet", system=system, domain=Domain(start=start), isolate=False)
    assert (found.passed is True, said in found.verdict) == (not change, True), found.verdict
