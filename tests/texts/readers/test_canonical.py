"""Space, signs, raised and lowered digits and fractions have one spelling, which is its own."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.readers.canonical import canonical_text
from tests.texts.readers.reading import read

READ = [
    (
        "x\u2033 = q\u2032 = \u22120.5\u00a0and\t\n  ½(q²\u2009+\u2009v²), vₙ₊₁",
        "x'' = q' = -0.5 and\n1/2(q^2 + v^2), v_{n+1}",
    ),
    ("3.3×10⁻⁴, 10^12, h^{6}, 1½, 5\u202f651, \u0663\u0664", "3.3×10^{-4}, 10^{12}, h^6, 1 1/2, 5,651, 34"),
    ("h²3x ½3x ½½ h²", "h^{2}3x 1/2 3x 1/2 1/2 h^2"),
    ("\ufeffa\u200bb\u00ad 1⁄2 kick\u2011drift “c”", 'ab 1/2 kick-drift "c"'),
]


@pytest.mark.parametrize(("source", "text"), READ)
def test_text_has_one_spelling(source, text):
    assert read("plain", source) == text


@given(st.text(alphabet="0123456789 ,.-−½⁰¹²₁ab\n\u00a0"))
def test_canonical_spelling_is_its_own(text):
    once = canonical_text(text)
    assert canonical_text(once) == once
