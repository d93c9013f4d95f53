"""The catalogue of methods by key. To add a method, add an entry to its family's file in `methods/tables`.

>>> from driftproof import METHODS
>>> METHODS["rk4"].title
'Classical RK4'
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from typing import Any, TypeAlias, TypeVar

from driftproof.methods.additive import Additive
from driftproof.methods.continuous import ContinuousExtension
from driftproof.methods.multistep import Multistep
from driftproof.methods.names import (
    BASHFORTH_MOULTON,
    COMMON_NAMES,
    KeyedTable,
    UnknownKey,
    counted_names,
    keys_called,
    plain_name,
)
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import Method, MethodError, RungeKutta
from driftproof.support.plain_text import shortened, unknown

# The tables of `driftproof.methods.tables`, in the order in which the methods are listed.
TABLES = (
    *("basic", "explicit", "stabilised", "embedded", "high_order_pairs", "decimal_pairs", "implicit"),
    *("diagonally_implicit", "collocation", "splittings", "decimal_splittings", "nystrom"),
)
# The tables of methods whose step takes more than one state and f: there are facts of them, but no exact runs or
# derivations; those of one f have float runs.
FURTHER_TABLES = ("multistep", "rosenbrock", "additive")
FurtherMethod: TypeAlias = Multistep | Rosenbrock | Additive
Entry: TypeAlias = Method | FurtherMethod
_Kind = TypeVar("_Kind")

# Appended to the key of a pair for the method that propagates its embedded weights.
EMBEDDED_SUFFIX = "_embedded"


class Catalogue(KeyedTable[_Kind]):
    """The methods of the tables by key. Tables are imported one after the other, until the key is found.

    The embedded weights of a pair have a key, too, such as fehlberg45_embedded, which iteration leaves out.
    """

    def __init__(self, tables: Iterable[str]) -> None:
        """Take the names of the tables, without importing any."""
        self._unread = deque(tables)
        self._methods: dict[str, Any] = {}
        self._embedded: dict[str, Any] = {}

    def __getitem__(self, key: str) -> _Kind:
        """The method with this key. Raises UnknownKey."""
        while key not in self._methods and self._unread:
            self._read_next()
        if key not in self._methods and key not in self._embedded:
            pair = self._methods.get(key.removesuffix(EMBEDDED_SUFFIX))
            if not isinstance(pair, RungeKutta) or pair.b_embedded is None:
                raise UnknownKey(key, self)
            self._embedded[key] = pair.embedded(EMBEDDED_SUFFIX)
        found: _Kind = self._methods.get(key) or self._embedded[key]
        return found

    def __iter__(self) -> Iterator[str]:
        """The keys, in the order of the tables."""
        while self._unread:
            self._read_next()
        return iter(self._methods)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _read_next(self) -> None:
        for method in import_module(f"driftproof.methods.tables.{self._unread[0]}").ENTRIES:
            if method.key in self._methods:
                raise ValueError(f"driftproof/methods/tables: two entries share the key {method.key}")
            self._methods[method.key] = method
        self._unread.popleft()


METHODS: Catalogue[Method] = Catalogue(TABLES)
FURTHER_METHODS: Catalogue[FurtherMethod] = Catalogue(FURTHER_TABLES)
EXTENSIONS: Catalogue[ContinuousExtension] = Catalogue(["continuous"])


def extensions_of(method: RungeKutta) -> tuple[ContinuousExtension, ...]:
    """The continuous extensions of a method: its own, and those of the same tableau under another key."""
    tableau, own = (method.a, method.b, method.c), tuple[ContinuousExtension, ...]()
    if method.dense is not None:
        said = (f"{method.key}_dense", f"{method.title}, its dense output", 0, method.source)
        own = (ContinuousExtension(*said, method, method.a, method.c, method.dense),)
    known = (each for each in EXTENSIONS.values() if (each.method.a, each.method.b, each.method.c) == tableau)
    return (*own, *known)


def of_one_state(method: Entry, name: str = "") -> Method:
    """Return the method. Raises MethodError if its step takes more than one state and f; `name` may be its file."""
    if isinstance(method, FurtherMethod):
        starts = isinstance(method, Multistep) and method.derivative == 1
        asked = f"`driftproof value 'run {name or method.key} started=rk4 h=0.1 t=1 : state_error'`"
        runs = "" if isinstance(method, Additive) else "`driftproof stability`, `work-precision`, scenes of a problem, "
        raise MethodError(
            f"{method.key} is {method.kind}: {runs}`driftproof facts` and `driftproof verify` accept it, but exact "
            "runs and derivations do not; they need a method whose step takes one state and one f"
            + f"; what gives its first values is named by {asked}"
            * starts
        )
    return method


def entry_named(name: str) -> Entry:
    """The method with this key, common name or title, such as "rk4" or "Crank-Nicolson", case and hyphens aside.

    Raises ValueError for an unknown name, and for one that several methods share, with their keys.

    >>> entry_named("semi-implicit Euler").key
    'symplectic_euler'
    """
    entries: list[Entry] = [METHODS[key] if key in METHODS else FURTHER_METHODS[key] for key in keys_of_name(name)]
    if len(entries) == 1:
        return entries[0]
    if entries:
        meant = " or ".join(f"{each.key} ({each.title})" for each in entries)
        raise ValueError(f"{shortened(name)!r} may mean {meant}: say which")
    if corrected := BASHFORTH_MOULTON.fullmatch(name.strip().lower()):
        corrector = f"adams_moulton{int(corrected[1]) - 1}" if int(corrected[1]) > 2 else "trapezoid"
        raise ValueError(
            f"{name!r} is corrected a fixed number of times, which only `driftproof verify` and `identify` know; "
            f"elsewhere give adams_bashforth{corrected[1]} or {corrector}, or in exact runs a method of one step"
        )
    raise ValueError(
        unknown("method", name, (*METHODS, *FURTHER_METHODS, *COMMON_NAMES), "`driftproof methods` lists all")
    )


def keys_of_name(name: str) -> tuple[str, ...]:
    """The keys of the methods that a key, a title or another name may mean; () for an unknown name."""
    key = name.casefold().replace("-", "_")  # RADAU-IIA5 is a key, though Radau IIA 5 may mean two methods
    if key in METHODS or key in FURTHER_METHODS:
        return (key,)
    return keys_called(name) or tuple(_keys_by_title().get(plain_name(name), ()))


def names_listed(text: str) -> list[str]:
    """The names in a list with commas, stripped; a title with a comma, such as "Gauss, 4 stages", is one of them."""
    parts, found = text.split(","), list[str]()
    while parts:
        longest = len(parts) if ", " in text or "(" in text else 1  # else no title is among them, and none is read
        joined = (",".join(parts[:count]) for count in range(longest, 1, -1))
        found.append(next(filter(keys_of_name, joined), parts[0]))
        del parts[: found[-1].count(",") + 1]
    return [name.strip() for name in found]


@cache
def _keys_by_title() -> dict[str, list[str]]:
    found = defaultdict[str, list[str]](list)
    for key, method in (*METHODS.items(), *FURTHER_METHODS.items()):
        for plain in {*map(plain_name, (key, method.title, *counted_names(method.title)))}:
            found[plain].append(key)
    return found
