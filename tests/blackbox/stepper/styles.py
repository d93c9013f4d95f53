"""The page docs/steppers.md, read: each of its styles as code, with the method that it is, and the wrapper if any."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from driftproof.blackbox.families.reports import read_family
from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.matching.linear_match import linear_fit
from driftproof.blackbox.matching.match import matched
from driftproof.blackbox.probes.questions import read_coefficients
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.looping import exactly

PAGE = Path(__file__).parents[3] / "docs" / "steppers.md"
_BLOCKS = r"```python\n(.*?)```\n(?:\n```text\n(.*?)```\n)?"
_STYLE = re.compile(rf"^### ([^\n]*)\n(?:(?!###).)*?{_BLOCKS}\nIt is `(\w+)`", re.DOTALL | re.MULTILINE)
# Loaded where a style needs it, and is left out where it is not installed.
OPTIONAL = ("torch", "jax", "numba")


class Style(NamedTuple):
    """One example of the page."""

    title: str
    code: str
    wrapper: str
    key: str

    @property
    def needs(self) -> list[str]:
        """The packages without which it does not run, of those that are not installed."""
        return [name for name in OPTIONAL if f"{name}." in self.code and find_spec(name) is None]


def styles() -> list[Style]:
    """All of the page."""
    return [Style(*found) for found in _STYLE.findall(PAGE.read_text(encoding="utf-8"))]


def namespace(code: str) -> dict[str, Any]:
    """What the code defines, beside the names that the page takes for granted."""
    known = {"np": np, "dataclass": dataclass, "NamedTuple": NamedTuple, "partial": partial}
    known |= {"__name__": __name__} | {name: __import__(name) for name in OPTIONAL if f"{name}." in code}
    exec(code, known)
    return known


def defined(code: str) -> Callable[..., Any]:
    """The stepper: the last thing that the code defines."""
    found: Callable[..., Any] = list(namespace(code).values())[-1]
    return found


STYLES = exactly(54, styles())


def keys_of(step: Callable[..., Any]) -> tuple[str, ...]:
    """The methods of the catalogue that a stepper is, as its coefficients or its one-step matrix tell."""
    subject = opened(step)
    if subject.convention.kind != MAP:
        return tuple(matched(read_coefficients(subject)).keys)
    best = linear_fit(subject).best
    return () if best is None else tuple(best.methods)


def pasted(names: dict[str, Any], name: str) -> str:
    """What the refusal of what has this name says; its wrapper is pasted, and is then `wrapped` among the names."""
    with pytest.raises(BadInput, match="write: ") as caught:
        opened(names[name])
    exec(str(caught.value).partition("write: ")[2], names)
    return str(caught.value)


def is_read_as(step: Callable[..., Any], key: str) -> bool:
    """True if a stepper is this method by its coefficients, its one-step matrix, or its steps from earlier ones."""
    if key in METHODS:
        return key in keys_of(step)
    family = read_family(opened(step))
    return family is not None and family.key == key
