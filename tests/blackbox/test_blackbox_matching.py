"""A reading is named as what it is: a method, one of several that no step tells apart, a relative, or nearly one."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from itertools import product

import numpy as np
import pytest

from driftproof.blackbox.matching.match import match_forces, match_tableau
from driftproof.blackbox.probes.force import read_forces
from driftproof.blackbox.probes.tableau import read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Nystrom, RungeKutta, Splitting
from driftproof.methods.stepping import stepper
from tests.blackbox import blackbox_codes as codes

EXPLICIT = [key for key, method in METHODS.items() if method.explicit]
TABLEAUX = [key for key in EXPLICIT if isinstance(METHODS[key], RungeKutta)]
SHORT = [key for key in TABLEAUX if METHODS[key].stages < 20]
SPLITTINGS = [key for key in EXPLICIT if isinstance(METHODS[key], Splitting)]
# The same step under several names: a pair propagates it, or it was found twice.
TIES = [{"heun2", "ssprk22", "heun_euler21"}, {"rk4", "zonneveld43"}, {"ralston3", "bogacki_shampine32"}]
TIES += [{"dop853", "dop853_third"}]


def ties_of(key):
    return next((tie for tie in TIES if key in tie), {key})


def in_field(step):
    return match_tableau(read_tableau(opened(step, "field")))


def on_force(step):
    return match_forces(read_forces(opened(step)))


@pytest.mark.parametrize("key", EXPLICIT)
def test_every_method_is_recognised_by_its_forces_and_none_is_taken_for_another(key):
    assert set(on_force(stepper(METHODS[key], float)).keys) == ties_of(key)


@pytest.mark.parametrize("key", TABLEAUX)
def test_every_tableau_is_recognised_by_its_slopes_and_none_is_taken_for_another(key):
    identity = in_field(codes.tableau(*codes.floats(METHODS[key])))
    assert set(identity.keys) == ties_of(key)
    assert identity.matches[0].closeness == "every coefficient correctly rounded"


BY_HAND = [
    (codes.euler, {"forward_euler"}),
    (codes.rk4, ties_of("rk4")),
    (codes.rk4_without_time, ties_of("rk4")),
    (codes.rk4_in_lists, ties_of("rk4")),
    (codes.rk4_of_one_number, ties_of("rk4")),
    (codes.rk38, {"rk38"}),
    (codes.heun, ties_of("heun2")),
    (codes.midpoint, {"midpoint2"}),
    (codes.ralston, {"ralston2"}),
    (codes.dopri5, {"dormand_prince54"}),
    (codes.ssprk33_in_convex_combinations, {"ssprk33"}),
    (codes.ssprk104_in_two_registers, {"ssprk104"}),
]


@pytest.mark.parametrize(("step", "keys"), BY_HAND)
def test_a_code_written_by_hand_is_recognised(step, keys):
    identity = in_field(step)
    assert set(identity.keys) == keys
    assert identity.lines[0].startswith("called in this way" if len(keys) > 1 else min(keys))


BY_HAND_ON_FORCES = [
    (codes.symplectic_euler, "symplectic_euler"),
    (codes.velocity_from_positions, "symplectic_euler"),
    (codes.symplectic_euler_in_a_field, "symplectic_euler"),
    (codes.velocity_verlet, "velocity_verlet"),
    (codes.velocity_verlet_by_acceleration, "velocity_verlet"),
    (codes.position_verlet_calling_twice, "position_verlet"),
]


@pytest.mark.parametrize(("step", "key"), BY_HAND_ON_FORCES)
def test_a_splitting_written_by_hand_is_recognised(step, key):
    assert on_force(step).keys == (key,)


@pytest.mark.parametrize("kind", [np.float32, np.float16])
def test_narrow_floats_are_recognised_by_their_own_rounding(kind):
    assert set(in_field(codes.in_precision(codes.rk4, kind)).keys) == ties_of("rk4")
    assert in_field(codes.in_precision(codes.rk38, kind)).keys == ("rk38",)


def test_among_equals_the_one_that_makes_as_many_calls_comes_first():
    pair = codes.floats(METHODS["zonneveld43"])
    assert in_field(codes.tableau(*pair)).keys == ("zonneveld43", "rk4")
    assert in_field(codes.rk4).keys == ("rk4", "zonneveld43")


@pytest.mark.parametrize(("error", "named"), [(2.0**-53, True), (1e-13, False)])
def test_a_last_bit_is_said_and_a_wrong_digit_makes_another_method(error, named):
    rows, weights, nodes = codes.floats(METHODS["rk38"])
    weights[1] += error
    identity = in_field(codes.tableau(rows, weights, nodes))
    assert (identity.keys == ("rk38",)) == named
    if named:
        assert identity.lines == ["rk38: every coefficient within 3 roundings"]
    else:
        assert identity.near[0].key == "rk38"
        assert identity.near[0].differences == (f"b[1]: {weights[1]!r} instead of 3/8",)


def test_a_third_with_fifteen_digits_is_recognised_and_named():
    rows, weights, nodes = codes.floats(METHODS["rk38"])
    rows[1][0] = nodes[1] = 0.333333333333333
    (line,) = in_field(codes.tableau(rows, weights, nodes)).lines
    assert line.startswith("rk38: the coefficients as sums make them: c[1] is ")


def changed_tableaux(method):
    """(name of the coefficient, the method with it changed): its sign flipped, or an eighth more."""
    for j, factor in product(range(method.stages), FACTORS):
        if method.b[j]:
            yield f"b[{j}]", replace(method, b=replaced(method.b, j, factor))
    for i, j, factor in product(range(method.stages), range(method.stages), FACTORS):
        if method.a[i][j] and i in counted(method):
            row = replaced(method.a[i], j, factor)
            yield f"a[{i}][{j}]", replace(method, a=(*method.a[:i], row, *method.a[i + 1 :]))


FACTORS = (-1, Q(9, 8))


def replaced(row, place, factor):
    return tuple(x * (factor if i == place else 1) for i, x in enumerate(row))


def counted(method):
    """The stages that the step depends on."""
    found = {j for j, x in enumerate(method.b) if x}
    for i in reversed(range(method.stages)):
        found |= {j for j, x in enumerate(method.a[i]) if x and i in found}
    return found


def demand_that_it_is_named(identity, key, name):
    """Another method, or the same with another step where all that is left of a method is its one weight."""
    assert key not in identity.keys
    if key == "forward_euler":
        assert "with the step" in identity.matches[0].relation
        return
    assert not identity.matches
    assert any(near.key == key and [d.split(":")[0] for d in near.differences] == [name] for near in identity.near)


def sample(changed, key):
    """One of the changed methods, another one for each key."""
    found = list(changed)
    return found[sum(map(ord, key)) % len(found)]


@pytest.mark.parametrize("key", SHORT[::3])
def test_a_wrong_coefficient_is_named_through_both_conventions(key):
    name, wrong = sample(changed_tableaux(METHODS[key]), key)
    step = codes.tableau(*codes.floats(wrong))
    demand_that_it_is_named(in_field(step), key, name)
    demand_that_it_is_named(match_forces(read_forces(opened(step, "field"))), key, name)


@pytest.mark.long
@pytest.mark.parametrize("key", SHORT)
def test_every_wrong_coefficient_is_named_through_both_conventions(key):
    for name, wrong in changed_tableaux(METHODS[key]):
        step = codes.tableau(*codes.floats(wrong))
        demand_that_it_is_named(in_field(step), key, name)
        demand_that_it_is_named(match_forces(read_forces(opened(step, "field"))), key, name)


def changed_splittings(method):
    for i, factor in product(range(len(method.parts)), FACTORS):
        kind, x = method.parts[i]
        if x:
            yield f"{kind} {i}", replace(method, parts=(*method.parts[:i], (kind, x * factor), *method.parts[i + 1 :]))


def demand_that_a_sub_step_is_named(key, name, wrong):
    identity = on_force(codes.composed([(kind, float(x)) for kind, x in wrong.parts]))
    assert key not in identity.keys
    near = [near for near in identity.near if near.key == key]
    assert near or not len(wrong.parts) > 2
    assert all(n.differences[0].startswith(f"{name}:") for n in near)


@pytest.mark.parametrize("key", SPLITTINGS[::3])
def test_a_wrong_sub_step_is_named(key):
    demand_that_a_sub_step_is_named(key, *sample(changed_splittings(METHODS[key]), key))


@pytest.mark.long
@pytest.mark.parametrize("key", SPLITTINGS)
def test_every_wrong_sub_step_is_named(key):
    for name, wrong in changed_splittings(METHODS[key]):
        demand_that_a_sub_step_is_named(key, name, wrong)


@pytest.mark.parametrize("key", [key for key in EXPLICIT if isinstance(METHODS[key], Nystrom)])
def test_a_wrong_weight_of_a_nystrom_method_is_named(key):
    wrong = replace(METHODS[key], b_velocity=replaced(METHODS[key].b_velocity, 1, -1))
    identity = on_force(stepper(wrong, float))
    assert [(n.key, n.differences[0].split(":")[0]) for n in identity.near] == [(key, "b_velocity[1]")]


@pytest.mark.parametrize("key", [key for key in SHORT[1::4] if METHODS[key].stages > 2])
def test_two_weights_exchanged_are_named_both(key):
    rows, weights, nodes = codes.floats(METHODS[key])
    *_, i, j = (k for k, x in enumerate(weights) if x)
    weights[i], weights[j] = weights[j], weights[i]
    identity = in_field(codes.tableau(rows, weights, nodes))
    if weights[i] == weights[j]:
        assert key in identity.keys
    else:
        assert not identity.matches
        assert [d.split(":")[0] for n in identity.near if n.key == key for d in n.differences] == [f"b[{i}]", f"b[{j}]"]


def in_another_order(method):
    """The method with two neighbours exchanged of which the later does not use the earlier; None if there are none."""
    rows, weights, nodes = codes.floats(method)
    for i in range(1, method.stages - 1):
        if not rows[i + 1][i] and i + 1 in counted(method):
            order = [*range(i), i + 1, i, *range(i + 2, method.stages)]
            return [[rows[k][m] for m in order] for k in order], [weights[k] for k in order], [nodes[k] for k in order]
    return None


REORDERED = [key for key in TABLEAUX if in_another_order(METHODS[key])]


@pytest.mark.parametrize("key", REORDERED)
def test_the_order_in_which_independent_stages_are_called_does_not_matter(key):
    rows, weights, nodes = in_another_order(METHODS[key])
    assert set(in_field(codes.tableau(rows, weights, nodes)).keys) == ties_of(key)


@pytest.mark.parametrize("key", REORDERED)
def test_stages_called_in_another_order_without_their_weights_are_another_method(key):
    rows, weights, nodes = in_another_order(METHODS[key])
    own = codes.floats(METHODS[key])[1]
    assert (key in in_field(codes.tableau(rows, own, nodes)).keys) == (own == weights)


def test_independent_stages_are_there_to_be_exchanged():
    assert len(REORDERED) >= 3


def test_a_stage_at_a_wrong_time_and_a_stopped_clock_are_named():
    rows, weights, nodes = codes.floats(METHODS["rk38"])
    nodes[1] = 0.5
    assert in_field(codes.tableau(rows, weights, nodes)).lines[1] == "nearest: rk38 but for c[1]: 1/2 instead of 1/3"
    stopped = "nearest: rk4 or zonneveld43 but for c[1]: 0 instead of 1/2; c[2]: 0 instead of 1/2; c[3]: 0 instead of 1"
    assert in_field(codes.rk4_on_a_stopped_clock).lines == ["no method of the catalogue", stopped]


def test_a_wrong_stage_of_an_error_estimate_is_said_beside_the_step():
    rows, weights, nodes = codes.floats(METHODS["bogacki_shampine32"])
    assert not in_field(codes.tableau(rows, weights, nodes)).matches[0].beside
    rows[3][2] = -rows[3][2]
    identity = in_field(codes.tableau(rows, weights, nodes))
    assert set(identity.keys) == ties_of("ralston3")
    beside = "bogacki_shampine32: in a call whose answer is not used, a[3][2]: -4/9 instead of 4/9"
    assert beside in identity.lines
