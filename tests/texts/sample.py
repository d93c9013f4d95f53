"""A claim in one line, and a text with claims about it, for several test files."""

import json
from pathlib import Path

from driftproof.texts.claims.checking import check_claims, coverage
from driftproof.texts.claims.claims import Claims, parse_claims
from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.document import document_of
from driftproof.texts.readers.numbers import numbers_in


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


def claims_and_slips(text):
    """What each number of a text with a point in it is claimed to be, "" for nothing, and the slips."""
    suggestions, numbers = Suggestions(text), [x for x in numbers_in(text) if "." in x.text]
    best = {x.text: ones[0] if (ones := suggestions.look_alikes(x)) else None for x in numbers}
    claimed = {text: one.question if one and one.strong else "" for text, one in best.items()}
    return claimed, {x.text: [*suggestions.slips(x).values()] for x in numbers if suggestions.slips(x)}


def strong_and_slips(text):
    """What each number of two digits or more, or of an order, is strongly like, and is a slip for."""
    suggestions, found = Suggestions(text), list[tuple[str, bool, list[str]]]()
    for number in numbers_in(text):
        alike = suggestions.look_alikes(number)[:1]
        found.append((number.text, any(one.strong for one in alike), [*suggestions.slips(number).values()]))
    return found
