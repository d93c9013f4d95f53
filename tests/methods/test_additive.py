"""Additive methods as data: what is refused, and in which words."""

from dataclasses import replace

import pytest

from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.schemes import MethodError


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"a_explicit": ((0, 0), (1, 1))}, "ars111: a_explicit has a nonzero entry on or above its diagonal"),
        ({"a_implicit": ((0, 1), (0, 1))}, "ars111: a_implicit has a nonzero entry above its diagonal"),
        ({"b_implicit": (0, 0, 1)}, "ars111: b_implicit has 3 entries, b_explicit has 2; they must agree"),
        (
            {"embedded_order": 1},
            "ars111: b_explicit_embedded, b_implicit_embedded and embedded_order must be given together",
        ),
        ({"b_explicit": (0.5, 0.5)}, "ars111: b_explicit.0. is 0.5 .float."),
    ],
)
def test_what_is_no_additive_method_is_refused(changes, words):
    with pytest.raises(MethodError, match=words):
        replace(FURTHER_METHODS["ars111"], **changes)


def test_residuals_and_parts_are_named():
    method = FURTHER_METHODS["ars111"]
    assert isinstance(method, Additive)
    assert replace(method, b_implicit=(1, 1)).inconsistencies() == {"sum(b_implicit) - 1": 1}
    assert [method.table(x).key for x in ("explicit", "implicit")] == [
        f"ars111, {x} part" for x in ("explicit", "implicit")
    ]
    assert (method.explicit, method.stages) == (False, 2)
