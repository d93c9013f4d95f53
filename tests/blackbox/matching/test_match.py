"""A reading is named as what it is: a method, one of several that no step tells apart, a variant, or nearly one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.matching.candidates import EMBEDDED
from driftproof.blackbox.matching.match import Identity, Match, match_method
from driftproof.blackbox.probes.tableau import StageSolution
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import EXPLICIT, TABLEAUX, TOLD, in_field, on_force, read_with, ties_of
from tests.blackbox.transcripts import Asked
from tests.looping import some


@pytest.mark.slow(keep=14)
@pytest.mark.parametrize("key", EXPLICIT)
def test_every_method_is_recognised_by_its_forces_and_none_is_taken_for_another(key, as_before):
    identity = on_force(stepper(METHODS[key], float))
    assert set(identity.keys) == ties_of(key)
    if key in TOLD:
        as_before(*identity.lines)


@pytest.mark.parametrize("key", TABLEAUX)
def test_every_tableau_is_recognised_by_its_slopes_and_none_is_taken_for_another(key, as_before):
    identity = in_field(codes.tableau(*codes.floats(METHODS[key])))
    assert set(identity.keys) == ties_of(key)
    assert identity.matches[0].closeness == "every coefficient correctly rounded"
    if key in TOLD:
        as_before(*identity.lines)


BY_HAND = [codes.euler, codes.rk4, codes.rk4_without_time, codes.rk4_in_lists, codes.rk4_of_one_number, codes.rk38]
BY_HAND += [codes.heun, codes.midpoint, codes.ralston, codes.dopri5, codes.ssprk33_in_convex_combinations]
BY_HAND += [codes.ssprk104_in_two_registers, codes.rk4_on_a_stopped_clock]
ON_FORCES = [codes.symplectic_euler, codes.velocity_from_positions, codes.symplectic_euler_in_a_field]
ON_FORCES += [codes.velocity_verlet, codes.velocity_verlet_by_acceleration, codes.position_verlet_calling_twice]


@pytest.mark.parametrize(
    ("read", "step"), [*((in_field, step) for step in BY_HAND), *((on_force, step) for step in ON_FORCES)]
)
def test_a_code_written_by_hand_is_recognised(read, step, as_before):
    asked = Asked(step)
    identity = read(asked.code)
    as_before(*identity.lines, identity.keys, asked)


@pytest.mark.parametrize("kind", [np.float32, np.float16])
def test_narrow_floats_are_recognised_by_their_own_rounding(kind):
    assert set(in_field(codes.in_precision(codes.rk4, kind)).keys) == ties_of("rk4")
    assert in_field(codes.in_precision(codes.rk38, kind)).keys == ("rk38",)


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


# Of a number 1, below which the next ones are one rounding apart each.
@pytest.mark.parametrize(
    ("roundings", "closeness"), [(4, "every coefficient within 4 r"), (5, "coefficients formed as sums")]
)
def test_coefficients_that_take_four_operations_are_told_from_those_that_sums_make(roundings, closeness):
    found = match_method(read_with("rk38", ("a", 2, 1), by=-roundings * 2.0**-53), METHODS["rk38"])
    assert found.matches[0].closeness.startswith(closeness)


def test_no_splitting_is_found_through_a_right_hand_side_and_no_explicit_method_in_implicit_stages():
    solved = replace(read_with("rk4"), solved=StageSolution(0.0, 0.0))
    assert match_method(read_with("rk4"), METHODS["velocity_verlet"]) == Identity(())
    assert match_method(solved, METHODS["rk4"]) == Identity(())


def test_what_a_solver_leaves_in_a_coefficient_is_told_relative_to_it():
    reading = replace(read_with("sdirk2", ("a", 0, 0), by=1e-9), stage_error=1e-9, solved=StageSolution(0.0, 0.0))
    closeness = f"every coefficient within {1e-9 / (1 - 0.5**0.5):.1e}, the accuracy of its stage solver"
    assert match_method(reading, METHODS["sdirk2"]).matches[0].closeness == closeness


OFF = (("b", 1), ("b", 0), ("a", 1, 0), ("c", 1), ("b", 2))
# A third of its numbers may be off, but no more than three: of 2, 5 and 9, of 6 without times, of 14.
MOST_OFF = [("forward_euler", 1, True), ("heun2", 1, True), ("heun3", 3, True), ("heun3", 2, False), ("rk4", 3, True)]


@pytest.mark.parametrize(("key", "most", "timed"), MOST_OFF)
def test_a_method_is_near_that_differs_in_a_third_of_its_numbers_or_in_three(key, most, timed):
    places = [("b", 0), *OFF] if key == "forward_euler" else OFF
    for count in some((most, most + 1)[: len(METHODS[key].b)], 1):
        near = match_method(read_with(key, *places[:count], timed=timed), METHODS[key]).near
        assert [len(each.differences) for each in near] == [count] * (count == most)


SAID = [Match("a", "", 0, "b[0]", True, (), 1.0), Match("a", "so", 2, "b[0]", True, (), 2e-7)]
SAID += [Match("a", EMBEDDED if n == 1 else "", n, "b[0]", summed, (), 0.0) for n in (1, 2) for summed in (False, True)]


def test_how_near_a_match_is_is_said_of_the_first_of_several(as_before):
    other = Match("z", "", 3, "c[0]", False, ("this", "that"), 0.0)
    found = [identity for match in SAID for identity in (Identity((match,)), Identity((match, other)))]
    as_before(*(line for each in found for line in (*each.lines, each.keys)))


def test_a_stage_at_a_wrong_time_is_named():
    rows, weights, nodes = codes.floats(METHODS["rk38"])
    nodes[1] = 0.5
    assert in_field(codes.tableau(rows, weights, nodes)).lines[1] == "nearest: rk38 except for c[1]: 1/2 instead of 1/3"


def test_a_wrong_stage_of_an_error_estimate_is_said_beside_the_step():
    rows, weights, nodes = codes.floats(METHODS["bogacki_shampine32"])
    assert not in_field(codes.tableau(rows, weights, nodes)).matches[0].beside
    rows[3][2] = -rows[3][2]
    identity = in_field(codes.tableau(rows, weights, nodes))
    assert set(identity.keys) == ties_of("ralston3")
    beside = "bogacki_shampine32: in a call whose answer is not used, a[3][2]: -4/9 instead of 4/9"
    assert beside in identity.lines


def weighted(*kicks):
    """Kicks with drifts between them; Nyström's method of order 4 has the same weights and nodes."""

    def step(force, q, v, h):
        for i, kick in enumerate(kicks):
            q = q + h / (len(kicks) - 1) * v if i else q
            v = v + kick * h * force(q)
        return q, v

    return step


def test_a_table_whose_inner_coefficients_all_differ_is_near_to_no_method():
    """The twin, of the same kind, is a method of the catalogue, which is named."""
    assert identify(weighted(1 / 6, 2 / 3, 1 / 6)).verdict == "it is not a known method, but has 3 stages and order 2"
    assert "velocity_verlet" in identify(weighted(1 / 2, 1 / 2)).verdict


@pytest.mark.parametrize(("part", "words"), [(0.25, "4 steps of h/4"), (1.0, "4 steps of h each instead of h/4")])
def test_several_steps_in_one_are_told_from_whole_steps_in_their_place(part, words):
    def step(f, t, y, h):
        for i in range(4):
            y = codes.rk4(f, t + i * part * h, y, part * h)
        return y

    assert identify(step, isolate=False).verdict.startswith(f"it is rk4, {words}, ")
