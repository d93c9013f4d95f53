"""A claim in one line, and a text with claims about it, for several test files."""

import json
from pathlib import Path

from driftproof.texts.claims.checking import check_claims, coverage
from driftproof.texts.claims.claims import Claims, parse_claims
from driftproof.texts.readers.document import document_of


def claim(phrase, more="", value="0.33"):
    """A claim whose one value, if its phrase has one, is a number spelled so."""
    values = f"value = {{given = {json.dumps(value)}}}" if "{value}" in phrase else ""
    text = f"[[claim]]\nid = 'a'\nphrase = {json.dumps(phrase, ensure_ascii=False)}\n{values}\n{more}"
    return parse_claims(text).claims[0]


def stands(text, one, form="plain"):
    """How often the phrase of the claim stands in the text."""
    return len(check_claims(document_of(text, form), [one])[0].occurrences)


TEXT = """\
RK4, read in 5 min.
1. In Section 2 the error is 0.33 after 40 steps, q₁ = 0.5.
It prints 0.25, and nobody claims 7 or 8/9."""
CLAIMS = Claims(
    (claim("error is {value} after 40 steps", "given = true"),),
    parse_claims("[[label]]\nphrase = '{n} min'\nwhy = 'time'").labels,
)
ROOT = Path(__file__).parents[3]
SPRING = ROOT / "examples" / "text" / "spring.md"


def held(document, text):
    """The coverage by drafted claims, all of which hold."""
    claims = parse_claims(text)
    outcomes = check_claims(document, claims.claims)
    findings = [finding for outcome in outcomes for finding in outcome.findings]
    assert findings == []  # of a text without numbers there is nothing to find
    return coverage(document, outcomes).counts
