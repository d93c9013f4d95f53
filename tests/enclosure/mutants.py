"""Modules of the enclosure with a line of their text replaced: wrong enclosures, for the tests to catch."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from sys import modules
from types import ModuleType


def mutant(name: str, *replaced: tuple[str, str]) -> ModuleType:
    """driftproof.enclosure.<name> with each old text, which stands there once, replaced by the new."""
    spec = find_spec(f"driftproof.enclosure.{name}")
    text = Path(spec.origin).read_text(encoding="utf-8")
    for old, new in replaced:
        if text.count(old) != 1:
            raise ValueError(f"{old!r} stands {text.count(old)} times in {name}")
        text = text.replace(old, new)
    module = ModuleType(f"mutant_of_{name}")
    # Dataclasses look their module up while it is made.
    modules[module.__name__] = module
    try:
        exec(compile(text, spec.origin, "exec"), vars(module))
    finally:
        del modules[module.__name__]
    return module
