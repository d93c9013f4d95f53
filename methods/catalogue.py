"""The methods by key. To add one, add an entry to the table of its family in `methods/tables`, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from itertools import chain

from methods.schemes import Method
from methods.tables import (
    basic,
    collocation,
    decimal_pairs,
    decimal_splittings,
    diagonally_implicit,
    embedded,
    explicit,
    high_order_pairs,
    implicit,
    nystrom,
    splittings,
    stabilised,
)

TABLES = (
    basic,
    explicit,
    stabilised,
    embedded,
    high_order_pairs,
    decimal_pairs,
    implicit,
    diagonally_implicit,
    collocation,
    splittings,
    decimal_splittings,
    nystrom,
)


def _by_key(entries: Iterable[Method]) -> dict[str, Method]:
    methods: dict[str, Method] = {}
    for method in entries:
        if method.key in methods:
            raise ValueError(f"methods/tables: two entries share the key {method.key}")
        methods[method.key] = method
    return methods


METHODS: dict[str, Method] = _by_key(chain.from_iterable(table.ENTRIES for table in TABLES))


def method_named(key: str) -> Method:
    """The catalogue entry `key`. Raises ValueError naming the closest keys if there is none."""
    if key in METHODS:
        return METHODS[key]
    close = get_close_matches(key, METHODS, n=2, cutoff=0.4)
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    raise ValueError(f"unknown method {key[:60]!r}; {hint}(`driftproof methods` lists all)")
