"""The methods by key. To add one, add an entry to the table of its family in `methods/tables`, and nothing else.

>>> from driftproof import METHODS
>>> METHODS["rk4"].title
'Classical RK4'
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module

from driftproof.methods.names import keys_called, plain_name
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.support.plain_text import did_you_mean

# The tables of `driftproof.methods.tables`, in the order in which the methods are listed.
TABLES = (
    *("basic", "explicit", "stabilised", "embedded", "high_order_pairs", "decimal_pairs", "implicit"),
    *("diagonally_implicit", "collocation", "splittings", "decimal_splittings", "nystrom"),
)


# What is written behind the key of a pair for the method that propagates its other row of weights.
EMBEDDED_SUFFIX = "_embedded"


class Catalogue(Mapping[str, Method]):
    """The methods of the tables by key. Tables are read one after the other, no further than to the key asked for.

    The other row of a pair has a key, too, fehlberg45_embedded; listed is the method of the row that `b` is.
    """

    def __init__(self, tables: Iterable[str] = TABLES) -> None:
        """Nothing is read yet."""
        self._unread = deque(tables)
        self._methods: dict[str, Method] = {}
        self._embedded: dict[str, Method] = {}

    def __getitem__(self, key: str) -> Method:
        """The method. Raises KeyError."""
        while key not in self._methods and self._unread:
            self._read_next()
        if key not in self._methods and key not in self._embedded:
            pair = self._methods[key.removesuffix(EMBEDDED_SUFFIX)]
            if not isinstance(pair, RungeKutta) or pair.b_embedded is None:
                raise KeyError(key)
            self._embedded[key] = pair.embedded(EMBEDDED_SUFFIX)
        return self._methods.get(key) or self._embedded[key]

    def __iter__(self) -> Iterator[str]:
        """The keys, in the order of the tables."""
        while self._unread:
            self._read_next()
        return iter(self._methods)

    def __len__(self) -> int:
        """How many methods there are."""
        return sum(1 for _ in self)

    def _read_next(self) -> None:
        for method in import_module(f"driftproof.methods.tables.{self._unread[0]}").ENTRIES:
            if method.key in self._methods:
                raise ValueError(f"driftproof/methods/tables: two entries share the key {method.key}")
            self._methods[method.key] = method
        self._unread.popleft()


METHODS = Catalogue()


def method_named(name: str) -> Method:
    """The method with this key, or that people call so: "rk4", "Crank-Nicolson", or a title, case and hyphens aside.

    Raises ValueError for a word that may mean several methods, with their keys, and for one that means none.

    >>> method_named("semi-implicit Euler").key
    'symplectic_euler'
    """
    if name in METHODS:
        return METHODS[name]
    keys = keys_called(name) or tuple(
        key for key, method in METHODS.items() if plain_name(name) in (plain_name(key), plain_name(method.title))
    )
    if len(keys) == 1:
        return METHODS[keys[0]]
    if keys:
        meant = " or ".join(f"{key} ({METHODS[key].title})" for key in keys)
        raise ValueError(f"{name[:60]!r} may mean {meant}: say which")
    raise ValueError(f"unknown method {name[:60]!r}{did_you_mean(name, METHODS)} (`driftproof methods` lists all)")
