"""One spelling for what a reader takes for the same: spaces, minus signs, raised and lowered digits, fractions."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator

from driftproof.texts.readers.mapped import At, Mapped, Part

RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁿⁱ", "0123456789+-=()ni", strict=True))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋₌₍₎ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ", "0123456789+-=()aehijklmnoprstuvx", strict=True))
FRACTIONS = "½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅐⅛⅜⅝⅞⅑⅒"
_ONE_SIGN = {
    **dict.fromkeys(
        "\u2212\u2010\u2011\u2012\u2013\ufe63\uff0d", "-"
    ),  # minus signs, and the dashes that stand in for them
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


def canonical(text: Mapped) -> Mapped:
    """The text with one spelling of each thing, every character with its place.

    Space is " " or, where a line ends, "\\n"; minus is "-"; h⁶ is h^6, 10⁻⁴ is 10^{-4}, q₁ is q_1, vₙ₊₁ is v_{n+1}; ½
    is 1/2; prime and apostrophe are '; a no-break space between groups of digits is a comma; digits are 0 to 9.
    """
    return text.rewritten(_SPECIAL, _parts)


def _parts(match: re.Match[str]) -> Iterable[Part]:
    kind, found = match.lastgroup, match[0]
    if kind == "group":
        return [","]
    if kind == "space":
        return ["\n" if "\n" in found or "\r" in found else " "]
    if kind == "raised":
        return _script("^", match, RAISED)
    if kind == "lowered":
        return _script("_", match, LOWERED)
    if kind == "fraction":
        return _fraction(match)
    if kind == "script":
        return _braced(match)
    if kind == "sign":
        return [_ONE_SIGN[found]]
    return [str(unicodedata.decimal(found))]


def _script(sign: str, match: re.Match[str], table: dict[str, str]) -> Iterator[Part]:
    """^ or _ before one character, braces around more, and around one that another digit follows."""
    found, start = match[0], match.start()
    braces = len(found) > 1 or _is_digit(match.string[match.end() : match.end() + 1])
    yield sign + "{" * braces
    yield from (At(table[character], start + i) for i, character in enumerate(found))
    yield "}" * braces


def _braced(match: re.Match[str]) -> Iterator[Part]:
    """The same for what is written with ^ or _ already."""
    text, start, end = match[0], match.start(), match.end()
    yield (start, start + 1)
    if text[1] == "{":
        yield (start + 2, end - 1)
    else:
        yield from ("{", (start + 1, end), "}")


def _fraction(match: re.Match[str]) -> Iterator[Part]:
    """½ as 1/2, with a space beside a whole number: 1½ is 1 1/2."""
    before, after = match.string[match.start() - 1 : match.start()], match.string[match.end() : match.end() + 1]
    spelled = unicodedata.normalize("NFKC", match[0]).replace("\N{FRACTION SLASH}", "/")
    yield " " * _is_digit(before) + spelled + " " * (_is_digit(after) and after not in FRACTIONS)


def _is_digit(character: str) -> bool:
    """Whether a digit stands there, or a fraction, which begins and ends with one."""
    return character.isdecimal() or (character != "" and character in FRACTIONS)
