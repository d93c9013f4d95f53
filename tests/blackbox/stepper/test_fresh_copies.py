"""A fresh copy remembers nothing, and shares nothing with the original that is in its reach."""

import threading

from driftproof.blackbox.stepper.fresh_copies import fresh_copy


class Counter:
    """Counts its steps."""

    def __init__(self):
        self.steps = 0

    def step(self, by=1):
        self.steps += by
        return self.steps


def counter_in_a_default(seen=[]):  # noqa: B006
    seen.append(0)
    return len(seen)


def counter_in_a_keyword(*, seen=[]):  # noqa: B006
    seen.append(0)
    return len(seen)


def counting_on_itself():
    def step():
        step.steps += 1
        return step.steps

    step.steps = 0
    return step


def counting():
    seen = []
    return lambda: seen.append(0) or len(seen)


def test_a_method_and_a_closure_are_copied_with_what_they_hold():
    for step in (Counter().step, counting_on_itself(), counting()):
        first = fresh_copy(step)
        assert [first(), first(), fresh_copy(step)(), step()] == [1, 2, 1, 1]


def test_a_default_is_shared_as_by_all_runs_of_a_process():
    for step in (counter_in_a_default, counter_in_a_keyword):
        first = fresh_copy(step)
        assert [first(), first(), fresh_copy(step)(), step()] == [1, 2, 3, 4]


def test_what_refuses_to_be_copied_is_none():
    lock = threading.Lock()
    assert fresh_copy(lambda: lock.locked()) is None


def test_functions_that_share_a_variable_share_that_of_the_copy():
    import math

    seen = 0

    def more():
        nonlocal seen
        seen += 1

    also = more

    def step(again=True):
        assert also is more
        more()
        return (math.floor(seen), step(again=False)[0]) if again else (seen,)

    first, second = fresh_copy(step), fresh_copy(step)
    assert (first(), second(), first()) == ((1, 2), (1, 2), (3, 4))
