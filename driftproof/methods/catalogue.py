"""The methods by key. To add one, add an entry to the table of its family in `methods/tables`, and nothing else.

>>> from driftproof import METHODS
>>> METHODS["rk4"].title
'Classical RK4'
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import Any, Generic, TypeAlias, TypeVar

from driftproof.methods.additive import Additive
from driftproof.methods.continuous import ContinuousExtension
from driftproof.methods.multistep import Multistep
from driftproof.methods.names import keys_called, plain_name
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.support.plain_text import did_you_mean, shortened

# The tables of `driftproof.methods.tables`, in the order in which the methods are listed.
TABLES = (
    *("basic", "explicit", "stabilised", "embedded", "high_order_pairs", "decimal_pairs", "implicit"),
    *("diagonally_implicit", "collocation", "splittings", "decimal_splittings", "nystrom"),
)
# Those of methods whose step is no map of one state by f alone: they have facts, and are not run, read or identified.
TABLES_OF_FACTS = ("multistep", "rosenbrock", "additive")
FactsOnly: TypeAlias = Multistep | Rosenbrock | Additive
_Entry = TypeVar("_Entry")

# What is written behind the key of a pair for the method that propagates its other row of weights.
EMBEDDED_SUFFIX = "_embedded"


class Catalogue(Mapping[str, _Entry], Generic[_Entry]):
    """The methods of the tables by key. Tables are read one after the other, no further than to the key asked for.

    The other row of a pair has a key, too, fehlberg45_embedded; listed is the method of the row that `b` is.
    """

    def __init__(self, tables: Iterable[str]) -> None:
        """Nothing is read yet."""
        self._unread = deque(tables)
        self._methods: dict[str, Any] = {}
        self._embedded: dict[str, Any] = {}

    def __getitem__(self, key: str) -> _Entry:
        """The method. Raises KeyError."""
        while key not in self._methods and self._unread:
            self._read_next()
        if key not in self._methods and key not in self._embedded:
            pair = self._methods[key.removesuffix(EMBEDDED_SUFFIX)]
            if not isinstance(pair, RungeKutta) or pair.b_embedded is None:
                raise KeyError(key)
            self._embedded[key] = pair.embedded(EMBEDDED_SUFFIX)
        found: _Entry = self._methods.get(key) or self._embedded[key]
        return found

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


METHODS: Catalogue[Method] = Catalogue(TABLES)
FACTS_ONLY: Catalogue[FactsOnly] = Catalogue(TABLES_OF_FACTS)
EXTENSIONS: Catalogue[ContinuousExtension] = Catalogue(["continuous"])


def extensions_of(method: RungeKutta) -> tuple[ContinuousExtension, ...]:
    """The continuous extensions of a method, those of the same tableau under another key among them."""
    tableau = (method.a, method.b, method.c)
    return tuple(each for each in EXTENSIONS.values() if (each.method.a, each.method.b, each.method.c) == tableau)


def method_named(name: str) -> Method:
    """The method with this key, or that people call so: "rk4", "Crank-Nicolson", or a title, case and hyphens aside.

    Raises ValueError for a word that may mean several methods, with their keys, and for one that means none or a method
    that has facts only.

    >>> method_named("semi-implicit Euler").key
    'symplectic_euler'
    """
    return of_one_state(entry_named(name))


def of_one_state(method: Method | FactsOnly) -> Method:
    """The method itself. Raises ValueError for one that has facts only."""
    if isinstance(method, FactsOnly):
        raise ValueError(
            f"{method.key} is {method.kind}: `driftproof facts` and `driftproof verify` accept it, but runs and "
            "derivations do not; they need a method whose step takes one state and one f"
        )
    return method


def entry_named(name: str) -> Method | FactsOnly:
    """The method that `method_named` finds, or one that has facts only. Raises ValueError."""
    keys = keys_of_name(name)
    entries: list[Method | FactsOnly] = [METHODS[key] if key in METHODS else FACTS_ONLY[key] for key in keys]
    if len(entries) == 1:
        return entries[0]
    if entries:
        meant = " or ".join(f"{each.key} ({each.title})" for each in entries)
        raise ValueError(f"{shortened(name)!r} may mean {meant}: say which")
    near = did_you_mean(name, (*METHODS, *FACTS_ONLY))
    raise ValueError(f"unknown method {shortened(name)!r}{near} (`driftproof methods` lists all)")


def keys_of_name(name: str) -> tuple[str, ...]:
    """The keys of the entries that a key, a title or another name may mean: none for a name that is unknown."""
    if name in METHODS or name in FACTS_ONLY:
        return (name,)
    return keys_called(name) or tuple(_keys_by_title().get(plain_name(name), ()))


@cache
def _keys_by_title() -> dict[str, list[str]]:
    found = defaultdict[str, list[str]](list)
    for key, method in (*METHODS.items(), *FACTS_ONLY.items()):
        for plain in {plain_name(key), plain_name(method.title)}:
            found[plain].append(key)
    return found
