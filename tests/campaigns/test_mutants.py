"""The campaign plants what it says, calls a mutant killed only where a test tells it, and writes what it found."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns.mutants import (
    EQUIVALENT,
    KILLED,
    ROOT,
    SURVIVED,
    Workshop,
    checks_of,
    chosen,
    judged,
    mutants_of,
    page,
    reason,
)
from tests.looping import some

SOURCE = '''"""A docstring 1 + 1."""
LIMIT: int = 3
def f(a: "x < y", b):
    if a < b and not g(a, b):
        raise ValueError("1 < 2")
    assert a, a + 1
    a[0] = -b
    return f"{a + b}", max(a, b)
@dataclass(frozen=True, slots=True, order=True)
class C:
    pairs = zip(f(a, b, strict=True), strict=True), np.hypot(a, b)
'''
PLANTED = """3 -> 4; 3 -> 2; a < b and not g(a, b) -> (a < b or not g(a, b)); a < b -> (a <= b);
not g(a, b) -> (g(a, b)); g(a, b) -> g(b, a); raise ValueError("1 < 2") -> pass; a[0] = -b -> pass;
0 -> 1; 0 -> -1; -b -> (b); True -> False; f(a, b, strict=True) -> f(b, a, strict=True); True -> False"""


def test_every_kind_of_error_is_planted_where_it_stands_and_nowhere_else(tmp_path: Path) -> None:
    place = "driftproof/methods/a.py"
    (tmp_path / place).parent.mkdir(parents=True)
    (tmp_path / place).write_text(SOURCE, encoding="utf-8")
    found = mutants_of(tmp_path, place)
    assert sorted(f"{m.old} -> {m.new}" for m in found) == sorted(PLANTED.replace("\n", " ").split("; "))
    assert len({m.name for m in found}) == len(found)
    assert all(SOURCE[m.start : m.end] == m.old for m in found)


def test_tests_of_a_module_begin_with_its_own() -> None:
    assert checks_of(ROOT, "driftproof/methods/rationals.py")[0] == "tests/methods/test_rationals.py"
    assert "tests/methods/tables/test_tables_entries.py" in checks_of(ROOT, "driftproof/methods/tables/basic.py")


@pytest.mark.long
def test_a_mutant_is_killed_by_a_test_that_passes_without_it(tmp_path: Path) -> None:
    shop = Workshop(tmp_path)
    found = {m.name: m for m in mutants_of(ROOT, "driftproof/methods/tables/basic.py")}
    assert shop.outcome(next(iter(found.values()))) == KILLED
    assert (tmp_path / "driftproof/methods/tables/basic.py").read_bytes() == (
        ROOT / "driftproof/methods/tables/basic.py"
    ).read_bytes()


def test_page_leaves_out_of_the_score_what_is_equivalent() -> None:
    killed, survived, equivalent = mutants_of(ROOT, "driftproof/methods/rationals.py")[:3]
    text = page({killed: KILLED, survived: SURVIVED, equivalent: EQUIVALENT}, "python")
    assert "| methods | 3 | 1 | 1 | 1 | 0 | 50 % |" in text
    assert text.count(f"`{survived.new}`") >= 1


def test_the_edge_of_a_bound_on_rounding_is_equivalent_and_another_side_is_not(tmp_path: Path) -> None:
    place = "driftproof/methods/a.py"
    (tmp_path / place).parent.mkdir(parents=True)
    (tmp_path / place).write_text("x = abs(a - b) <= rounding.of(c)\ny = a <= b\n", encoding="utf-8")
    edges = [m.new for m in mutants_of(tmp_path, place) if reason(m)]
    assert edges == ["(abs(a - b) < rounding.of(c))"]


def test_every_judgement_names_a_mutant_and_says_why() -> None:
    planted = {name.partition(" | ")[0] for name in judged()}
    assert set(judged()) <= {m.name for place in planted for m in mutants_of(ROOT, place)}
    for place, line in some((where.split(" | ") for where in chosen()), 40):
        assert line in map(str.strip, (ROOT / place).read_text(encoding="utf-8").splitlines())
    assert all(reason.endswith(".") for reason in (*judged().values(), *chosen().values()))
