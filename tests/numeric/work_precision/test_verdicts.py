"""Methods that are never worth choosing."""

from __future__ import annotations

from math import inf

from driftproof.numeric.work_precision.verdicts import Priced, dominators

FAST = [Priced(1e-2, 1), Priced(1e-4, 2)]
SLOW = [Priced(1e-2, 2), Priced(1e-3, 3)]


def test_a_method_is_dominated_when_every_point_is_and_its_twin_with_one_good_point_is_not() -> None:
    assert dominators({"fast": FAST, "slow": SLOW}) == {"slow": ["fast"]}
    assert dominators({"fast": FAST, "slow": [*SLOW, Priced(1e-5, 9)]}) == {}
    assert dominators({"fast": FAST, "same": list(FAST)}) == {}
    assert dominators({"fast": FAST, "none": [Priced(inf, 1)]}) == {}


def test_a_point_over_the_limit_is_beaten_by_no_larger_error_and_beats_none() -> None:
    assert dominators({"fast": FAST, "slow": [*SLOW, Priced(1e-3, inf)]}) == {"slow": ["fast"]}
    assert dominators({"fast": FAST, "slow": [*SLOW, Priced(1e-5, inf)]}) == {}
    assert dominators({"a": [Priced(1e-3, inf)], "b": [Priced(1e-2, inf)]}) == {}


def test_those_that_dominate_together_are_all_named() -> None:
    of = {"a": [Priced(1, 1)], "b": [Priced(0.1, 10)], "c": [Priced(1, 2), Priced(0.1, 11), Priced(0.2, 12)]}
    assert dominators(of) == {"c": ["b", "a"]}
