"""One spelling for what a reader takes for the same: spaces, minus signs, raised and lowered digits, fractions."""

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
    **dict.fromkeys("“”″", '"'),
    **dict.fromkeys("⋅∙", "·"),
    **dict.fromkeys("\u200b\u200c\u200d\u2060\u2061\u2062\u2063\u2064\ufeff\u00ad", ""),  # these take no room
}
# A space between two groups of three digits is no space between two numbers where it does not break a line.
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
    """The text with one spelling of each thing, every character with its place.

    Space is " " or, where a line ends, "\\n"; minus is "-"; h⁶ is h^6, 10⁻⁴ is 10^{-4}, q₁ is q_1, vₙ₊₁ is v_{n+1}; ½
    is 1/2; prime and apostrophe are '; a no-break space between groups of digits is a comma; digits are 0 to 9.
    """
    return text.rewritten(_SPECIAL, _pieces)


def _pieces(match: re.Match[str]) -> Iterable[Piece]:
    kind, found = match.lastgroup, match[0]
    if kind in _SCRIPTS:
        return _script(*_SCRIPTS[kind], match)
    if kind == "script":  # as `_script`, of what is written with ^ or _ already
        start, end = match.span()
        head = (start, start + 1)
        return [head, (start + 2, end - 1)] if found[1] == "{" else [head, "{", (start + 1, end), "}"]
    if kind == "group":
        return [","]
    if kind == "space":
        return ["\n" if "\n" in found or "\r" in found else " "]
    if kind == "fraction":
        return [_fraction(match)]
    return [_ONE_SIGN[found] if kind == "sign" else str(unicodedata.decimal(found))]


_SCRIPTS = {"raised": ("^", RAISED), "lowered": ("_", LOWERED)}


def _script(sign: str, table: dict[str, str], match: re.Match[str]) -> Iterator[Piece]:
    """^ or _ before one character, braces around more, and around one that another digit follows."""
    braces = len(match[0]) > 1 or _is_digit(match.string[match.end() : match.end() + 1])
    yield sign + "{" * braces
    yield from (Insertion(table[character], i) for i, character in enumerate(match[0], match.start()))
    yield "}" * braces


def _fraction(match: re.Match[str]) -> str:
    """½ as 1/2, with a space beside a whole number: 1½ is 1 1/2."""
    before, after = match.string[match.start() - 1 : match.start()], match.string[match.end() : match.end() + 1]
    spelled = unicodedata.normalize("NFKC", match[0]).replace("\N{FRACTION SLASH}", "/")
    return " " * _is_digit(before) + spelled + " " * (_is_digit(after) and after not in FRACTIONS)


def _is_digit(character: str) -> bool:
    """Whether a digit stands there, or a fraction, which begins and ends with one."""
    return character.isdecimal() or (character != "" and character in FRACTIONS)


def canonical_text(text: str) -> str:
    """A text in this spelling, of whose places nothing is asked."""
    return canonical_spelling(SourceText.of(text)).text
