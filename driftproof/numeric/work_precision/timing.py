"""Time calls side by side: short ones in batches, in random order, in several rounds, garbage collection off."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from random import Random
from statistics import median, quantiles
from time import perf_counter

from driftproof.support.plain_text import with_digits

ROUNDS = 5
# A call shorter than SHORT seconds is repeated in a batch of about BATCH seconds, long enough to hide the clock's cost.
SHORT, BATCH = 10e-6, 100e-6
SEED = 1


@dataclass
class Timing:
    """The seconds of one call, one sample per round, each the mean of a batch of `batch` calls."""

    batch: int = 1
    samples: list[float] = field(default_factory=list)
    remark: str = ""  # why the call was not timed
    too_long: bool = False  # whether that is why

    @property
    def best(self) -> float:
        """The minimum, which is the estimate, because disturbances only make a run longer."""
        return min(self.samples)

    @property
    def median(self) -> float:
        """The median of the samples."""
        return median(self.samples)

    @property
    def spread(self) -> float | None:
        """The interquartile range of the samples over their median; None for a single sample."""
        if len(self.samples) < 2:
            return None
        low, _, high = quantiles(self.samples, n=4, method="inclusive")
        return (high - low) / median(self.samples)


TimeSource = Callable[[], float]


def started(call: Callable[[], object], clock: TimeSource = perf_counter) -> tuple[Timing, float]:
    """Return a timing without samples, its batch chosen by a trial call, and the seconds which that call took."""
    seconds = _seconds(call, 1, clock)
    batch = 1 if seconds >= SHORT else round(BATCH / max(seconds, SHORT / 100))
    return Timing(batch), seconds


def interleave(
    calls: Mapping[str, Callable[[], object]],
    timings: Mapping[str, Timing],
    *,
    limit: float,
    rounds: int = ROUNDS,
    seed: int = SEED,
    clock: TimeSource = perf_counter,
) -> Iterator[str]:
    """Take one more sample of each call that has fewer than `rounds`, in every round in a new random order.

    Turns interleave, so that a busy moment of the machine meets all calls. A call that has spent `limit` seconds gets
    no further turn. Yields the name after each sample, which is in `timings` by then, and "" after each round.
    """
    order = Random(seed)
    for _ in range(rounds):
        names = sorted(name for name in calls if needs_more_samples(timings[name], rounds, limit))
        order.shuffle(names)
        for name in names:
            timing = timings[name]
            timing.samples.append(_seconds(calls[name], timing.batch, clock))
            yield name
        yield ""


def needs_more_samples(timing: Timing, rounds: int, limit: float) -> bool:
    """True if a timing has too few samples, time left to spend, and no remark."""
    spent = sum(timing.samples) * timing.batch
    return not timing.remark and len(timing.samples) < rounds and spent < limit


def _seconds(call: Callable[[], object], batch: int, clock: TimeSource) -> float:
    with collector_off():
        before = clock()
        for _ in range(batch):
            call()
        return (clock() - before) / batch


@contextmanager
def collector_off() -> Iterator[None]:
    """Turn garbage collection off in a block, as `timeit` does."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def seconds_text(seconds: float) -> str:
    """The seconds with three digits, in ns, µs, ms or s."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{with_digits(seconds / size, 3)} {unit}"
    return f"{with_digits(seconds / 1e-9, 3)} ns"
