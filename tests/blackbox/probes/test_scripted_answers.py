"""Answers are scripted one by one, steps of too many calls end, and rounding is allowed for."""

import pytest

from driftproof.blackbox.probes.scripted_answers import (
    MOST_CALLS,
    Departs,
    NotReadable,
    Rounding,
    Script,
    demand_calls,
    demand_same,
    performed,
    read_at_some_size,
    unit,
    varied,
)
from driftproof.symbolic.rounding.formats import BINARY64

ROUNDING = Rounding(BINARY64, 4)


def test_a_script_answers_in_its_order_and_keeps_what_it_was_asked():
    script = Script([1.0, 2.0], 0.0)
    assert [script(place) for place in "abc"] == [1.0, 2.0, 0.0]
    assert script.calls == ["a", "b", "c"]


def test_a_step_of_too_many_calls_is_ended():
    with pytest.raises(NotReadable, match=f"more than {MOST_CALLS} calls"):
        performed(lambda: [script(0) for script in [Script([], 0.0)] for _ in range(MOST_CALLS + 1)])


def test_answers_are_powers_of_two_of_both_signs():
    assert unit(3, 1) == [0.0, 1.0, 0.0]
    assert {abs(x) for x in varied(20, 1)} == {0.25, 0.5, 1.0, 2.0, 4.0}
    assert {x > 0 for x in varied(20, 1)} == {True, False}


@pytest.mark.parametrize(("limit", "found"), [(1.0, 1.0), (0.5, 2.0**-5), (0.01, 2.0**-10)])
def test_a_limit_leads_to_smaller_numbers_and_a_remark(limit, found):
    def read(size):
        if size > limit:
            raise Departs("far off")
        return size

    remark = () if found == 1 else (f"read with numbers of size {found:.1e}; of size 1, far off",)
    assert read_at_some_size(read) == (found, remark)
    with pytest.raises(Departs, match="far off"):
        read_at_some_size(lambda size: read(2.0))


def test_what_differs_by_more_than_rounding_is_refused():
    demand_calls(4, 4)
    demand_same(ROUNDING, [1.0, 2.0], [1.0, 2.0 * (1 + 2.0**-52)])
    for seen in ([1.0], [1.0, 2.0001]):
        with pytest.raises(NotReadable, match="taken twice is not the same"):
            demand_same(ROUNDING, [1.0, 2.0], seen)
    with pytest.raises(NotReadable, match="4, then 5"):
        demand_calls(4, 5)
