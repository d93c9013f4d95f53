"""What is a method but for a few coefficients, or with few decimals, is told with the wrong ones."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from itertools import product

import numpy as np
import pytest

from driftproof.blackbox.matching.candidates import in_field as candidate_in_field
from driftproof.blackbox.matching.match import match_forces, match_method
from driftproof.blackbox.matching.near_misses import near_misses, typed_in
from driftproof.blackbox.matching.tables import Fingerprint
from driftproof.blackbox.probes.force import ForceReading, read_forces
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.tableau import read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Nystrom
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import EXPLICIT, SHORT, SPLITTINGS, counted, in_field, on_force
from tests.looping import some


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


def require_that_it_is_named(identity, key, name):
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


def named_in_both(key, name, wrong):
    """What is said of a wrong tableau through fields and through forces, where its wrong coefficient is named."""
    step = codes.tableau(*codes.floats(wrong))
    found = in_field(step), match_forces(read_forces(opened(step, "field")))
    for identity in found:
        require_that_it_is_named(identity, key, name)
    return [line for identity in found for line in identity.lines]


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("key", SHORT[::4])
def test_a_wrong_coefficient_is_named_through_both_conventions(key, as_before):
    as_before(*named_in_both(key, *sample(changed_tableaux(METHODS[key]), key)))


@pytest.mark.long
@pytest.mark.parametrize("key", SHORT)
def test_every_wrong_coefficient_is_named_through_both_conventions(key):
    assert all(named_in_both(key, *changed) for changed in some(changed_tableaux(METHODS[key])))


def changed_splittings(method):
    for i, factor in product(range(len(method.parts)), FACTORS):
        kind, x = method.parts[i]
        if x:
            yield f"{kind} {i}", replace(method, parts=(*method.parts[:i], (kind, x * factor), *method.parts[i + 1 :]))


def require_that_a_sub_step_is_named(key, name, wrong):
    identity = on_force(codes.composed([(kind, float(x)) for kind, x in wrong.parts]))
    assert key not in identity.keys
    near = [near for near in identity.near if near.key == key]
    assert near or not len(wrong.parts) > 2
    assert all(n.differences[0].startswith(f"{name}:") for n in near)


@pytest.mark.parametrize("key", SPLITTINGS[::3])
def test_a_wrong_sub_step_is_named(key):
    require_that_a_sub_step_is_named(key, *sample(changed_splittings(METHODS[key]), key))


@pytest.mark.long
@pytest.mark.parametrize("key", SPLITTINGS)
def test_every_wrong_sub_step_is_named(key):
    for name, wrong in some(changed_splittings(METHODS[key])):
        require_that_a_sub_step_is_named(key, name, wrong)


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


@pytest.mark.parametrize("key", ["ralston4", "gill4", "rk38", "fehlberg45"])
def test_what_is_said_of_rounded_tables_is_what_it_was(key, as_before):
    rows, weights, nodes = codes.floats(METHODS[key])
    said = []
    for digits in (3, 4, 8, 14):
        for more in (0.0, 2.0):
            rounded = [[round(x, digits) for x in row] for row in rows], [round(x, digits) for x in weights]
            rounded[1][0] = round(rounded[1][0] + more * 10.0**-digits, digits)
            reading = read_tableau(opened(codes.tableau(*rounded, [round(x, digits) for x in nodes]), "field"))
            identity = match_method(reading, METHODS[key])
            said.append((digits, more, *identity.lines, *(n.key for n in identity.near)))
    as_before(*said)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["ruth3", "nystrom4", "heun3"])
@pytest.mark.parametrize("off", [1e-12, 0.1])
def test_what_is_said_of_forces_that_are_off_is_what_it_was(key, off, as_before):
    method = METHODS[key]
    name = "parts" if hasattr(method, "parts") else "b_velocity" if hasattr(method, "b_velocity") else "b"
    row = list(getattr(method, name))
    said = []
    for place in range(len(row)):
        wrong = [(x[0], x[1] + Q(off)) if name == "parts" else x + Q(off) for x in row[place : place + 1]]
        changed = replace(method, **{name: (*row[:place], *wrong, *row[place + 1 :])})
        identity = match_forces(read_forces(opened(stepper(changed, float), "force")))
        said += [*identity.lines, *(near.key for near in identity.near)]
    as_before(*said)


@pytest.mark.parametrize("key", ["ralston4", "gill4"])
def test_the_decimals_of_a_table_are_told_from_4_to_14_where_four_numbers_or_more_are_off(key, as_before):
    candidate, said = candidate_in_field(METHODS[key], True), []
    for digits, shift, first in [*product(range(3, 16), range(4), (0,)), *product((6,), (0,), range(8, 22))]:
        numbers = [x for part in codes.floats(METHODS[key]) for x in np.ravel(part).tolist()]
        numbers[first:] = [round(x, digits) for x in numbers[first:]]
        numbers[8] += shift * 10.0**-digits
        a, b, c = np.split(np.array(numbers), (16, 20))
        read = Fingerprint(StageCoefficients(a.reshape(4, 4), (b, b), c), None)
        said += [
            (digits, shift, first, *near.differences) for near in typed_in(read, [candidate], Rounding(BINARY64, 4))
        ]
    as_before(*said)


# Of Heun's third-order method, the largest number of the row, of the sum, or of the products that it is made of.
@pytest.mark.parametrize(
    ("name", "place", "size"),
    [("a", 6, 2 / 9), ("b_position", 1, 1 / 2), ("c", 2, 2 / 3), ("drift", 0, 1.0), ("b_velocity", 1, 1.0)],
)
@pytest.mark.parametrize(("share", "same"), [(0.99, True), (1.01, False), (-1.01, False)])
def test_a_table_is_that_of_a_method_to_the_rounding_of_both(name, place, size, share, same):
    a, b, _ = (np.array(part) for part in codes.floats(METHODS["heun3"]))
    seen, off = induced(a, b), share * Rounding(BINARY32, 3).of(2 * size)
    seen[name].flat[place] += off
    if name == "b_velocity":  # which moves the others with it
        seen = induced(a, b)
    found = differences_of("heun3", seen)
    assert (() in found) == same


@pytest.mark.parametrize(("share", "more"), [(0.99, 0), (1.01, 1)])
def test_a_row_is_as_certain_as_its_weight_is_large(share, more):
    a, b, _ = (np.array(part) for part in codes.floats(METHODS["heun3"]))
    a[2] += [0.125, share * Rounding(BINARY32, 3).of(2.0) / b[2], 0.0]
    assert max(map(len, differences_of("heun3", induced(a, b)))) == 1 + more


def induced(a, b):
    """The table of a method for forces, in floats."""
    return {"c": a.sum(axis=1), "a": a @ a, "b_position": b @ a, "b_velocity": b, "drift": np.array([b.sum()])}


def differences_of(key, seen):
    """In what a table for forces differs from that of a method, as often as that is told."""
    rows = {name: tuple(row.tolist()) for name, row in seen.items()}
    table = rows | {"a": tuple(map(tuple, rows["a"])), "drift": rows["drift"][0]}
    return [near.differences for near in near_misses(ForceReading(**table, format=BINARY32)) if near.key == key]


@pytest.mark.parametrize(("digits", "named"), [(6, ["pefrl"]), (3, [])])
def test_a_splitting_whose_constants_are_typed_with_few_decimals_is_named_with_them(digits, named):
    xi, strong, chi = (round(x, digits) for x in (0.1786178958448091, -0.2123418310626054, -0.06626458266981849))
    drifts = (xi, chi, 1 - 2 * (chi + xi), chi, xi)
    kicks = (0.5 - strong, strong, strong, 0.5 - strong)
    parts = [
        part for drift, kick in zip(drifts, (*kicks, 0), strict=True) for part in (("drift", drift), ("kick", kick))
    ]
    near = match_forces(read_forces(opened(codes.composed(parts[:-1])))).near
    assert [each.key for each in near] == named
    assert all("of 6 decimals" in each.differences[0] for each in near)


@pytest.mark.parametrize(("off", "named"), [(1e-7, ["yoshida6"]), (1e-2, [])])
def test_a_splitting_one_of_whose_numbers_is_mistyped_is_named_with_how_far_its_sub_steps_are_off(off, named):
    """The number is the first of three from which all sub-steps are computed."""
    w = [0.784513610477560 + off, 0.235573213359357, -1.17767998417887]
    w = [*w, 1 - 2 * sum(w), *w[::-1]]
    kicks = [(x + z) / 2 for x, z in zip([0, *w], [*w, 0], strict=True)]
    parts = [part for pair in zip(kicks, [*w, 0], strict=True) for part in zip(("kick", "drift"), pair, strict=True)]
    near = match_forces(read_forces(opened(codes.composed(parts[:-1])))).near
    assert [each.key for each in near] == named
    assert all("coefficients, off by up to 2.0e-07, such as kick 0: " in each.differences[0] for each in near)
