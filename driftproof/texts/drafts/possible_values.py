"""The values that the numbers of one text may be: published ones, usual ones, those asked for and those stated.

Each has its question, and says how likely a number that looks so means it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import chain, product
from math import prod

from flint import arb, ctx

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.solution.steps import with_effort
from driftproof.methods.catalogue import FURTHER_METHODS, METHODS, keys_of_name
from driftproof.support.progress import stage
from driftproof.symbolic.algebra.certified import Uncertified, enclose
from driftproof.texts.claims.phrases import NumberForm, form_of, spelled
from driftproof.texts.questions.answer import GIVEN, Answer
from driftproof.texts.questions.arithmetic import NUMBER_FUNCTIONS
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.values.published import published_values
from driftproof.texts.words.contradictions import SETTING, sentence_around
from driftproof.texts.words.method_names import lowered, methods_asked, methods_named

# The usual questions: about the methods that the text names, else about these, with its step sizes, then with these.
_USUAL_METHODS = ("forward_euler", "symplectic_euler", "velocity_verlet", "rk4")
_USUAL_STEPS = ("1/4", "1/2", "1/10")
_RUN_READOUTS = ("state_error", "energy", "energy_change", "phase_error", "q", "v", "steps", "evaluations")
_STEP_READOUTS = ("q", "v", "energy")
LIMITS_OF_METHODS = ("imaginary_limit", "real_limit", "angle")
_USUAL_FACTS = (*LIMITS_OF_METHODS, "order", "stages", "error_constant", "limit_at_infinity")
# Limits that keep this to a few hundred questions of cheap runs, a second or two in all.
_MOST_METHODS, _MOST_RUN, _MOST_SIZES, _MOST_TIMES, _MOST_COUNTS = 20, 6, 4, 2, 2
_LONGEST_RUN = 10_000
# Of the steps that may enclose a solution: at most 1000 explicit ones, some seconds.
EFFORT = 1 / 20
# Bits of precision: enough for the digits of any number of a text; for what the author asks, of some hundred steps.
_MOST_BITS = 256
_MOST_BITS_ASKED = 8 * _MOST_BITS
# The questions for a value as a percentage, and for its size.
SHARE, SIZE = "percent({}, 1)", "abs({})"
# The oscillator of the lesson, as a question states it.
_LESSON = re.compile(r"(?:^| )(\w+)'=(\w+), \2'=-(?:1 ?\*? ?)?\1, \1\(0\)=1, \2\(0\)=0")
# A question whose answer stands in it, such as run rk4 h=0.1 N=10 : steps: a claim of it could not fail.
_SAYS_ITSELF = re.compile(r"(?:\bN ?=|[0-9] steps\b).*: ?steps$|\bh ?=.*: ?h$|\bt ?=.*: ?t$")
# Chosen: a look-alike is strong if at most one in 100 random numbers with as many digits would look as good.
_ODDS = 100
# The same for values that the author asked for, which the text is known to contain.
_ODDS_OF_ASKED = 20
# At most this many questions may come of one with braces: each may take a run.
_MOST_ASKED = 2000
_BRACES = re.compile(r"((?:\b\w+ ?= ?)?)\{([^{}]*)\}")
# A count of steps in words or a setting.
COUNT_OF_STEPS = re.compile(r"(?:\bN ?= ?|\b(?=[0-9]+ (?:time )?steps\b))([0-9]{1,5})\b")


def questions_in(asked: str) -> dict[str, tuple[str, ...]]:
    """Each question that the braces stand for -> its choices. Raises ValueError for none or 2001.

    Equal braces choose alike, and so do those of one setting with as many choices, as in h={0.2,0.1} and h={0.1,0.05}.
    """
    together = dict[tuple[str, int], dict[str, list[str]]]()
    for setting, brace in _BRACES.findall(asked):
        ends = re.fullmatch(r"([0-9]{1,6})\.\.([0-9]{1,6})", brace)
        choices = [*map(str, range(int(ends[1]), int(ends[2]) + 1))] if ends else brace.split(",")
        together.setdefault((setting or brace, len(choices)), {})[brace] = choices
    ways = [[*zip(*choices.values(), strict=True)] for choices in together.values()]
    if not 0 < (count := prod(map(len, ways))) <= _MOST_ASKED:
        raise ValueError(f"{asked[:60]!r} expands to {count} questions; from 1 to {_MOST_ASKED} are allowed")
    found = {}
    for chosen in map(tuple, map(chain.from_iterable, product(*ways))):
        chosen_for = dict(zip(chain(*together.values()), chosen, strict=True))
        found[_BRACES.sub(lambda brace, chosen_for=chosen_for: brace[1] + chosen_for[brace[2]], asked)] = chosen  # type: ignore[misc]
    return found


@dataclass(frozen=True)
class KnownValue:
    """A value that a number may be, by question or id; `chosen` has the choices from the braces of an asked one.

    A `stated` one was not asked by the author, but is about a problem that the text states.
    """

    question: str
    answer: Answer
    chosen: tuple[str, ...] | None = None
    stated: bool = False

    @cached_property
    def methods(self) -> list[set[str]]:
        """The methods that are chosen, each as the keys that its name may mean."""
        return [{*keys} for text in self.chosen or () if (keys := keys_of_name(text))]

    @cached_property
    def numbers(self) -> list[set[Fraction]]:
        """The chosen numbers, which stand beside the value in a table; for a number N of steps also the time N h."""
        chosen = [{number.value} for text in self.chosen or () for number in numbers_in(text) if number.text == text]
        h, n = (Fraction(*found[:1]) for found in (x.findall(self.question) for x in (SETTING["h"], COUNT_OF_STEPS)))
        return [x | {n * h} if x == {n} else x for x in chosen]

    @cached_property
    def names(self) -> list[str]:
        """The words that name the value, without single letters and words common to all questions."""
        words_chosen = [text for text in self.chosen or () if not keys_of_name(text)]
        text = " ".join(words_chosen) if self.chosen else re.sub(r"\b(?:run|step|from) |[htN]=\S+", "", self.question)
        words = dict.fromkeys(re.split(r"[^a-z0-9]+", text.lower()))
        least = "[a-z]{2,}[0-9]*" if self.chosen is not None else ".*[a-z].+|.+[a-z].*"
        return [word for word in words if re.fullmatch(least, word)]

    @cached_property
    def keys(self) -> set[str]:
        """The keys of the methods that the question names."""
        return set().union(*self.methods) or methods_named(self.question.lower())

    @cached_property
    def rank(self) -> int:
        """2 for what the author asks for, 1 for what is about a stated problem, 0 for other values."""
        return (self.chosen is not None) + (self.chosen is not None and not self.stated)

    @property
    def of_lesson(self) -> bool:
        """True for what a run of the lesson gives, no fact and of no problem of the text."""
        return self.rank == 0 and (" : " in self.question or "." in self.question.partition(" ")[0])

    @property
    def most(self) -> int:
        """How many names, methods and numbers it has, all of which may stand near a number."""
        return len(self.names) + len(self.methods) + len(self.numbers)

    def is_meant(self, x: Fraction, digits: int, fit: int, rivals: int) -> bool:
        """True if x hardly looks so by chance: `fit` names are near, and as near to no more than `rivals` values."""
        asked = self.chosen is not None
        likely = rivals * (_ODDS_OF_ASKED if asked and not self.stated else _ODDS) <= 9 * 10 ** (digits - 1)
        only_method = {*self.names} <= {*"_".join(self.keys).split("_")}
        says_what = asked or digits > 1 or not only_method
        named = says_what and fit == self.most and fit > (digits < 2 or not asked)
        # Digits of roots of small numbers are not random, so an irrational value needs a name nearby.
        near = asked or fit > 0 or isinstance(self.answer.exact, Fraction)
        # A constant that the lesson chose may be chosen by another text, too, without being meant.
        return (likely or (self.answer.exact == x and named)) and near and self.answer.evidence != GIVEN


class PossibleValues:
    """The values that the numbers of one text may be, each by its question."""

    def __init__(self, text: str, stated: Sequence[str], asked: Iterable[str] = ()) -> None:
        """Take a text in canonical spelling, questions about the problems that it states, and those of its author.

        Braces in questions stand for several; the author says that the text has their values.
        """
        self.text, self.stated, self.lower = text, stated, lowered(text, stated)
        asked_for = {question: chosen for one in asked for question, chosen in questions_in(one).items()}
        # Of braces such as h={0.1,0.2}, t={0.5,1}, the combinations that are runs, or all if none is, to be refused.
        pairs = {one: zip(*(map(Fraction, SETTING[x].findall(one)) for x in "ht"), strict=False) for one in asked_for}
        runs = {one: asked_for[one] for one in asked_for if all((t / h).denominator == 1 for h, t in pairs[one])}
        self.asked = {one: chosen for one, chosen in (runs or asked_for).items() if not _SAYS_ITSELF.search(one)}
        said = [one for one in asked_for if _SAYS_ITSELF.search(one)]
        no_runs = [one for one in asked_for if runs and one not in runs]
        self._refused, self._unanswered = dict[str, Refused](), dict[str, QuestionError]()
        self.not_asked: dict[str, Collection[str]] = {
            "h does not divide t": no_runs,
            "the question has no answer": self._unanswered,
            "the question itself says the value": said,
            "the solution is not enclosed in the few steps of a draft; --ask takes more": self._refused,
        }
        self._spelled: dict[NumberForm, dict[str, list[KnownValue]]] = {}

    @cached_property
    def known(self) -> list[KnownValue]:
        """The published values, the usual ones for the methods, step sizes and times of the text, and the asked ones.

        Raises QuestionError if no question of the author has an answer.
        """
        questions = (published_values() if self._of_lesson else {}) | dict.fromkeys(self._usual_questions())
        found = [KnownValue(each, answer) for each in questions if (answer := usual(each))]
        asked = list[KnownValue]()
        for question, chosen in self.asked.items():
            try:
                asked.append(KnownValue(question, self.limited(question), chosen))
            except QuestionError as error:  # of braces, one method may have no such value
                self._unanswered[question] = error
        if self._unanswered and not asked:
            raise next(iter(self._unanswered.values()))
        stated = {q: chosen for one in self.stated for q, chosen in questions_in(one).items() if q not in self.asked}
        spoken = methods_named(self.lower)
        for question, chosen in stated.items():
            if (keys := methods_asked(question)) and keys.isdisjoint(spoken):
                continue  # of a name that means several methods, one that is named in full nearby
            with suppress(ValueError, Refused):  # a method that is not for the problem, or a solution that ends
                asked.append(KnownValue(question, self.limited(question, EFFORT), chosen, stated=True))
        sizes = [k for k in asked if k.question.endswith(": largest_energy_change") and not k.stated]
        asked += [
            replace(k, question=SIZE.format(k.question), answer=NUMBER_FUNCTIONS["abs"][0](k.answer)) for k in sizes
        ]
        percent, one = NUMBER_FUNCTIONS["percent"][0], Answer("", Fraction(1))
        shares = [each for each in asked if each.answer.is_number and not each.answer.unit]
        shares = [replace(k, question=SHARE.format(k.question), answer=percent(k.answer, one)) for k in shares]
        return [*found, *asked, *shares]

    @cached_property
    def _of_lesson(self) -> bool:
        """True unless all problems that the text states are others than the lesson's."""
        own = [one for one in self.stated if "'=" in one]
        return not own or any(_LESSON.search(one) for one in own)

    def _usual_questions(self) -> Iterator[str]:
        """The facts of the methods, and the lesson's runs with the step sizes, times and counts of the text."""
        found = ([x for x in SETTING[letter].findall(self.text) if len(x) < 20] for letter in "ht")
        own, given = ([str(x) for x in dict.fromkeys(map(Fraction, one)) if x] for one in found)
        sizes = [*dict.fromkeys((*own, *_USUAL_STEPS))][:_MOST_SIZES]
        times = [*dict.fromkeys((*given, "10"))][:_MOST_TIMES]
        ends = {h: self._ends(h, times, h in own) for h in sizes} if self._of_lesson else {}
        spoken = methods_named(self.lower)
        named = dict.fromkeys(key for key in (*_USUAL_METHODS, *METHODS, *FURTHER_METHODS) if key in spoken)
        for i, method in enumerate([*(named or _USUAL_METHODS)][:_MOST_METHODS]):
            yield from (f"{fact} {method}" for fact in _USUAL_FACTS)
            if method in METHODS and spoken & {*FURTHER_METHODS}:
                yield f"-error_constant {method}"
            for h in ends if method in METHODS and i < _MOST_RUN else ():
                yield f"energy_multiplier {method} h={h}"
                yield from (f"step {method} h={h} : {readout}" for readout in _STEP_READOUTS)
                for end, readout in product(ends[h], _RUN_READOUTS):
                    if readout != "steps" or end.startswith("t"):
                        yield f"run {method} h={h} {end} : {readout}"
        for t in (*times, *sizes) if self._of_lesson else ():
            yield from (f"exact t={t} : {readout}" for readout in "qv")

    def _ends(self, h: str, times: Sequence[str], own: bool) -> list[str]:
        """The ends of runs with this step size: times, and if it is the text's own the counts that go with it."""
        counted = {Fraction(n): f"N={n}" for n, of in self._counts if own and (not of or Fraction(h) in of)}
        ends = counted | {Fraction(t) / Fraction(h): f"t={t}" for t in times}
        return [end for n, end in ends.items() if n.denominator == 1 and n <= _LONGEST_RUN]

    @cached_property
    def _counts(self) -> list[tuple[int, set[Fraction]]]:
        """The first counts of steps in the text, with the step sizes that their sentences give."""
        counts = dict[int, set[Fraction]]()
        for count in COUNT_OF_STEPS.finditer(self.text):
            said = [SETTING["h"].findall(part) for part in sentence_around(self.text, *count.span())]
            counts.setdefault(int(count[1]), set()).update(map(Fraction, said[0][-1:] or said[1][:1]))
        return [(n, sizes) for n, sizes in counts.items() if n][:_MOST_COUNTS]

    def written(self, form: NumberForm) -> dict[str, list[KnownValue]]:
        """Spelling -> the values spelled so in this form; a value without this form, such as a tie, is left out."""
        if form not in self._spelled:
            table = self._spelled[form] = {}
            with stage("working out values that the text may mean") as progress:
                for i, known in enumerate(reversed(self.known)):  # long runs hold the shorter ones
                    progress.part = i / len(self.known)
                    with suppress(ValueError):
                        for spelling in form.spellings(known.answer):
                            table.setdefault(spelling, []).append(known)
        return self._spelled[form]

    def written_like(self, number: TextNumber) -> Sequence[KnownValue]:
        """The values that are spelled as the number is."""
        return self.written(form_of(number, self.text)).get(spelled(number), ())

    def limited(self, question: str, effort: float = 1.0) -> Answer:
        """The answer, refused where it is a tie or takes more than this part of the steps allowed: once is enough."""
        try:  # the sign of an error, whose ratio is asked for, takes the solution
            with with_effort(effort):
                answer, balls = value(question), dict[int, arb]()
        except Refused as refusal:
            self._refused[question] = refusal
            raise
        x, most_bits = answer.exact, _MOST_BITS if effort < 1 else _MOST_BITS_ASKED
        if x is None or not callable(x):
            return answer

        def ball() -> arb:
            if ctx.prec in balls:  # spelled in a dozen forms, a value is worked out once
                return balls[ctx.prec]
            if ctx.prec > most_bits:
                raise Uncertified("a tie")
            if question in self._refused:
                raise self._refused[question]
            try:
                with with_effort(effort):
                    return balls.setdefault(ctx.prec, enclose(x))
            except Refused as refusal:
                self._refused[question] = refusal
                raise

        return replace(answer, exact=ball)


@cache
def usual(question: str) -> Answer | None:
    """The answer to a question that names no file, computed once for all texts; None if there is none."""
    with suppress(ValueError):
        return value(question)
    return None
