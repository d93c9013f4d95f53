"""Dense outputs are named, with degree, order and ends; those that do not fit to their steps are at fault."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.matching.dense_outputs import judged_dense, judged_reading
from driftproof.blackbox.probes.dense import BETWEEN, THETAS, DenseReading
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import EXTENSIONS, METHODS
from driftproof.methods.continuous import hermite
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.extension_steppers import but_the_last, extension_step, first_and_last_exchanged


def judged(step):
    return judged_dense(opened(step, "field"))


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", EXTENSIONS)
def test_every_extension_of_the_catalogue_is_named(key, as_before):
    found, table = judged(extension_step(key)), EXTENSIONS[key]
    assert (found.extension, found.degree, found.order) == (key, table.degree, table.claimed_order)
    assert found.faults == ()
    as_before(*found.lines)


def test_the_cubic_of_any_method_is_named():
    found = judged(extension_step("", extension=hermite(METHODS["fehlberg45"])))
    assert (found.extension, found.order, found.faults) == ("fehlberg45_hermite", 3, ())


def shampine(change):
    """The step whose dense output is that of `change(theta, h, right, straight)`."""

    def step(f, t, y, h):
        y1, dense = extension_step("dormand_prince54_shampine")(f, t, y, h)
        return y1, lambda theta: change(theta, h, dense(theta), y + theta * (y1 - y))

    return step


def weighted(weights):
    return extension_step("dormand_prince54_shampine", weights=weights)


def afresh(**spoiled):
    """The step that evaluates all its slopes anew for the dense output, each time it is asked."""
    right, asked = extension_step("dormand_prince54_shampine"), extension_step("dormand_prince54_shampine", **spoiled)
    return lambda f, t, y, h: (right(f, t, y, h)[0], lambda theta: asked(f, t, y, h)[1](theta))


def test_calls_with_equal_arguments_are_one_stage():
    found = judged(afresh())
    assert (found.extension, found.order, found.faults) == ("dormand_prince54_shampine", 4, ())
    (fault, *_) = judged(afresh(weights=but_the_last(lambda row: [*row[:-1], row[-1] + 1e-3]))).faults
    assert fault == "the dense output is not y1 at theta = 1: the weight of call 6 is off by 0.001"


def test_a_stage_moved_a_little_is_another_one():
    def step(f, t, y, h):
        near = f(t, y + 1e-12 * h * (k := f(t, y)))
        return y + h * k, lambda theta: y + h * (theta * near + (1 - theta) * theta * k)

    assert judged(step).faults[0] == "the dense output is not y1 at theta = 1: the weight of call 0 is off by -1"


WRONG = {
    "moved too early": weighted(first_and_last_exchanged),
    "a wrong digit": weighted(but_the_last(lambda row: [*row[:-1], row[-1] + 1e-3])),
    "not y at 0": weighted(but_the_last(lambda row: [0.25, row[1] - 0.5, *row[2:]])),
    "linear": weighted(lambda rows: [[0.0, sum(row), 0.0, 0.0, 0.0] for row in rows]),
    "linear late": shampine(lambda theta, h, right, straight: straight if 0.9 < theta < 1 else right),
    "linear back in time": shampine(lambda theta, h, right, straight: straight if h < 0 else right),
    "linear in between": shampine(lambda theta, h, right, straight: right if theta % 0.0625 == 0 else straight),
}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("name", WRONG)
def test_what_does_not_fit_is_at_fault(name, as_before):
    found = judged(WRONG[name])
    assert found.faults
    as_before(found.extension, found.order, found.degree, *found.lines, *found.faults)


@pytest.mark.parametrize(("first", "faults"), [(0, 0), (1, 1)])
def test_a_curve_of_second_order_steps_is_more_than_a_straight_line(first, faults):
    def step(f, t, y, h):
        k = [f(t, y)]
        k.append(f(t + h, y + h * k[0]))
        bend = lambda theta: theta**2 / 2
        return y + h / 2 * (k[0] + k[1]), lambda x: y + h * ((x - bend(x)) * k[first] + bend(x) * k[1 - first])

    found = judged(step)
    line = "the dense output has order 1 only, no more than the straight line from y to y1, the steps have order 2"
    assert found.faults == (line,) * faults
    assert not judged(lambda f, t, y, h: (y1 := step(f, t, y, h)[0], lambda x: y + x * (y1 - y))).faults


# Of one call, 12 roundings of numbers up to 2 in each value, as many of the line through two; of a slope 1 once more.
@pytest.mark.parametrize(("between", "end", "faults"), [(90, 0, 0), (100, 0, 1), (0, 46, 0), (0, 50, 1), (0, -50, 1)])
def test_a_dense_output_is_held_to_the_roundings_of_its_weights(between, end, faults):
    u, step = 2.0**-53, TableauReading(((0.0,),), (1.0,), (0.0,), BINARY64)
    others = tuple((theta, (float(theta) + between * u,)) for theta in BETWEEN)
    rows = tuple((float(theta),) for theta in THETAS)
    assert len(judged_reading(DenseReading("theta", step, rows, (1.0 + end * u,), others)).faults) == faults


@pytest.mark.parametrize(("power", "degree"), [(1, 1), (2, 2), (7, 7), (12, 12), (13, None)])
def test_a_dense_output_is_a_polynomial_up_to_degree_12(power, degree, as_before):
    step = TableauReading(((0.0, 0.0), (0.75, 0.0)), (0.25, 0.75), (0.0, 0.75), BINARY64)
    row = lambda theta: (float(theta) - 0.75 * float(theta) ** power, 0.75 * float(theta) ** power)
    others = tuple((theta, row(theta)) for theta in BETWEEN)
    found = judged_reading(DenseReading("theta", step, tuple(map(row, THETAS)), (0.25, 0.75), others))
    assert (found.degree, found.faults) == (degree, ())
    as_before(found.order, *found.lines)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda theta, h, right, straight: np.minimum(right, 1e-3), "is right neither half-way nor at the end"),
        (
            lambda theta, h, right, straight: np.array([*right[:-1], *straight[-1:]]) if len(right) > 2 else right,
            "the components of y are not advanced alike",
        ),
    ],
)
def test_a_dense_output_that_is_no_sum_of_slopes_alike_in_all_numbers_leaves_it_undecided(change, words):
    report = verify(shampine(change), "dormand_prince54", examples=20, isolate=False)
    assert report.passed is None
    assert words in report.section("Dense output: undecided").lines[0]
    assert report.section("What would decide it").lines[0].startswith("dense output: a dense output that is a sum of ")
