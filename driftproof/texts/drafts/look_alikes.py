"""The values that a number of a text looks like: published ones, usual ones, and those that its author asks for."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import takewhile

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.multistep import Multistep
from driftproof.symbolic.algebra.certified import certified_sign
from driftproof.texts.claims.checking import Span
from driftproof.texts.claims.phrases import NumberForm, digits_of, digits_told, form_of, spelled
from driftproof.texts.drafts.named_places import NamedPlaces
from driftproof.texts.drafts.possible_values import LIMITS_OF_METHODS, KnownValue, usual
from driftproof.texts.readers.number_words import PERCENT, is_trend, trend_said, words_said_in
from driftproof.texts.readers.numbers import TextNumber
from driftproof.texts.values.published import published_values
from driftproof.texts.words.calculations import Calculation, calculations_in
from driftproof.texts.words.contradictions import (
    SETTING,
    asked_quantity,
    contradicted,
    sentence_around,
    sentence_before,
)
from driftproof.texts.words.heads import LIMIT_OF_STEPS, fact_in_column
from driftproof.texts.words.method_names import (
    begins_with_method,
    methods_named,
    names_in_order,
    with_names_settled,
)
from driftproof.texts.words.places import COMPARED, Place
from driftproof.texts.words.stated_facts import (
    fact_of,
    fact_said,
    is_bound,
    is_on_the_safe_side,
    limit_of_steps,
    linear_equations,
)
from driftproof.texts.words.worded import fact_in_word, gap_to_number, signed_by

# Characters between two numbers that are said of one run: about two sentences.
BESIDE = 200
# Characters between a number and the word that says what becomes of it, as in "0.2 mV too low".
_NEAR_WORD = 12
# Before a number that is set.
_SET = re.compile(r"(?<!\w)(?:[htnz]|dt|δt|step ?size) ?(?:=|of) ?\Z")
# A step size or a time in a question.
_SIZE = re.compile(r"\b[ht]=[^\s,:]+")


@dataclass(frozen=True)
class LookAlike:
    """A value that looks like a number of the text in this form; `strong` if that is unlikely to be chance.

    That depends on the digits, and on how many values have as many of their names nearby, unless it is equal and all
    its names are; and the sentence must name no other method, step size or quantity.
    """

    question: str
    form: NumberForm
    strong: bool


@dataclass(frozen=True)
class _Here:
    """One number x, the values that are written `alike`, and what decides between them.

    `fits` counts the names of each value that stand near, `ranked` the values by rank and fit. The place means those in
    `meant`, of which `stated` ones are of the text's problem, and `wholes` of no single unknown. It names a `fact`,
    which is the `sole` meaning of its words; a `bound` of step sizes may be `unsafe`.
    """

    number: TextNumber
    x: Fraction
    form: NumberForm
    digits: int
    place: Place
    alike: Sequence[KnownValue]
    fits: Mapping[str, int]
    ranked: Mapping[tuple[int, int], int]
    meant: Sequence[KnownValue]
    stated: Sequence[KnownValue]
    wholes: Sequence[KnownValue]
    fact: str | None
    sole: str | None
    bound: bool
    unsafe: bool
    joint: KnownValue | None
    asked_alone: KnownValue | None
    unsaid_runs: bool
    of_no_method: bool
    not_run: bool
    not_signed: set[str]

    @cached_property
    def kinds(self) -> set[str]:
        """The values of the text's problem that the place means, but for their step sizes and times."""
        return {without_sizes(each.question) for each in self.stated}


class LookAlikes(NamedPlaces):
    """The values that the numbers of one text look like."""

    def __init__(self, text: str, asked: Iterable[str] = (), printed: Iterable[tuple[str, Span]] = ()) -> None:
        """Take a text in canonical spelling, and questions, braces allowed, whose values its author says it has.

        Programs have `printed` spans of the text.
        """
        super().__init__(text, asked, printed)
        self._alike: dict[int, list[LookAlike]] = {}
        self.calculated = {one.result: one for one in calculations_in(text)}
        calculations = self.calculated.values()
        self.in_calculation = {at: one.start for one in calculations for at in range(one.start, one.result)}

    def look_alikes(self, number: TextNumber) -> list[LookAlike]:
        """Every value written like the number, best first: asked, not contradicted, more of its names nearby, equal."""
        if number.is_worded:
            fact, form = self._fact_at(number), form_of(number)
            return [LookAlike(fact, form, strong=True)] if fact and number.text in self.fact_spelled(fact, form) else []
        if number.start not in self._alike:
            try:
                x = number.value
            except (ValueError, ZeroDivisionError):
                return []
            self._alike[number.start] = self._look_alikes(number, x)
            done = self.calculated.get(number.start)
            results = printed(done, number) if done else []
            if done and results and "." not in done.question and spelled(number) not in results:
                # Of whole numbers it gives that and nothing else.
                self._alike[number.start] = [replace(one, strong=False) for one in self._alike[number.start]]
            elif done and not any(one.strong for one in self._alike[number.start]) and spelled(number) in results:
                self._alike[number.start].insert(0, LookAlike(done.question, form_of(number), strong=True))
        return self._alike[number.start]

    def _look_alikes(self, number: TextNumber, x: Fraction) -> list[LookAlike]:
        here = self._here(number, x)
        weighed = sorted((self._weighed(known, here) for known in here.alike), key=lambda pair: pair[0])
        alikes = [alike for _, alike in weighed]
        if not here.fact or here.unsafe or (alikes[:1] and alikes[0].strong):
            return alikes
        is_fact = spelled(number) in self.fact_spelled(here.fact, here.form)
        return [LookAlike(here.fact, here.form, strong=True), *alikes] if is_fact else alikes

    def _here(self, number: TextNumber, x: Fraction) -> _Here:
        """What decides between the values that the number looks like."""
        percent = re.compile(PERCENT).match(self._lower, number.end) is not None
        possible = [
            k
            for k in self.values.known
            if not (k.keys and k.keys <= self._not_meant)
            and ((k.answer.unit == "%") == percent or (k.question in self.values.asked and not percent))
        ]
        written = self.values.written_like(number)
        alike, digits = {each.question for each in written}, digits_told(number, self.text)
        place, fact, meant = self._place_of(number), self._fact_at(number), self._meant_at(number)
        before, _ = sentence_around(self._lower, number.start, number.end)
        stated, bound, fits = [each for each in meant if each.stated], is_bound(before), self.names_near(number)
        counted = [each for each in possible if digits < 3 or not each.keys or each.keys & place.methods]
        few = digits < 3 and len(digits_of(number.text)) > (place.settings.get("t") != 0)
        jointly = few and (self.agrees_jointly(number) or self.says_all(number))
        of_author = [each for each in possible if each.rank == 2 and each.question in alike]
        is_setting = place.quantity == "chosen" or _SET.search(before)
        return _Here(
            number,
            x,
            form_of(number, self.text),
            digits,
            place,
            alike=[each for each in possible if each.question in alike],
            fits=fits,
            ranked=Counter((each.rank, fits[each.question]) for each in counted),
            meant=meant,
            stated=stated,
            wholes=[x for x in stated if not (place.unknown or asked_quantity(x.question)[1])],
            fact=fact,
            sole=None if fact and "*" in fact else fact,  # a number of evaluations is also that of a run
            bound=bound,
            unsafe=bool(bound and fact and self._is_unsafe(number, fact, before)),
            joint=self.only_meant(number) if jointly else None,
            asked_alone=of_author[0] if len(of_author) == 1 and not is_setting else None,
            unsaid_runs=self._is_of_unsaid_runs(number),
            of_no_method=any(self._is_exact(x, number) for x in written) or self._is_of_unnamed_method(number),
            not_run=bool(place.methods) and place.methods.isdisjoint(self._methods_run),  # as a splitting with friction
            not_signed=self._of_either_sign(number),
        )

    def _weighed(self, known: KnownValue, here: _Here) -> tuple[tuple[object, ...], LookAlike]:
        """A value that is written like the number, and its place among these; smaller is better."""
        denied, fit, place = self._is_denied(known, here), here.fits[known.question], here.place
        likely = known is here.joint or self._is_likely(known, here)
        named = place.names(known.question, known.keys, self._sizes) if known.keys else fit == known.most
        guessed = (known.chosen is None and not named) or (known.rank < 2 and place.quantity == "chosen")
        strong = likely and not denied and not guessed and not self._is_elsewhere(known, here)
        strong = not here.unsafe and (known.question == here.sole if here.sole else strong)
        unpublished = known.question not in published_values()
        first = -known.rank * (strong or known.rank == 2)
        head = self.tables.column_of(here.number)
        headed = any(name in head for name in known.names)  # order under "order", not the number of stages
        # In two digits an error is like the value itself, whose name it lacks.
        no_error = asked_quantity(known.question)[0] == "error" != place.quantity and bool(place.own)
        order = first, denied, not headed, not strong, no_error, known not in here.meant and unpublished, -fit
        last = known.answer.exact != here.x, unpublished, len(known.question), known.question
        return (*order, *last), LookAlike(known.question, here.form, strong)

    def _is_likely(self, known: KnownValue, here: _Here) -> bool:
        """True if the number hardly looks like this value by chance."""
        asked, fit = known.chosen is not None, here.fits[known.question]
        rivals = sum(many for (rank, own), many in here.ranked.items() if rank >= known.rank and own >= fit)
        rivals = min(rivals, len(here.meant)) if asked and known in here.meant else rivals
        written, telling = len(digits_of(here.number.text)), here.digits
        if known.stated and [known] in (here.stated, here.wholes):
            telling = written
        if known is here.asked_alone and 0 < fit == known.most:  # whatever zeros at its end; its power is told, too
            telling = written + ("e" in spelled(here.number))
        return known.is_meant(here.x, telling, fit, rivals)

    def _is_elsewhere(self, known: KnownValue, here: _Here) -> bool:
        """True for a value of the text's problem, if the place names another one, or another step size for its kind."""
        if not known.stated or known in here.meant:
            return False
        asked, same_kind = here.place.named_of(known.question)["h"], without_sizes(known.question) in here.kinds
        other = same_kind and bool(asked) and here.place.settings.get("h", asked[0]) not in asked
        named = here.place.sure and bool(here.stated)
        kept = self._is_kept_energy(known, here.number)
        return (named or other or kept or here.unsaid_runs) and not self._is_exact(known, here.number)

    def _is_denied(self, known: KnownValue, here: _Here) -> bool:
        """True if what is said where the number stands is said of something else than this value."""
        number, place, question = here.number, here.place, known.question
        return (
            (question != here.sole if here.sole else self._is_contradicted(known, here))
            or place.is_of_others(question)
            or (bool(known.keys) and (here.of_no_method or (known.stated and here.not_run)))
            or (known.chosen is not None and self._is_of_another_cell(question, number))
            or question.lstrip("-") in here.not_signed
            or ("abs(" in question and self.is_signed(number))
            or (here.bound and not here.sole and not question.lstrip("-").startswith(LIMITS_OF_METHODS))
            or (known.stated and question.endswith(" : steps") and not place.counts_steps(question))
            or self._changes_otherwise(known, number)
            # One digit of an unknown of the text's own problem is nothing of the lesson's.
            or (known.of_lesson and len(digits_of(number.text)) < 2 and place.unknown in self._unknowns.values())
            or (known.rank < 2 and (place.is_of_another(question) or self._compares_others(known, number)))
        )

    def _is_contradicted(self, known: KnownValue, here: _Here) -> bool:
        """True if the sentence names another method or time, but for values that are asked of its own methods."""
        number, place, asked = here.number, here.place, known.chosen is not None
        own = place.methods if place.own else self.methods_beside(number) if known.keys > place.methods else ()
        of_own = asked and bool(known.keys) and known.keys <= {*own}
        said = not of_own and contradicted(known.question, self._lower, number.start, number.end, asked)
        return said or (known.stated and place.denies(known.question))

    def fact_spelled(self, fact: str, form: NumberForm) -> list[str]:
        """What a fact is, spelled in this form; [] for none or a tie."""
        with suppress(ValueError):
            return form.spellings(answer) if (answer := usual(fact)) and (answer.is_number or form.spelled) else []
        return []

    def _is_unsafe(self, number: TextNumber, fact: str, before: str) -> bool:
        """True for a bound of step sizes that is rounded to the wrong side of the limit by more than 1 in 20."""
        limits = map(Fraction, self.fact_spelled(fact, NumberForm(digits=6))[:1])
        return any(not is_on_the_safe_side(before, number.value, x) and 20 * abs(number.value - x) > x for x in limits)

    def _fact_at(self, number: TextNumber) -> str | None:
        """The fact, as a question, where a column of facts crosses the row of one method, or as in A(73.4°)-stable."""
        if is_trend(number.text):
            return self._signed_by(number)
        cell, methods = self.tables.cell_of(number), self._place_of(number).methods
        own = methods if self._place_of(number).own else frozenset[str]()
        observed = self._place_of(number).quantity == "observed_order"
        alone = cell and not observed and cell.text.strip("≈~°<≤ ").removeprefix("h ").strip("<≤ ") == number.text
        fact = fact_in_column(cell.head) if cell and alone else None
        equation = next((one for one in reversed(linear_equations(self.text)) if one.at < number.start), None)
        if self._lower[: number.start].endswith("a(") and self._lower.startswith("°)-stab", number.end):
            return fact_of("angle", methods)
        if not cell:
            before, after = self._said_around(number)
            steps = self._place_of(number).steps if SETTING["h"].search(before) else None
            far = self._lower[max(0, number.start - 2 * BESIDE) : number.start]
            said = fact_said(before, after, own, equation, steps, far)
            word = number.text.lower() if number.is_worded and not said else ""
            return fact_in_word(word, before, after, equation) if word else said
        if fact == LIMIT_OF_STEPS:
            return limit_of_steps(methods, equation)
        return fact_of(fact, methods) if fact and len(methods) == 1 else None

    def _said_around(self, number: TextNumber) -> tuple[str, str]:
        """The sentence before and after the number; the method before in place of "it", and the one meant."""
        before, after = sentence_around(self._lower, number.start, number.end)
        subject = re.sub(r"\A\s*(?:in [^,]{1,40}, )?(?:the )?", "", sentence_before(self._lower, number.start))
        name = names_in_order(subject)[0] if begins_with_method(subject) else ""
        before = re.sub(r"\A\s*it (?=has|needs|is)", f"{name} ", before) if name else before
        return with_names_settled(before, self._settled[0]), with_names_settled(after, self._settled[0])

    def _of_either_sign(self, number: TextNumber) -> set[str]:
        """Error constants of methods of one step, if multistep methods are named nearby: their signs are others."""
        near = methods_named(self._lower[max(0, number.start - 2 * BESIDE) : number.end + BESIDE])
        several = {key for key in near if isinstance(FURTHER_METHODS.get(key), Multistep)}
        of_one = near & {*METHODS} if several and not self.tables.row_of(number) else set[str]()
        return {f"error_constant {key}" for key in of_one}

    def _is_exact(self, known: KnownValue, number: TextNumber) -> bool:
        """True if this is the solution, or its energy, at the time of the sentence, and that names no method."""
        place, told = replace(self._place_of(number), methods=frozenset()), len(digits_of(number.text)) > 4
        place = place if place.quantity == "energy" else replace(place, quantity="exact")
        told &= "exact" in (known.question[:5], asked_quantity(known.question)[0]) and not self.tables.row_of(number)
        return told and not self.methods_beside(number) and place.means(known.question, set())

    def _is_kept_energy(self, known: KnownValue, number: TextNumber) -> bool:
        """True for an energy of a run if the number is that of the solution, too, of which every sentence may speak."""
        energy = asked_quantity(known.question)[0] == "energy" and bool(known.keys)
        alike = self.values.written_like(number) if energy else ()
        return any(x.question.startswith("exact ") and x.question.endswith(": energy") for x in alike)

    def _compares_others(self, known: KnownValue, number: TextNumber) -> bool:
        """True if the value compares the errors of another unknown than those right before the number are of."""
        quantity, unknown = asked_quantity(known.question)
        if not known.stated or quantity not in COMPARED:
            return False
        at = bisect_left(self._numbers, number.start, key=lambda x: x.start)
        for before in takewhile(lambda x: number.start - x.start < BESIDE, reversed(self._numbers[:at])):
            first = [] if self._place_of(before).quantity in {"chosen", *COMPARED} else self.look_alikes(before)[:1]
            if any(one.strong and " : error" in one.question for one in first):
                return asked_quantity(first[0].question)[1] != unknown
        return unknown != ""

    def _changes_otherwise(self, known: KnownValue, number: TextNumber) -> bool:
        """True for a change, or its size, that went up where the sentence says that it went down, or down for up."""
        if "_change" not in known.question or asked_quantity(known.question)[0] in COMPARED:
            return False
        said = trend_said(sentence_around(self._lower, number.start, number.end)[0])
        signed = re.sub(r"abs\((.*?)\)(?=, 1\)|\Z)", r"\1", known.question)
        change = next((each.answer.exact for each in self.values.known if each.question == signed), None)
        return bool(said) and change is not None and certified_sign(change) == -said

    @cached_property
    def words(self) -> list[TextNumber]:
        """The words that say facts of methods, such as "four stages", and what becomes of a value, as in "too low"."""
        return [x for x in self._words if not self.tables.row_of(x) and self._fact_at(x)]

    @cached_property
    def _words(self) -> list[TextNumber]:
        return [TextNumber(*word, None) for word in words_said_in(self.text)]

    def _signed_by(self, word: TextNumber) -> str | None:
        """The question whose sign a word such as grows, smaller or low says, by that of the number beside it."""
        before, after = self._said_around(word)
        at = bisect_left(self._numbers, word.start, key=lambda x: x.start)
        behind, ahead = self._numbers[at : at + 1], self._numbers[max(at - 1, 0) : at]
        near = [x for x in behind if gap_to_number("", self._lower[word.end : x.start])]
        ahead += [x for x in self._words if 0 < word.start - x.end < _NEAR_WORD and not is_trend(x.text)]
        near += [x for x in ahead if gap_to_number(self._lower[x.end : word.start], "")]
        if not near:
            return None
        alike = [one.question for one in self.look_alikes(near[0])[:1] if one.strong]
        meant = [x for x in self.values.written_like(near[0]) if x in self._meant_at(near[0])]
        alike = alike or [x.question for x in meant if x.rank == max(one.rank for one in meant)]
        far = re.split(r"[.?!]\s|\n\n", self._lower[max(0, word.start - 2 * BESIDE) : word.start])[-1]
        signs = {signed_by(one, far.removesuffix(before), before, after) for one in alike}
        return signs.pop() if len(signs) == 1 else None


def without_sizes(question: str) -> str:
    """The question without its step size and time."""
    return _SIZE.sub("", question)


def printed(done: Calculation, number: TextNumber) -> list[str]:
    """What a calculation gives, spelled in the form of the number; [] for a tie."""
    with suppress(ValueError):
        return form_of(number).spellings(done.answer)
    return []
