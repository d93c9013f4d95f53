"""What a stepper did that no stepper should has one word for its kind."""

from driftproof.blackbox import findings
from driftproof.blackbox.findings import Misbehaviour, NotFinite, UnsupportedCall


def test_every_kind_of_misbehaviour_has_a_word_of_its_own():
    kinds = [each.kind for each in vars(findings).values() if isinstance(each, type) and issubclass(each, Misbehaviour)]
    assert len(set(kinds)) == len(kinds) > 4
    assert UnsupportedCall.kind not in kinds


def test_what_is_not_finite_comes_with_its_numbers():
    assert NotFinite("it returns inf", (float("inf"), 0.0)).answer == (float("inf"), 0.0)
