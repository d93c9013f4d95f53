"""Suggest what the numbers of a text may be: the values that they look like, or are slips for."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import TypeAlias

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Splitting
from driftproof.texts.claims.phrases import NumberForm, digits_of, digits_told, form_of, slips, spelled
from driftproof.texts.drafts.look_alikes import BESIDE, LookAlike, LookAlikes, printed, without_sizes
from driftproof.texts.drafts.possible_values import SHARE, SIZE, KnownValue
from driftproof.texts.questions.answer import Answer
from driftproof.texts.readers.number_words import is_said_of, is_trend, opposite
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.words.contradictions import asked_quantity, asked_settings, sentence_around
from driftproof.texts.words.heads import LIMIT_OF_STEPS, fact_in_column
from driftproof.texts.words.method_names import methods_asked, methods_named
from driftproof.texts.words.places import COMPARED
from driftproof.texts.words.stated_facts import is_bound, is_on_the_safe_side

# Chosen: a number nearer than this to the value that its place names, relative to it, hardly means another one.
_NEAR = Fraction(1, 100)
_READOUT = re.compile(" : .*")
_METHOD = re.compile(
    "|".join(rf"(?<={what} )\S+" for what in (r"\brun", "^order", "^angle", "^stages", "_limit", "_constant"))
)
_METHOD_AND_START = re.compile(rf"(?:{_METHOD.pattern})(?: started=\S+)?")
# An asked question, its answer, and the numbers that may be slips for it, or equal to it in few digits.
Missed: TypeAlias = tuple[str, Answer, list[TextNumber], list[TextNumber]]


class Suggestions(LookAlikes):
    """The values that the numbers of one text look like or are slips for."""

    def nowhere(self) -> list[Missed]:
        """The asked questions that no number matches strongly, the answers, and numbers that may mean them.

        First come the likely slips, then the numbers that are equal to the value, with few digits.
        """
        asked = [known for known in self.values.known if known.rank == 2 and known.question in self.values.asked]
        missed: dict[str, Missed] = {known.question: (known.question, known.answer, [], []) for known in asked}
        shares = {form.format(question): question for question in missed for form in (SHARE, SIZE)}
        for number in (each for each in numbers_in(self.text) if missed and each.label is None):
            for alike in self.look_alikes(number):
                question = shares.get(alike.question, alike.question)
                if alike.strong:
                    missed.pop(question, None)
                elif question in missed:
                    few = not re.search("[.]0.*[1-9]", number.text) and not digits_of(number.text)[1:]
                    missed[question][3].extend([number] * (not few or missed[question][1].exact == number.value))
            for question in missed.keys() & self.slips(number).keys():
                missed[question][2].append(number)
        return [*missed.values()]

    def slips(self, number: TextNumber) -> dict[str, str]:
        """Question -> how its value is spelled, if a number of three digits or more may be a slip for it.

        An asked value needs five digits, or four and all its names nearby, or its numbers on the line: one number in
        180 is by chance a slip for a given value.
        Of three digits, a number near the one value that its place names is a slip, whatever its digits are.
        """
        if number.is_worded:
            return self._slip_of_word(number)
        alike, digits = self.look_alikes(number), digits_told(number, self.text)
        if (done := self.calculated.get(number.start)) and not any(one.strong for one in alike):
            results = printed(done, number)
            return {done.question: results[0]} if results and digits > 1 else {}
        meant = {known.question for known in self._meant_at(number) if known.rank}
        right = meant | self._asked_at(number)
        wrong = not any(one.strong or one.question in right for one in alike)
        found = self._kept(number, self._slips_of_digits(number, alike, digits, meant)) if wrong else {}
        return {question: slip for question, slip in found.items() if question in meant} or found

    def _slip_of_word(self, word: TextNumber) -> dict[str, str]:
        """The fact that a word gets wrong, with the right word, or the opposite of a trend."""
        own = self.fact_spelled(fact, form_of(word)) if (fact := self._fact_at(word)) else []
        if fact and not own and not is_trend(word.text):  # for every h, and there is a limit
            own = self.fact_spelled(fact, NumberForm(digits=4))
        if not (fact and own) or word.text in own:
            return {}
        alike = (each for each in own if is_said_of(each) == is_said_of(word.text))  # second, beside third, not two
        return {fact: opposite(word.text) or next(alike, own[0])}

    def _asked_at(self, number: TextNumber) -> set[str]:
        """The questions of the author that may have their values here."""
        beside = self.methods_beside(number)
        asked = (x for x in self.values.asked if not beside or not (keys := methods_asked(x)) or keys & beside)
        return {x for x in asked if not self._is_of_another_cell(x, number)}

    def _slips_of_digits(
        self, number: TextNumber, alike: Sequence[LookAlike], digits: int, meant: set[str]
    ) -> dict[str, str]:
        """The values that the number misses by a digit or two, the fact of its place, or the one value meant there."""
        written = self.values.written(form_of(number, self.text))
        shape = re.sub("[0-9]", "0", spelled(number))  # 2.9e-3 beside 8.1e-4, no 29e-4
        ways = sorted(written.items(), key=lambda way: re.sub("[0-9]", "0", way[0]) == shape)
        first = {known.question: spelling for spelling, ones in ways for known in ones}
        right = any(one.question in self._stated_values for one in alike)
        few = len({first[question] for question in meant & first.keys()}) <= 2 * digits - 3
        found, other_sign = dict[str, str](), next(slips(spelled(number)))
        for slip in slips(spelled(number)):
            turned = slip == other_sign
            if len(digits_of(slip)) < 2 or (turned and self._is_factor(number)):  # a modulus
                continue
            for known in written.get(slip, ()):
                if known.chosen is None or not self._may_miss(known, number, slip, digits):
                    continue
                sure = digits > 2 and (turned or digits > 4 or self._is_near(known, number, digits))
                sure = (sure and not known.stated) or (digits > 5 and not right)
                counted = known.question.endswith("evaluations")
                if sure or (known.question in meant and (digits > 3 or (few and not counted))):
                    found[known.question] = slip
        return self._slip_of_fact(number, alike, digits, first, found)

    def _may_miss(self, known: KnownValue, number: TextNumber, slip: str, digits: int) -> bool:
        """True unless the place of the number rules out that it is this value, misspelled."""
        beside, here = self.methods_beside(number), self._place_of(number)
        if known.keys and (known.keys <= self._not_meant or (beside and known.keys.isdisjoint(beside))):
            return False
        if here.denies(known.question) or (digits < 3 and not here.sure):
            return False
        if known.rank == 2 and self._is_of_another_cell(known.question, number):
            return False
        if known.rank < 2 and here.is_of_another(known.question):
            return False
        if "error" in known.question.rpartition(":")[2] and spelled(number) == f"-{slip}":  # a difference has a sign
            return False
        if known.stated and (here.is_of_others(known.question) or self._is_kept_energy(known, number) > here.own):
            return False
        # The force at the start, which a code may need once more, is no slip.
        one_more = known.question.endswith("evaluations") and number.value - Fraction(slip) == 1
        return not (one_more and any(isinstance(METHODS.get(key), Splitting) for key in known.keys))

    def _slip_of_fact(
        self,
        number: TextNumber,
        alike: Sequence[LookAlike],
        digits: int,
        spellings: Mapping[str, str],
        found: dict[str, str],
    ) -> dict[str, str]:
        """What was found, with the fact of its place if that is another, or else the one value that is meant there."""
        fact, row = self._fact_at(number), self.tables.row_of(number)
        own = self.fact_spelled(fact, form_of(number)) if fact else []
        if fact and not row:
            wrong = bool(own) and spelled(number) not in own and not self._is_safe(number, fact, Fraction(own[0]))
            return found | ({fact: own[0]} if wrong else {})
        if fact and (of_row := spellings.get(fact) or next(iter(own), "")):
            if self._is_safe(number, fact, Fraction(of_row)):
                return found
            of_others = fact.partition(" ")[0] in {one.question.partition(" ")[0] for one in alike} and digits > 1
            of_others &= of_row.lstrip("-") != spelled(number).lstrip("-")  # not the other convention
            return found | ({fact: of_row} if of_others else self._misfit(number, {fact: of_row}))
        in_cell = bool(row) and "." in number.text  # there 0.4300 has four digits
        return found or self._misplaced(number, spellings, max(digits, in_cell * len(digits_of(number.text))))

    def _kept(self, number: TextNumber, found: dict[str, str]) -> dict[str, str]:
        """Slips that neither the column, the row or the list of the number, nor few digits of a ratio make right."""
        if found and self._column_kinds(number) - {*map(without_sizes, found)}:
            return {}
        if self._is_of_row(number, found) or self._is_of_list(number, found):
            return {}
        in_text = not (self.tables.row_of(number) or self.says_error(number))
        if in_text and self._place_of(number).quantity == "percent":
            found = {x: y for x, y in found.items() if x in self.values.asked}  # of an amplitude, say
        least = Fraction(2, 10 ** (number.places or 0))  # of ratios of errors that are printed in few digits
        near = {x for x, y in found.items() if abs(number.value - Fraction(y)) <= least}
        return {x: y for x, y in found.items() if x not in near or asked_quantity(x)[0] not in COMPARED}

    def _is_factor(self, number: TextNumber) -> bool:
        """True for a number of a product, a quotient or a modulus that stands in no table."""
        before, after = self.text[: number.start].rstrip(" ")[-1:], self.text[number.end :].lstrip(" ")[:1]
        return not self.tables.row_of(number) and bool({before, after} & {*"*·×/|"})

    def has_slip_before(self, number: TextNumber) -> bool:
        """True for the result of a calculation with a number that is perhaps a slip."""
        done = self.calculated.get(number.start)
        return done is not None and any(self.slips(x) for x in self._numbers if done.start <= x.start < number.start)

    def _is_of_row(self, number: TextNumber, found: Iterable[str]) -> bool:
        """True if the number is such a value at the step size or time that stands in its row, under whatever head."""
        row = {Fraction(x.text) for x in self.tables.row_of(number) if re.fullmatch(r"[0-9]+(?:\.[0-9]+)?", x.text)}
        for one, other in product(found, self.look_alikes(number) if row else ()):
            if without_sizes(one) == without_sizes(other.question):
                said, own = asked_settings(one), asked_settings(other.question)
                if all(said[x] == own[x] or (row >= {*own[x]} and not row >= {*said[x]}) for x in said):
                    return True
        return False

    def _is_of_list(self, number: TextNumber, found: Iterable[str]) -> bool:
        """True for a ratio or an order, in a sentence that names no method, that such a value of another method is."""
        if self._place_of(number).quantity not in COMPARED or self.tables.row_of(number) or self.methods_beside(number):
            return False
        kinds = {_METHOD_AND_START.sub("", without_sizes(one)) for one in found}
        alike = (one.question for one in self.look_alikes(number) if asked_quantity(one.question)[0] in COMPARED)
        return any(_METHOD_AND_START.sub("", without_sizes(one)) in kinds for one in alike)

    def _is_safe(self, number: TextNumber, fact: str, limit: Fraction) -> bool:
        """True for a bound of step sizes that is right and no limit: cut off, of two digits, or 1 in 20 away.

        In a column of limits it is cut off or of two digits.
        """
        x, last = number.value, Fraction(1, 10 ** (number.places or 0))
        before, _ = sentence_around(self._lower, number.start, number.end)
        short = len(digits_of(number.text)) < 3 or abs(x - limit) <= last
        if not is_bound(before) and 0 <= limit - x <= last:
            return "_limit" in fact
        if self.tables.row_of(number):
            return short and x <= limit and fact_in_column(self.tables.column_of(number)) == LIMIT_OF_STEPS
        return is_bound(before) and is_on_the_safe_side(before, x, limit) and (short or 20 * abs(x - limit) > limit)

    def _column_kinds(self, number: TextNumber) -> set[str]:
        """The values of a problem, but for step sizes and times, that all of the number's column look like.

        None if a method heads it, or for one number of more than three digits.
        """
        if not self.tables.row_of(number) or methods_named(self.tables.column_of(number)):
            return set()
        column = [
            x for x in self._company[self.tables.column_place(number)] if len(digits_of(x.text, telling=True)) > 3
        ]
        kinds = [{without_sizes(x.question) for x in self.look_alikes(one)} for one in column]
        return set.intersection(*kinds) if number in column and kinds[1:] else set()

    def _misplaced(self, number: TextNumber, spellings: Mapping[str, str], digits: int) -> dict[str, str]:
        """The one value that the place names, if the number is near to it, or has another h or t, or unknown there.

        Numbers of less than three digits are none, but for those of two in a table whose others are what is meant.
        """
        if digits < 3 and not (digits == 2 and self.agrees_jointly(number)):
            return {}
        stated = [known.question for known in self._meant_at(number) if known.rank]
        named = {x: spellings[x] for x in stated if x in spellings and not x.endswith("evaluations")}
        if digits < 3:  # a last digit that is cut off is no slip
            named = {x: y for x, y in named.items() if abs(number.value - Fraction(y)) > abs(Fraction(y)) / 10}
            found = self._misfit(number, named)
        elif other := self._moved(number, named) or self._exchanged(number, named):
            return other
        else:
            found = self._of_same_run(number, named, digits) or self._of_other_method(number, named, digits)
            if not found and (self.tables.row_of(number) or (digits > 3 and not self.look_alikes(number))):
                found = self._misfit(number, named)
        return found if len({*found.values()}) == 1 else {}

    def _of_same_run(self, number: TextNumber, named: Mapping[str, str], digits: int) -> dict[str, str]:
        """The values that the place names and the number is near to, if it is sure; or of a run that the number is of.

        That has the number at another step size or time, or for another unknown or slope.
        """
        place, row = self._place_of(number), self.tables.row_of(number)
        runs = {run for one in self.look_alikes(number) if (run := without_sizes(one.question)) != one.question}
        near = {x: y for x, y in named.items() if 0 < abs(number.value - Fraction(y)) <= _NEAR * abs(Fraction(y))}
        if place.sure and near:  # what another method gives may stand far from its name
            of_others = digits > 4 and bool(runs) and not (row or place.of_solution)
            return {x: y for x, y in near.items() if not of_others or without_sizes(x) in runs}
        alone = not row and (place.own or self.methods_beside(number) == {*place.methods})
        if digits <= 3 - (alone and bool(place.quantity) and "h" in place.near):
            return {}
        part = " : " if place.unknown or re.fullmatch("k[0-9]", place.quantity or "") else "\n"
        others = {x for run in runs for x in (run, run.rpartition(part)[0])} - {""}
        of = {x: without_sizes(x) for x in named if place.sure or " h=" in x}
        return {x: named[x] for x, run in of.items() if {run, run.rpartition(part)[0] * place.sure} & others}

    def _of_other_method(self, number: TextNumber, named: Mapping[str, str], digits: int) -> dict[str, str]:
        """The values that the place surely names of a method, if the number is that of another one."""
        in_row = self.tables.row_of(number) and digits > 3 and self.methods_beside(number)
        if not (self._place_of(number).own or in_row):
            return {}
        others = {_METHOD.sub("", one.question) for one in self.look_alikes(number)}
        return {x: y for x, y in named.items() if _METHOD.sub("", x) in others}

    def _across(self, number: TextNumber) -> list[TextNumber]:
        """The other numbers of its row that the text does not choose."""
        row = self.tables.row_of(number)
        found = [x for x in self._numbers if row and row[0].start <= x.start < row[-1].end and x != number]
        return [x for x in found if self._place_of(x).quantity != "chosen"]

    def _exchanged(self, number: TextNumber, named: Mapping[str, str]) -> dict[str, str]:
        """The value that the place names, if a number of its row has it, and this number the value named there."""
        alike = {one.question for one in self.look_alikes(number)}
        for other in self._across(number):
            if any(known.stated and known.question in alike for known in self._meant_at(other)):
                theirs = {one.question for one in self.look_alikes(other)}
                return {x: y for x, y in named.items() if x in theirs}
        return {}

    def _moved(self, number: TextNumber, named: Mapping[str, str]) -> dict[str, str]:
        """The values that the place names, at most two, of these digits with the point or the power elsewhere."""
        form, found = NumberForm(digits=len(digits_of(number.text))), dict[str, str]()
        shape = re.sub("[0-9]", "0", spelled(number))
        for known in (each for each in self._meant_at(number) if each.question in named):
            with suppress(ValueError):
                own = min(form.spellings(known.answer), key=lambda one: re.sub("[0-9]", "0", one) != shape)
                if digits_of(own) == digits_of(number.text) and (own[0] == "-") == (number.value < 0):
                    found[known.question] = own
        return found if len(found) < 3 else {}

    def _misfit(self, number: TextNumber, named: Mapping[str, str]) -> dict[str, str]:
        """The values that the place names, if they are of the kind of those beside the number.

        Those are half of its column, at least two, of the same method or another, or one of it and half of its row and
        column; or outside tables the nearest one written alike, of the same run or, with a value not twice or half of
        it, of another method.
        """
        column, exact = bool(self.tables.row_of(number)), self._place_of(number).quantity == "exact"
        beside = sorted(self._company[self.tables.column_place(number)], key=lambda x: abs(x.start - number.start))[1:]
        if not column:
            alike = [x for x in beside if abs(x.start - number.start) < BESIDE and form_of(x) == form_of(number)]
            beside = [x for x in alike if any(one.strong for one in self.look_alikes(x))][:1]
        held = self._held(beside)
        for other in ("", _METHOD_AND_START) if column else (_READOUT, _METHOD_AND_START):
            kind = {x: re.sub(other, "", without_sizes(x) if column else x) for x in (*held, *named)}
            kinds, least = Counter(kind[x] for x in held), max(2, len(beside) // 2) if column else 1
            found = {x: y for x, y in named.items() if kinds[kind[x]] >= least}
            found = {x: y for x, y in found.items() if exact or not x.startswith("exact ")}
            if other is _METHOD_AND_START and not column:
                found = {x: y for x, y in found.items() if Fraction(y) and 1 < 2 * number.value / Fraction(y) < 4}
            if found:
                return found
        row = self.tables.row_of(number)
        across = self._across(number)
        kinds = Counter(_METHOD_AND_START.sub("", without_sizes(x)) for x in (*held, *self._held(across)))
        own, fewest = {without_sizes(x) for x in held}, max(3, (len(beside) + len(across)) / 2)
        sure = {x: without_sizes(x) for x in named if row and without_sizes(x) in own}
        return {x: named[x] for x, run in sure.items() if kinds[_METHOD_AND_START.sub("", run)] >= fewest}

    def _held(self, numbers: Iterable[TextNumber]) -> list[str]:
        """The questions of those of the numbers that are claims."""
        return [ones[0].question for x in numbers if (ones := self.look_alikes(x)) and ones[0].strong]

    def _is_near(self, known: KnownValue, number: TextNumber, digits: int) -> bool:
        """True if all the numbers of an asked value stand on the line or, if there are none, its names nearby."""
        if known.numbers:
            return not any(map(self._on_line_of(number).isdisjoint, known.numbers))
        return digits > 3 and 0 < known.most == self.names_near(number)[known.question]

    @cached_property
    def _stated_values(self) -> set[str]:
        """The questions of all values that are about stated problems."""
        return {known.question for known in self.values.known if known.stated}
