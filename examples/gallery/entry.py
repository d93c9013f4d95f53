"""One line of the gallery: where a package's stepper is, and what the package says that it is."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


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


def targets(
    module: str, package: str, *, array: str | None = None, rounds: str = "", **claims: Mapping[str, Sequence[Any]]
) -> dict[str, Entry]:
    """The table of a module, named `package step`: by calling convention, the claim of each step.

    That is the claimed method, its order and its catalogue key; one that begins with the step itself, which is not a
    function of the module, gives it its name there.
    """
    found = {}
    for calls, of_steps in claims.items():
        for step, claim in of_steps.items():
            made, method, order, *key = claim if callable(claim[0]) else (None, *claim)
            if made is not None:
                setattr(sys.modules[module], step, made)
            found[f"{package} {step}"] = Entry(
                f"{module}:{step}", package, method, order, calls, *key, array=array, rounds=rounds
            )
    return found
