"""What a number of a text might be: which of our values, written as it is, look the same."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from driftproof.texts.claims.spelling import Form
from driftproof.texts.readers.numbers import TextNumber

# Methods of which a text is taken to speak where it names none that we know.
USUAL_METHODS = ("forward_euler", "symplectic_euler", "velocity_verlet", "rk4")
USUAL_STEPS = ("1/4", "1/2", "1/10")
RUN_READOUTS = ("state_error", "energy", "energy_change", "phase_error", "q", "v", "steps", "evaluations")
STEP_READOUTS = ("q", "v", "energy")
FACTS = ("imaginary_limit", "real_limit", "order", "error_constant")
MOST_METHODS, MOST_STEPS, MOST_TIMES = 6, 4, 2
# Runs of more steps are not cheap.
LONGEST_RUN = 10_000
# Digits to which values are compared first.
COMPARED = 40
# A number of so many digits, or of so many after the point, looks like few values.
ENOUGH_DIGITS = 3
# Characters on each side of a number in which the names of a value are looked for.
NEIGHBOURHOOD = 100

_H, _T = (re.compile(rf"\b{letter} ?= ?([0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?)(?![\w./])") for letter in "ht")


@dataclass(frozen=True)
class Candidate:
    """A value that looks like a number when written in `form`: its id or question, and how many of its names are near.

    It is `strong` where the number has many digits, or is the value itself and all its names are near.
    """

    question: str
    form: Form
    fit: int
    strong: bool


@dataclass(frozen=True)
class _Known:
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

    def of(self, number: TextNumber) -> list[Candidate]:
        """Every value that is written like the number, the best first: its names stand nearby, or it is equal."""
        try:
            value = number.value
        except (ValueError, ZeroDivisionError):
            return []
        unit = _unit_of(number, value)
        found = []
        for known in self._known:
            if abs(known.approximation - value) <= unit and (form := _form(known, number)):
                fit = self._fit(known, number)
                strong = _is_long(number, value) or (known.exact == value and fit == len(known.names) > 1)
                order = (-fit, known.exact != value, not known.published, len(known.question), known.question)
                found.append((order, Candidate(known.question, form, fit, strong)))
        return [candidate for _, candidate in sorted(found, key=lambda pair: pair[0])]

    def _fit(self, known: _Known, number: TextNumber) -> int:
        """How many of the value's names stand near the number."""
        near = self.text[max(0, number.start - NEIGHBOURHOOD) : number.end + NEIGHBOURHOOD].lower()
        return sum(bool(re.search(rf"(?<![a-z]){name}", near)) for name in known.names)

    @cached_property
    def _known(self) -> list[_Known]:
        """The published values, and those of the usual questions about the methods, steps and times of the text."""
        from driftproof.texts.values.published import published_values

        published = [found for key in published_values() if (found := _known(key, published=True))]
        return published + [found for question in self._questions() if (found := _known(question, published=False))]

    def _questions(self) -> Iterator[str]:
        methods, steps = _methods_in(self.text), _found(_H, self.text, USUAL_STEPS)[:MOST_STEPS]
        times = _found(_T, self.text, ("10",))[:MOST_TIMES]
        for method in methods:
            yield from (f"{fact} {method}" for fact in FACTS)
            for h in steps:
                yield from (f"step {method} h={h} : {readout}" for readout in STEP_READOUTS)
                for t in times:
                    if (n := Fraction(t) / Fraction(h)).denominator == 1 and n <= LONGEST_RUN:
                        yield from (f"run {method} h={h} t={t} : {readout}" for readout in RUN_READOUTS)
        yield from (f"exact t={t} : {readout}" for t in (*times, *steps) for readout in "qv")


def _methods_in(text: str) -> list[str]:
    """The methods whose keys or titles stand in the text, or else the usual ones."""
    from driftproof.methods.catalogue import METHODS

    flat = text.lower().replace("\n", " ").replace("-", " ")
    named = [key for key, method in METHODS.items() if re.search(rf"\b{key}\b", flat) or _plain(method.title) in flat]
    usual = [key for key in USUAL_METHODS if key in named or key.replace("_", " ") in flat]
    return (list(dict.fromkeys([*usual, *named])) or list(USUAL_METHODS))[:MOST_METHODS]


def _plain(title: str) -> str:
    return title.lower().replace("-", " ")


def _found(pattern: re.Pattern[str], text: str, default: Iterable[str]) -> list[str]:
    """The positive numbers that the text gives to a letter, then the default ones, each once."""
    found: dict[Fraction, str] = {}
    for spelled in (*pattern.findall(text), *default):
        if len(spelled) < 20 and Fraction(spelled):
            found.setdefault(Fraction(spelled), str(Fraction(spelled)))
    return list(found.values())


def _known(question: str, published: bool) -> _Known | None:
    from driftproof.texts.questions.ask import value
    from driftproof.texts.questions.style import HALF_EVEN, Style

    try:
        answer = value(question)
        if not answer.is_number:
            return None
        exact = answer.exact if isinstance(answer.exact, Fraction) else None
        near = exact if exact is not None else Fraction(answer.digits(COMPARED, Style(rounding=HALF_EVEN)))
    except ValueError:
        return None  # a question that this method has no answer to
    return _Known(question, published, near, exact)


def _form(known: _Known, number: TextNumber) -> Form | None:
    """The form in which the value is written like the number; None where there is none."""
    from driftproof.texts.questions.ask import value
    from driftproof.texts.questions.errors import AmbiguousRounding

    spelled = re.sub(r" ?[×·] ?10\^\{?(-?[0-9]+)\}?", r"e\1", number.text.replace(",", "").lstrip("+"))
    for rounding in (None, "half-even", "half-away"):
        form = _form_of(number, rounding)
        try:
            if spelled in form.spellings(value(known.question)):
                return form
            if rounding is None:
                return None
        except AmbiguousRounding:
            continue
        except ValueError:
            return None
    return None


def _form_of(number: TextNumber, rounding: str | None) -> Form:
    """The form in which the number stands."""
    if "/" in number.text:
        return Form(exact=True)
    if number.places is None:
        return Form(digits=max(1, _digits(re.split(r"[eE]| ?[×·]", number.text)[0])), rounding=rounding)
    return Form() if number.places == 0 else Form(places=number.places, rounding=rounding)


def _is_long(number: TextNumber, value: Fraction) -> bool:
    return _digits(number.text) >= ENOUGH_DIGITS or bool(value and (number.places or 0) >= ENOUGH_DIGITS)


def _digits(text: str) -> int:
    """How many digits it has from the first that is not 0."""
    return len(re.sub(r"[^0-9]", "", text).lstrip("0"))


def _unit_of(number: TextNumber, value: Fraction) -> Fraction:
    """How far a value may be from what the number spells: a unit of its last place, or nothing."""
    if "/" in number.text or number.places == 0:
        return Fraction(0)
    if number.places is not None:
        return Fraction(1, 10**number.places)
    return abs(value)
