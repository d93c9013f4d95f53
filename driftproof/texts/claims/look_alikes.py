"""The values that a number of a text looks like: published ones, usual ones, and those that its author asks for."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import chain, takewhile
from typing import Any

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Splitting
from driftproof.texts.claims.calculations import Calculation, calculations_in
from driftproof.texts.claims.checking import Span
from driftproof.texts.claims.contradictions import SETTING, contradicted, methods_named, sentence_around
from driftproof.texts.claims.known_values import KnownValue
from driftproof.texts.claims.phrases import NumberForm
from driftproof.texts.claims.places import (
    COMPARED,
    Place,
    asked_quantity,
    asked_settings,
    fact_in_column,
    fact_said,
    is_head_of,
    leaves_quantity,
    place_of,
)
from driftproof.texts.claims.possible_values import PossibleValues
from driftproof.texts.claims.spellings import digits_of, form_of, spelled
from driftproof.texts.claims.stated_problems import speeds_named
from driftproof.texts.claims.stated_questions import stated_questions
from driftproof.texts.claims.tables import tables_of
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.values.published import published_values

# Characters on each side of a number that are searched for the names of a value: about a line.
_NEIGHBOURHOOD = 100
# Characters between two numbers that are said of one run: about two sentences.
BESIDE = 200
# A decimal of a program, and a step size or a time in a question.
_DECIMAL = re.compile(r"(?<![\w.])[0-9]+\.[0-9]+(?![\w.])")
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


class LookAlikes:
    """The values that the numbers of one text look like."""

    def __init__(self, text: str, asked: Iterable[str] = (), printed: Iterable[tuple[str, Span]] = ()) -> None:
        """Take a text in canonical spelling, and questions, braces allowed, whose values its author says it has.

        Programs have `printed` spans of the text.
        """
        self.text, self.tables = text, tables_of(text)
        self.values = PossibleValues(text, stated_questions(text, self.tables.column_of), asked)
        self._printed = [*printed]
        self._meant: dict[int, list[KnownValue]] = {}
        self._places, self._named = dict[int, Place](), dict[int, Place]()
        self._alike: dict[int, list[LookAlike]] = {}
        self.calculated = {one.result: one for one in calculations_in(text)}
        calculations = self.calculated.values()
        self.in_calculation = {at: one.start for one in calculations for at in range(one.start, one.result)}
        self._lower = self.values.lower

    def look_alikes(self, number: TextNumber) -> list[LookAlike]:
        """Every value written like the number, best first: asked, not contradicted, more of its names nearby, equal."""
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
        fits = self._fits(number)
        form, found, digits, ids = form_of(number), [], len(digits_of(number.text, telling=True)), published_values()
        percent = self.text.startswith(("%", " %"), number.end)
        possible = [
            k
            for k in self.values.known
            if (k.answer.unit == "%") == percent or (k.question in self.values.asked and not percent)
        ]
        meant, head = self._meant_at(number), self.tables.column_of(number)
        place = self._place_of(number)
        of_own = place.unknown in self._unknowns.values()
        placed, fact = place.sure and any(known.stated for known in meant), self._fact_at(number)
        kinds = {without_sizes(each.question) for each in meant if each.stated}
        compared, runs = self._compared_at(number)
        here = [each for each in possible if digits < 3 or not each.keys or each.keys & place.methods]
        alike = {each.question for each in self.values.written_like(number)}
        for known in (each for each in possible if each.question in alike):
            fit, asked = fits[known.question], known.chosen is not None
            rivals = sum(fits[other.question] >= fit for other in here if other.rank >= known.rank)
            denied = contradicted(known.question, self._lower, number.start, number.end, asked)
            denied = known.question != fact if fact else denied | (known.stated and place.denies(known.question))
            denied |= place.is_of_others(known.question)
            # One digit of an unknown of the text's own problem is nothing of the lesson's.
            denied |= len(digits_of(number.text)) < 2 and of_own and _of_lesson(known)
            denied |= known.rank < 2 and (place.is_of_another(known.question) or self._compares_others(known, number))
            rivals = min(rivals, len(meant)) if asked and known in meant else rivals
            if known.question == compared:
                rivals, denied = runs, denied or not self._is_in_order(number, compared)
            other = without_sizes(known.question) in kinds and not place.has_step(known.question)
            elsewhere = known.stated and known not in meant and (placed or other)
            only = known.stated and [each for each in meant if each.stated] == [known]
            telling = len(digits_of(number.text)) if only else digits
            strong = not denied and not elsewhere and known.is_meant(x, telling, fit, rivals)
            named = place.names(known.question, known.keys, self._sizes) if known.keys else fit == known.most
            guessed = not (asked or named) or (known.rank < 2 and place.quantity == "chosen")
            strong = known.question == fact if fact else strong and not guessed
            unpublished = known.question not in ids
            first = -known.rank * (strong or known.rank == 2)
            headed = any(name in head for name in known.names)  # order under "order", not the number of stages
            order = first, denied, not headed, not strong, known not in meant and unpublished, -fit
            last = known.answer.exact != x, unpublished, len(known.question), known.question
            found.append(((*order, *last), LookAlike(known.question, form, strong)))
        return [alike for _, alike in sorted(found, key=lambda pair: pair[0])]

    def _fact_at(self, number: TextNumber) -> str | None:
        """The fact, as a question, where a column of facts crosses the row of one method, or as in A(73.4°)-stable."""
        cell, methods = self.tables.cell_of(number), self._place_of(number).methods
        own = methods if self._place_of(number).own else frozenset[str]()
        observed = self._place_of(number).quantity == "observed_order"
        fact = fact_in_column(cell.head) if cell and not observed and cell.text.strip("≈~° ") == number.text else None
        if self._lower[: number.start].endswith("a(") and self._lower.startswith("°)-stab", number.end):
            fact = "angle"
        if not cell and (said := fact_said(*sentence_around(self._lower, number.start, number.end), own)):
            fact, methods = said
        if not fact or len(methods) != 1:
            return None
        (method,) = methods  # the stages of a splitting are counted in several ways
        return None if fact == "stages" and isinstance(METHODS.get(method), Splitting) else f"{fact} {method}"

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

    def _compared_at(self, number: TextNumber) -> tuple[str, int]:
        """The one question that a ratio of errors is like whose two runs are not said, and of how many; "" for none."""
        place = self._place_of(number)
        if place.quantity not in COMPARED or "h" in place.settings or self.tables.row_of(number):
            return "", 0
        known = (each for each in self.values.known if each.stated)
        runs = {each.question for each in known if place.means(each.question, each.keys, any_runs=True)}
        alike = [each.question for each in self.values.written_like(number) if each.question in runs]
        return (alike[0], len(runs)) if len(alike) == 1 else ("", 0)

    def _is_in_order(self, number: TextNumber, question: str) -> bool:
        """True if the step sizes of the ratios of one kind in the sentence go down."""
        h = asked_settings(question)["h"][0]
        for x in self._numbers:
            between = self.text[min(x.end, number.end) : max(x.start, number.start)]
            if x != number and len(between) < BESIDE and not re.search(r"[.?!]\s", between):
                other = self._compared_at(x)[0]
                size = asked_settings(other)["h"][0] if _SIZE.sub("", other) == _SIZE.sub("", question) else h
                if size != h and (size < h) == (x.start < number.start):
                    return False
        return True

    def methods_at(self, number: TextNumber) -> frozenset[str]:
        """The methods that the text names where the number stands."""
        return self._place_of(number).methods

    def counts_of_methods(self, number: TextNumber) -> bool:
        """True if its column has one number for each method, not all the same: found, and not chosen."""
        column = self._company[self.tables.column_place(number)]
        rows = [next((cell.text for cell in self.tables.row_of(x) if cell.text), "") for x in column]
        return len({x.text for x in column}) > 1 and len({*rows}) == len(rows) and bool(methods_named(rows[0]))

    @cached_property
    def _numbers(self) -> list[TextNumber]:
        return [number for number in numbers_in(self.text) if number.label is None]

    @cached_property
    def _company(self) -> dict[tuple[int, int], list[TextNumber]]:
        """The numbers of each column of a table, and those outside tables."""
        found = defaultdict[tuple[int, int], list[TextNumber]](list)
        for number in self._numbers:
            found[self.tables.column_place(number)].append(number)
        return found

    def _fits(self, number: TextNumber) -> dict[str, int]:
        """For each value, how many of its names stand near the number plus how many of its numbers on the same line."""
        near = self._lower[max(0, number.start - _NEIGHBOURHOOD) : number.end + _NEIGHBOURHOOD]
        near += self.tables.column_of(number)
        stand = {name for name in self._all_names if re.search(rf"(?<![a-z]){name}", near)}
        single = set[str]()  # one digit looks like much: not like a readout that only another sentence names
        if len(digits_of(number.text)) < 2 and not self.tables.row_of(number):
            said = " ".join(sentence_around(self._lower, number.start, number.end))
            single = {name for name in stand if not re.search(rf"(?<![a-z]){name}", said)}
        spoken, line = methods_named(near), self._on_line_of(number)
        return {
            known.question: sum(x in stand and not (x in single and _of_lesson(known)) for x in known.names)
            + sum(not line.isdisjoint(x) for x in known.numbers)
            + sum(not spoken.isdisjoint(x) for x in known.methods)
            for known in self.values.known
        }

    def _place_of(self, number: TextNumber) -> Place:
        if number.start not in self._places:
            place, table = self._named_at(number), self.tables.column_place(number)[0]
            if table >= 0 and self.values.stated and leaves_quantity(self.tables.column_of(number), self._unknowns):
                place = replace(place, quantity=self._quantities.get(table, place.quantity))
            if place.quantity in COMPARED and "h" not in place.near:
                place = replace(place, **self._runs_beside(number))
            if "h" not in place.near and ((sizes := self._sizes_of_program(number)) or table in self._steps):
                step = min(sizes) if len(sizes) == 1 else self._steps.get(table)
                kept = {x: given for x, given in place.settings.items() if x != "h"}
                own = {"h": step} if step else {}
                place = replace(place, settings=kept | own, near=place.near | own.keys())
            rows_of_steps = any(is_head_of("h", cell.head) for cell in self.tables.row_of(number))
            if rows_of_steps and place.quantity == "observed_order":
                place = replace(place, of_row=(self._run_of_row(number),))
            self._places[number.start] = place
        return self._places[number.start]

    def _sizes_of_program(self, number: TextNumber) -> set[Fraction]:
        """The step sizes of the text that stand in the program that has printed the number, if any has."""
        programs = [program for program, (start, end) in self._printed if start <= number.start < end]
        given = {Fraction(x) for program in programs for x in _DECIMAL.findall(program)}
        known = (each.question for each in self.values.known if each.stated and given)
        return given.intersection(*[chain.from_iterable(asked_settings(one)["h"] for one in known)])

    def _runs_beside(self, number: TextNumber) -> dict[str, Any]:
        """What says that a ratio is of the two runs whose errors stand beside it, if any of its column is."""
        above = {Fraction(x) for cell in self.tables.row_of(number) for x in SETTING["h"].findall(cell.head)}
        for x in self._company[self.tables.column_place(number)] if len(above) == 2 else ():
            place = self._named_at(x)
            place = replace(place, settings=place.settings | {"h": max(above)}, of_row=(0,))
            if any(place.means(known.question, known.keys) for known in self.values.written_like(x)):
                own = self._named_at(number)
                return {"settings": own.settings | {"h": max(above)}, "near": own.near | {"h"}, "of_row": (0,)}
        return {}

    def _run_of_row(self, number: TextNumber) -> int:
        """Which of two runs has the step size of the row in a table of observed orders: that of most of its values."""
        votes, (table, _) = Counter({1: 1}), self.tables.column_place(number)
        for x in chain(*(numbers for place, numbers in self._company.items() if place[0] == table)):
            place = self._named_at(x)
            for known in self.values.written_like(x) if place.quantity == "observed_order" else ():
                if place.means(known.question, known.keys):
                    sizes = asked_settings(known.question)["h"]
                    votes.update(i for i, size in enumerate(sizes) if size == place.settings["h"])
        return votes.most_common(1)[0][0]

    def _named_at(self, number: TextNumber) -> Place:
        if number.start not in self._named:
            row = self.tables.row_of(number)
            self._named[number.start] = place_of(self._lower, number.start, number.end, row, self._unknowns)
        return self._named[number.start]

    @cached_property
    def _quantities(self) -> dict[int, str]:
        """What a table gives whose heads do not say it, by where it begins."""
        return self._most_of_tables("quantity", lambda x: leaves_quantity(self.tables.column_of(x), self._unknowns))

    @cached_property
    def _steps(self) -> dict[int, Fraction]:
        """The one step size of a table that does not say it, by where it begins."""
        return self._most_of_tables("h", lambda x: "h" not in self._named_at(x).near)

    def _most_of_tables(self, what: str, counts: Callable[[TextNumber], bool]) -> dict[int, Any]:
        """What half of the numbers of a table say, at least 3: the quantity, or the step size of those with one."""
        tables = defaultdict[int, list[TextNumber]](list)
        for (table, _), numbers in self._company.items() if self.values.stated else ():
            tables[table] += [x for x in numbers if table >= 0 and len(digits_of(x.text)) > 2 and counts(x)]
        found = dict[int, Any]()
        for table, numbers in tables.items():
            said = [self._said_by(x, what) for x in numbers]
            if what == "h" and (own := {*map(Fraction, SETTING["h"].findall(self.tables.section_of(table).lower()))}):
                said = [sizes & own for sizes in said]
            tally, of = Counter(chain(*said)), sum(map(bool, said)) if what == "h" else len(numbers)
            most, count = max(tally.items(), key=lambda one: one[1], default=("", 0))
            if count >= max(3, of / 2):
                found[table] = most
        return found

    def _said_by(self, number: TextNumber, what: str) -> set[Any]:
        """The quantities, or the step sizes, of which the number has a value that its row and head name."""
        place, found = self._named_at(number), set[Any]()
        for known in self.values.written_like(number):
            quantity, sizes = asked_quantity(known.question)[0], SETTING["h"].findall(known.question)
            said: Any = quantity if what == "quantity" else next(map(Fraction, sizes), None)
            of = place.settings | {"h": said} if what == "h" else place.settings
            at = replace(place, settings=of, quantity=quantity if what == "quantity" else place.quantity)
            if known.stated and said is not None and at.means(known.question, known.keys):
                found.add(said)
        return found

    @cached_property
    def _sizes(self) -> set[Fraction]:
        """The step sizes that the text gives."""
        return {*map(Fraction, SETTING["h"].findall(self._lower))}

    @cached_property
    def _unknowns(self) -> dict[str, str]:
        """The names of the unknowns in questions, in lower case, by those of a text: v is also dx, if x' = v."""
        asked = " ".join((*self.values.asked, *self.values.stated)).lower()
        names = dict.fromkeys(re.findall(r"(\w+)'=", asked))
        speeds = {f"d{x}": v for x, v in re.findall(r"(\w+)'=(\w+),", asked) if v in names}
        own = {*speeds.values()}
        if len(own) == 1 and own <= {*speeds}:  # of x'' = F(x), also called v, or omega where the text says so
            speeds |= dict.fromkeys(("v", *speeds_named(self._lower, min(own)[1:])), min(own))
        return speeds | {name: name for name in names}

    def _meant_at(self, number: TextNumber) -> list[KnownValue]:
        """The values that the place of the number names."""
        if number.start not in self._meant:
            place = self._place_of(number)
            self._meant[number.start] = [each for each in self.values.known if place.means(each.question, each.keys)]
        return self._meant[number.start]

    @cached_property
    def _all_names(self) -> set[str]:
        return {name for known in self.values.known for name in known.names}

    def _on_line_of(self, number: TextNumber) -> set[Fraction]:
        """The other numbers of the line, and in a table the step size and time that heads and counts of steps give."""
        if not (self.values.asked or self.values.stated):  # then no value has numbers of its own
            return set()
        line = {x for start, x in self._lines[self.text.count("\n", 0, number.start)] if start != number.start}
        return line | ({*self._place_of(number).settings.values()} if self.tables.row_of(number) else set())

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


def without_sizes(question: str) -> str:
    """The question without its step size and time."""
    return _SIZE.sub("", question)


def _of_lesson(known: KnownValue) -> bool:
    """True for what a run of the lesson gives, no fact and of no problem of the text."""
    return known.rank == 0 and (" : " in known.question or "." in known.question.partition(" ")[0])


def printed(done: Calculation, number: TextNumber) -> list[str]:
    """What a calculation gives, spelled in the form of the number; [] for a tie."""
    with suppress(ValueError):
        return form_of(number).spellings(done.answer)
    return []
