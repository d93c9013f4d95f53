"""The end of a step is found in what runs and generators return."""

import pytest

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.stepper.opening import opened


@pytest.mark.parametrize(
    "run",
    [
        lambda q, v, h, n: ([0.0, h], [q, q + h * v], [v, v - h * q]),
        lambda q, v, h, n: [(q, v), (q + h * v, v - h * q)],
        lambda q, v, h, n: (q + h * v, v - h * q),
        lambda f, y0, h, n: ([0.0, h], [[*y0], [*(y0 + h * f(0.0, y0))]]),
        lambda f, y0, ts: [[a, b] for a, b in zip(y0, y0 + ts[1] * f(0.0, y0), strict=True)],
    ],
    ids=["times and columns", "rows", "the end alone", "times and rows", "columns"],
)
def test_the_end_of_a_run_is_found_in_rows_and_columns_with_and_without_times(run):
    assert opened(run).step(1.0, 0.75, 0.25) == (1.1875, 0.5)


def test_a_run_that_is_not_of_one_step_is_refused_in_words():
    with pytest.raises(Misbehaviour, match="not two states"):
        opened(lambda q, v, h, n: [(q, v)] * 3)
    with pytest.raises(Misbehaviour, match="ends before it yields a state"):
        opened(lambda q, v, h: iter(()))
