"""The linear fit names every method of the catalogue by its steps, up to those with the same matrix, and no other."""

from __future__ import annotations

from fractions import Fraction as Q
from math import cos, cosh, sin, sinh

import numpy as np
import pytest

from driftproof.blackbox.matching.equivalent_methods import Rates, all_matrices, equivalent_methods
from driftproof.blackbox.matching.linear_candidates import FORWARDS, Error, LinearCandidate
from driftproof.blackbox.matching.linear_match import LinearFit, Nearest, fitted, linear_fit
from driftproof.blackbox.matching.matrix_facts import MatrixFacts
from driftproof.blackbox.probes.linear_steps import LINEAR, LINEARISED, NOT_LINEAR, LinearReading
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.steppers import rk4, symplectic_euler
from driftproof.support.messages import decode, encode
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.catalogue_steppers import float_subject
from tests.blackbox.matching.linear_fits import alike, fit
from tests.blackbox.matching.readings import EACH, TOLD
from tests.blackbox.transcripts import Asked, shortened


@pytest.mark.parametrize("key", EACH)
def test_each_method_is_named_up_to_those_with_the_same_matrix(key, as_before):
    found = linear_fit(float_subject(METHODS[key]))
    assert found.kind == LINEAR
    assert found.best is not None
    assert found.best.methods == tuple(alike()[key])
    assert found.best.extras == 0
    assert found.best.error.in_bounds <= 1
    assert (found.best.position, found.best.stiffness) == (1, 1)
    assert found.facts.linear_order == METHODS[key].claimed_order
    if key in TOLD:
        as_before(*found.lines, f"{found.best.error.in_bounds:.3g} bounds")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["velocity_verlet", "rk4", "nystrom5"])
def test_methods_in_binary32_are_named_whether_or_not_the_answers_say_so(key):
    from driftproof.methods.programs.stepping import stepper

    single = stepper(METHODS[key], np.float32)

    def step(force, q, v, h):
        return single(lambda x: np.float32(force(x)), np.float32(q), np.float32(v), np.float32(h))

    for answer in (step, lambda force, q, v, h: tuple(map(float, step(force, q, v, h)))):
        found = fit(answer)
        assert found.format == "binary32"
        assert found.best is not None
        assert (found.best.methods, found.best.extras) == (tuple(alike()[key]), 0)


@pytest.mark.parametrize(
    ("omega2", "shown"),
    [(Q(4), "4"), (Q(1, 3), "1/3"), (Q(-2), "-2"), (10**6, "1000000"), (1.2345678901234567, None)],
    ids=str,
)
def test_the_stiffness_that_a_stepper_has_built_in_is_recovered(omega2, shown):
    k = float(omega2)
    found = fit(lambda q, v, h: rk4(lambda x: -k * x, q, v, h))
    assert found.best.methods[0] == "rk4"
    assert found.best.extras == 0
    assert found.stiffness == (omega2 if shown else Q(k))


def test_without_a_rate_no_method_is_named_and_none_is_excluded():
    def verlet(q, v, h, k=2.0**150):
        v -= h / 2 * k * q
        q += h * v
        return q, v - h / 2 * k * q

    found = fit(verlet)
    assert found.best is None
    assert found.lines[0] == "undetermined: no method can be named"


def test_a_fit_is_plain_data_and_its_lines_name_what_cannot_be_told_apart():
    found = fit(lambda force, q, v, h: rk4(force, q, v, h))
    assert decode(encode(found), "driftproof") == found
    assert found.lines[:2] == (
        "rk4, to rounding in binary64",
        "no linear test distinguishes rk4 from rk38, gill4, ralston4, zonneveld43, england45",
    )


@pytest.mark.parametrize(("off", "shown"), [(3e-15, "1e-14"), (1e-13, "1e-13"), (1e-12, "1e-12")])
def test_a_step_that_is_all_but_exact_is_no_method_of_high_order(off, shown):
    def step(q, v, h):
        c, s = (1 + off) * cos(h), (1 + off) * sin(h)
        return c * q + s * v, c * v - s * q

    found = fit(step)
    assert (found.best.methods, found.best.words) == ((), f"the exact solution, to {shown}")
    assert found.lines == (f"the exact solution, to {shown}",)


def test_a_step_that_is_off_by_more_is_not_called_exact():
    found = fit(lambda q, v, h: (cos(h) * q + sin(h) * v, cos(h) * v - (1 + 1e-6) * sin(h) * q))
    assert found.best is None or "the exact solution, to" not in found.best.words


def short_only(q, v, h):
    if abs(h) > 0.6:
        raise ValueError("unstable")
    return q + h * v, v - h * q


def iterated(force, q, v, h):
    """The implicit midpoint rule, to a tolerance."""
    q1, v1 = q, v
    for _ in range(60):
        before = q1, v1
        q1, v1 = q + h * (v + v1) / 2, v + h * force((q + q1) / 2)
        if abs(q1 - before[0]) + abs(v1 - before[1]) < 1e-9:
            break
    return q1, v1


def adaptive(force, q, v, h):
    """Runge and Kutta's method in steps halved until the position stays."""
    z, before, n = rk4(force, q, v, h), (0.0, 0.0), 1
    while abs(z[0] - before[0]) + abs(z[1] - before[1]) >= 1e-9 and n < 64:
        before, z, n = z, (q, v), 2 * n
        for _ in range(n):
            z = rk4(force, *z, h / n)
    return z


def near_rk4(q, v, h):
    s = h * h
    return (1 - s / 2 + s * s / 23) * q + h * v, v - h * q * (1 - s / 6 * (1 + 2.0**-30))


def kicked_first(kick):
    """Velocity-first symplectic Euler with another kick."""

    def step(q, v, h):
        v = kick(q, v, h)
        return q + h * v, v

    return step


def forwards_only(force, q, v, h):
    return symplectic_euler(force, q, v, h) if h > 0 else (q, v)


LINEAR_STEPS = {
    "damped": lambda q, v, h: (q + 2 * h * (v + h * (-4 * q - 0.25 * v)), v + h * (-4 * q - 0.25 * v)),
    "dragged": lambda q, v, h: (q + h * v, v - h * v / 8),
    "short_only": short_only,
    "capped": kicked_first(lambda q, v, h: max(-8.0, min(8.0, v - h * q))),
    "cubic": lambda q, v, h: (q + h * v, v - h * q**3),
    "sloppy": lambda q, v, h: (round(q + h * v, 9), round(v - h * q, 9)),
    "iterated": iterated, "adaptive": adaptive,
    "still": lambda q, v, h: (q + h * v, v),
    "to_nowhere": lambda q, v, h: (0.0, 0.0),
    "at_once": lambda q, v, h: (v, -q),
    "growing": lambda q, v, h: (q + h * v, v + 2 * h * q),
    "repelled": lambda q, v, h: (
        q * cosh(h / 2) + 2 * v * sinh(h / 2), q * sinh(h / 2) / 2 + v * cosh(h / 2)
    ),
    "exact": lambda q, v, h: (q * np.cos(h) + v * np.sin(h), v * np.cos(h) - q * np.sin(h)),
    "turned": lambda q, v, h: (q - h * v, v + h * q),
    "moved": lambda q, v, h: (2 * q + h * v, v - h * q),
    "near_rk4": near_rk4, "forwards_only": forwards_only,
    "shortly_forwards": lambda force, q, v, h: forwards_only(force, q, v, h) if h <= 1 else (q, v),
    "shorter_than_one": lambda force, q, v, h: symplectic_euler(force, q, v, h) if abs(h) < 1 else (q, q),
    "shorter_than_one_forwards": lambda force, q, v, h: forwards_only(force, q, v, h if h < 1 else 0),
}  # fmt: skip


# In binary32 and in binary64.
ALIKE = (
    "dragged", "iterated", "adaptive", "repelled", "near_rk4", "shortly_forwards",
)  # fmt: skip
CASES = [(each, name) for name in LINEAR_STEPS for each in (None, np.float32) if each is None or name not in ALIKE]


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize(("array", "name"), CASES)
def test_a_step_is_named_as_what_it_is_and_all_else_is_as_it_was(name, array, as_before):
    asked = Asked(LINEAR_STEPS[name])
    found = linear_fit(opened(asked.code, array=array))
    rates, state = (found.position, found.stiffness), (found.kind, found.doubts, found.is_disturbed)
    told = [(c.words, c.extras, c.restriction, f"{c.error.in_bounds:.3g}") for c in found.candidates]
    said = [*found.lines, (found.amplitude, *state, *map(str, rates)), found.nearest, *told]
    as_before(*shortened(said, array is None), asked)


def seen_near(matrix, loose=0.0, h=0.25):
    """The method that a step is nearly, of which one matrix was read at states of size 1."""
    rest, ordinary = (1.0, 2.0**-20, -(2.0**-20), 1.0), ((h, tuple(matrix)),)
    reading = LinearReading(BINARY64, NOT_LINEAR, tiny=2.0**-20, at_zero=rest, ordinary=ordinary, loose=loose)
    nearly = fitted(reading, known=True).nearly
    return nearly and nearly.methods[0]


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_step_is_nearly_a_method_to_1e_4_where_no_other_is_16_times_as_far(share):
    classes = equivalent_methods()
    matrices = all_matrices(classes, Rates(0.25, 1.0, 1.0))
    assert seen_near(matrices[0] + [0, 0, share * 1e-4, 0]) == ("forward_euler" if share < 1 else None)
    assert seen_near(matrices[0], loose=share * 1e-4) == ("forward_euler" if share < 1 else None)
    (mine,) = (i for i, each in enumerate(classes) if "fehlberg45" in each.keys)
    far = np.abs(matrices - matrices[mine]).max(axis=1)
    far[mine] = np.inf
    between = matrices[mine] + share / 17 * (matrices[far.argmin()] - matrices[mine])
    assert seen_near(between) == (classes[mine].keys[0] if share < 1 else None)


def newmark_in_displacements(gamma):
    """Newmark's method for q'' = -q with beta = 1/4: the new acceleration is a difference over h^2."""

    def step(q, v, h):
        stiff = 4 / h**2
        new = (stiff * q + 4 / h * v - q) / (1 + stiff)
        acceleration = stiff * (new - q) - 4 / h * v + q
        return new, v + h * ((1 - gamma) * -q + gamma * acceleration)

    return step


@pytest.mark.parametrize(("gamma", "named"), [(0.5, True), (0.6, False), (0.4, False)])
def test_rates_are_not_those_of_a_step_so_tiny_that_differences_cancel(gamma, named):
    """Of steps of 2^-60 the difference is 0, and slopes become (2 gamma - 1) q."""
    found = linear_fit(opened(newmark_in_displacements(gamma)))
    assert (found.position, found.stiffness) == (1, 1)
    assert ("implicit_midpoint" in (found.best.methods if found.best else ())) is named


@pytest.mark.parametrize("rate", [1, Q(3, 2)])
def test_rates_of_a_quotient_that_rounds_are_those_of_the_system(rate):
    """The exponential Euler method, with (exp(h) - 1)/h: at h = 2^-26 it is off by 2^-27."""

    def step(f, t, y, h):
        return np.exp(-h) * y + (1 - np.exp(-h)) * (float(rate) * f(t, y) + y)

    found = linear_fit(opened(step))
    assert (found.position == found.stiffness == 1) is (rate == 1)


def candidate(*methods, restriction="", off=0.5):
    return LinearCandidate(methods, False, Q(1), Q(1), True, Error(off, off), restriction)


ONE = (Q(1), Q(1))
FITS = {
    "two": LinearFit(LINEAR, 8.0, "binary32", *ONE, (candidate("rk4", "rk38"), candidate("heun3"))),
    "forwards": LinearFit(LINEAR, 1.0, "binary64", *ONE, (candidate("rk4", restriction=FORWARDS),)),
    "at few steps": LinearFit(LINEAR, 1.0, "binary64", *ONE, (candidate("rk4", restriction="but only here", off=2.0),)),
    "near": LinearFit(LINEARISED, 2.0**-40, "binary64", *ONE, (candidate("rk4"),), Nearest(("a",), 0.5, 1e-3)),
    "the same": LinearFit(NOT_LINEAR, 1.0, "binary64", nearest=Nearest(("a",), 0.5, 0.0), remarks=("so", "too")),
    "nearly": LinearFit(LINEAR, 1.0, "binary64", Q(1, 3), Q(-2), nearly=Nearest(("a",), 0.5, 1.25e-7)),
    "far out": LinearFit(LINEAR, 1.0, "binary64", Q(1), Q(1), remarks=("not linear far out: at 7",), limited=True),
    "back": LinearFit(LINEAR, 1.0, "binary64", Q(-1), Q(-1), (candidate("rk4"),)),
    "without a force": LinearFit(LINEAR, 1.0, "binary64", Q(1), Q(0), (candidate("rk4"),)),
    "unknown": LinearFit(NOT_LINEAR, 1.0, "binary64", Q(2)),
    "facts": LinearFit(LINEAR, 1.0, "binary64", facts=MatrixFacts(("q" * 160, "v" * 161, "0", "1"), "1 - h", None, 3)),
    "exact": LinearFit(LINEAR, 1.0, "binary64", facts=MatrixFacts(None, None, "1", None)),
    "no order": LinearFit(LINEAR, 1.0, "binary64", facts=MatrixFacts(None, None, None, -1)),
    "order 0": LinearFit(LINEAR, 1.0, "binary64", facts=MatrixFacts(None, None, None, 0)),
}  # fmt: skip


@pytest.mark.parametrize("name", FITS)
def test_all_that_a_fit_says_is_what_it_was(name, as_before):
    as_before(*FITS[name].lines, FITS[name].doubts, FITS[name].is_disturbed)
