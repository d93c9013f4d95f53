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
    r"versions?|volumes?|vol\.|no\.|issues?|cells?|footnotes?)[ \n]?\(?|§ ?|#)$",
    re.IGNORECASE,
)
_LONGEST_REFERENCE, _BEFORE_REFERENCE = len("propositions ("), tuple(" \n(§#")
# Why a number in one of these is a label, as coverage says it; the first that holds counts.
_LABELS = {
    re.compile(r"_\{[^{}]{0,40}\}"): "an index",
    re.compile(r"(?:https?://|www\.|doi:)[^\s<>\"]+", re.IGNORECASE): "part of an address",
    re.compile(r"^ ?\(?[0-9]{1,3}[.)](?= )", re.MULTILINE): "the number of an item",
    re.compile(r"^#+ [0-9]{1,2}(?:\.[0-9]{1,2})*(?=\.? [A-Z])", re.MULTILINE): "the number of a heading",
    re.compile(
        r"(?<=[.:!?)]\n)[0-9]{1,2}(?:\.[0-9]{1,2})+(?=\.? [A-Z][a-z ].{0,80}[^.,;:\n]\n)"
    ): "the number of a heading",
    re.compile(r"(?<![^\W_])[^\W\d_]'{0,2}\(-?[0-9]+(?:[./][0-9]+)?\)"): "the argument of a function",
    re.compile(r"\[\^?[0-9]+\]"): "an index or a reference in brackets",
    re.compile(r"[:%](?: |[-+,<>^]?[0-9]*)\.[0-9]+[a-zA-Z%](?![-+0-9])"): "a format",
}


@dataclass(frozen=True)
class TextNumber:
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


def numbers_in(text: str) -> list[TextNumber]:
    """Every number of a text in canonical spelling, in order.

    Read are integers, decimals, fractions, exponents, powers and groups of three digits; words are for number_words.
    A label is a whole number that follows a letter (RK4, float64), an index (q_1), what follows a word such as Section,
    Figure or Exercise, a version or a date, the number of an item or of a heading at the start of a line, one number in
    square brackets, what is in an address, and the digits of a format such as :.6f.
    """
    inside = bytearray(len(text))  # of each character, which of _LABELS holds, counted from 1
    for k, pattern in reversed([*enumerate(_LABELS, 1)]):
        for match in pattern.finditer(text):
            inside[slice(*match.span())] = bytes([k]) * len(match[0])
    reasons = [None, *_LABELS.values()]
    return [
        TextNumber(*match.span(), match[0], _label(text, match, reasons[inside[match.start()]]))
        for match in _NUMBER.finditer(text)
    ]


def _label(text: str, match: re.Match[str], place: str | None) -> str | None:
    """Why the number is a label: what it is, what it stands in, or what stands before it."""
    if match["version"]:
        return "a version or a date"
    start, before = match.start(), text[match.start() - 1 : match.start()]
    if place is None and match[0].isdigit() and (before.isalpha() or before == "_"):
        return "part of a name" if before.isalpha() else "an index"
    refers = match["number"] and before in _BEFORE_REFERENCE and match[0][0] not in "+-"
    refers = refers and (before != "#" or match[0].isdigit())  # x = 1 #2.5 is a comment
    if place is None and refers and _REFERENCE.search(text, max(0, start - _LONGEST_REFERENCE), start):
        return "a reference"
    return place
