"""What tests of this folder are given: transcripts hold, too, how far rounding may carry what was compared."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from driftproof.blackbox.probes.scripted_answers import Rounding
from tests.blackbox.transcripts import checksum


@pytest.fixture
def as_before(as_before: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """As elsewhere, with a checksum of all that was allowed to three digits: a bound twice as wide is noticed."""
    allowed, of = list[str](), Rounding.of

    def noted(self: Rounding, size: Any) -> float:
        allowed.append(f"{of(self, size):.3g}")
        return of(self, size)

    monkeypatch.setattr(Rounding, "of", noted)
    return lambda *said: as_before(*said, f"allowed {len(allowed)} times, {checksum(' '.join(allowed))}")
