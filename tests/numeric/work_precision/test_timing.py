"""Calls timed side by side, by a clock that moves by what the calls take."""

from __future__ import annotations

import gc

import pytest

from driftproof.numeric.work_precision.timing import BATCH, SHORT, Timing, interleave, started


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
    for seconds, batch in ((0.0, 1000), (5e-6, 20), (9e-6, 11), (10e-6, 1)):
        assert started((fresh := FakeClock()).call(seconds), fresh)[0].batch == batch  # type: ignore[arg-type]
    short, _ = started(clock.call(1e-6), clock)  # type: ignore[arg-type]
    long, seconds = started(clock.call(2 * SHORT), clock)  # type: ignore[arg-type]
    assert short.batch == round(BATCH / 1e-6)
    assert long.batch == 1
    assert clock.now == pytest.approx(1e-6 + 2 * SHORT), "one call each, which is not kept"
    assert seconds == pytest.approx(2 * SHORT)
    assert not short.samples


def test_turns_interleave_in_a_random_order_that_the_seed_fixes() -> None:
    def order(**seed: int) -> list[str]:
        clock, names = FakeClock(), "abcdef"
        timings = {name: Timing() for name in names}
        calls = {name: clock.call(1e-3) for name in names}
        return list(interleave(calls, timings, limit=1, clock=clock, **seed))  # type: ignore[arg-type]

    turns = order(seed=1)
    rounds = "".join(turn or "|" for turn in turns).split("|")[:-1]
    assert [sorted(turn) for turn in rounds] == [list("abcdef")] * 5
    assert len(set(rounds)) > 1
    assert order() == turns != order(seed=2)


def test_samples_are_seconds_of_one_call_and_their_minimum_median_and_spread_are_read() -> None:
    clock = FakeClock()
    timings = {"a": Timing(batch=2)}
    calls = {"a": clock.call(*[x for pair in ((1, 1), (4, 4), (2, 2), (3, 3), (9, 9)) for x in pair])}
    list(interleave(calls, timings, limit=100, clock=clock))  # type: ignore[arg-type]
    timing = timings["a"]
    assert timing.samples == [1, 4, 2, 3, 9]
    assert (timing.best, timing.median, timing.spread) == (1, 3, (4 - 2) / 3)
    assert (Timing().batch, Timing(samples=[1.0]).spread) == (1, None)
    assert Timing(samples=[1.0, 3.0]).spread == 0.5


def test_a_call_that_has_spent_its_time_gets_no_further_turn() -> None:
    clock = FakeClock()
    timings = {"slow": Timing(), "quick": Timing(), "marked": Timing(remark="too long")}
    calls = {"slow": clock.call(2.0), "quick": clock.call(0.1), "marked": clock.call(1.0)}
    list(interleave(calls, timings, limit=2, clock=clock))  # type: ignore[arg-type]
    assert [len(timing.samples) for timing in timings.values()] == [1, 5, 0]


@pytest.mark.parametrize("before", [True, False])
def test_no_garbage_is_collected_while_a_call_is_timed_and_afterwards_it_is_as_before(before: bool) -> None:
    meanwhile: list[bool] = []
    try:
        (gc.enable if before else gc.disable)()
        started(lambda: meanwhile.append(gc.isenabled()))
        assert (meanwhile, gc.isenabled()) == ([False], before)
    finally:
        gc.enable()
