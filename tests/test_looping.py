"""A loop over nothing is noticed: by `some` and `exactly` when a test runs, by its text before."""

from __future__ import annotations

from pathlib import Path
from textwrap import indent

import pytest

from tests.looping import exactly, idle_tests, some


def test_some_and_exactly_give_what_there_is() -> None:
    assert some(x for x in "ab") == exactly(2, iter("ab")) == some("ab", 2) == ["a", "b"]


@pytest.mark.parametrize(
    ("look", "given"),
    [
        *((some, ([],)), (some, ({},)), (some, ([], 0)), (some, ([1], 0)), (some, ([1], 2))),
        *((exactly, (0, [])), (exactly, (2, [1])), (exactly, (1, [1, 2]))),
    ],
)
def test_less_than_expected_is_an_error_and_nothing_may_not_be_expected(look, given) -> None:
    with pytest.raises(AssertionError, match="to look at"):
        look(*given)


SURE = """(1, 2) | [*x, 3] | {1} | {1: 2} | {**x, 1: 2} | 'ab' | range(3) | range(-1, 1) | MANY | many | NINE | drawn
MANY.items() | sorted(MANY) | map(f, MANY) | enumerate([1]) | zip(x, [1], strict=True) | zip(MANY, [1]) | some(f())
product(MANY, 'ab') | chain(x, MANY) | x + [1] | exactly(2, x) | (y for y in MANY) | {y for y in many for z in NINE}"""
UNSURE = """x | () | [] | {} | '' | [*x] | {**x} | range(0) | range(x) | range(2, 1) | FEW | few | f() | ELSEWHERE
x.items() | sorted(x) | map(MANY, x) | zip(x, [1]) | product(MANY, x) | MANY[1:] | chain(x, few) | zip()
(y for y in MANY if y) | (y for y in x) | {y for y in many for z in x} | x + few | zip(few, f(), strict=True)"""
LOOPS = """
for y in {}:
    assert y

for y in [1]:
    for z in {}:
        assert z == y

for y in {}:
    with raises(ValueError):
        f(y)

if f:
    for y in {}:
        assert y

try:
    for y in {}:
        assert y
finally:
    f()

for y in {}:
    held(y)

assert all(y for y in {})

assert not any(y for y in {})

assert all({}) and all({})

assert [y for y in {} if f(y)] == []

assert {{f(y) for y in {}}} <= {{1}}
"""


def is_idle(root: Path, body: str, by: str = "given") -> bool:
    """Whether a test of these statements is found to say nothing, in a file that knows a few names."""
    (root / "a").mkdir(exist_ok=True)
    (root / "a/nine.py").write_text("NINE: list = [9]\nFEW = []\n")
    path = root / f"a/test_{len(list((root / 'a').iterdir()))}.py"
    head = "from a.nine import NINE, FEW\nMANY = {1: 2}\ndef held(y):\n    assert y\n"
    head += f"@{by}(drawn=x)\ndef test_it(drawn):\n"
    path.write_text(head + indent(f"many = few = [1]\nfew = []\n{body}\n", "    "))
    return idle_tests(root, path) != []


@pytest.mark.parametrize("loop", LOOPS.split("\n\n"))
def test_test_over_what_may_be_empty_is_idle(loop: str, tmp_path: Path) -> None:
    assert is_idle(tmp_path, loop.format("f()", "f()"))
    assert not is_idle(tmp_path, loop.format("f()", "f()") + "\nassert n == 3")
    assert not is_idle(tmp_path, loop.format("some(f())", "some(f())"))


def members(text: str) -> list[str]:
    return [each.strip() for line in text.splitlines() for each in line.split(" | ")]


@pytest.mark.parametrize("items", members(SURE))
def test_what_surely_has_a_member_is_known(items: str, tmp_path: Path) -> None:
    assert not is_idle(tmp_path, f"for y in {items}:\n    assert y")


@pytest.mark.parametrize("items", members(UNSURE))
def test_what_may_be_empty_is_not_taken_for_more(items: str, tmp_path: Path) -> None:
    assert is_idle(tmp_path, f"for y in {items}:\n    assert y")


def test_that_a_list_is_empty_may_be_what_is_said(tmp_path: Path) -> None:
    assert not is_idle(tmp_path, "assert [y for y in f()] == []")
    assert is_idle(tmp_path, "assert [z for y in f() for z in y] == []")
    assert is_idle(tmp_path, "for y in f():\n    assert [z for z in y] == []")


def test_what_is_drawn_is_not_always_empty_but_a_table_of_parameters_may_be(tmp_path: Path) -> None:
    assert not is_idle(tmp_path, "for y in drawn:\n    assert y", "given")
    assert is_idle(tmp_path, "for y in drawn:\n    assert y", "parametrize")
