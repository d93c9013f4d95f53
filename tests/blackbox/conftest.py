"""What tests of this folder are given: the transcript that stands under their name."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.blackbox.transcripts import assert_as_before


@pytest.fixture
def as_before(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Called with lines: they are those that the text file beside the test file has under the name of the test."""
    return lambda *said: assert_as_before(request.path.with_suffix(".txt"), request.node.name, said)
