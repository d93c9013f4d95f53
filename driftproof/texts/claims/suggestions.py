"""What a number of a text might be: which of our values, written as it is, look the same."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from driftproof.texts.claims.phrases import NumberForm
from driftproof.texts.readers.numbers import TextNumber

# What is asked, of the methods of which a text is taken to speak where it names none that we know.
_USUAL_METHODS = ("forward_euler", "symplectic_euler", "velocity_verlet", "rk4")
_USUAL_STEPS = ("1/4", "1/2", "1/10")
_RUN_READOUTS = ("state_error", "energy", "energy_change", "phase_error", "q", "v", "steps", "evaluations")
_STEP_READOUTS = ("q", "v", "energy")
_USUAL_FACTS = ("imaginary_limit", "real_limit", "order", "error_constant")
# A few hundred questions, which take a second or two; runs of more steps are not cheap.
_MOST_METHODS, _MOST_SIZES, _MOST_TIMES = 6, 4, 2
_LONGEST_RUN = 10_000
# Digits to which values are compared first.
_COMPARED = 40
# A number of so many digits, or of so many after the point, looks like few values.
_ENOUGH_DIGITS = 3
# Characters on each side of a number in which the names of a value are looked for: about a line.
_NEIGHBOURHOOD = 100

_H, _T = (re.compile(rf"\b{letter} ?= ?([0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?)(?![\w./])") for letter in "ht")


@dataclass(frozen=True)
class LookAlike:
    """A value that looks like a number when written in `form`: its id or question.

    It is `strong` where the number has many digits, or is the value itself and all its names are near.
    """

    question: str
    form: NumberForm
    strong: bool


@dataclass(frozen=True)
class _Known:
    """A value that a number might be: its question, the value to 40 digits, and exactly where it is rational."""

    question: str
    published: bool
    approximation: Fraction
    exact: Fraction | None

    @cached_property
    def names(self) -> list[str]:
        """What the value is called, but for single letters and what is said of every value."""
        words = re.split(r"[^a-z0-9]+", re.sub(r"\b(?:run|step|from) |[htN]=\S+", "", self.question))
        return [word for word in dict.fromkeys(words) if len(word) > 1 and not word.isdigit()]


@dataclass(frozen=True)
class Suggestions:
    """What the numbers of `text`, in canonical spelling, might be."""

    text: str

    def of(self, number: TextNumber) -> list[LookAlike]:
        """Every value that is written like the number, the best first: its names stand nearby, or it is equal."""
        try:
            value = number.value
        except (ValueError, ZeroDivisionError):
            return []
        near = self.text[max(0, number.start - _NEIGHBOURHOOD) : number.end + _NEIGHBOURHOOD].lower()
        decimals, form = number.places or 0, _form_of(number)
        long = _digits(number.text) >= _ENOUGH_DIGITS or bool(value and decimals >= _ENOUGH_DIGITS)
        # A value is at most a unit of the last place away from a decimal, and is a whole number or a fraction itself.
        unit = abs(value) if form.digits else Fraction(bool(decimals), 10**decimals)
        found = []
        for known in self._known:
            if abs(known.approximation - value) <= unit and _is_written(known, form, number):
                fit = sum(bool(re.search(rf"(?<![a-z]){name}", near)) for name in known.names)
                strong = long or (known.exact == value and fit == len(known.names) > 1)
                order = (-fit, known.exact != value, not known.published, len(known.question), known.question)
                found.append((order, LookAlike(known.question, form, strong)))
        return [alike for _, alike in sorted(found, key=lambda pair: pair[0])]

    @cached_property
    def _known(self) -> list[_Known]:
        """The published values, and those of the usual questions about the methods, steps and times of the text."""
        from driftproof.texts.values.published import published_values

        asked = [*((key, True) for key in published_values()), *((question, False) for question in self._questions())]
        return [known for question, published in asked if (known := _known(question, published))]

    def _questions(self) -> Iterator[str]:
        sizes, times = _given(_H, self.text, _USUAL_STEPS)[:_MOST_SIZES], _given(_T, self.text, ("10",))[:_MOST_TIMES]
        for method in _methods_in(self.text):
            yield from (f"{fact} {method}" for fact in _USUAL_FACTS)
            for h in sizes:
                yield from (f"step {method} h={h} : {readout}" for readout in _STEP_READOUTS)
                for t in times:
                    if (n := Fraction(t) / Fraction(h)).denominator == 1 and n <= _LONGEST_RUN:
                        yield from (f"run {method} h={h} t={t} : {readout}" for readout in _RUN_READOUTS)
        yield from (f"exact t={t} : {readout}" for t in (*times, *sizes) for readout in "qv")


def _methods_in(text: str) -> list[str]:
    """The methods whose keys or titles stand in the text, or else the usual ones."""
    from driftproof.methods.catalogue import METHODS

    flat = text.lower().replace("\n", " ").replace("-", " ")
    titles = {key: method.title.lower().replace("-", " ") for key, method in METHODS.items()}
    named = [key for key, title in titles.items() if re.search(rf"\b{key}\b", flat) or title in flat]
    usual = [key for key in _USUAL_METHODS if key in named or key.replace("_", " ") in flat]
    return (list(dict.fromkeys([*usual, *named])) or list(_USUAL_METHODS))[:_MOST_METHODS]


def _given(pattern: re.Pattern[str], text: str, default: Iterable[str]) -> list[str]:
    """The positive numbers that the text gives to a letter, then the default ones, each once."""
    spelled = [number for number in (*pattern.findall(text), *default) if len(number) < 20]
    return [str(x) for x in dict.fromkeys(map(Fraction, spelled)) if x]


def _known(question: str, published: bool) -> _Known | None:
    """The value, None where it is no number, or the method has none."""
    from driftproof.texts.questions.decimals import HALF_EVEN, Style
    from driftproof.texts.questions.evaluate import value

    try:
        answer = value(question)
        if not answer.is_number:
            return None
        exact = answer.exact if isinstance(answer.exact, Fraction) else None
        near = exact if exact is not None else Fraction(answer.digits(_COMPARED, Style(rounding=HALF_EVEN)))
    except ValueError:
        return None
    return _Known(question, published, near, exact)


def _form_of(number: TextNumber) -> NumberForm:
    """The form in which the number stands."""
    if "/" in number.text:
        return NumberForm(exact=True)
    if number.places is None:
        return NumberForm(digits=max(1, _digits(re.split(r"[eE]| ?[×·]", number.text)[0])))
    return NumberForm(places=number.places or None)


def _is_written(known: _Known, form: NumberForm, number: TextNumber) -> bool:
    """Whether the value, written in this form, is spelled like the number; a tie is not."""
    from driftproof.texts.questions.evaluate import value

    spelled = re.sub(r" ?[×·] ?10\^\{?(-?[0-9]+)\}?", r"e\1", number.text.replace(",", "").lstrip("+"))
    try:
        return spelled in form.spellings(value(known.question))
    except ValueError:
        return False


def _digits(text: str) -> int:
    """How many digits it has from the first that is not 0."""
    return len(re.sub(r"[^0-9]", "", text).lstrip("0"))
