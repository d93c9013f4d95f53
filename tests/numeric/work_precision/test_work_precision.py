"""Error against evaluations: exact errors, counted work, orders, and verdicts, each with an instrument broken."""

from __future__ import annotations

import dataclasses
from decimal import Decimal
from fractions import Fraction as Q
from math import cos, hypot, inf, sin

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.fields import Field
from driftproof.methods.schemes import RungeKutta
from driftproof.numeric.advance import field_rate
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.numeric.problems.problem import EXACT, Problem, Reference
from driftproof.numeric.work_precision.curves import (
    FLOOR_POINTS,
    Curve,
    Point,
    counts,
    curve_of,
    curves,
    measure_curve,
    step_counts,
)
from driftproof.numeric.work_precision.exact import (
    ENERGY,
    PHASE,
    STATE,
    Size,
    U,
    decimal_energy,
    distance_from_digits,
    doubt,
    errors,
    floors,
    half_unit,
)
from driftproof.numeric.work_precision.integrators import (
    KINDS,
    PYTHON,
    CountedRun,
    Integrator,
    counted_evaluations,
    integrator,
)
from driftproof.numeric.work_precision.timing import BATCH, ROUNDS, SHORT, Timing, interleave, started
from driftproof.numeric.work_precision.verdicts import Priced, cheapest, dominators

T = Q(10)
RUNGS = (64, 128, 256, 512)


def test_distance_of_floats_from_digits_is_exact_where_a_difference_of_floats_is_not() -> None:
    tenth = Q(0.1) - Q(1, 10)
    assert distance_from_digits((0.1, 0.0), ("0.1", "0")) == float(tenth) != 0.1 - float("0.1")
    assert distance_from_digits((3.0, 4.0), ("0", "0")) == 5


def test_half_unit_is_that_of_the_last_digit_printed() -> None:
    assert half_unit(("0.123",)) == 0.0005
    assert half_unit(("1e-7", "-2e-7")) == float(Decimal("0.5e-7") * Decimal(2).sqrt())
    assert half_unit(("0.1230",)) == 0.00005


def test_errors_of_the_exact_state_are_below_the_floor_and_those_of_another_are_not() -> None:
    exact = (cos(10), -sin(10))
    found, floor = errors(HARMONIC, {T: exact}), floors(HARMONIC)
    assert all(found[name].final <= floor[name] for name in (STATE, ENERGY, PHASE))
    off = errors(HARMONIC, {T: (exact[0] + 1e-12, exact[1])})
    assert all(off[name].final > 1000 * floor[name] for name in (STATE, ENERGY, PHASE))


def test_largest_error_is_over_the_times_that_were_landed_on() -> None:
    half = HARMONIC.reference.times[3]
    found = errors(HARMONIC, {half: (2.0, 0.0), T: (cos(10), -sin(10))})
    assert found[STATE].largest > 1 > found[STATE].final


def test_phase_of_a_state_turned_by_a_degree_is_a_degree_and_undefined_at_the_origin() -> None:
    degree = 3.141592653589793 / 180
    assert abs(errors(HARMONIC, {T: (cos(10 + degree), -sin(10 + degree))})[PHASE].final - 1) < 1e-13
    assert errors(HARMONIC, {T: (0.0, 0.0)})[PHASE].final == 180


def test_a_state_that_is_not_finite_has_no_error() -> None:
    with pytest.raises(ArithmeticError, match="no longer finite"):
        errors(HARMONIC, {T: (inf, 0.0)})


@pytest.mark.parametrize(("name", "function"), [("sin", sin), ("cos", cos)])
@pytest.mark.parametrize("x", [0.0, 0.5, -3.0, 40.0])
def test_energy_computes_functions_far_below_rounding(name: str, function: object, x: float) -> None:
    problem = _decay(energy=f"{name}(y0)")
    assert float(decimal_energy(problem, [x])) == pytest.approx(function(x), abs=2**-52, rel=2**-52)  # type: ignore[operator]
    square = decimal_energy(_decay(energy="sin(y0) * sin(y0) + cos(y0) * cos(y0)"), [x])
    assert abs(square - 1) < Decimal("1e-50")


def test_energy_reads_parameters_division_and_signs() -> None:
    problem = _decay(energy="-rate * y0 / 2 + exp(log(3)) - sqrt(4)")
    assert abs(6 * Q(decimal_energy(problem, [Q(1, 3)])) - 7) < Q(1, 10**50)


def _decay(energy: str | None = None) -> Problem:
    reference = Reference((Q(1),), (("0.36787944117144232160",),), EXACT, "1/e")
    rates = Field(("rate * y0",), (("rate", Q(-1)),))
    return Problem("decay", "y' = -y", rates, (Q(1),), reference, "test", energy=energy)


def test_doubt_grows_with_the_steps_and_covers_the_rounding_of_a_run_whose_method_is_exact_enough() -> None:
    found = measure_curve(HARMONIC, integrator(METHODS["dop853"], HARMONIC), (256, 512, 1024))
    assert all(0 < point.error < point.doubt for point in found)
    assert doubt(HARMONIC, 1024, 1.0) > 1.9 * doubt(HARMONIC, 512, 1.0) > float(512 * U)


def test_ladder_lands_on_the_references_times_and_only_on_the_last_where_that_would_cost_too_much() -> None:
    assert step_counts(HARMONIC, 100) == (8, 16, 32, 64)
    times = (Q(1, 997), Q(1))
    awkward = dataclasses.replace(_decay(), reference=Reference(times, (("1",), ("1",)), EXACT, ""))
    assert step_counts(awkward, 64) == (8, 16, 32, 64)
    thirds = dataclasses.replace(_decay(), reference=Reference((Q(1, 3), Q(1)), (("1",), ("1",)), EXACT, ""))
    assert step_counts(thirds, 64) == (9, 18, 36)
    assert set(integrator(METHODS["rk4"], HARMONIC).run(8).states) == set(HARMONIC.reference.times)
    assert set(integrator(METHODS["rk4"], HARMONIC).run(9).states) == {T}


@pytest.mark.parametrize(
    ("key", "a_step"), [("forward_euler", 1), ("velocity_verlet", 2), ("rk4", 4), ("nystrom5", 4), ("dop853", 12)]
)
def test_evaluations_are_counted_on_the_program_that_runs(key: str, a_step: int) -> None:
    assert counted_evaluations(METHODS[key], HARMONIC, 100) == 100 * a_step
    assert curves(HARMONIC, [key], [16])[0].points[0].evaluations == 16 * a_step


def test_evaluations_of_an_implicit_method_are_the_calls_that_it_makes() -> None:
    few, more = curves(HARMONIC, ["implicit_midpoint"], [64, 128])[0].points
    assert few.evaluations is not None
    assert more.evaluations is not None
    assert 64 < few.evaluations < more.evaluations


@pytest.mark.parametrize("key", ["forward_euler", "symplectic_euler", "velocity_verlet", "rk4", "nystrom5", "gauss2"])
def test_measured_order_is_the_claimed_one(key: str) -> None:
    (curve,) = curves(HARMONIC, [key], RUNGS)
    assert curve.order is not None
    assert curve.order.least <= curve.order.median <= curve.order.largest
    assert curve.verdict == ""


def test_a_method_with_one_coefficient_wrong_is_flagged() -> None:
    rk4 = METHODS["rk4"]
    assert isinstance(rk4, RungeKutta)
    wrong = dataclasses.replace(rk4, b=(rk4.b[0] + Q(1, 24), rk4.b[1] - Q(1, 24), *rk4.b[2:]))
    assert curve_of(wrong, HARMONIC, RUNGS).verdict == "below the order 4 claimed"
    modest = dataclasses.replace(rk4, claimed_order=3)
    assert curve_of(modest, HARMONIC, RUNGS).verdict == "above the order 3 claimed"


def test_slopes_a_whole_order_apart_are_not_settled() -> None:
    curve = Curve("a", "A", 2, [_point(n, e) for n, e in ((8, 1.0), (16, 0.25), (32, 0.2), (64, 0.001))])
    assert curve.verdict == "not settled"


def test_points_as_large_as_the_solution_or_near_the_floor_tell_no_order() -> None:
    assert counts(_point(8, 0.5))
    assert not counts(dataclasses.replace(_point(8, 0.5), scale=0.4))
    assert not counts(dataclasses.replace(_point(8, 0.5), doubt=0.1))
    assert not counts(Point("8", None, remark="not finite", steps=8))
    (curve,) = curves(problem_named("stiff_pair"), ["rk4"], [8, 16, 32, 64])
    assert curve.order is None


def _point(steps: int, error: float) -> Point:
    return Point(str(steps), steps, {STATE: Size(error, error)}, steps=steps)


def test_a_splitting_on_a_first_order_problem_is_refused_with_the_reason() -> None:
    refused, runs = curves(problem_named("dahlquist_1"), ["velocity_verlet", "rk4"], [8])
    assert "second-order" in refused.refused
    assert not refused.points
    assert runs.points
    assert not runs.refused


def test_a_run_that_overflows_is_a_point_that_says_so() -> None:
    first, *_ = curves(problem_named("dahlquist_1e6"), ["rk4"], [64, 128])[0].points
    assert first.error == inf
    assert "finite" in first.remark or "range" in first.remark


def test_climb_ends_at_the_floor() -> None:
    (curve,) = curves(HARMONIC, ["dop853"])
    at_floor = [point for point in curve.points if point.error <= point.doubt]
    assert len(at_floor) == FLOOR_POINTS
    assert curve.points[-1] is at_floor[-1]


def test_climb_marks_a_run_that_would_take_too_long_and_makes_none_after_it() -> None:
    made = []

    def slow(steps: int) -> CountedRun:
        made.append(steps)
        sum(range(40 * steps))
        return CountedRun({T: (1.0, 0.0)}, steps)

    found = measure_curve(HARMONIC, Integrator(slow, {}, {}), (8, 10**9, 10**10), limit=1)
    assert [point.steps for point in found] == [8, 10**9]
    assert found[-1].remark.startswith("not run: would take about")
    assert set(made) == {8}


def test_timed_calls_reach_the_state_whose_error_is_measured() -> None:
    for key in ("rk4", "velocity_verlet", "gauss2"):
        runs = integrator(METHODS[key], HARMONIC)
        assert runs.calls[PYTHON](16)() == runs.run(16).states[T]
        assert {*runs.calls, *runs.absent} <= set(KINDS)


def test_an_ensemble_reaches_the_same_bits_and_is_refused_where_there_is_none() -> None:
    runs = integrator(METHODS["rk4"], HARMONIC)
    call = runs.calls["ensemble"](16)
    assert call() == call() == runs.run(16).states[T]
    assert "one position" in integrator(METHODS["rk4"], problem_named("stiff_pair")).absent["ensemble"]


def test_rate_of_a_field_is_the_field_whatever_its_parameters_are_called() -> None:
    rate = field_rate(Field(("rate * y1 + t", "sin(y0)"), (("rate", Q(1, 2)),)))
    assert rate(3.0, [0.5, 4.0]) == [5.0, sin(0.5)]
    doubling = field_rate(Field(("sin(y0)",)), {"sin": lambda x: 2 * x})
    assert doubling(0.0, [4]) == [8]


class FakeClock:
    """A clock that moves by what the calls take."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now

    def call(self, *seconds: float) -> object:
        taken = iter([*seconds, *[seconds[-1]] * 10**6])

        def work() -> None:
            self.now += next(taken)

        return work


def test_short_calls_are_timed_in_batches_and_long_ones_alone() -> None:
    clock = FakeClock()
    short, _ = started(clock.call(1e-6), clock)  # type: ignore[arg-type]
    long, seconds = started(clock.call(2 * SHORT), clock)  # type: ignore[arg-type]
    assert short.batch == round(BATCH / 1e-6)
    assert long.batch == 1
    assert seconds == pytest.approx(2 * SHORT)
    assert not short.samples


def test_turns_interleave_in_a_random_order_that_the_seed_fixes() -> None:
    def order(seed: int) -> list[str]:
        clock, names = FakeClock(), "abcdef"
        timings = {name: Timing() for name in names}
        calls = {name: clock.call(1e-3) for name in names}
        return list(interleave(calls, timings, limit=1, seed=seed, clock=clock))  # type: ignore[arg-type]

    turns = order(1)
    rounds = "".join(turn or "|" for turn in turns).split("|")[:-1]
    assert [sorted(turn) for turn in rounds] == [list("abcdef")] * ROUNDS
    assert len(set(rounds)) > 1
    assert order(1) == turns != order(2)


def test_samples_are_seconds_of_one_call_and_their_minimum_median_and_spread_are_read() -> None:
    clock = FakeClock()
    timings = {"a": Timing(batch=2)}
    calls = {"a": clock.call(*[x for pair in ((1, 1), (4, 4), (2, 2), (3, 3), (9, 9)) for x in pair])}
    list(interleave(calls, timings, limit=100, clock=clock))  # type: ignore[arg-type]
    timing = timings["a"]
    assert timing.samples == [1, 4, 2, 3, 9]
    assert (timing.best, timing.median, timing.spread) == (1, 3, (4 - 2) / 3)
    assert Timing(samples=[1.0]).spread is None


def test_a_call_that_has_spent_its_time_gets_no_further_turn() -> None:
    clock = FakeClock()
    timings = {"slow": Timing(), "quick": Timing(), "marked": Timing(remark="too long")}
    calls = {"slow": clock.call(2.0), "quick": clock.call(0.1), "marked": clock.call(1.0)}
    list(interleave(calls, timings, limit=1, clock=clock))  # type: ignore[arg-type]
    assert [len(timing.samples) for timing in timings.values()] == [1, ROUNDS, 0]


FAST = [Priced(1e-2, 1), Priced(1e-4, 2)]
SLOW = [Priced(1e-2, 2), Priced(1e-3, 3)]


def test_cheapest_is_a_measured_point_and_none_where_no_point_meets_the_goal() -> None:
    assert cheapest([*SLOW, *FAST], 1e-3) == Priced(1e-4, 2)
    assert cheapest(SLOW, 5e-4) is None
    assert cheapest([], 1) is None
    assert cheapest([*SLOW, Priced(1e-9, inf)], 5e-4) is None


def test_a_method_is_dominated_when_every_point_is_and_its_twin_with_one_good_point_is_not() -> None:
    assert dominators({"fast": FAST, "slow": SLOW}) == {"slow": ["fast"]}
    assert dominators({"fast": FAST, "slow": [*SLOW, Priced(1e-5, 9)]}) == {}
    assert dominators({"fast": FAST, "same": list(FAST)}) == {}
    assert dominators({"fast": FAST, "none": [Priced(inf, 1)]}) == {}


def test_a_point_over_the_limit_is_beaten_by_no_larger_error_and_beats_none() -> None:
    assert dominators({"fast": FAST, "slow": [*SLOW, Priced(1e-3, inf)]}) == {"slow": ["fast"]}
    assert dominators({"fast": FAST, "slow": [*SLOW, Priced(1e-5, inf)]}) == {}
    assert dominators({"a": [Priced(1e-3, inf)], "b": [Priced(1e-2, inf)]}) == {}


def test_those_that_dominate_together_are_all_named() -> None:
    of = {"a": [Priced(1, 1)], "b": [Priced(0.1, 10)], "c": [Priced(1, 2), Priced(0.1, 11), Priced(0.2, 12)]}
    assert dominators(of) == {"c": ["b", "a"]}


def test_speed_of_the_oscillator_is_its_size() -> None:
    assert hypot(*field_rate(HARMONIC.field)(10.0, [cos(10), -sin(10)])) == pytest.approx(1, abs=1e-15)
