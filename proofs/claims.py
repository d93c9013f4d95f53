"""How a proof names its claim and its evidence, and which statements are claims."""

from __future__ import annotations

import pytest

# The kinds of evidence, strongest first.
PROVED = "PROVED"  # an identity, a visible sign, an exact value or series: no sampling, no floats
RESTRICTED = "RESTRICTED"  # proved under a hypothesis that the sentence leaves out, itself proved necessary
CERTIFIED = "CERTIFIED"  # an enclosure whose two ends round to the printed digits, or disjoint enclosures
COUNTED = "COUNTED"  # counted while running
FUZZED = "FUZZED"  # sampled: evidence, not proof
GIVEN = "GIVEN"  # a constant that the lesson chooses, and that the toolkit holds: there is nothing to derive
EVIDENCE = (PROVED, RESTRICTED, CERTIFIED, COUNTED, FUZZED, GIVEN)

# Sentences of the lesson that state nothing to verify, and why.
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

STATEMENTS = tuple(f"L{number:03}" for number in range(1, 250))
REQUIRED = tuple(key for key in STATEMENTS if key not in NOT_VERIFIABLE)
# What the toolkit claims about itself; these stand in a part of the ledger of their own.
TOOLKIT = ("T01", "T02", "T03", "T04", "T05")


def claim(*ids: str, evidence: str, by: str) -> pytest.MarkDecorator:
    """Mark a proof with the ids of the statements it settles, the kind of evidence, and the technique in three words.

    The statement in the ledger is the first line of the proof's docstring, or the text given to `proofs.printed`.
    """
    if evidence not in EVIDENCE:
        raise ValueError(f"evidence {evidence!r} is none of {', '.join(EVIDENCE)}")
    for key in ids:
        if key not in (*REQUIRED, *TOOLKIT):
            raise ValueError(f"{key} is not a claim to prove: see proofs/claims.py")
    return pytest.mark.claim(*ids, evidence=evidence, by=by)
