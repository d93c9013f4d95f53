"""What tests of this folder are given: the transcript that stands under their name."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.blackbox.transcripts import assert_as_before

_COLLECTED: defaultdict[Path, set[str]] = defaultdict(set)


def pytest_itemcollected(item: pytest.Item) -> None:
    """Also those that are left out afterwards."""
    _COLLECTED[item.path].add(item.name)


@pytest.fixture
def as_before(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Called with lines: they are those that the text file beside the test file has under the name of the test."""
    tests = () if any("::" in chosen for chosen in request.config.args) else _COLLECTED[request.path]
    return lambda *said: assert_as_before(request.path.with_suffix(".txt"), request.node.name, said, tests)
