"""Every test of this folder measures quickly."""

from __future__ import annotations

import pytest

from tests.reports.studies import be_quick


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """As `be_quick`."""
    be_quick(monkeypatch)
