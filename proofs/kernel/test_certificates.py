"""Checks of the certificates without Coq: complete claims, correct printed numbers."""

from __future__ import annotations

import re

from proofs.claims import GIVEN, REQUIRED
from proofs.kernel.certificates import IN_PART, ORDER, THEORY, WRITTEN, all_theorems, certificates, source
from proofs.kernel.coq import Theorem, theorems
from proofs.kernel.mutants import mutants
from proofs.printed import ROWS

# Words of Coq that assert or allow something without proof.
UNPROVED = re.compile(r"\b(Admitted|admit|Axiom|Axioms|Parameter|Parameters|Conjecture|Abort|give_up|Unset)\b")


def test_nothing_is_taken_for_granted() -> None:
    """No file contains a word of UNPROVED, and every file of the theory is compiled."""
    assert {path.stem for path in THEORY.iterdir()} | set(WRITTEN) == set(ORDER)
    assert [name for name in ORDER if UNPROVED.search(source(name))] == []


def test_every_theorem_that_is_named_for_a_claim_is_found_once() -> None:
    """The pattern of theorems finds every theorem that is named for claims, and all these claims exist."""
    named = [name for file in ORDER for name in re.findall(r"^Theorem ([LT]\d\w*)", source(file), re.M)]
    assert named == [found.theorem.name for found in all_theorems() if found.theorem.claims]
    assert {key for key in certificates() if key[0] != "T"} <= set(REQUIRED)
    assert set(IN_PART) <= set(certificates())


def test_printed_numbers_are_the_numbers_of_the_statements() -> None:
    """The statement ends with the decimal as the lesson prints it, after "=", "==" or "≈" for "rounds to"."""
    shown = [row for row in ROWS if row.quantity.evidence != GIVEN]
    assert len(shown) > 80
    for row in shown:
        relation, number = certificates()[row.claim].theorem.statement[1:].rsplit(")", 1)[0].rsplit(" ", 2)[1:]
        exact = "=" if row.id in (*COUNTED, "exact.energy") else "=="
        assert (relation, number) == ("≈" if row.relation == "≈" else exact, row.text)


COUNTED = {row.id for row in ROWS if row.id.endswith(("evaluations", "stages"))}


def test_every_way_of_being_right_has_errors_planted() -> None:
    """Each technique in the ledger has mutants, and each mutant differs from the right statement."""
    planted = mutants()
    techniques = {found.theorem.technique for found in all_theorems() if found.theorem.claims}
    assert techniques <= {right.theorem.technique for right, _ in planted}
    assert all(right.theorem.statement != mutant.statement for right, mutant in planted)


def test_a_theorem_is_read_as_it_is_written() -> None:
    """A theorem written to a file is read back unchanged; an unfinished one is not read."""
    mine = Theorem("L035_L036", "1 + 1 = 2", "by_ring.")
    assert list(theorems(f"(* *)\n{mine.text()}\n")) == [mine]
    assert (mine.claims, mine.technique) == (("L035", "L036"), "ring")
    assert Theorem("to_R_run", "True", "by_ring.").claims == ()
    assert Theorem("L035", "True", "intros. by_ring.").technique == "script"
    assert list(theorems("Theorem L035 : False.\nProof. Admitted.\n")) == []
