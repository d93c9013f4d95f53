"""Find the numbers of a text, and tell which are labels: parts of names, about which nothing is claimed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

# 3.3e-4, 3.3×10^{-4}, 3.3·10^4
_EXPONENT = r"(?:[eE][-+]?[0-9]++(?!\.?[0-9])| ?[×·] ?10\^(?:\{[-+]?[0-9]+\}|[0-9]))?"
_WHOLE = r"(?:[1-9][0-9]{0,2}(?:[,'][0-9]{3})++(?![0-9])|[0-9]++)"
# A minus is a sign unless something to subtract from stands before it.
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
# Pattern -> why a number within its match is a label, as shown by coverage; the first pattern that matches counts.
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
    """A number of a text: its span, its spelling there, and why it is a label, None if it is not one."""

    start: int
    end: int
    text: str
    label: str | None

    @property
    def is_worded(self) -> bool:
        """True for a number in words, which `numbers_in` does not find."""
        return self.text[:1].isalpha()

    @property
    def value(self) -> Fraction:
        """The value as a fraction. Raises ZeroDivisionError for n/0, ValueError for too many digits and for words."""
        text = re.sub(r" ?[×·] ?10\^\{?([-+]?[0-9]+)\}?", r"e\1", self.text).replace(",", "").replace("'", "")
        exponent = re.search(r"[eE][-+]?0*([0-9]+)", text)
        if len(text) > 1000 or (exponent and len(exponent[1]) > 3):
            raise ValueError(f"{text[:20]!r} is too long")
        return Fraction(text)

    @property
    def places(self) -> int | None:
        """The number of digits after the decimal point, None for a fraction or a number with an exponent."""
        if re.search(r"[/eE^]", self.text):
            return None
        return len(self.text.partition(".")[2])


def numbers_in(text: str) -> list[TextNumber]:
    """Every number of a text in canonical spelling, in order.

    Numbers are integers, also with groups of three digits, decimals, fractions, exponents and powers; `number_words`
    finds numbers in words. A label is a whole number after a letter (RK4, float64), an index (q_1), a number after a
    word such as Section, Figure or Exercise, a version, a date, the number of an item or a heading, the argument of a
    function, a number alone in square brackets, a part of an address, or the digits of a format such as :.6f.
    """
    inside = bytearray(len(text))  # for each character, which of _LABELS matches there, from 1
    for k, pattern in reversed([*enumerate(_LABELS, 1)]):
        for match in pattern.finditer(text):
            inside[slice(*match.span())] = bytes([k]) * len(match[0])
    reasons = [None, *_LABELS.values()]
    return [
        TextNumber(*match.span(), match[0], _label(text, match, reasons[inside[match.start()]]))
        for match in _NUMBER.finditer(text)
    ]


def _label(text: str, match: re.Match[str], place: str | None) -> str | None:
    """The reason why the number is a label, None if it is not one."""
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
