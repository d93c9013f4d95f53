"""One line of the gallery: where a package's stepper is, and what the package says that it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """A stepper as `module:name`, the package it comes from, and the package's own claim: a method and its order.

    `key` is the claimed method in driftproof's catalogue, where it stands there; `order` is None where none is claimed.
    `rounds` says what it does, by its source, besides rounding the method's sums and products.
    """

    step: str
    package: str
    method: str
    order: int | None
    calls: str
    key: str | None = None
    array: str | None = None
    rounds: str = ""


Claim = tuple[str, int | None] | tuple[str, int | None, str]


def targets(
    module: str, package: str, calls: str, claims: Mapping[str, Claim], array: str | None = None, rounds: str = ""
) -> dict[str, Entry]:
    """The table of a module, named `package step`: of each step the claimed method, its order and its catalogue key."""
    maker = f"{module}:{array}" if array else None
    return {
        f"{package} {step}": Entry(
            f"{module}:{step}", package, claim[0], claim[1], calls, *claim[2:], array=maker, rounds=rounds
        )
        for step, claim in claims.items()
    }
