"""Suggest values that the numbers of a text may be: published ones, usual ones, and those that its author asks for."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import product
from math import prod

from flint import arb, ctx

from driftproof.methods.catalogue import FACTS_ONLY, METHODS
from driftproof.symbolic.algebra.certified import Uncertified, enclose
from driftproof.texts.claims.contradictions import contradicted, methods_named
from driftproof.texts.claims.phrases import NumberForm
from driftproof.texts.questions.answer import GIVEN, Answer
from driftproof.texts.questions.arithmetic import NUMBER_FUNCTIONS
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.values.published import published_values

# The usual questions: about the methods that the text names, else about these, with its step sizes, then with these.
_USUAL_METHODS = ("forward_euler", "symplectic_euler", "velocity_verlet", "rk4")
_USUAL_STEPS = ("1/4", "1/2", "1/10")
_RUN_READOUTS = ("state_error", "energy", "energy_change", "phase_error", "q", "v", "steps", "evaluations")
_STEP_READOUTS = ("q", "v", "energy")
_USUAL_FACTS = ("imaginary_limit", "real_limit", "order", "error_constant", "limit_at_infinity", "angle")
# Limits that keep this to a few hundred questions of cheap runs, a second or two in all.
_MOST_METHODS, _MOST_RUN, _MOST_SIZES, _MOST_TIMES, _MOST_COUNTS = 12, 6, 4, 2, 2
_LONGEST_RUN = 10_000
# Chosen: a look-alike is strong if at most one in 100 random numbers with as many digits would look as good.
_ODDS = 100
# The same for values that the author asked for, which the text is known to contain.
_ODDS_OF_ASKED = 20
# At most this many questions may come of one with braces: each may take a run.
_MOST_ASKED = 2000
# Bits of precision: enough for the digits of any number of a text.
_MOST_BITS = 256
_BRACES = re.compile(r"\{([^{}]*)\}")
# The question for a value as a percentage, and words shortly before a number that is no approximation.
_SHARE, _SOLVED = "percent({}, 1)", re.compile(r"\b(?:exact|true|solution)\b")
# Characters on each side of a number that are searched for the names of a value: about a line.
_NEIGHBOURHOOD = 100

_H, _T = (re.compile(rf"\b{letter} ?= ?([0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?)(?![\w./])") for letter in "ht")
_N = re.compile(r"(?:\bN ?= ?|\b(?=[0-9]+ (?:time )?steps\b))([0-9]{1,5})\b")


@dataclass(frozen=True)
class LookAlike:
    """A value that looks like a number of the text when written in `form`, given by its id or its question.

    It is `strong` if a match with so many digits is unlikely to be chance, given how many values have as many of their
    names nearby, or if the number equals the value and all names of the value are nearby; and if the sentence names no
    other method, step size or quantity.
    """

    question: str
    form: NumberForm
    strong: bool


def questions_in(asked: str) -> dict[str, tuple[str, ...]]:
    """Expand the braces of a question: each question with one choice per brace -> these choices.

    Equal braces take equal choices. Raises ValueError for more than 2000 questions, and for an empty range.

    >>> questions_in("step rk4 h=1/{2,4} N={1..2} : q - {1..2}")["step rk4 h=1/4 N=2 : q - 2"]
    ('4', '2')
    """
    choices = dict[str, list[str]]()
    for brace in _BRACES.findall(asked):
        ends = re.fullmatch(r"([0-9]{1,6})\.\.([0-9]{1,6})", brace)
        choices[brace] = [*map(str, range(int(ends[1]), int(ends[2]) + 1))] if ends else brace.split(",")
    if not 0 < (count := prod(map(len, choices.values()))) <= _MOST_ASKED:
        raise ValueError(f"{asked[:60]!r} expands to {count} questions; from 1 to {_MOST_ASKED} are allowed")
    found = {}
    for chosen in product(*choices.values()):
        chosen_for = dict(zip(choices, chosen, strict=True))
        found[_BRACES.sub(lambda brace, chosen_for=chosen_for: chosen_for[brace[1]], asked)] = chosen  # type: ignore[misc]
    return found


@dataclass(frozen=True)
class _Known:
    """A value that a number may be: its question, or its id if it is published, and the answer.

    For a value that the author asked for, `chosen` holds the choices from the braces, which identify it.
    """

    question: str
    published: bool
    answer: Answer
    chosen: tuple[str, ...] | None = None

    @cached_property
    def numbers(self) -> list[Fraction]:
        """The chosen numbers, which stand beside the value in a table."""
        return [number.value for text in self.chosen or () for number in numbers_in(text) if number.text == text]

    @cached_property
    def names(self) -> list[str]:
        """The words that name the value, without single letters and words common to all questions."""
        if self.chosen is not None:
            words = re.split("[^a-z0-9]+", " ".join(self.chosen).lower())
            return [word for word in words if re.fullmatch("[a-z]{2,}[0-9]*", word)]
        words = re.split(r"[^a-z0-9]+", re.sub(r"\b(?:run|step|from) |[htN]=\S+", "", self.question))
        return [word for word in dict.fromkeys(words) if len(word) > 1 and not word.isdigit()]


class Suggestions:
    """The values that the numbers of one text may be."""

    def __init__(self, text: str, asked: Iterable[str] = ()) -> None:
        """Take a text in canonical spelling, and questions, braces allowed, whose values its author says it has."""
        self.text, self._lower = text, text.lower()
        self.asked = {question: chosen for one in asked for question, chosen in questions_in(one).items()}
        self._spelled: dict[NumberForm, dict[str, list[_Known]]] = {}

    def of(self, number: TextNumber) -> list[LookAlike]:
        """Every value written like the number, best first: asked, not contradicted, more of its names nearby, equal."""
        try:
            x = number.value
        except (ValueError, ZeroDivisionError):
            return []
        fits = self._fits(number)
        digits = _digits(number.text, telling=True)
        spelled = re.sub(r" ?[×·] ?10\^\{?(-?[0-9]+)\}?", r"e\1", number.text.replace(",", "").lstrip("+"))
        spelled = re.sub(r"^(-?)\.", r"\g<1>0.", re.sub(r"[eE](-?)\+?0*(?=[0-9])", r"e\1", spelled))
        form, found = form_of(number), []
        before, percent = (
            self.text[: number.start][-_NEIGHBOURHOOD:],
            self.text[number.end :].lstrip(" ").startswith("%"),
        )
        possible = [
            k for k in self._known if (k.answer.unit == "%") == percent or (k.question in self.asked and not percent)
        ]
        alike = {each.question for each in self._written(form).get(spelled, ())}
        for known in (each for each in possible if each.question in alike):
            fit, asked = fits[known.question], known.chosen is not None
            rivals = sum(fits[other.question] >= fit for other in possible if (other.chosen is not None) >= asked)
            odds = _ODDS_OF_ASKED if asked else _ODDS
            likely = rivals * odds <= 9 * 10 ** (digits - 1)
            named = fit == len(known.names) + len(known.numbers) and fit > (digits < 2 or not asked)
            # Digits of roots of small numbers are not random, so an irrational value needs a name nearby.
            near = asked or fit > 0 or isinstance(known.answer.exact, Fraction)
            denied = contradicted(known.question, self._lower, number.start, number.end, asked)
            # A constant that the lesson chose may be chosen by another text, too, without being meant.
            chosen = known.answer.evidence == GIVEN
            strong = (likely or (known.answer.exact == x and named)) and near and not (denied or chosen)
            other = _SOLVED.search(before) is not None and not re.search(r"\bexact\b", known.question)
            last = known.answer.exact != x, not known.published, len(known.question), known.question
            found.append(((not asked, denied, other, -fit, *last), LookAlike(known.question, form, strong)))
        return [alike for _, alike in sorted(found, key=lambda pair: pair[0])]

    def nowhere(self) -> list[tuple[str, Answer]]:
        """The asked questions, with answers, that no number matches strongly, alone, or beside the chosen numbers."""
        asked = {known.question: known for known in self._known if known.question in self.asked}
        shares, found = {_SHARE.format(question): question for question in asked}, set[str]()
        for number in (each for each in numbers_in(self.text) if asked and each.label is None):
            beside, digits = self._on_line_of(number), _digits(number.text, telling=True)
            alike = {shares.get(one.question, one.question): one.strong for one in self.of(number)}
            for known in (possible := [asked[question] for question in asked.keys() & alike]):
                told = digits > 1 + (not known.numbers) or known.answer.exact == number.value
                told = (told and beside.issuperset(known.numbers)) or (len(possible) == 1 and digits > 2)
                found |= {known.question} if told or alike[known.question] else set()
        return [(known.question, known.answer) for known in asked.values() if known.question not in found]

    def _fits(self, number: TextNumber) -> dict[str, int]:
        """For each value, how many of its names stand near the number plus how many of its numbers on the same line."""
        near = self.text[max(0, number.start - _NEIGHBOURHOOD) : number.end + _NEIGHBOURHOOD].lower()
        stand = {name for name in self._all_names if re.search(rf"(?<![a-z]){name}", near)}
        line = self._on_line_of(number) if self.asked else set()
        return {
            known.question: sum(name in stand for name in known.names) + sum(x in line for x in known.numbers)
            for known in self._known
        }

    @cached_property
    def _all_names(self) -> set[str]:
        return {name for known in self._known for name in known.names}

    def _on_line_of(self, number: TextNumber) -> set[Fraction]:
        return {x for start, x in self._lines[self.text.count("\n", 0, number.start)] if start != number.start}

    @cached_property
    def _lines(self) -> list[list[tuple[int, Fraction]]]:
        """For each line of the text, its numbers with their positions."""
        lines, at = list[list[tuple[int, Fraction]]](), 0
        for line in re.split("(?<=\n)", self.text):
            lines.append([])
            for number in numbers_in(line):
                with suppress(ValueError, ZeroDivisionError):
                    lines[-1].append((at + number.start, number.value))
            at += len(line)
        return lines

    def _written(self, form: NumberForm) -> dict[str, list[_Known]]:
        """Spelling -> the values spelled so in this form; a value without this form, such as a tie, is left out."""
        if form not in self._spelled:
            table = self._spelled[form] = {}
            for known in self._known:
                with suppress(ValueError):
                    for spelling in form.spellings(known.answer):
                        table.setdefault(spelling, []).append(known)
        return self._spelled[form]

    @cached_property
    def _known(self) -> list[_Known]:
        """The published values, the usual ones for the methods, step sizes and times of the text, and the asked ones.

        Raises QuestionError if a question of the author has no answer.
        """
        questions = (ids := published_values()) | dict.fromkeys(self._questions())
        found = [_Known(each, each in ids, answer) for each in questions if (answer := _usual(each))]
        asked = [_Known(question, False, _limited(value(question)), chosen) for question, chosen in self.asked.items()]
        percent, one = NUMBER_FUNCTIONS["percent"][0], Answer("", Fraction(1))
        shares = [each for each in asked if each.answer.is_number and not each.answer.unit]
        shares = [replace(k, question=_SHARE.format(k.question), answer=percent(k.answer, one)) for k in shares]
        return [*found, *asked, *shares]

    def _questions(self) -> Iterator[str]:
        sizes, times = _given(_H, self.text, _USUAL_STEPS)[:_MOST_SIZES], _given(_T, self.text, ("10",))[:_MOST_TIMES]
        own, counts = _given(_H, self.text, ()), _given(_N, self.text, ())[:_MOST_COUNTS]
        spoken = methods_named(self._lower)
        named = dict.fromkeys(key for key in (*_USUAL_METHODS, *METHODS, *FACTS_ONLY) if key in spoken)
        for i, method in enumerate([*(named or _USUAL_METHODS)][:_MOST_METHODS]):
            yield from (f"{fact} {method}" for fact in _USUAL_FACTS)
            for h in sizes if method in METHODS and i < _MOST_RUN else ():
                yield f"energy_multiplier {method} h={h}"
                yield from (f"step {method} h={h} : {readout}" for readout in _STEP_READOUTS)
                ends = {Fraction(n): f"N={n}" for n in counts if h in own}
                ends |= {Fraction(t) / Fraction(h): f"t={t}" for t in times}
                for end in (end for n, end in ends.items() if n.denominator == 1 and n <= _LONGEST_RUN):
                    readouts = [readout for readout in _RUN_READOUTS if readout != "steps" or end.startswith("t")]
                    yield from (f"run {method} h={h} {end} : {readout}" for readout in readouts)
        yield from (f"exact t={t} : {readout}" for t in (*times, *sizes) for readout in "qv")


@cache
def _usual(question: str) -> Answer | None:
    """The answer to a question that names no file, computed once for all texts; None if there is none."""
    with suppress(ValueError):
        return value(question)
    return None


def _limited(answer: Answer) -> Answer:
    """The answer with its enclosure limited in precision, so that a tie ends early and is not suggested."""
    x = answer.exact
    if x is None or not callable(x):
        return answer

    def ball() -> arb:
        if ctx.prec > _MOST_BITS:
            raise Uncertified("a tie")
        return enclose(x)

    return replace(answer, exact=ball)


def _given(pattern: re.Pattern[str], text: str, default: Iterable[str]) -> list[str]:
    """The positive numbers that the text gives to a letter, then the default ones, without repetition."""
    spelled = [number for number in (*pattern.findall(text), *default) if len(number) < 20]
    return [str(x) for x in dict.fromkeys(map(Fraction, spelled)) if x]


def form_of(number: TextNumber) -> NumberForm:
    """The form in which the text writes the number."""
    if "/" in number.text:
        return NumberForm(exact=True)
    if number.places is None:
        return NumberForm(digits=max(1, _digits(number.text)))
    return NumberForm(places=number.places or None)


def _digits(text: str, telling: bool = False) -> int:
    """The number of significant digits of a number as text.

    With `telling`, the zeros of a final .0 and of two or more final zeros after the point do not count: a round number
    such as 4.000 is likelier than one in 9000.
    """
    mantissa = re.split(r"[eE]| ?[×·]", text)[0]
    mantissa = re.sub(r"(?<=\.)0$|00+$", "", mantissa) if telling and "." in mantissa else mantissa
    return len(re.sub(r"[^0-9]", "", mantissa).lstrip("0"))
