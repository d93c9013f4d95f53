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

SOURCE = '''"""A docstring 1 + 1.5."""
LIMIT: int = 3
def f(a: "x < y", b):
    if a < b and not g(a, b):
        raise ValueError("1 < 2")
    assert a, a + 1
    a[0] = -b
    return f"{a + b}", max(a, b)
@dataclass(frozen=True, slots=True, order=True)
class C:
    pairs = zip(f(a, b, strict=True), strict=True), np.hypot(a, b), _distance(a, b)
'''
PLANTED = """3 -> 4; 3 -> 2; a < b and not g(a, b) -> (a < b or not g(a, b)); a < b -> (a <= b);
not g(a, b) -> (g(a, b)); g(a, b) -> g(b, a); raise ValueError("1 < 2") -> pass; a[0] = -b -> pass;
0 -> 1; 0 -> -1; -b -> (b); True -> False; f(a, b, strict=True) -> f(b, a, strict=True); True -> False"""


def test_every_kind_of_error_is_planted_where_it_stands_and_nowhere_else(tmp_path: Path) -> None:
    place = "driftproof/methods/tables/a.py"
    (tmp_path / place).parent.mkdir(parents=True)
    (tmp_path / place).write_text(SOURCE, encoding="utf-8")
    found = mutants_of(tmp_path, place)
    assert sorted(f"{m.old} -> {m.new}" for m in found) == sorted(PLANTED.replace("\n", " ").split("; "))
    assert len({m.name for m in found}) == len(found)
    assert all(SOURCE[m.start : m.end] == m.old for m in found)


def test_tests_of_a_module_begin_with_its_own() -> None:
    assert checks_of(ROOT, "driftproof/methods/numbers/rationals.py")[0] == "tests/methods/numbers/test_rationals.py"
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
    killed, survived, equivalent = mutants_of(ROOT, "driftproof/methods/numbers/rationals.py")[:3]
    text = page({killed: KILLED, survived: SURVIVED, equivalent: EQUIVALENT}, "python")
    assert "| methods | 3 | 1 | 1 | 1 | 0 | 50 % |" in text
    assert text.count(f"`{survived.new}`") >= 1


EDGES = """\
from driftproof.methods.a import _FAR, NEAR
_SMALL, _COUNT = 1e-6, 3
x = abs(a - b) <= rounding.of(c)
y = a <= b
z = abs(a) > NEAR * size and abs(b) > _COUNT
w = 0 < abs(a) < 2 * _SMALL
v = abs(a - b) == _SMALL, a * _SMALL
u = abs(a) > _FAR
t = sum(x * y for x, y in zip(a, b)), max(abs(x - y) for x, y in zip(a, c)), [x - y for x, y in zip(a, d)]
"""


def test_the_edge_of_what_is_measured_and_the_order_of_a_product_are_equivalent_and_another_side_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tests.campaigns.mutants.ROOT", tmp_path)
    place = tmp_path / "driftproof" / "methods" / "a.py"
    place.parent.mkdir(parents=True)
    place.write_text("_FAR, NEAR = 8.0, 2.0**-10\n", encoding="utf-8")
    place.with_name("b.py").write_text(EDGES, encoding="utf-8")
    edges = [m.new for m in mutants_of(tmp_path, "driftproof/methods/b.py") if reason(m)]
    moved = ["(abs(a - b) < rounding.of(c))", "(abs(a) >= NEAR * size)", "(0 < abs(a) <= 2 * _SMALL)"]
    assert edges == [*moved, "zip(b, a)", "zip(c, a)"]


@pytest.mark.slow
def test_every_judgement_names_a_mutant_and_says_why() -> None:
    lines: dict[str, set[str]] = {}
    for place, line, _ in some((name.split(" | ", 2) for name in judged()), 40):
        lines.setdefault(place, set()).add(line)
    assert set(judged()) <= {m.name for place, only in lines.items() for m in mutants_of(ROOT, place, only)}
    for place, line in some((where.split(" | ") for where in chosen()), 40):
        assert line in map(str.strip, (ROOT / place).read_text(encoding="utf-8").splitlines())
    assert all(reason.endswith(".") for reason in (*judged().values(), *chosen().values()))
