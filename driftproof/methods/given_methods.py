"""Methods as users give them: by key or name, by file, as objects, one or several.

The readers of files and of expressions are imported when something is to be read: most methods are given by key.
"""

from __future__ import annotations

from collections.abc import Sequence
from os.path import exists, isdir
from pathlib import Path
from typing import TypeAlias

from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import (
    FURTHER_METHODS,
    METHODS,
    Entry,
    FurtherMethod,
    entry_named,
    keys_of_name,
    names_listed,
    of_one_state,
)
from driftproof.methods.families import FAMILIES, Family
from driftproof.methods.names import plain_name
from driftproof.methods.schemes import Method
from driftproof.support.files import file_named
from driftproof.support.plain_text import shortened

# Methods as users give them, one or several: a key or name, a file, the method itself.
GivenMethods: TypeAlias = str | Path | Method | Sequence[str | Path | Method]
# Methods that are not in the catalogue, each after the name that it has in a scene.
NamedMethods: TypeAlias = tuple[tuple[str, Method], ...]


def method_of(given: str | Path | Method | Family | FurtherMethod) -> Method:
    """The method with this key or name, or in this .toml file; a method is returned as it is.

    Raises ValueError for anything else, including a family and a method of which there are only facts.
    """
    return of_one_state(entry_of(given), str(given) if isinstance(given, str | Path) else "")


def entry_of(given: str | Path | Method | Family | FurtherMethod) -> Entry:
    """Like `method_of`, but also for methods whose step takes more than one state and f. Raises ValueError."""
    subject = subject_of(given)
    if isinstance(subject, Family):
        what = f"{subject.key} is a family of methods, with {subject.parameter} free; one method is needed"
        raise ValueError(f"{what}, such as '{given if isinstance(given, str | Path) else subject.key} at 1/2'")
    return subject


def methods_of(given: GivenMethods) -> list[Entry]:
    """One method or several, whose keys may stand in one text: "rk4,heun2"; not all of them may be IMEX methods.

    Raises ValueError.
    """
    found = [*map(entry_of, _each(given))]
    if found and all(isinstance(each, Additive) for each in found):
        method_of(_each(given)[0])  # raises
    return found


_GIVE, _FIRST = "give a key, a .toml file, or a method", "; what is examined comes first"


def _each(given: GivenMethods) -> Sequence[str | Path | Method]:
    if isinstance(given, str):
        return names_listed(given)
    return given if isinstance(given, Sequence) else [given]


def subject_of(given: str | Path | Method | Family | FurtherMethod) -> Method | Family | FurtherMethod:
    """Like `method_of`, but also for families and for methods of which there are only facts.

    A family or its file with a value, such as "explicit_order_2 at 2/3", is a member of the family.
    """
    if isinstance(given, Method | Family | FurtherMethod):
        return given
    if not isinstance(given, str | Path):
        raise ValueError(f"{shortened(str(given))!r} is not a method: {_GIVE}{_FIRST * callable(given)}")
    name = str(given)
    if name.endswith(".toml"):
        from driftproof.methods.tableau_file import read_method

        return read_method(file_named(name))
    of, at, value = f"{name} ".rpartition(" at ")
    if at and not keys_of_name(name):
        if not isinstance(family := subject_of(of), Family):
            raise ValueError(f"{family.key} has no parameter; only families such as sdirk_order_2 do")
        from driftproof.methods.formulas.expressions import parse_number

        return family.member(parse_number(value.strip(), family.parameter))
    families = () if keys_of_name(name) else FAMILIES.values()  # which take FLINT to be read
    called = (each for each in families if plain_name(name) in (plain_name(each.key), plain_name(each.title)))
    found = next(called, None)
    if not found and not keys_of_name(name) and exists(path := file_named(name)) and not isdir(path):
        raise ValueError(f"{shortened(name)}: the name of a method's file ends in .toml")
    return found or entry_named(name)


def names_of(given: GivenMethods) -> tuple[list[str], NamedMethods]:
    """The names of these methods in a scene, which are keys and files, and those of them that are not in the catalogue.

    One with the key of another method there is "of your own". Raises ValueError for two of your own with one key.
    """
    named, own = list[str](), dict[str, Method]()
    for each in _each(given):
        if isinstance(each, str | Path):
            named.append(str(each))
            continue
        known = METHODS.get(each.key) or FURTHER_METHODS.get(each.key)
        taken = known != each and keys_of_name(each.key)
        named.append(f"{each.key} of your own" if taken else each.key)
        if known != each and own.setdefault(named[-1], each) != each:
            raise ValueError(f"two methods have the key {named[-1]}; give each a key of its own")
    return named, tuple(own.items())
