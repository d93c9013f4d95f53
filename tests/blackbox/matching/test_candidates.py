"""A variant of a method is named as one: repeated, with another step, rearranged, iterated; and strangers as none."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.blackbox.matching.candidates import ExactTable, field_variants, force_variants, newmark
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


def in_three_registers(f, t, y, h):
    """Williamson's method of third order, which is none of the catalogue's."""
    register = 0 * y
    for a, b, c in ((0.0, 1 / 3, 0.0), (-5 / 9, 15 / 16, 1 / 3), (-153 / 128, 8 / 15, 3 / 4)):
        register = a * register + h * f(t + c * h, y)
        y = y + b * register
    return y


RELATIVES = {
    "rk38 twice": codes.repeated(codes.rk38, 2),
    "midpoint2 three times": codes.repeated(codes.midpoint, 3),
    "midpoint2 four times": codes.repeated(codes.midpoint, 4),
    "midpoint2 five times": codes.repeated(codes.midpoint, 5),
    "dormand_prince54 twice": codes.repeated(codes.dopri5, 2),
    "rk38 of h/2": with_step(codes.rk38, 0.5), "rk38 of -h": with_step(codes.rk38, -1),
    "rk38 of h/3": with_step(codes.rk38, 1 / 3), "fehlberg45, embedded": embedded("fehlberg45"),
    "implicit_midpoint in 3 iterations": codes.midpoint_iterated(3),
    "implicit_midpoint in 4 iterations of the state": codes.midpoint_iterated(3, first=0.5),
    "backward_euler in 1 iteration": codes.tableau([[0, 0], [1, 0]], [0, 1], [0, 1]),
    "no step": lambda f, t, y, h: y + 0 * f(t, y),
    "none of ours": in_three_registers,
}  # fmt: skip


@pytest.mark.parametrize("name", RELATIVES)
def test_a_variant_is_named_through_both_conventions_and_a_stranger_as_none(name, as_before):
    found = in_field(RELATIVES[name]), match_forces(read_forces(opened(RELATIVES[name], "field")))
    as_before(*(line for each in found for line in (*each.lines, each.keys)))
    named = int(name not in ("midpoint2 five times", "no step", "none of ours"))
    assert [len(each.matches) for each in found] == [named, named]


TIMES = [f"{n} steps of h/{n}" for n in range(5)]
ITERATED = [
    f"with {n} fixed-point iterations from the {what} at the start: explicit"
    for n, what in ((5, "slope"), (6, "state"), (3, "state"))
]
# Through fields and through forces; the last stage of one step may be the first of the next, three times.
VARIANTS = {
    "heun2": TIMES[3:], "kutta3": TIMES[2:3],
    "fehlberg45": ["with the embedded weights propagated"],
    "butcher5": ["with the step 1/3 h in place of h"], "implicit_midpoint": ITERATED[:2], "gauss2": ITERATED[2:],
}  # fmt: skip
SPLIT = {
    "velocity_verlet": TIMES[3:],
    "implicit_midpoint": ITERATED[:1],
    "gauss2": [],
    "ruth3": TIMES[2:3],
    "mclachlan4": ["kicks and drifts exchanged", "its adjoint, kicks and drifts exchanged"],
}


def test_variants_are_those_that_have_so_many_stages_that_count():
    """Of six calls."""
    for said, variants in (
        (VARIANTS, field_variants(True, 6, Q(1, 3), implicit=False)),
        (VARIANTS | SPLIT, force_variants(6, Q(1, 3))),
    ):
        found = [(each.key, each.relation) for each in variants if each.key in said]
        assert {key: [relation for name, relation in found if name == key] for key in said} == said


def rearranged(key, change):
    return codes.composed([(kind, float(x)) for kind, x in change(METHODS[key].parts)])


def exchanged(parts):
    return [({"kick": "drift", "drift": "kick"}[kind], x) for kind, x in parts]


def verlet_in(steps, h_over):
    """So many steps of velocity Verlet, each of a part of h."""

    def step(force, q, v, h):
        for _ in range(steps):
            q, v = codes.velocity_verlet(force, q, v, h / h_over)
        return q, v

    return step


RELATIVES_ON_FORCES = {
    "ruth3's adjoint": rearranged("ruth3", lambda parts: parts[::-1]),
    "ruth3, exchanged": rearranged("ruth3", exchanged),
    "mclachlan4, exchanged": rearranged("mclachlan4", exchanged),
    "velocity_verlet of h/2": verlet_in(1, 2),
    "velocity_verlet twice": verlet_in(2, 2),
    "half moved": codes.half_moved,
}


@pytest.mark.parametrize("name", RELATIVES_ON_FORCES)
def test_a_variant_of_a_splitting_is_named(name, as_before):
    found = on_force(RELATIVES_ON_FORCES[name])
    as_before(*found.lines, found.keys)


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
    nothing = StageCoefficients((at_start * 2,) * 4, (at_start * 2,) * 2, at_start * 2)
    assert not [*newmark(ExactTable.of(nothing, Q(1)))]
