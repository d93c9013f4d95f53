"""Hypothesis profiles and the `long` marker, for the proofs and the tests alike."""

from __future__ import annotations

import gc
import os

import pytest
from hypothesis import HealthCheck, settings

# Deadlines would time the machine, not the code; a printed blob reproduces a failure elsewhere.
# Randomness is spelled out because Hypothesis derandomises by itself wherever a variable CI is set, to anything.
settings.register_profile("default", deadline=None, print_blob=True, derandomize=False)
settings.register_profile("ci", parent=settings.get_profile("default"), derandomize=True)
settings.register_profile(
    "thorough", parent=settings.get_profile("default"), max_examples=2000, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile(
    os.environ.get("HYPOTHESIS_PROFILE") or ("ci" if os.environ.get("CI", "").lower() == "true" else "default")
)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip what is marked `long` unless -m names it."""
    if "long" in config.option.markexpr:
        return
    for item in items:
        if item.get_closest_marker("long"):
            item.add_marker(pytest.mark.skip(reason="long; run with -m long"))


def pytest_collection_finish() -> None:
    """Let the garbage collector leave alone what was imported, which it would look through again and again."""
    gc.freeze()
    gc.set_threshold(20_000)
