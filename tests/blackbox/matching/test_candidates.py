"""A variant of a method is named as one: repeated, with another step, rearranged, iterated; and strangers as none."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.blackbox.matching.candidates import ExactTable, newmark
from driftproof.blackbox.matching.match import match_forces
from driftproof.blackbox.probes.force import read_forces
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import in_field, on_force


def with_step(step, factor):
    return lambda f, t, y, h: step(f, t, y, factor * h)


def embedded(key):
    rows, _, nodes = codes.floats(METHODS[key])
    return codes.tableau(rows, [float(x) for x in METHODS[key].b_embedded], nodes)


RELATIVES = [
    (codes.repeated(codes.rk38, 2), "rk38, 2 steps of h/2"),
    (codes.repeated(codes.midpoint, 3), "midpoint2, 3 steps of h/3"),
    (codes.repeated(codes.dopri5, 2), "dormand_prince54, 2 steps of h/2"),
    (with_step(codes.rk38, 0.5), "rk38, with the step 1/2 h in place of h"),
    (with_step(codes.rk38, -1), "rk38, with the step -1 h in place of h"),
    (with_step(codes.rk38, 1 / 3), "rk38, with the step 1/3 h in place of h"),
    (embedded("fehlberg45"), "fehlberg45, with the embedded weights propagated"),
    (codes.midpoint_iterated(3), "implicit_midpoint, with 3 fixed-point iterations"),
    (codes.repeated(codes.midpoint, 4), "midpoint2, 4 steps of h/4"),
    (codes.tableau([[0, 0], [1, 0]], [0, 1], [0, 1]), "backward_euler, with 1 fixed-point iteration from the slope"),
]


@pytest.mark.parametrize(("step", "name"), RELATIVES)
def test_a_variant_is_named_through_both_conventions(step, name, as_before):
    as_before(*in_field(step).lines, *match_forces(read_forces(opened(step, "field"))).lines)
    for identity in (in_field(step), match_forces(read_forces(opened(step, "field")))):
        assert identity.keys == (("fehlberg45_embedded",) if name.startswith("fehlberg45,") else ())
        assert [match.name.startswith(name) for match in identity.matches] == [True]


@pytest.mark.parametrize("step", [codes.repeated(codes.midpoint, 5), lambda f, t, y, h: y + 0 * f(t, y)])
def test_five_steps_in_one_and_none_at_all_are_variants_of_nothing(step):
    assert in_field(step).matches == match_forces(read_forces(opened(step, "field"))).matches == ()


def rearranged(key, change):
    return codes.composed([(kind, float(x)) for kind, x in change(METHODS[key].parts)])


def exchanged(parts):
    return [({"kick": "drift", "drift": "kick"}[kind], x) for kind, x in parts]


RELATIVES_ON_FORCES = [
    (rearranged("ruth3", lambda parts: parts[::-1]), "ruth3, its adjoint"),
    (rearranged("ruth3", exchanged), "ruth3, kicks and drifts exchanged"),
    (rearranged("mclachlan4", exchanged), "mclachlan4, kicks and drifts exchanged"),
    (lambda force, q, v, h: codes.velocity_verlet(force, q, v, h / 2), "velocity_verlet, with the step 1/2 h"),
    (
        lambda force, q, v, h: codes.velocity_verlet(force, *codes.velocity_verlet(force, q, v, h / 2), h / 2),
        "velocity_verlet, 2 steps of h/2",
    ),
]


@pytest.mark.parametrize(("step", "name"), RELATIVES_ON_FORCES)
def test_a_variant_of_a_splitting_is_named(step, name, as_before):
    identity = on_force(step)
    as_before(*identity.lines)
    assert identity.keys == ()
    assert identity.matches[0].name.startswith(name)


def test_a_variant_with_a_wrong_coefficient_is_none():
    rows, weights, nodes = codes.floats(METHODS["rk38"])
    weights[0] += 2.0**-30
    wrong = codes.tableau(rows, weights, nodes)
    assert in_field(codes.repeated(wrong, 2)).matches == ()
    assert in_field(with_step(wrong, 0.5)).matches == ()


# To 2**-36, as solvers come by default, a number is told as a fraction; from a denominator of 100 on in decimals.
@pytest.mark.parametrize(
    ("beta", "gamma", "words"),
    [
        (Q(25, 99), Q(51, 100), "with beta = 25/99 and gamma = 0.51"),
        (Q(1, 3) + Q(0.99 * 2.0**-36), Q(1, 2), "with beta = 1/3 and gamma = 1/2"),
        (Q(1, 3) + Q(1.01 * 2.0**-36), Q(1, 2), "with beta = 0.3333333333480308 and gamma = 1/2"),
    ],
)
def test_newmark_is_told_with_its_numbers_and_has_their_table(beta, gamma, words):
    at_start, at_end = (Q(0), Q(0)), (Q(1, 2) - beta, beta)
    weights, nodes = (at_end, (1 - gamma, gamma)), (Q(0), Q(1))
    (found,) = newmark(ExactTable.of(StageCoefficients((at_start, at_end), weights, nodes), Q(1)))
    assert (found.key, found.relation) == ("newmark", words)
    assert abs(found.raw.values - [[float(x) for x in row] for row in (at_start, at_end, *weights)]).max() < 2.0**-36
    assert (found.raw.nodes, found.raw.drift) == (nodes, 1)
    turned = StageCoefficients((at_end[::-1], at_start), tuple(row[::-1] for row in weights), nodes[::-1])
    assert [each.relation for each in newmark(ExactTable.of(turned, Q(1)))] == [words]
    assert not [
        *newmark(ExactTable.of(StageCoefficients((at_start * 2,) * 4, (at_start * 2,) * 2, at_start * 2), Q(1)))
    ]


def test_a_position_that_moves_by_half_is_symplectic_euler_but_for_its_drift():
    lines = on_force(codes.half_moved).lines
    assert lines == ["no method of the catalogue", "nearest: symplectic_euler but for drift 1: 1/2 instead of 1"]


def test_a_method_that_is_none_of_ours_is_not_forced_into_one():
    williamson = [0.0, -5 / 9, -153 / 128], [1 / 3, 15 / 16, 8 / 15], [0.0, 1 / 3, 3 / 4]

    def step(f, t, y, h):
        register = 0 * y
        for a, b, c in zip(*williamson, strict=True):
            register = a * register + h * f(t + c * h, y)
            y = y + b * register
        return y

    assert in_field(step).lines == ["no method of the catalogue"]
    assert match_forces(read_forces(opened(step, "field"))).lines == ["no method of the catalogue"]
