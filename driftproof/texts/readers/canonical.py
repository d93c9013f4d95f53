"""Canonical spelling: one form each for spaces, minus signs, quotes, superscripts, subscripts and fractions."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator

from driftproof.texts.readers.source_text import Insertion, Piece, SourceText

RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁿⁱ", "0123456789+-=()ni", strict=True))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋₌₍₎ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ", "0123456789+-=()aehijklmnoprstuvx", strict=True))
FRACTIONS = "½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅐⅛⅜⅝⅞⅑⅒"
_ONE_SIGN = {
    **dict.fromkeys("\u2212\u2010\u2011\u2012\u2013\ufe63\uff0d", "-"),  # minus signs, and dashes
    **dict.fromkeys("⁄∕", "/"),
    **dict.fromkeys("’‘′", "'"),
    **dict.fromkeys("“”", '"'),
    "″": "''",
    **dict.fromkeys("⋅∙", "·"),
    **dict.fromkeys("\u200b\u200c\u200d\u2060\u2061\u2062\u2063\u2064\ufeff\u00ad", ""),  # of zero width
}
# A no-break space before a group of three digits separates thousands, not two numbers.
_GROUP = r"(?P<group>(?<=[0-9])[\u00a0\u2009\u202f](?=[0-9]{3}(?![0-9])))"
_SPECIAL = re.compile(
    _GROUP
    + r"|(?P<space>\s\s+|[^\S \n])"
    + rf"|(?P<raised>[{''.join(RAISED)}]+)|(?P<lowered>[{''.join(LOWERED)}]+)|(?P<fraction>[{FRACTIONS}])"
    + r"|(?P<script>[\^_](?:\{[^\s{}]\}(?!\d)|-?[0-9]{2,}|-[0-9]))"
    + rf"|(?P<sign>[{''.join(_ONE_SIGN)}])"
    + r"|(?P<digit>(?![0-9])\d)"
)


def canonical_spelling(text: SourceText) -> SourceText:
    """The text in canonical spelling, with the places of its characters kept.

    White space is " " or, with a line break in it, "\\n"; minus signs and dashes are "-"; primes and apostrophes are ';
    no-break spaces between groups of digits are commas; h⁶ is h^6, 10⁻⁴ is 10^{-4}, q₁ is q_1, vₙ₊₁ is v_{n+1}, ½ is
    1/2; all digits are 0 to 9.
    """
    return text.rewritten(_SPECIAL, _pieces)


def _pieces(match: re.Match[str]) -> Iterable[Piece]:
    kind, found = match.lastgroup, match[0]
    if kind in _SCRIPTS:
        return _script(*_SCRIPTS[kind], match)
    if kind == "script":  # ASCII ^ and _, with braces as `_script` sets them
        start, end = match.span()
        head = (start, start + 1)
        return [head, (start + 2, end - 1)] if found[1] == "{" else [head, "{", (start + 1, end), "}"]
    if kind == "group":
        return [","]
    if kind == "space":
        return ["\n" if "\n" in found or "\r" in found else " "]
    if kind == "fraction":  # ½ as 1/2, with a space between it and a neighbouring digit: 1½ is 1 1/2
        before, after = match.string[match.start() - 1 : match.start()], match.string[match.end() : match.end() + 1]
        spelled = unicodedata.normalize("NFKC", found).replace("\N{FRACTION SLASH}", "/")
        return [" " * _is_digit(before), spelled, " " * (_is_digit(after) and after not in FRACTIONS)]
    return [_ONE_SIGN[found] if kind == "sign" else str(unicodedata.decimal(found))]


_SCRIPTS = {"raised": ("^", RAISED), "lowered": ("_", LOWERED)}


def _script(sign: str, table: dict[str, str], match: re.Match[str]) -> Iterator[Piece]:
    """^ or _ and the characters, in braces if there are several or a digit follows."""
    braces = len(match[0]) > 1 or _is_digit(match.string[match.end() : match.end() + 1])
    yield sign + "{" * braces
    yield from (Insertion(table[character], i) for i, character in enumerate(match[0], match.start()))
    yield "}" * braces


def _is_digit(character: str) -> bool:
    """True for a digit, and for a fraction such as ½, which is spelled with a digit at both ends."""
    return character.isdecimal() or (character != "" and character in FRACTIONS)


def canonical_text(text: str) -> str:
    """A string in canonical spelling, without places."""
    return canonical_spelling(SourceText.of(text)).text
