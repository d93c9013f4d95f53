"""Packages that only some commands need: what to install where one is missing."""

from __future__ import annotations

from importlib.util import find_spec


def installed(package: str) -> bool:
    """True where the package can be imported."""
    return find_spec(package) is not None


def how_to_install(extra: str) -> str:
    """What to type for an extra of ours."""
    return f"pip install 'driftproof[{extra}]'"


def demand(package: str, extra: str, need: str) -> None:
    """Raises ValueError with one line, `need` and what to type, if the package is not there: before work is done."""
    if not installed(package):
        raise ValueError(f"{need}; install it with {how_to_install(extra)}")


def demand_pictures() -> None:
    """Raises ValueError if nothing can be drawn."""
    demand("matplotlib", "report", "pictures need matplotlib")
