"""The certificates without Coq: they are written alike each time, and say what the sentences say."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from proofs.claims import GIVEN, REQUIRED
from proofs.kernel.certificates import IN_PART, ORDER, THEORY, WRITTEN, all_theorems, certificates, source
from proofs.kernel.coq import Theorem, theorems
from proofs.kernel.mutants import mutants
from proofs.printed import ROWS

# Words by which a file of Coq may claim without proof.
UNPROVED = re.compile(r"\b(Admitted|admit|Axiom|Axioms|Parameter|Parameters|Conjecture|Abort|give_up|Unset)\b")
# A second writing, in a process of its own with another seed of hashes.
WRITE = "from proofs.kernel.certificates import ORDER, source; print(*map(source, ORDER), sep='', end='')"


def test_files_are_written_byte_for_byte_alike() -> None:
    """Another process writes the same bytes."""
    command = [sys.executable, "-c", WRITE]
    root = Path(__file__).parents[2]
    again = subprocess.run(command, cwd=root, env={"PYTHONHASHSEED": "7"}, capture_output=True, check=True).stdout
    assert again.decode() == "".join(map(source, ORDER))


def test_nothing_is_taken_for_granted() -> None:
    """No file holds a word by which Coq takes a statement without proof, and every file of the theory is read."""
    assert {path.stem for path in THEORY.iterdir()} | set(WRITTEN) == set(ORDER)
    assert [name for name in ORDER if UNPROVED.search(source(name))] == []


def test_every_theorem_that_is_named_for_a_claim_is_found_once() -> None:
    """The names of theorems are claims of the ledger, and none escapes the pattern that reads them."""
    named = [name for file in ORDER for name in re.findall(r"^Theorem ([LT]\d\w*)", source(file), re.M)]
    assert named == [found.theorem.name for found in all_theorems() if found.theorem.claims]
    assert {key for key in certificates() if key[0] != "T"} <= set(REQUIRED)
    assert set(IN_PART) <= set(certificates())


def test_printed_numbers_are_the_numbers_of_the_statements() -> None:
    """The decimal that the lesson prints stands in the statement as it is printed, after "=" or after "rounds to"."""
    shown = [row for row in ROWS if row.quantity.evidence != GIVEN]
    assert len(shown) > 80
    for row in shown:
        relation, number = certificates()[row.claim].theorem.statement[1:].rsplit(")", 1)[0].rsplit(" ", 2)[1:]
        exact = "=" if row.id in (*COUNTED, "exact.energy") else "=="
        assert (relation, number) == ("≈" if row.relation == "≈" else exact, row.text)


COUNTED = {row.id for row in ROWS if row.id.endswith(("evaluations", "stages"))}


def test_every_way_of_being_right_has_errors_planted() -> None:
    """Each technique of the ledger's column has mutants, each of them another statement than the right one."""
    planted = mutants()
    techniques = {found.theorem.technique for found in all_theorems() if found.theorem.claims}
    assert techniques <= {right.theorem.technique for right, _ in planted}
    assert all(right.theorem.statement != mutant.statement for right, mutant in planted)


def test_a_theorem_is_read_as_it_is_written() -> None:
    """Statement, proof and claims survive the way to a file and back; one that is not finished is none."""
    mine = Theorem("L035_L036", "1 + 1 = 2", "by_ring.")
    assert list(theorems(f"(* *)\n{mine.text()}\n")) == [mine]
    assert (mine.claims, mine.technique) == (("L035", "L036"), "ring")
    assert Theorem("to_R_run", "True", "by_ring.").claims == ()
    assert Theorem("L035", "True", "intros. by_ring.").technique == "script"
    assert list(theorems("Theorem L035 : False.\nProof. Admitted.\n")) == []
