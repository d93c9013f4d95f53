"""Every test of this folder measures quickly."""

import pytest

from tests.reports.studies import be_quick


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """As `be_quick`."""
    be_quick(monkeypatch)
