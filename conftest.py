"""Hypothesis profiles, and which tests are run, for the proofs and the tests alike."""

from __future__ import annotations

import gc
import os
from collections import defaultdict
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Deadlines would time the machine, not the code; a printed blob reproduces a failure elsewhere.
# Randomness is spelled out because Hypothesis derandomises by itself wherever a variable CI is set, to anything.
# By default half as many examples as Hypothesis takes: they are others in each run.
settings.register_profile("default", deadline=None, print_blob=True, derandomize=False, max_examples=50)
settings.register_profile("ci", parent=settings.get_profile("default"), derandomize=True, max_examples=100)
settings.register_profile(
    "thorough", parent=settings.get_profile("default"), max_examples=2000, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile(
    os.environ.get("HYPOTHESIS_PROFILE") or ("ci" if os.environ.get("CI", "").lower() == "true" else "default")
)


def pytest_configure(config: pytest.Config) -> None:
    """Without -m, what is `slow` or `long` is left out."""
    config.option.markexpr = config.option.markexpr or "not (slow or long)"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of the cases of a test that is `slow` with some to keep, take the mark from as many, spread evenly over them."""
    cases = defaultdict[tuple[Path, str, int], list[pytest.Item]](list)
    for item in items:
        if (mark := item.get_closest_marker("slow")) and mark.kwargs and not item.get_closest_marker("long"):
            cases[item.path, item.originalname, mark.kwargs["keep"]].append(item)  # type: ignore[attr-defined]
    for (*_, keep), of_one in cases.items():
        kept = min(keep, len(of_one))
        for k in range(kept):
            item = of_one[k * len(of_one) // kept]
            item.own_markers = [mark for mark in item.own_markers if mark.name != "slow"]


def pytest_collection_finish() -> None:
    """Let the garbage collector leave alone what was imported, which it would look through again and again."""
    gc.freeze()
    gc.set_threshold(20_000)
