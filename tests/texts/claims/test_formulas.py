"""Formulas are compared as functions, exactly, and one of a text is held however it is written."""

import pytest

from driftproof.texts.claims.checking import check_claims
from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.claims.formulas import same_formula
from driftproof.texts.readers.canonical import canonical_text
from driftproof.texts.readers.document import document_of

# As we write it, as papers do, and formulas that are others.
SAME = [
    ("1 - h**6/72 + h**8/576", "1 + h⁸/576 − (1/72)h⁶", ["1 + h⁸/576 - h⁶/71", "1 - h⁶/72", "1 - h⁶/72 + h⁷/576"]),
    ("(1 + z/2)/(1 - z/2)", "(2 + z)/(2 - z)", ["(2 - z)/(2 + z)", "(2+z)/(2-z) + (z-2)/(1-z)", "1/0"]),
    ("q**2/2 - h*q*v/2 + v**2/2", "(q² − hqv + v²)/2".replace("hqv", "h q v"), ["(q² + h q v + v²)/2", "(q² + v²)/2"]),
    ("(1 - 2*gamma)/(1 - gamma*z)**2", "(1 − 2γ)(1 − γ z)^{-2}", ["(1 − 2γ)/(1 − γ z)", "(1 - 2γ)(1 - z)^{-2}"]),
    ("h**2", "h h", ["2h", "h^{12}", "(0/0)^0"]),
    ("0/((h - 2)*(h - 3))", "0", ["h*(h - 1)", "0/(h - h)"]),  # 0 at fewer points than their degrees add up to
    ("h*(h - 1)", "h^2 - h", ["0/((h - 2)(h - 3))"]),
    ("-h**2 + 1/h", "(1 - h^3) h^{-1}", ["-(h**2 + 1/h)", "h**2 + 1/h", "-(h**2) - 1/h"]),
]


@pytest.mark.parametrize(("ours", "theirs", "others"), SAME)
def test_formula_is_the_same_however_it_is_written(ours, theirs, others):
    assert same_formula(ours, canonical_text(theirs))
    assert [other for other in others if same_formula(ours, canonical_text(other))] == []


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("sqrt(h)", "it contains sqrt; only rational functions"),
        ("h^(1/2)", "it contains a root; only rational"),
        ("1 +", "is not a formula"),
        ("(1 + h + h^2)^{199}", "too long to compare: 20100 terms"),  # at most
        ("(1 + h)^{199} (w + z)^{100}", "too long to compare: 20200 terms"),
    ],
)
def test_what_is_not_compared_is_refused(text, why):
    with pytest.raises(ValueError, match=why):
        same_formula("h", text)


def test_formulas_are_compared_with_20000_terms_at_most():
    for pair in (("(1 + h)**199", "1/(1 + z)^{100}"), ("1/(1 + h)**199", "(1 + z)^{100}")):  # n₁d₂ and n₂d₁
        with pytest.raises(ValueError, match="too long to compare: 20200 terms"):
            same_formula(*pair)
    assert same_formula("(1 + h)**99*(1 + z)**99", "(1 + z)^{99}(1 + h)^{98}(h + 1)")
    assert not same_formula("h**199*z**99", "1 + h^{199}z^{99}")


def test_formula_of_a_text_is_held_as_it_is_written():
    right, other = "1 + h⁸/576 − h⁶/72", "1 + h⁸/576 − h⁶/71"
    for n, text, wrong in (
        (72, "$1+h^8/576-h^6/72$", 1),
        (72, right, 0),
        (72, "1 − h⁶/72 + h⁸/576", 0),
        (71, other, 1),
    ):
        ask = f'ask = "energy_multiplier rk4", written = "1 + h^8/576 - h^6/{n}"'
        claims = parse_claims(f'[[claim]]\nid="a"\nphrase="by {{m}}"\nvalues={{m={{{ask}}}}}').claims
        (found,) = check_claims(document_of(f"by {text}"), claims)
        assert len(found.findings) == wrong
