"""`python -m proofs.kernel`: check every certificate with Coq; with claims, show the statement that Coq accepts."""

from __future__ import annotations

import argparse
import re
import resource
import sys
import time
from pathlib import Path

from proofs.claims import EVIDENCE
from proofs.kernel.certificates import IN_PART, all_theorems, certificates, definitions
from proofs.kernel.compiling import PACKAGES, Refused, accepted_mutants, compile_all, foreign_axioms, missing_programs
from proofs.kernel.mutants import mutants

START = time.perf_counter()
LEDGER = Path(__file__).parents[1] / "ledger.md"
# Further theorems that are counted -> the pattern of their statements.
BESIDE = {
    "orders of exact tables": r"has_order \w+ \d+",
    "orders but for rounding of tables of decimals": r"has_rounded_order .+",
    "verdicts on A-stability": r"(collocation_is_)?(not_)?a_stable .+",
}
_ROW = re.compile(r"^\| ([LT]\d+) \| [^|]* \| (.*) \| (\w+) \| [^|]* \| [^|]* \| [^|]* \|$", re.M)


def main(arguments: list[str] | None = None) -> int:
    """Compile everything, count the claims and try the mutants; or print the statements of the given claims."""
    parser = argparse.ArgumentParser(prog="python -m proofs.kernel", description=__doc__)
    parser.add_argument("claims", nargs="*", metavar="CLAIM", help="show this claim's sentence and its Coq statement")
    parser.add_argument("--packages", action="store_true", help="print the Debian packages that it needs")
    options = parser.parse_args(arguments)
    if options.packages:
        print(" ".join(PACKAGES))
        return 0
    rows = {key: (sentence, evidence) for key, sentence, evidence in _ROW.findall(LEDGER.read_text("utf-8"))}
    if options.claims:
        for claim in options.claims:
            if claim not in rows:
                parser.error(f"{claim} is no claim of {LEDGER.name}")
            print(_claim_text(claim, rows[claim][0]))
        return 0
    if (advice := missing_programs()) is not None:
        print(advice, file=sys.stderr)
        return 2
    try:
        return _check(rows)
    except Refused as refusal:
        print(f"refused: {refusal}", file=sys.stderr)
        return 1


def _claim_text(claim: str, sentence: str) -> str:
    certificate = certificates().get(claim)
    if certificate is None:
        return f"{claim}  {sentence}\n      no certificate: docs/kernel.md says why"
    statement = "\n      ".join(certificate.theorem.statement.splitlines())
    lines = [f"{claim}  {sentence}", statement, f"({certificate.theorem.technique}, {certificate.file}.v)"]
    if claim in IN_PART:
        lines.append(f"leaves out: {IN_PART[claim]}")
    if words := definitions(certificate):
        lines.append("words: " + "; ".join(f"{', '.join(names)} in {file}.v" for file, names in words.items()))
    return "\n      ".join(lines)


def _check(rows: dict[str, tuple[str, str]]) -> int:
    compile_all()
    print(f"compiled in {_seconds()}")
    foreign, planted = foreign_axioms(), mutants()
    passed = accepted_mutants(planted)
    for evidence in EVIDENCE:
        claims = [claim for claim, (_, kind) in rows.items() if kind == evidence]
        accepted = sum(claim in certificates() for claim in claims)
        part = sum(claim in IN_PART for claim in claims)
        print(f"{evidence}: {accepted} of {len(claims)} claims accepted by Coq{f', {part} in part' if part else ''}")
    for what, pattern in BESIDE.items():
        accepted = sum(re.fullmatch(pattern, found.theorem.statement) is not None for found in all_theorems())
        print(f"{what}: {accepted} accepted by Coq")
    print(f"{len(planted) - len(passed)} of {len(planted)} planted errors refused")
    for statement in passed:
        print(f"accepted, but false: {statement}", file=sys.stderr)
    for axiom in foreign:
        print(f"rests on an axiom that is none of Coq's own: {axiom}", file=sys.stderr)
    return 1 if passed or foreign else 0


def _seconds() -> str:
    """The CPU seconds of Coq and the wall-clock seconds since the start, as text."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return f"{used.ru_utime + used.ru_stime:.0f} CPU seconds, {time.perf_counter() - START:.0f} on the clock"


if __name__ == "__main__":
    sys.exit(main())
