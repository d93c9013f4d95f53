"""Tables of collocation methods beside printed ones and by their definition; attempts that know their error."""

from __future__ import annotations

from dataclasses import replace
from math import inf, sqrt

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import MethodError
from driftproof.numeric.steps.elimination import FULL, Band
from driftproof.numeric.steps.loops import FieldWriters
from driftproof.numeric.steps.simplified_newton import WANTED, collocation_attempt, collocation_table, work_for
from driftproof.numeric.steps.step_control import EVALUATIONS, StepControl, Tolerances
from driftproof.numeric.steps.tableaux import float_tableau
from tests.looping import some

TABLES = [
    key for key in METHODS if key.startswith(("gauss", "radau_iia")) or key in ("backward_euler", "implicit_midpoint")
]
NOTHING = FieldWriters(lambda t, y, f: None, lambda t, y, matrix: None)


def attempt_at(rate, jacobian, band=FULL):
    """The attempt of a step, with the parts of its `StepControl` as arguments."""
    writers = FieldWriters(rate, jacobian, band)
    return lambda t, y, h, moved, new, *control: collocation_attempt(
        writers, t, y, h, moved, new, StepControl(*control)
    )


def test_radau_iia3_has_the_numbers_of_hairer_and_wanner():
    """IV.8: (8.5) and (8.20), to the binary32 of eigenvalues."""
    table, r = collocation_table(METHODS["radau_iia3"]), sqrt(6)
    assert table.estimate == pytest.approx([(-13 - 7 * r) / 3, (-13 + 7 * r) / 3, -1 / 3], rel=1e-14)
    assert table.blocks == [[0, 1], [1, 2]]
    unreal = collocation_table(METHODS["gauss2"])  # 3 +- i sqrt(3), and their size for the estimate
    assert (unreal.blocks, unreal.eigenvalues[0]) == ([[0, 0], [0, 2]], [float(np.float32(sqrt(12))), 0])
    assert [x for pair in table.eigenvalues for x in pair] == pytest.approx(
        [3.6378342527444957, 0, 2.6810828736277521, 3.0504301992474105], rel=2**-23
    )


@pytest.mark.parametrize("key", TABLES)
def test_a_table_is_what_its_names_say(key):
    table, method = collocation_table(METHODS[key]), float_tableau(METHODS[key])
    stages, inverse = method.stages, np.linalg.inv(method.a)
    size = np.abs(inverse).max() * 2**-40
    assert table.inverse == pytest.approx(inverse, abs=size)
    assert np.array(table.weights) @ method.a == pytest.approx(method.b, abs=1e-9)
    nodes = np.array(table.c)[:, None] ** np.arange(1, stages + 1)
    assert nodes @ table.powers == pytest.approx(np.eye(stages), abs=1e-3 if stages > 8 else 1e-6)
    diagonal, rows = np.zeros((stages, stages)), 0
    for (first, count), (real, imaginary) in zip(table.blocks, table.eigenvalues, strict=True):
        block = [[real, imaginary], [-imaginary, real]]
        diagonal[first : first + count, first : first + count] = np.array(block)[:count, :count]
        rows += count
    assert rows == stages
    found = np.array(table.from_blocks) @ diagonal @ table.to_blocks
    # Entries are rounded to 24 bits, and the columns of T are up to 10⁵ times nearer to each other than they are long.
    assert found == pytest.approx(inverse, abs=np.abs(inverse).max() * 2**-22 * np.linalg.cond(table.from_blocks))


@pytest.mark.parametrize("key", ["rk4", "trapezoid", "lobatto_iiia4", "radau_ia2", "sdirk2", "radau_i3", "yoshida4"])
def test_methods_that_tell_no_error_here_are_refused(key):
    with pytest.raises(MethodError, match=f"{key} has no error estimate"):
        collocation_table(METHODS[key])
    with pytest.raises(MethodError, match="no error estimate"):
        collocation_table(replace(METHODS["backward_euler"], a=((0,),)))


@pytest.mark.parametrize("key", ["backward_euler", "radau_iia2", "radau_iia3", "gauss2", "gauss4"])
def test_estimates_see_powers_of_t_from_their_order_on_and_no_earlier(key):
    """y' = tᵏ, J = 0: the estimate is the difference from a formula that is exact for k < s."""
    table = collocation_table(METHODS[key])
    for k in some(range(len(table.c) + 1)):

        def rate(t, y, f, k=k):
            f[0] = t**k

        attempt = attempt_at(rate, lambda t, y, matrix: matrix.__setitem__(0, [0.0]))
        new, work = [0.0], work_for(1, table, NOTHING)
        error = attempt(0.0, [0.0], 1.0, True, new, Tolerances(0.0, 1.0, 1.0), table, work, [0.0] * 5)
        # J is right, and so one iteration is exact but for T, which is rounded to 24 bits.
        method = float_tableau(METHODS[key])
        assert new[0] == pytest.approx(method.b @ method.c**k, abs=1e-5)
        assert (error < 1e-5) == (k < len(table.c))


@pytest.mark.parametrize("key", ["backward_euler", "radau_iia3", "gauss2", "gauss4"])
def test_iterations_start_on_the_polynomial_of_the_step_before(key):
    """Of y' = (1 + t)ˢ⁻¹ that is y, in steps of any length, also after one that is not taken; of another power not."""
    table, seen = collocation_table(METHODS[key]), []
    for power in (len(table.c), len(table.c) + 1):
        right = lambda t, power=power: ((1 + t) ** power - 1) / power

        def rate(t, y, f, power=power):
            seen.append((t, y[0]))
            f[0] = (1 + t) ** (power - 1)

        attempt = attempt_at(rate, lambda t, y, matrix: matrix.__setitem__(0, [0.0]))
        work, new, given = work_for(1, table, NOTHING), [0.0], Tolerances(0.0, 1e-9, 1.0)
        for t, h, moved in ((0.0, 1.0, True), (1.0, 2.0, True), (1.0, 0.5, False)):
            seen.clear()
            attempt(t, [right(t)], h, moved, new, given, table, work, [0.0] * 5)
            at, begun = zip(*seen[moved : moved + len(table.c)], strict=True)
            assert at == tuple(t + c * h for c in table.c)
            # Of the first step there is nothing to go on from; T is rounded to 24 bits, and so is what is left of it.
            goes_on = begun == pytest.approx([right(x) for x in at], rel=1e-6)
            assert (begun == (0.0,) * len(at)) if t == 0 else (goes_on is (power == len(at)))


# y' = -y by backward Euler with h = 1, J such that iterations leave a part `left`: the first moves by (1 - left)/2, and
# after n more left^n (1 - left)/2 / tolerance times left/(1 - left), at most 0.01, is left; J is wanted anew if slow.
ITERATIONS = [
    (5e-4, 1e-8, 3, 0.0), (0.1, 10.0, 2, 0.0), (0.1, 1.0, 2, 0.0), (0.1, 1e-2, 4, 1.0), (0.3, 0.02, 7, 1.0),
    (0.5, 1.0, 6, 1.0), (0.1, 44.0, 2, 0.0), (0.1, 46.0, 1, 0.0), (0.1, 0.15, 3, 1.0), (0.1, 7.5, 2, 0.0),
    (0.1, 8.0, 2, 0.0), (0.0, 1.0, 2, 0.0),
    *((0.3, 0.01, 2, None), (0.5, 0.1, 2, None), (0.9, 1.0, 2, None), (1.5, 1.0, 2, None), (-1.0, 1.0, 2, None)),
]  # fmt: skip


@pytest.mark.parametrize(
    ("left", "absolute", "iterations", "wanted", "relative"),
    # Of a relative tolerance r, 2^-49/r is enough if that is more than 0.01: here it is 1/16 and 1/32.
    [*((*row, 0.0) for row in ITERATIONS), (0.1, 10.0, 1, 0.0, 2.0**-45), (0.1, 10.0, 2, 0.0, 2.0**-44)],
)
def test_iterations_go_on_while_they_lead_within_the_tolerance(left, absolute, iterations, wanted, relative):
    table, report = collocation_table(METHODS["backward_euler"]), [0.0] * 5
    jacobian = lambda t, y, m: m.__setitem__(0, [1 - 2 / (1 - left)])
    attempt = attempt_at(lambda t, y, f: f.__setitem__(0, -y[0]), jacobian)
    work, given = work_for(1, table, NOTHING), Tolerances(relative, absolute, 2.0)
    error = attempt(0.0, [1.0], 1.0, True, [0.0], given, table, work, report)
    assert (error < inf) is (wanted is not None)
    large = wanted is not None and (1 - left) / 4 > absolute  # the first estimate, 1/2 over 1 - J
    assert report[EVALUATIONS] == 1 + iterations + large
    assert wanted in (None, work.memory[WANTED])
    if wanted is not None:  # once more: left/(1 - left) is at first taken to be what it was, a little worse
        soon = iterations == 1 or (left / (1 - left)) ** 0.8 * (1 - left) / 2 / absolute <= 0.01
        assert attempt(0.0, [1.0], 1.0, False, [0.0], given, table, work, report) < inf
        assert report[EVALUATIONS] == 1 + iterations + large + (1 if soon else iterations) + large


def test_an_old_matrix_that_fails_is_made_anew_and_nothing_is_known_of_what_the_new_one_leaves():
    """y' = -y by an iteration that leaves a tenth, then -30 y, begun on the same line: it leads to -30/31."""
    table = collocation_table(METHODS["backward_euler"])
    for part, iterations in ((0.99, 1), (1.01, 2)):
        now, report, made = [-1.0, 1 - 2 / 0.9], [0.0] * 5, []
        jacobian = lambda t, y, m, now=now, made=made: made.append(t) or m.__setitem__(0, now[1:])
        attempt = attempt_at(lambda t, y, f, now=now: f.__setitem__(0, now[0] * y[0]), jacobian)
        work, given = work_for(1, table, NOTHING), Tolerances(0.0, 100 * (30 / 31 - 0.495) / part, 2.0)
        assert attempt(0.0, [1.0], 1.0, True, [0.0], Tolerances(0.0, 1.0, 2.0), table, work, report) < 1
        now[:], report[EVALUATIONS] = (-30.0, -30.0), 0.0
        assert attempt(1.0, [1.0], 1.0, True, [0.0], given, table, work, report) < 1
        assert (made, report[EVALUATIONS]) == ([0.0, 1.0], 1 + 2 + iterations)


@pytest.mark.parametrize(("slope", "derivative"), [(lambda y: y, 1.0), (lambda y: inf, 0.0)])
def test_a_singular_matrix_and_a_slope_that_is_infinite_are_infinitely_wrong(slope, derivative):
    table = collocation_table(METHODS["backward_euler"])
    jacobian = lambda t, y, m: m.__setitem__(0, [derivative])
    attempt = attempt_at(lambda t, y, f: f.__setitem__(0, slope(y[0])), jacobian)
    given, report = Tolerances(0.0, 1.0, 2.0), [0.0] * 5
    assert attempt(0.0, [1.0], 1.0, True, [0.0], given, table, work_for(1, table, NOTHING), report) == inf
    assert report[EVALUATIONS] == (1 if derivative else 2)


@pytest.mark.parametrize("key", ["backward_euler", "radau_iia3", "gauss2"])
@pytest.mark.parametrize("band", [Band(1, 3), Band(2, 1), Band(0, 0)])
def test_in_a_band_an_attempt_has_the_bits_of_full_matrices(key, band):
    """Entries beside the diagonal are large, so that rows are exchanged, and fill in."""
    n, (lower, upper), table, found = 7, band, collocation_table(METHODS[key]), []
    entry = lambda i, j: (5.0 + (3 * i + 5 * j) % 7 if i != j else -1.0 - i) if -lower <= j - i <= upper else 0.0
    matrix = [[entry(i, j) for j in range(n)] for i in range(n)]

    def rate(t, y, f):
        f[:] = [sum(a * x for a, x in zip(row, y, strict=False)) for row in matrix]

    for given in (FULL, band):
        within = [row[max(0, i - given.lower) : i + given.upper + 1] for i, row in enumerate(matrix)]

        def jacobian(t, y, m, rows=within):
            for to, row in zip(m, rows, strict=True):
                for k, x in enumerate(row):
                    to[k] = x  # within the room that there is, which a slice would extend

        attempt = attempt_at(rate, jacobian, given)
        new, work = [0.0] * n, work_for(n, table, FieldWriters(rate, jacobian, given))
        start, tolerances = [1.0 - i / 4 for i in range(n)], Tolerances(0.0, 1.0, 2.0)
        for h in (0.5, 0.75):  # in the same room, in which nothing of the first matrix may be left
            error = attempt(0.0, start, h, True, new, tolerances, table, work, [0.0] * 5)
        found.append((error, new))
    assert found[0] == found[1]
    assert 0 < found[0][0] < inf


def test_an_attempt_without_stages_is_infinitely_wrong():
    """y' = 10 y², y = 1, h = 1: complex roots only."""

    def rate(t, y, f):
        f[0] = 10 * y[0] * y[0]

    table, seen = collocation_table(METHODS["backward_euler"]), []
    attempt = attempt_at(rate, lambda t, y, m: seen.append(t) or m.__setitem__(0, [20 * y[0]]))
    work = work_for(1, table, NOTHING)
    assert attempt(0.0, [1.0], 1.0, True, [0.0], Tolerances(0.0, 1e-3, 2.0), table, work, [0.0] * 5) == inf
    assert attempt(0.0, [1.0], 1e-3, False, [0.0], Tolerances(0.0, 1e-3, 2.0), table, work, [0.0] * 5) < 1
    assert seen == [0.0]  # the state has not moved
