"""Numbers and trends in words, such as "sixteen", "a third", "second order" or "grows": writing and finding them."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import chain
from typing import NamedTuple

_NAMES = (
    "zero one two three four five six seven eight nine ten "
    "eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen",
    "twenty thirty forty fifty sixty seventy eighty ninety",
)
_SMALL, _TENS = map(str.split, _NAMES)
_SCALES = {10**9: "billion", 10**6: "million", 1000: "thousand"}
_PARTS = dict(enumerate(("half", "third", "quarter", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"), 2))
# Sign of a change -> the words for it, the plainest first; and of a difference, behind "times" or "too", or from the
# exact value. The words of a difference have their opposites in the same places.
_TRENDS = {
    1: "grows grow grew grown growing increases increase increased increasing rises rise rose risen rising gains gain "
    "gained",
    -1: "shrinks shrink shrank shrunk shrinking decreases decrease decreased decreasing falls fall fell fallen falling "
    "loses lose lost losing decays decayed drops dropped",
    0: "stays stay stayed staying keeps keep kept keeping",
}
_COMPARED = {
    1: "larger greater higher high large multiplies warm hot above overestimates overestimate overestimated overshoots",
    -1: "smaller less lower low small divides cold cool below underestimates underestimate underestimated undershoots",
    0: "",
}
# Number, or "oo" -> what only its sentence makes a number: "of second order", "halves the error", "for every h".
_IN_SENTENCES = {
    **{str(n): ordinal for n, ordinal in _PARTS.items() if n not in (2, 4)},
    **{"0": "no", "1": "first", "2": "second doubles", "4": "fourth quadruples", "1/2": "halves", "1/4": "quarters"},
    "oo": "every any all",
}
_UNIT = "|".join(sorted(_SMALL, key=len, reverse=True))
_BELOW_HUNDRED = rf"(?:(?:{'|'.join(_TENS)})(?:[- ](?:{'|'.join(_SMALL[1:10])}))?|{_UNIT})"
_LARGE = rf"(?:hundred|{'|'.join(_SCALES.values())})"
_WHOLE = rf"(?:{_BELOW_HUNDRED}|an?(?=[- ]{_LARGE}))(?:(?:[- ]{_LARGE})+(?:(?:[- ]and)?[- ]{_BELOW_HUNDRED})?)*"
_PART = rf"(?:an?|{_UNIT})[- ](?:hal(?:f|ves)|(?:{'|'.join([*_PARTS.values()][1:])})s?)"
WORDED_NUMBER = rf"(?:{_PART}|{_WHOLE}|half|twice|thrice)"
WORDED_TREND = rf"(?:{'|'.join(' '.join((*_TRENDS.values(), *_COMPARED.values())).split())})"
WORD_OF_SENTENCE = rf"(?:{'|'.join(' '.join(_IN_SENTENCES.values()).split())})"
_WHOLE_NUMBER = re.compile(rf"\b{_BELOW_HUNDRED}\b(?![- ](?:{_LARGE}|hal(?:f|ves)|thirds?|quarters?))", re.IGNORECASE)
_TREND = re.compile(rf"\b{WORDED_TREND}\b", re.IGNORECASE)
_SAID = re.compile(
    rf"\b{WORD_OF_SENTENCE}(?=(?:[ -]order| the errors?| (?:h|(?:time )?step ?sizes?))\b)"
    rf"|(?:(?<= times )|(?<= times as )|(?<= too )){WORDED_TREND}\b"
    r"|\b(?:(?:smaller|larger)(?= by\b)|(?:divides|multiplies)(?= the errors?\b))"
    r"|\b(?:(?:above|below)(?= (?:the )?(?:exact|true)\b)|(?:over|under)(?:estimate[sd]?|shoots)"
    r"|(?:lower|higher|smaller|larger|less|greater)(?= than (?:the )?(?:exact|true)\b))\b",
    re.IGNORECASE,
)
# Beside an order in the same sentence, that of another method, as in "RK4 is of fourth order, Heun of second".
_ORDINAL = "|".join(("first", "second", "third", "fourth", *(_PARTS[n] for n in range(5, 11))))
_OF_ORDINAL = re.compile(rf"(?<=\bof )(?:{_ORDINAL})(?= ?(?:[.,;:)]|\Z)| and\b)", re.IGNORECASE)
_OF_ORDER = re.compile(rf"\b(?:{_ORDINAL})[ -]order\b", re.IGNORECASE)
_CHANGES = "|".join(f"{_TRENDS[1]} {_TRENDS[-1]}".split())
_CHANGE = re.compile(rf"\b(?:{_CHANGES})\b", re.IGNORECASE)
# Every word that a number could stand for, and neither, as in "neither A- nor L-stable".
_MULTIPLIES = r"halve[sd]|doubled|doubles|tripled|triples|quadrupled|quadruples|quartered|quarters|neither"
_TOO = "(?<=too )(?:high|large|low|small|warm|hot|cold|cool|fast|slow|early|late|long|short|far|near)"
_ESTIMATED = "(?:over|under)(?:estimate[sd]?|shoots?)"
_READ = re.compile(rf"\b(?:{WORDED_NUMBER}|{_CHANGES}|{_MULTIPLIES}|{_TOO}|{_ESTIMATED})\b", re.IGNORECASE)
# "one" by itself is more often a pronoun; it counts after a word for counting.
_COUNTED = re.compile(r"\b(?:uses|needs|takes|costs|makes|has|only|exactly)\s$", re.IGNORECASE)

# A number of steps as N = 100.
COUNT_GIVEN = re.compile(r"(?<!\w)[nN] ?= ?([1-9][0-9]{0,4})(?![\w.])")
# A count of steps in digits or, below twenty, in words, the last also in "after one step and ... after two".
_STEPS = re.compile(
    rf"(?<![\w.])([0-9]{{1,5}}|(?<!of )(?<!than )(?<!three and )(?:{_UNIT})) (?:time |equal )?step(?:s\b|\b(?! ?size))"
    rf"|(?<=\bafter )({_UNIT})(?=[.,;)])",
    re.IGNORECASE,
)
# The unit of a time, as in day 20, and a time with it behind.
TIME_UNIT = "(?:time|day|hour|minute|second|week|month|year)"
_DURATION = re.compile(rf"\bafter ([0-9]+(?:\.[0-9]+)?|{_UNIT}) (?:time unit|{TIME_UNIT})s?\b", re.IGNORECASE)
# What makes a percentage of the number before it.
PERCENT = r"[ \n]?(?:%|per ?cent\b)"
# A unit right behind a number, in lower case: what is said of the number goes on after it.
_MEASURE = (
    r" ?(?:(?:[fpnuµμmck]?(?:v|m|s|g|a|n|j|w|l|hz|pa|ω|mol|ohms?)|k|min|rad|°c?|%|mmhg|volts?|met(?:er|re)s?|seconds?|"
    r"amperes?|joules?|newtons?|watts?|kelvins?|degrees?|radians?)(?:/(?:s|m|h|kg|l|min))?(?:\^?[23]|[²³])?)(?![\w/^'])"
)
UNIT_BEHIND = re.compile(rf"(?:(?<=[0-9}}])|\A){_MEASURE}")


def counts_of_steps(text: str) -> list[int]:
    """How many steps the text speaks of, in "200 steps", "one step" or "after five steps", in order."""
    found = ((match[1] or match[2]).lower() for match in _STEPS.finditer(text))
    return [int(count) if count.isdigit() else _SMALL.index(count) for count in found]


def durations(text: str) -> list[str]:
    """The times that the text speaks of, in digits: 1 for "after one second"; in order."""
    found = (match[1].lower() for match in _DURATION.finditer(text))
    return [str(_SMALL.index(x)) if x.isalpha() else x for x in found]


class TextWord(NamedTuple):
    """A number or a trend in words: its span in the text, and the words."""

    start: int
    end: int
    text: str


def worded_number(x: Fraction) -> list[str]:
    """The accepted ways to write the number in words, the plainest first. Raises ValueError if there are none."""
    found: list[str] = []
    if x.denominator == 1 and 0 <= x < 10**12:
        plain = _cardinal(int(x))
        found = [plain, plain.replace("-", " "), *{2: ["twice"], 3: ["thrice"]}.get(int(x), [])]
        found += ["a" + plain[3:]] if re.match(r"one (?:hundred|thousand|million|billion)", plain) else []
    elif x.denominator in _PARTS and 0 < x < 1:
        part, many = _PARTS[x.denominator], x.numerator > 1
        spaced = f"{_SMALL[x.numerator]} {part}{'s' * many}"
        found = [spaced, spaced.replace(" ", "-")]
        found = found if many else [f"a {part}" if part != "eighth" else f"an {part}", *found]
        found = ["half", *found] if x == Fraction(1, 2) else found
    if not found:
        raise ValueError("this number has no usual form in words; add places, digits or exact")
    return list(dict.fromkeys(form for word in found for form in (word, word[0].upper() + word[1:])))


def said_of(number: str) -> list[str]:
    """The words that only a sentence makes this number, such as "second" in "of second order", or every of oo."""
    return [form for word in _IN_SENTENCES.get(number, "").split() for form in (word, word.capitalize())]


def is_said_of(text: str) -> bool:
    """True for a word that only a sentence makes a number."""
    return re.fullmatch(WORD_OF_SENTENCE, text, re.IGNORECASE) is not None


def worded_trend(sign: int) -> list[str]:
    """The words for a change, or a difference, of this sign: 1 grows, -1 shrinks, 0 stays."""
    return [form for word in f"{_TRENDS[sign]} {_COMPARED[sign]}".split() for form in (word, word.capitalize())]


def words_like(text: str) -> list[str]:
    """The words for a change, or a difference, of the same sign as this one; other texts by themselves."""
    return next((words for sign in _TRENDS if text in (words := worded_trend(sign))), [text])


def is_trend(text: str) -> bool:
    """True if the whole text is one word for a change or a difference."""
    return _TREND.fullmatch(text) is not None


def trend_said(text: str) -> int:
    """The sign of the last change that the text speaks of: 1 for "has grown by", 0 for none."""
    words = _CHANGE.findall(text)
    return next((sign for sign, of in _TRENDS.items() if words and words[-1].lower() in of.split()), 0)


def opposite(text: str) -> str:
    """What is said of a difference of the other sign, as low for high; "" for other words."""
    pairs = [*zip(_COMPARED[1].split(), _COMPARED[-1].split(), strict=True)]
    return dict((*pairs, *((less, more) for more, less in pairs))).get(text.lower(), "")


def is_worded(text: str) -> bool:
    """True if the whole text is one number or one trend in words."""
    return is_trend(text) or is_said_of(text) or re.fullmatch(WORDED_NUMBER, text, re.IGNORECASE) is not None


def words_in(text: str) -> list[TextWord]:
    """The numbers in words, the words for growth or decay, and for what is said by words alone, in order."""
    found = (m for m in _READ.finditer(text) if m[0].lower() != "one" or _COUNTED.search(text[: m.start()]))
    return [TextWord(*match.span(), match[0]) for match in found]


def words_said_in(text: str) -> list[TextWord]:
    """The words by which a sentence may say a fact: whole numbers, ordinals, factors and directions, in order."""
    found = chain.from_iterable(words.finditer(text) for words in (_WHOLE_NUMBER, _CHANGE, _SAID))
    listed = (m for m in _OF_ORDINAL.finditer(text) if _OF_ORDER.search(_sentence_of(text, m.start())))
    return sorted(TextWord(*match.span(), match[0]) for match in chain(found, listed))


def _sentence_of(text: str, place: int) -> str:
    return re.split(r"[.?!]\s", text[:place])[-1] + re.split(r"[.?!]\s", text[place:], maxsplit=1)[0]


def _cardinal(n: int) -> str:
    if n < 20:
        return _SMALL[n]
    if n < 100:
        return _TENS[n // 10 - 2] + (f"-{_SMALL[n % 10]}" if n % 10 else "")
    size, name = next(((s, name) for s, name in _SCALES.items() if n >= s), (100, "hundred"))
    rest = n % size
    joined = " and " if size == 100 else " "
    return f"{_cardinal(n // size)} {name}" + (f"{joined}{_cardinal(rest)}" if rest else "")
