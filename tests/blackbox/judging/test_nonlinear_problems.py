"""The nonlinear problems are solved by what they say, and ask a stepper with as many numbers as it takes, in time."""

from itertools import product
from math import exp

import pytest
from flint import arb, ctx

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.judging.nonlinear_problems import (
    dragged_problem,
    field_problem,
    force_problem,
    moved,
    pushed,
    walls,
)
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.dragged_steppers import of_stages, semi_implicit


def rk4_of_two(f, t, y, h):
    q, v = y
    return codes.rk4(f, t, y + 0 * (q + v), h)


def rk4_of_one_without_time(f, y, h):
    return codes.rk4_of_one_number(lambda t, y: f(y), 0.0, y, h)


CODES = {
    "a nonlinear problem of 4 components, with t": codes.rk4,
    "a nonlinear problem of 4 components, without t: the code passes no time": codes.rk4_without_time,
    "a nonlinear problem of 2 components, with t": rk4_of_two,
    "a nonlinear problem of 1 component, with t": codes.rk4_of_one_number,
    "y' = exp(-y), without t: the code passes no time": rk4_of_one_without_time,
}
PROBLEMS = [*((words, field_problem(opened(step))) for words, step in CODES.items())]
PROBLEMS += [
    ("q'' = exp(-2q)", force_problem(opened(codes.velocity_verlet))),
    ("q'' = exp(-2q) of 2 positions", walls(2)),
    ("a nonlinear q'' = F(t, q)", force_problem(opened(codes.rk4))),
    ("a nonlinear q'' = F(t, q) of 2 positions", pushed(2, timed=True)),
    ("a nonlinear q'' = F(q) of 3 positions, one being the time", pushed(3, timed=False)),
    ("a nonlinear q'' = F(t, q, v)", dragged_problem(opened(of_stages("rk4")))),
    ("a nonlinear q'' = F(t, q, v) of 3 positions", dragged_problem(opened(of_stages("rk4")), 3)),
    ("a nonlinear q'' = F(q, v) of 2 positions", dragged_problem(opened(semi_implicit), 2)),
]


@pytest.mark.parametrize(("words", "problem"), PROBLEMS, ids=[words for words, _ in PROBLEMS])
def test_the_solution_solves_the_problem_and_the_code_is_asked_as_it_asks(words, problem):
    assert problem.words == words
    with ctx.workprec(400):
        width = arb(2) ** -100
        for t in (0.25, 1.5):
            here, before, after = (problem.solution(arb(t) + k * width) for k in (0, -1, 1))
            slopes = problem.rate(arb(t), here)
            differences = [(y - x) / (2 * width) for x, y in zip(before, after, strict=True)]
            assert all(abs(x - y) < 2.0**-180 for x, y in zip(slopes, differences, strict=True))


@pytest.mark.parametrize("problem", [problem for _, problem in PROBLEMS], ids=[words for words, _ in PROBLEMS])
def test_what_a_problem_asks_is_what_it_was_and_at_other_sizes_and_times(problem, as_before):
    said = []
    for each in (problem, moved(problem, (2.0, -0.5, 8.0), 4.0, -1.5)):
        n, y = each.positions, [float(x.mid()) + i / 7 for i, x in enumerate(each.solution(arb(0.3)))]
        forces = each.force(-0.4, y[:n]) if n and not each.dragged else []
        numbers = (*y, *each.rate(0.3, y), *each.rate(arb(0.7), [arb(x) for x in y]), *forces)
        said += [(n, each.names, each.scales, each.timed, each.coupled), " ".join(f"{float(x):.12g}" for x in numbers)]
    as_before(*said)


def test_every_slope_depends_on_the_time_and_on_other_numbers():
    problem = field_problem(opened(codes.rk4))
    y = [0.5, 0.75, -0.25, 1.0]
    assert all(a != b for a, b in zip(problem.rate(0.25, y), problem.rate(0.5, y), strict=True))
    euler = opened(of_stages("forward_euler"))  # of a force of position, velocity and time
    dragged, z = dragged_problem(euler), y[:2]
    moved = [a + 0.5 * k for a, k in zip(z, dragged.rate(0.25, z), strict=True)]
    assert dragged.stepped(euler, 0.25, z, 0.5) == pytest.approx(moved, rel=1e-14)
    for i, j in product(range(4), range(4)):
        moved = [x + 0.125 * (k == j) for k, x in enumerate(y)]
        assert (problem.rate(0.25, moved)[i] != problem.rate(0.25, y)[i]) == ((j - i) % 4 < 3)


def test_a_code_that_takes_none_of_the_sizes_is_not_asked():
    subject = opened(codes.euler)
    subject.function = lambda f, t, y, h: None
    with pytest.raises(Misbehaviour):
        field_problem(subject)
    with pytest.raises(UnsupportedCall):
        field_problem(opened(codes.velocity_verlet))


def test_a_step_that_goes_far_meets_no_force_beyond_that_of_the_largest_exponent():
    assert walls(1).rate(0.0, [-1e9, 2.0]) == [2.0, exp(700.0)]
