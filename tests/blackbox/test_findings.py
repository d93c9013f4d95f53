"""What a stepper did that no stepper should has one word for its kind."""

from driftproof.blackbox import findings
from driftproof.blackbox.findings import Misbehaviour, NotFinite, Outcome, UnsupportedCall


def test_every_kind_of_misbehaviour_has_a_word_of_its_own():
    kinds = [each.kind for each in vars(findings).values() if isinstance(each, type) and issubclass(each, Misbehaviour)]
    assert len(set(kinds)) == len(kinds) > 4
    assert UnsupportedCall.kind not in kinds
    assert Outcome(kind=NotFinite.kind, seen="it returns nan").said == "not finite: it returns nan"
