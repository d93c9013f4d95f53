"""The list of claims is complete: every statement is required or listed as not verifiable."""

from __future__ import annotations

from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import pytest

from driftproof import Facts
from proofs import conftest
from proofs.claims import (
    COUNTED,
    HOW_TO_ADD,
    NOT_VERIFIABLE,
    REQUIRED,
    STATEMENTS,
    claim,
)
from proofs.ledger import Entry, Ledger
from proofs.sentences import line_of_claim


def test_what_needs_no_proof_is_a_statement_of_the_lesson() -> None:
    """One that the lesson has dropped is to be deleted from NOT_VERIFIABLE."""
    assert set(NOT_VERIFIABLE) - set(STATEMENTS) == set()
    assert len(REQUIRED) > 200


def test_claim_refuses_an_unknown_id_and_unknown_evidence() -> None:
    """A proof cannot be marked with an invalid claim id or an unknown kind of evidence."""
    with pytest.raises(
        ValueError, match=r"L52 is no id of a claim: L and three digits .* a new one takes the next number"
    ):
        claim("L52", evidence="PROVED", by="nothing")
    with pytest.raises(ValueError, match="is not a claim to prove: "):
        claim(next(iter(NOT_VERIFIABLE)), evidence="PROVED", by="nothing")
    with pytest.raises(ValueError, match="L000 is no statement of the lesson any more: delete it here"):
        claim("L000", evidence="PROVED", by="nothing")
    with pytest.raises(ValueError, match="none of PROVED"):
        claim("L010", evidence="BELIEVED", by="nothing")


def test_ledger_tells_failed_and_not_run_from_proved() -> None:
    """The ledger counts a claim as proved only if its test passed, and is incomplete otherwise."""
    ledger = Ledger()
    ledger.add(
        ["a", "b"], [Entry("L010", "a", "first", "PROVED", "how"), Entry("L036", "b", "second", "PROVED", "how")]
    )
    assert ledger.standing("L010") == "not run"
    ledger.record("a", "passed")
    ledger.record("b", "passed")
    ledger.record("b", "failed")  # a failing teardown outweighs a passing call
    assert (ledger.standing("L010"), ledger.standing("L036")) == ("PROVED", "failed")
    assert not ledger.complete
    with pytest.raises(ValueError, match="claimed by both"):
        ledger.add(["c"], [Entry("L010", "c", "again", "PROVED", "how")])


def test_new_claim_needs_its_proof_alone_and_one_that_is_missing_says_what_to_do() -> None:
    """A proof of a statement beyond the list adds it to the ledger and requires all statements before it."""
    ledger, (new, missing, later) = Ledger(), (f"L{int(STATEMENTS[-1][1:]) + n}" for n in (1, 2, 3))
    proofs = [Entry(key, key, "a statement", "PROVED", "how") for key in (*REQUIRED, new, "T01", "T02")]
    ledger.add([entry.test for entry in proofs], proofs)
    for entry in proofs:
        ledger.record(entry.test, "passed")
    assert ledger.complete
    assert f"| {new} | - | a statement | PROVED | how | [{new}]({new}) | - |" in ledger.markdown()
    assert f"| L037 | {line_of_claim('L037')} | a statement |" in ledger.markdown()
    assert f"{len(REQUIRED) + 1} claims: {len(REQUIRED) + 1} PROVED; 2 about the toolkit" in ledger.totals()
    ledger.add([], [Entry(later, later, "a statement", "PROVED", "how")])
    assert not ledger.complete
    assert f"without a proof: {missing}; {HOW_TO_ADD}" in " ".join(ledger.text(200).split())
    of_one_file = Ledger()
    of_one_file.add(["a"], [Entry(REQUIRED[0], "a", "first", "PROVED", "how")])
    told = f"without a proof: {', '.join(REQUIRED[1:13])} and {len(REQUIRED) - 13} more; {HOW_TO_ADD}"
    assert told in " ".join(of_one_file.text(200).split())


def test_a_fact_read_by_name_fails_the_proof_of_a_claim_that_is_to_be_proved() -> None:
    """Whatever value it has; what a count or a page reads meanwhile is read."""
    for evidence, stopped in (*((known, True) for known in conftest.BY_DERIVATION), (COUNTED, False)):
        marker = claim("L250", evidence=evidence, by="").mark
        of: Any = SimpleNamespace(get_closest_marker=lambda name, marker=marker: marker)
        during, facts = conftest.pytest_runtest_call(of), Facts("rk4")
        next(during)
        with pytest.raises(pytest.fail.Exception, match="reads the fact 'order', and no") if stopped else nullcontext():
            assert facts.order == 4
        assert facts.method.key == "rk4"
        during.close()
        assert facts.order == 4


def test_ledger_refuses_two_values_under_one_id() -> None:
    """Two proofs that publish different values under one id stop the publication."""
    one = {"id": "x", "exact": "1", "decimal": "1", "evidence": "PROVED", "claim": "L067", "text": "1"}
    assert '"x"' in Ledger(published=[one]).values()
    for change in ({"claim": "L068", "decimal": "2"}, {}):
        with pytest.raises(ValueError, match="published twice"):
            Ledger(published=[one, {**one, **change}]).values()
