"""Phrases with placeholders for values: the accepted spellings of each value, and the patterns to search for.

No accepted spelling of a value can be read as another number. A number of a text has a form, too, its telling digits,
and what one slip makes of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import count, pairwise, zip_longest
from typing import TYPE_CHECKING, TypeAlias

from driftproof.texts.readers import number_words as words
from driftproof.texts.readers.canonical import canonical_text
from driftproof.texts.readers.numbers import TextNumber, numbers_in

if TYPE_CHECKING:
    from driftproof.texts.questions.answer import Answer

# Limits, chosen above all that texts need: a phrase is a few words around its numbers, or a row of a table.
LONGEST_PHRASE = 400
MOST_VALUES = 20
MOST_DECIMALS = 1000
# A value in words, such as sixteen, a third or twice; or the sign of a change: grows, shrinks, stays.
SPELLED = WORDS, TREND = ("words", "trend")
# No text prints a longer exact form.
_LONGEST_EXACT = 400
# Name of a value -> its accepted spellings, the plainest first.
Spellings: TypeAlias = Mapping[str, list[str]]

_PLACEHOLDER = re.compile(r"\{\{|\}\}|\{(?P<name>[a-z][a-z0-9_]*)\}|[{}]")
_DECIMAL = re.compile(r"(?P<sign>-?)(?P<whole>[0-9]+)(?:\.(?P<rest>[0-9]+))?(?:e(?P<exponent>-?[0-9]+))?")
# Any number, or several that run together; an exponent is no part of a fraction. Possessive, to avoid backtracking.
ANY_NUMBER = (
    r"(?>(?:(?<=\^)[0-9]++|[-+]?(?:[0-9]++(?:[.,'/][0-9]++)*+|\.[0-9]++)(?:[eE][-+]?[0-9]++)?+"
    r"(?: ?[×·] ?10\^(?:\{-?[0-9]++\}|[0-9]))?+)++)"
)
_ANY_WORD = rf"(?i:{words.WORDED_NUMBER}|{words.WORDED_TREND}|{words.WORD_OF_SENTENCE})|{ANY_NUMBER}"
# A match must not be a part of a longer number, a product, a power, a range or a percentage.
_NUMBER_BEGINS = r"(?<![0-9][,'/×·*])(?<![\w.^_√+-])(?<![0-9] [×·*x] )(?<!\bminus )(?<!\bnegative )"
_UNIT = r"%|‰|(?:per[ \n-]?(?:cent|mille?)|percentage|pp[mb]|hundred|thousand|[mb]illion|trillion)(?!\w)"
NUMBER_ENDS = (
    r"(?!\w)(?![.,'/][0-9])(?!/[\w(])(?![\^_√])(?!-\.?[0-9])"
    rf"(?![ \n]?[×·*x][ \n]?10(?![0-9.]))(?![ \n-]?(?:{_UNIT}))"
)

# Behind a whole number that is rounded, its zeros as well.
_ROUNDED = re.compile(rf"{words.PERCENT}| times ")


@dataclass(frozen=True)
class NumberForm:
    """How a text writes a number: to some places or digits, exactly, or in words; by default as a full decimal."""

    places: int | None = None
    digits: int | None = None
    exact: bool = False
    rounding: str | None = None
    spelled: str | None = None  # one of SPELLED

    def spellings(self, value: Answer) -> list[str]:
        """All spellings of the value in this form, in canonical spelling, the plainest first.

        Raises ValueError for a value without this form: a full decimal that does not end, or a tie for which no
        rounding policy is named.
        """
        from driftproof.texts.questions.decimals import Style

        style, x = Style(rounding=self.rounding), value.exact
        if self.spelled is not None:
            return _in_words(value, self.spelled)
        if not value.is_number or self.exact:
            return _exact_spellings(value)
        if self.places is not None:
            return [value.places(self.places, style)]
        if self.digits is not None:
            return decimal_spellings(value.digits(self.digits, style))
        if isinstance(x, Fraction) and 10**MOST_DECIMALS % x.denominator == 0:
            return [value.places(next(n for n in count() if 10**n % x.denominator == 0))]
        raise ValueError("the decimal of the value does not terminate; add places, digits or exact")


def _in_words(value: Answer, spelled: str) -> list[str]:
    """The spellings of a rational number in words, or the words for a change with the sign of the value."""
    from driftproof.symbolic.algebra.certified import certified_sign

    x = value.exact
    if spelled == TREND and x is not None:
        return words.worded_trend(certified_sign(x))
    if said := words.said_of(value.exact_text or "") * (not isinstance(x, Fraction)):
        return said
    if isinstance(x, Fraction):
        return [*words.worded_number(x), *words.said_of(str(x))]
    raise ValueError("the value is not rational, so it cannot be written in words; add places, digits or exact")


def _exact_spellings(value: Answer) -> list[str]:
    """The exact form as on paper, such as 3/8 or 2√2, and in program syntax with * and **."""
    text = value.exact_text
    if text is None:
        raise ValueError("the value has no exact form; add places or digits")
    if len(text) > _LONGEST_EXACT:
        raise ValueError(f"the exact form has {len(text)} characters; add places or digits")
    printed = re.sub(r"\*\*\(?(-?\w+)\)?", lambda to: f"^{to[1]}" if len(to[1]) == 1 else f"^{{{to[1]}}}", text)
    printed = re.sub(r"sqrt\((\w+)\)", r"√\1", printed).replace("sqrt(", "√(").replace("*", "")
    return list(dict.fromkeys((printed, text)))


def decimal_spellings(decimal: str) -> list[str]:
    """The decimal without and with an exponent, such as 0.00033, 3.3e-4, and in tables 33e-5 and 0.33e-3."""
    x = Decimal(decimal)
    if not x:
        return [decimal]
    scientific, n = f"{x:e}".replace("e+", "e"), x.adjusted()
    shifted = [f"{x.scaleb(k - n):f}e{n - k}" for k in (-1, *range(1, min(len(x.as_tuple().digits), 4))) if k != n]
    return [*([] if abs(n) > MOST_DECIMALS else [f"{x:f}"]), scientific, *shifted]


def form_of(number: TextNumber, text: str = "") -> NumberForm:
    """The form in which the text writes the number; a whole number is rounded as a percentage or a ratio."""
    if number.is_worded:
        return NumberForm(spelled=TREND if words.is_trend(number.text) else WORDS)
    if "/" in number.text:
        return NumberForm(exact=True)
    if number.places is None or (not number.places and _ROUNDED.match(text, number.end)):
        digits = digits_of(number.text)
        return NumberForm(digits=len(digits if number.places is None else digits.rstrip("0")) or len(digits))
    return NumberForm(places=number.places or None)


def spelled(number: TextNumber) -> str:
    """The number as values are spelled: 3.3e-4 for 3.3×10^{-4}, 0.5 for .5, without a plus and without groups."""
    spelled = re.sub(r" ?[×·] ?10\^\{?(-?[0-9]+)\}?", r"e\1", number.text.replace(",", "").lstrip("+"))
    return re.sub(r"^(-?)\.", r"\g<1>0.", re.sub(r"[eE](-?)\+?0*(?=[0-9])", r"e\1", spelled))


def slips(spelled: str) -> Iterator[str]:
    """What was meant if the sign is wrong, first, or if one digit is wrong, or two neighbours are exchanged."""
    yield spelled[1:] if spelled.startswith("-") else f"-{spelled}"
    digits = [i for i, sign in enumerate(spelled) if sign.isdigit()]
    for i, j in pairwise(digits):
        if spelled[i] != spelled[j]:
            yield spelled[:i] + spelled[j] + spelled[i + 1 : j] + spelled[i] + spelled[j + 1 :]
    for i in digits:
        yield from (spelled[:i] + new + spelled[i + 1 :] for new in "0123456789" if new != spelled[i])


def digits_of(text: str, telling: bool = False) -> str:
    """The significant digits of a number; with `telling`, without the zeros of a final .0 or final 00 after the point.

    A round value such as 4.000 is likelier than one in 9000. A number that a text chooses, such as 1000, may have any
    zeros at its end, so a draft asks for its digits without them.
    """
    mantissa = re.split(r"[eE]| ?[×·]", text)[0]
    mantissa = re.sub(r"(?<=\.)0$|00+$", "", mantissa) if telling and "." in mantissa else mantissa
    return re.sub(r"[^0-9]", "", mantissa).lstrip("0")


def digits_told(number: TextNumber, text: str) -> int:
    """How many significant digits of the number tell its value from others."""
    return min(len(digits_of(number.text, telling=True)), form_of(number, text).digits or MOST_DECIMALS)


def _spelling_pattern(spelling: str) -> str:
    """A regular expression for one spelling: it also allows a plus, digit groups, ×10^ or ·10^ for e, .5 for 0.5."""
    match = _DECIMAL.fullmatch(spelling)
    if match is None:
        return _literal_pattern(spelling)
    whole, rest, exponent = match["whole"], match["rest"], match["exponent"]
    if (groups := re.sub(r"(?<=[0-9])(?=(?:[0-9]{3})+\Z)", ",", whole)) != whole:
        whole = f"(?:{whole}|{groups}|{groups.replace(',', chr(39))})"
    whole = "0?" if whole == "0" and rest else whole
    text = f"{match['sign'] or '[+]?'}{whole}" + (rf"\.{rest}" if rest else "")
    if exponent is None:
        return text
    sign, raised = ("-", exponent) if exponent.startswith("-") else (r"\+?", exponent)
    raised = raised if len(raised) == 1 else rf"\{{{raised}\}}"
    return text + rf"(?:[eE]{sign}0{{0,2}}{exponent.lstrip('-')}| ?[×·] ?10\^{raised})"


def spelled_alike(plain: str, found: str) -> bool:
    """True if `found` is a spelling of `plain`: with the same digits, as 3.3e-4 is of 0.00033, or of one direction."""
    others = decimal_spellings(plain) if _DECIMAL.fullmatch(plain) else []
    return found in words.words_like(plain) or any(re.fullmatch(_spelling_pattern(other), found) for other in others)


def _literal_pattern(text: str) -> str:
    """A regular expression for a text in canonical spelling that lets each space be a line break."""
    return re.sub(r"(?:\\?[ \n])+", lambda space: "[ \\n]", re.escape(text))


@dataclass(frozen=True)
class Phrase:
    """Literal texts in canonical spelling, and the names of the values between them."""

    literals: tuple[str, ...]
    names: tuple[str, ...]

    @classmethod
    def of(cls, text: str) -> Phrase:
        """Parse a phrase: {name} is a placeholder for a value, {{ and }} are braces. Raises ValueError."""
        if len(text) > LONGEST_PHRASE:
            raise ValueError(f"it has {len(text)} characters; at most {LONGEST_PHRASE} are allowed")
        literals, names, done = [""], list[str](), 0
        for match in _PLACEHOLDER.finditer(text := text.strip()):
            literals[-1] += text[done : match.start()]
            done = match.end()
            if match["name"]:
                names.append(match["name"])
                literals.append("")
            elif len(match[0]) == 1:
                raise ValueError(f"unpaired {match[0]!r}; a placeholder is {{name}}, a literal brace {{{{ or }}}}")
            else:
                literals[-1] += match[0][:1]
        literals[-1] += text[done:]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise ValueError(f"the placeholder {{{twice}}} occurs twice")
        if len(names) > MOST_VALUES:
            raise ValueError(f"it has more than {MOST_VALUES} values")
        if not text:
            raise ValueError("it is empty")
        return cls(tuple(map(canonical_text, literals)), tuple(names))

    @property
    def free_numbers(self) -> list[str]:
        """The numbers in the literal texts, labels excluded."""
        return [number.text for text in self.literals for number in numbers_in(text) if number.label is None]

    @property
    def free_numbers_and_words(self) -> list[str]:
        """The numbers in the literal texts, labels excluded, and the whole ones in words."""
        return [*self.free_numbers, *(word.text for text in self.literals for word in words.words_said_in(text))]

    def exact(self, spellings: Spellings) -> re.Pattern[str]:
        """A pattern of the phrase with each value in one of its spellings, captured in a group of its name."""
        values = (f"(?P<{name}>{'|'.join(map(_spelling_pattern, spellings[name]))})" for name in self.names)
        return self._pattern(_alternating(map(_literal_pattern, self.literals), values))

    def shape(self, spellings: Spellings, names: bool = True) -> tuple[re.Pattern[str], list[str]]:
        """A pattern of the phrase with any numbers, each a group, and the correct ones in the order of the groups.

        With `names`, numbers in names such as RK4 stay.
        """
        texts, found = self._texts_and_numbers(spellings, names)
        numbers = (f"({_ANY_WORD if words.is_worded(number) else ANY_NUMBER})" for number in found)
        return self._pattern(_alternating(map(_literal_pattern, texts), numbers)), found

    def any_numbers(self) -> re.Pattern[str]:
        """A pattern of the phrase with any number for each value; literal numbers stay."""
        numbers = [f"({ANY_NUMBER})"] * len(self.names)
        return self._pattern(_alternating(map(_literal_pattern, self.literals), numbers))

    def written(self, spellings: Spellings) -> str:
        """The phrase with each value in its plainest spelling, a direction as "grows or larger"."""
        compared = ({"larger", "smaller"}.intersection(spellings[name]) for name in self.names)
        values = (" or ".join((spellings[name][0], *said)) for name, said in zip(self.names, compared, strict=True))
        return "".join(_alternating(self.literals, values))

    def _texts_and_numbers(self, spellings: Spellings, names: bool) -> tuple[list[str], list[str]]:
        """The phrase cut at its n numbers into n + 1 texts; numbers that run together count as one."""
        texts, found = [""], list[str]()
        values = [spellings[name][0] for name in self.names]
        for place, part in enumerate(_alternating(self.literals, values)):
            done = 0
            if place % 2 and words.is_worded(part):
                found.append(part)
                texts.append("")
                continue
            for number in numbers_in(part):
                if number.label is None or not names:
                    texts[-1] += part[done : number.start]
                    if found and not texts[-1]:
                        found[-1] += number.text
                    else:
                        found.append(number.text)
                        texts.append("")
                    done = number.end
            texts[-1] += part[done:]
        return texts, found

    def _pattern(self, parts: Iterable[str]) -> re.Pattern[str]:
        """The parts joined into one pattern that matches no partial word or number at its ends."""
        first, last = self.literals[0], self.literals[-1]
        begins = r"(?<!\w)" if re.match(r"\w", first) else ""
        ends = r"(?!\w)" if re.search(r"\w\Z", last) else ""
        if not first or re.match("[-+.]?[0-9]", first):
            begins = _NUMBER_BEGINS
        if not last or last[-1].isdigit():
            ends = NUMBER_ENDS
        # Put the lookbehind after the first letters: re searches ten times as fast for a literal prefix.
        pattern = re.sub(r"\A\(\?<!\\w\)([A-Za-z]+)", r"\1(?<!\\w\1)", begins + "".join(parts) + ends)
        return re.compile(pattern)


def _alternating(literals: Iterable[str], values: Iterable[str]) -> Iterator[str]:
    for pair in zip_longest(literals, values, fillvalue=""):
        yield from pair
