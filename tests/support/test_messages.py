"""Plain values survive the way to another process to the last bit, and no text executes anything."""

import json
from dataclasses import dataclass
from fractions import Fraction
from math import copysign, inf, isnan
from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.support.messages import MessageError, decode, encode

ATOMS = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False)
    | st.complex_numbers(allow_nan=False)
    | st.text(st.characters())
    | st.fractions()
)
VALUES = st.recursive(
    ATOMS,
    lambda inner: (
        st.lists(inner)
        | st.lists(inner).map(tuple)
        | st.dictionaries(ATOMS, inner)
        | st.frozensets(st.integers() | st.text())
        | st.sets(st.integers())
    ),
    max_leaves=8,
)


@dataclass(frozen=True)
class Found:
    values: tuple[float, ...]
    also: dict[str, Fraction]

    def __post_init__(self):
        assert self.values, "a decoder that ran this would execute what it was sent"


class Pair(NamedTuple):
    a: int
    b: str


@given(VALUES)
def test_a_value_comes_back_as_it_went_with_its_types(value):
    back = decode(encode(value))
    assert back == value
    assert type(back) is type(value)


def test_floats_come_back_to_the_last_bit():
    zero, infinite, tiny = decode(encode([-0.0, -inf, 5e-324]))
    assert (copysign(1, zero), infinite, tiny) == (-1, -inf, 5e-324)
    assert isnan(decode(encode(float("nan"))))
    assert decode(encode(10**5000)) == 10**5000
    assert encode([10**15 - 1, -(10**15)]) == f'[{10**15 - 1}, {{"int": "-0x38d7ea4c68000"}}]'


@pytest.mark.parametrize("value", [Found((0.1, inf), {"a": Fraction(1, 3)}), Pair(3, "x"), [Pair(1, "")]])
def test_our_own_records_come_back_where_they_are_awaited(value):
    assert decode(encode(value), "tests") == value
    with pytest.raises(MessageError, match="no plain class of ours"):
        decode(encode(value), "driftproof")


def test_a_record_is_made_without_running_its_code():
    text = json.dumps({"object": [f"{__name__}:Found", {"values": [], "also": {"dict": []}}]})
    assert decode(text, "tests").values == []


@pytest.mark.parametrize("value", [object(), len, bytes(3), Found, {1: object()}])
def test_what_is_no_plain_value_is_not_sent(value):
    with pytest.raises(TypeError, match="is no plain value"):
        encode(value)


@pytest.mark.parametrize(
    "text",
    [
        "", "nonsense", "[" * 100_000, '{"object": ["os:system", {}]}',
        '{"object": ["driftproof.support.messages:json", {}]}',
        '{"object": ["driftproof.support.messages:encode", {}]}',
        '{"object": ["driftproof.support.files:Path", {}]}', '{"object": ["driftproof.no_such_module:X", {}]}',
        '{"record": ["subprocess:Popen", [["true"]]]}', '{"float": "1/3"}', '{"fraction": ["0x1", "0x0"]}',
        '{"dict": [[[], 1]]}', '{"a": 1, "b": 2}', "{}", '{"eval": "1"}',
    ],
)  # fmt: skip
def test_no_other_text_is_read(text):
    with pytest.raises(MessageError, match="no message"):
        decode(text, "driftproof")
