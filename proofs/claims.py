"""The marker @claim, the kinds of evidence, and the list of statements that need a proof."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import pytest

from proofs.sentences import lines_read

# The kinds of evidence, strongest first.
PROVED = "PROVED"  # an identity, a visible sign, an exact value or series: no sampling, no floats
RESTRICTED = "RESTRICTED"  # proved under a hypothesis that the sentence leaves out, itself proved necessary
CERTIFIED = "CERTIFIED"  # an enclosure whose two ends round to the printed digits, or disjoint enclosures
COUNTED = "COUNTED"  # counted while running
FUZZED = "FUZZED"  # sampled: evidence, not proof
GIVEN = "GIVEN"  # a constant that the lesson chooses, and that the toolkit holds: there is nothing to derive
EVIDENCE = (PROVED, RESTRICTED, CERTIFIED, COUNTED, FUZZED, GIVEN)

# Sentences of the lesson that need no proof, and what they are instead.
NOT_VERIFIABLE = {
    "L001": "title",
    "L004": "reading time",
    "L013": "definition of numerical integration",
    "L028": "where the model applies",
    "L029": "how simulation software documents itself",
    "L030": "what neural ODEs are",
    "L031": "what the example leaves out",
    "L063": "who gives the RK4 formula",
    "L098": "heading of a diagram",
    "L100": "colours of a diagram",
    "L103": "colours of a diagram",
    "L107": "markers of a diagram",
    "L150": "what the segments of a diagram are",
    "L184": "pointer to another lesson",
    "L189": "who distinguishes the error orders",
    "L190": "pointer to another lesson",
    "L199": "advice on checking a simulation",
    "L200": "what real robots need",
    "L201": "what accuracy here does not establish",
    "L248": "advice on what to check",
    "L249": "heading of the sources",
}

# The statements of the present lesson: those with which its lines were read. A proof marked with the number after the
# last adds one, a proof marked T06 a claim about the toolkit; a number that is none of them was dropped by the lesson.
STATEMENTS = tuple(sorted({key for line in lines_read() for key in line.claims}))
REQUIRED = tuple(key for key in STATEMENTS if key not in NOT_VERIFIABLE)
_CLAIM = re.compile(r"L\d{3}|T\d{2}")
HOW_TO_ADD = "a claim is a function in the file of its subject in proofs/, marked @claim(id, evidence=..., by=...)"


def required_claims(proved: Iterable[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The claims of the lesson and of the toolkit that need a proof: all, and up to the last `proved` of each.

    >>> required_claims(["L002", "T02"]) == (REQUIRED, ("T01", "T02"))
    True
    """
    last = {"L": 0, "T": 0}
    for key in proved:
        last[key[0]] = max(last[key[0]], int(key[1:]))
    added = (f"L{number:03}" for number in range(int(STATEMENTS[-1][1:]) + 1, last["L"] + 1))
    return (*REQUIRED, *added), tuple(f"T{n:02}" for n in range(1, last["T"] + 1))


def verifiable_otherwise(listed: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    """A sentence for each entry of claims.json that is new, or is to be proved there and not here, or here alone."""
    for entry in listed:
        key, why = entry["id"], NOT_VERIFIABLE.get(entry["id"])
        if key not in STATEMENTS:
            yield f"{key}: new in claims.json: run python -m proofs.sentences, then write its proof; {HOW_TO_ADD}"
        elif entry["verifiable"] and why:
            yield f"{key}: verifiable in claims.json, but NOT_VERIFIABLE in proofs/claims.py says that it is {why!r}"
        elif not entry["verifiable"] and not why:
            yield f"{key}: not verifiable in claims.json; say in NOT_VERIFIABLE of proofs/claims.py what it is instead"


def claim(*ids: str, evidence: str, by: str) -> pytest.MarkDecorator:
    """Mark a proof with the ids of the statements that it settles, its kind of evidence, and its technique in brief.

    The ledger quotes the first line of the proof's docstring, or the sentence of a row of `proofs.printed`. Raises
    ValueError for an unknown kind of evidence and for an id that is not one of a claim.
    """
    if evidence not in EVIDENCE:
        raise ValueError(f"evidence {evidence!r} is none of {', '.join(EVIDENCE)}")
    for key in ids:
        if key in NOT_VERIFIABLE:
            raise ValueError(
                f"{key} is not a claim to prove: {NOT_VERIFIABLE[key]} (NOT_VERIFIABLE in proofs/claims.py)"
            )
        if not _CLAIM.fullmatch(key):
            what = "L and three digits are a statement of the lesson, T and two digits one about the toolkit"
            raise ValueError(f"{key} is no id of a claim: {what}; a new one takes the next number")
        if key <= STATEMENTS[-1] and key not in STATEMENTS:
            raise ValueError(
                f"{key} is no statement of the lesson any more: delete it here, with the proof if it is alone"
            )
    return pytest.mark.claim(*ids, evidence=evidence, by=by)
