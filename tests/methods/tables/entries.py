"""The catalogue's methods by key, by family, by file, and by whether their tables are rounded."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from hashlib import sha256
from importlib import import_module
from itertools import product as pairs
from pkgutil import iter_modules
from typing import Any

from driftproof.methods import tables
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method

# What each file of driftproof/methods/tables holds, found by looking, not by the catalogue's own list.
FILES: dict[str, tuple[Method, ...]] = {
    module.name: import_module(f"driftproof.methods.tables.{module.name}").ENTRIES
    for module in iter_modules(tables.__path__)
    if module.name != "notation"
}
EXACT: dict[str, Method] = {key: method for key, method in METHODS.items() if not method.decimal}
DECIMAL: dict[str, Method] = {key: method for key, method in METHODS.items() if method.decimal}
EXPLICIT = [method for method in METHODS.values() if method.explicit]
IMPLICIT = [method for method in METHODS.values() if not method.explicit]


def entry(key: str) -> Any:
    """The entry of that key, of whatever family its key says."""
    return METHODS[key]


def of_type(family: type) -> list[Any]:
    return [method for method in METHODS.values() if isinstance(method, family)]


def by_key(method: Method) -> str:
    return method.key


def product(p: Sequence[Fraction], q: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """The product of two polynomials, coefficient by coefficient."""
    found = [Fraction(0)] * (len(p) + len(q) - 1)
    for (i, x), (j, y) in pairs(enumerate(p), enumerate(q)):
        found[i + j] += x * y
    return tuple(found)


def fingerprint(method: Method) -> str:
    """The first digits of a checksum: any digit of any coefficient counts, the source, and what is said of it."""
    rows = ["c", "a", "b", "b_embedded", "embedded_order", "b_position", "b_velocity", "parts", "node_polynomial"]
    of_facts = ["weights", "rho", "sigma", "derivative", "alpha", "gamma", *Additive.matrices, *Additive.rows]
    names = (*rows, "claimed_order", "source", *of_facts)
    meant = {name: getattr(method, name) for name in names if hasattr(method, name)}
    for name in ("field", "decimal", "quadratic_kinetic"):  # the field with the ends between which its root lies
        if said := getattr(method, name, None):
            meant[name] = said
    return sha256(str(meant).encode()).hexdigest()[:12]
