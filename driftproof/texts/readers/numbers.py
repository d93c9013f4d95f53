"""The numbers of a text, and which of them are parts of names: labels, of which nothing is claimed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

# 3.3e-4, 3.3×10^{-4}, 3.3·10^4
_EXPONENT = r"(?:[eE][-+]?[0-9]++(?!\.?[0-9])| ?[×·] ?10\^(?:\{[-+]?[0-9]+\}|[0-9]))?"
_WHOLE = r"(?:[1-9][0-9]{0,2}(?:[,'][0-9]{3})++(?![0-9])|[0-9]++)"
# A minus is a sign where nothing stands before it that it could be subtracted from.
_NUMBER = re.compile(
    r"(?P<version>(?<![0-9.])[0-9]{1,3}+(?:\.[0-9]{1,3}+){2,}(?![0-9.])|(?<![0-9-])[12][0-9]{3}-[01][0-9]-[0-3][0-9](?![0-9]))"
    r"|(?P<power>(?<=\^)[0-9]|(?<=\^\{)[-+]?[0-9]++(?=\}))"
    r"|(?P<number>(?:(?<![\w)\]}.'])[-+])?(?P<body>"
    rf"(?<![0-9]/){_WHOLE}/[0-9]++(?![/0-9]|\.[0-9])|(?:{_WHOLE}(?:\.[0-9]++)?|(?<![\w)])\.[0-9]++){_EXPONENT}))"
)
_REFERENCE = re.compile(
    r"(?:\b(?:chapters?|sections?|sec\.|figures?|figs?\.|tables?|equations?|eqs?\.|exercises?|problems?|theorems?|"
    r"lemmas?|corollary|propositions?|definitions?|examples?|listings?|algorithms?|appendix|parts?|pages?|pp?\.|"
    r"versions?|volumes?|vol\.|no\.|issues?|cells?|footnotes?)[ \n]?\(?|[§#] ?)$",
    re.IGNORECASE,
)
_LONGEST_REFERENCE, _BEFORE_REFERENCE = 16, tuple(" \n(§#")
_LOWERED = re.compile(r"_\{[^{}]{0,40}\}")
_ADDRESS = re.compile(r"(?:https?://|www\.|doi:)[^\s<>\"]+", re.IGNORECASE)
_ITEM = re.compile(r"^ ?\(?[0-9]{1,3}[.)](?= )", re.MULTILINE)
_BRACKETS = re.compile(r"\[\^?[0-9]+\]")
_FORMAT = re.compile(r"[:%][-+,<>^ ]?[0-9]*\.[0-9]+[a-zA-Z%]")
# What makes each of these a label, as coverage says it.
NAME, INDEX, REFERENCE, VERSION, ADDRESS, ITEM, BRACKETED, FORMAT = (
    "part of a name",
    "an index",
    "a reference",
    "a version or a date",
    "part of an address",
    "the number of an item",
    "an index or a reference in brackets",
    "a format",
)
_REASONS = {INDEX: _LOWERED, ADDRESS: _ADDRESS, ITEM: _ITEM, BRACKETED: _BRACKETS, FORMAT: _FORMAT}


@dataclass(frozen=True)
class Number:
    """A number of a text: where, as it stands there, and why it is a label, or None."""

    start: int
    end: int
    text: str
    label: str | None

    @property
    def value(self) -> Fraction:
        """What it spells. Raises ZeroDivisionError for n/0, ValueError for an exponent nobody writes."""
        text = re.sub(r" ?[×·] ?10\^\{?([-+]?[0-9]+)\}?", r"e\1", self.text).replace(",", "").replace("'", "")
        exponent = re.search(r"[eE][-+]?0*([0-9]+)", text)
        if len(text) > 1000 or (exponent and len(exponent[1]) > 3):
            raise ValueError(f"{text[:20]!r} is too long")
        return Fraction(text)

    @property
    def places(self) -> int | None:
        """How many digits stand after the point, None for a fraction and for a number with an exponent."""
        if re.search(r"[/eE^]", self.text):
            return None
        return len(self.text.partition(".")[2])


def numbers(text: str) -> list[Number]:
    """Every number of a text in canonical spelling, in order.

    Read are integers, decimals, fractions, exponents, powers and groups of three digits; words for numbers are not.
    A label is a whole number that follows a letter (RK4, float64), an index (q_1), what follows a word such as Section,
    Figure or Exercise, a version or a date, the number of an item at the start of a line, one number in square
    brackets, what is in an address, and the digits of a format such as :.6f.
    """
    spans = {reason: [match.span() for match in pattern.finditer(text)] for reason, pattern in _REASONS.items()}
    inside = {reason: _Inside(found) for reason, found in spans.items()}
    return [Number(*match.span(), match[0], _label(text, match, inside)) for match in _NUMBER.finditer(text)]


class _Inside:
    """Whether an index stands in one of some spans, asked from left to right."""

    def __init__(self, spans: list[tuple[int, int]]) -> None:
        self.spans = spans[::-1]

    def __call__(self, index: int) -> bool:
        while self.spans and self.spans[-1][1] <= index:
            self.spans.pop()
        return bool(self.spans) and self.spans[-1][0] <= index


def _label(text: str, match: re.Match[str], inside: dict[str, _Inside]) -> str | None:
    start = match.start()
    reasons = [reason for reason, holds in inside.items() if holds(start)]
    if match["version"]:
        return VERSION
    if reasons:
        return reasons[0]
    before = text[start - 1 : start]
    whole = match[0].isdigit()
    if whole and before.isalpha():
        return NAME
    if whole and before == "_":
        return INDEX
    refers = match["number"] and before in _BEFORE_REFERENCE and match[0][0] not in "+-"
    if refers and _REFERENCE.search(text, max(0, start - _LONGEST_REFERENCE), start):
        return REFERENCE
    return None
