"""The tables: all of them are in the catalogue, no method is there twice, and a malformed definition is refused."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path
from typing import Any

import pytest

from driftproof.methods import catalogue
from driftproof.methods.catalogue import EXTENSIONS, METHODS
from driftproof.methods.schemes import Collocation, Method, RungeKutta, Splitting
from driftproof.methods.tables.splittings import alternating, palindrome, verlet_composition
from tests.methods.tables.entries import FILES, by_key, entry, fingerprint, of_type


def test_every_file_of_tables_is_in_the_catalogue_in_the_order_of_its_entries() -> None:
    assert [method for name in catalogue.TABLES for method in FILES[name]] == list(METHODS.values())
    assert [each for name in catalogue.FURTHER_TABLES for each in FILES[name]] == list(
        catalogue.FURTHER_METHODS.values()
    )
    # Extensions of methods are no methods.
    assert {*catalogue.TABLES, *catalogue.FURTHER_TABLES, "continuous"} == set(FILES)


def test_no_method_leaves_its_table_and_no_digit_of_one_changes() -> None:
    """Order conditions excuse the last of 16 digits; frozen.toml says what each table was held beside."""
    frozen = tomllib.loads(Path(__file__).with_name("frozen.toml").read_text(encoding="utf-8"))
    found = {name: {method.key: fingerprint(method) for method in methods} for name, methods in FILES.items()}
    lines, said = (
        {(name, f'{key} = "{digest}"') for name, table in tables.items() for key, digest in table.items()}
        for tables in (found, frozen)
    )
    assert lines - said == set(), "a method was added or changed: if that was meant, its line in frozen.toml is this"
    assert said - lines == set(), "a method was removed or changed: if that was meant, delete its line in frozen.toml"
    assert sum(map(len, frozen.values())) == len(METHODS) + len(EXTENSIONS) + len(catalogue.FURTHER_METHODS) > 100
    digit = replace(entry("tsitouras54"), b=(entry("tsitouras54").b[0] + Q(1, 10**17), *entry("tsitouras54").b[1:]))
    assert fingerprint(digit) != frozen["decimal_pairs"]["tsitouras54"]


def definition(method: Method) -> Any:
    if isinstance(method, Splitting):
        return method.parts
    if isinstance(method, Collocation):
        return method.node_polynomial
    rows = method.b_embedded if isinstance(method, RungeKutta) else method.b_position
    return method.a, rows, method.b if isinstance(method, RungeKutta) else method.b_velocity


def test_no_two_entries_are_the_same_method() -> None:
    assert len({definition(method) for method in METHODS.values()}) == len(METHODS) - 1
    first, second = METHODS["heun2"], entry("ssprk22")  # the one method that is here under its second name
    assert definition(first) == definition(second)


def test_weights_of_prince_and_dormand_as_printed_add_to_less_than_one() -> None:
    short = -entry("prince_dormand87").inconsistencies()["sum(b) - 1"]
    assert Q("3.6853146e-18") < short < Q("3.6853147e-18")


@pytest.mark.parametrize("method", of_type(RungeKutta), ids=by_key)
def test_family_of_tableau_is_as_its_file_says(method: RungeKutta) -> None:
    implicit = method in (*FILES["implicit"], *FILES["diagonally_implicit"])
    assert method.explicit is not implicit
    diagonal = all(x == 0 for i, given in enumerate(method.a) for x in given[i + 1 :])
    assert diagonal or method not in FILES["diagonally_implicit"]


def test_compositions_join_neighbouring_halves() -> None:
    assert palindrome((Q(1), Q(2))) == (Q(1), Q(2), Q(1))
    assert alternating("drift", (Q(1), Q(2))) == (("drift", Q(1)), ("kick", Q(2)))
    assert verlet_composition("kick", (Q(1),)) == METHODS["velocity_verlet"].parts
    assert verlet_composition("drift", (Q(1),)) == METHODS["position_verlet"].parts
    two = verlet_composition("kick", (Q(1, 3), Q(2, 3)))
    assert two == alternating("kick", (Q(1, 6), Q(1, 3), Q(1, 2), Q(2, 3), Q(1, 3)))
