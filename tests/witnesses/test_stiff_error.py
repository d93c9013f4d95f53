"""The witness for stiff errors: the reduced orders that are in print (hairer-wanner-1996, IV.15)."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.methods.schemes import RungeKutta
from tests.methods.tables.entries import entry
from tests.witnesses.stiff_error import stiff_error


@pytest.mark.parametrize(
    ("key", "power", "decay", "order"),
    [("backward_euler", 2, 1, 1), ("radau_iia2", 3, 1, 2), ("radau_iia3", 4, 1, 3), ("implicit_midpoint", 2, 0, 2)],
)
def test_reduced_order_is_the_printed_one(key: str, power: int, decay: int, order: int) -> None:
    found = stiff_error(entry(key))
    assert (found.power, found.decay, found.order) == (power, decay, order)


def test_explicit_method_is_refused_as_unstable() -> None:
    euler = RungeKutta("euler", "Euler", 1, "test", ((0,),), (Q(1),), (0,))
    with pytest.raises(ValueError, match="is unstable where"):
        stiff_error(euler)
