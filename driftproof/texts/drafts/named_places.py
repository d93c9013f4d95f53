"""What the places of the numbers of one text name, with what their tables and programs say of all of them."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import chain, product
from typing import Any

from driftproof.texts.claims.checking import Span
from driftproof.texts.claims.phrases import digits_of
from driftproof.texts.drafts.possible_values import COUNT_OF_STEPS, KnownValue, PossibleValues
from driftproof.texts.drafts.stated_questions import stated_questions
from driftproof.texts.readers.number_words import PERCENT
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.words.contradictions import SETTING, asked_quantity, asked_settings, sentence_around
from driftproof.texts.words.heads import is_head_of, leaves_quantity
from driftproof.texts.words.method_names import is_one_name, methods_asked, methods_in_full, methods_named
from driftproof.texts.words.places import COMPARED, ENERGY_OF_ALL, Place, place_of
from driftproof.texts.words.stated_problems import energies_named, speeds_named
from driftproof.texts.words.tables import tables_of

# Characters on each side of a number that are searched for the names of a value: about a line.
_NEIGHBOURHOOD = 100
# Chosen: so many numbers of a table, all wrong, are no slips of theirs.
_FEWEST_OFF = 4
# A decimal of a program.
_DECIMAL = re.compile(r"(?<![\w.])[0-9]+\.[0-9]+(?![\w.])")


# What says that a percentage is an error.
_ERROR = re.compile(r"\b(?:errors?|off|wrong|deviat\w+|differ\w+|inaccura\w+)\b")
_OFF = re.compile(rf"{PERCENT} (?:too|off|error|wrong|of error)\b")


class NamedPlaces:
    """The values that the numbers of one text may be, and what is named where they stand."""

    def __init__(self, text: str, asked: Iterable[str] = (), printed: Iterable[tuple[str, Span]] = ()) -> None:
        """Take a text in canonical spelling, and questions, braces allowed, whose values its author says it has.

        Programs have `printed` spans of the text.
        """
        self.text, self.tables = text, tables_of(text)
        self.values = PossibleValues(text, stated_questions(text, self.tables.column_of), asked)
        self._printed = [*printed]
        self._meant: dict[int, list[KnownValue]] = {}
        self._places, self._named = dict[int, Place](), dict[int, Place]()
        self._lower = self.values.lower

    def methods_at(self, number: TextNumber) -> frozenset[str]:
        """The methods that the text names where the number stands."""
        return self._place_of(number).methods

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

    def _place_of(self, number: TextNumber) -> Place:
        place, (meanings, undecided) = self._unsettled(number), self._settled
        methods = frozenset[str]() if number.start in undecided else meanings.get(place.methods, place.methods)
        return replace(place, methods=methods)

    @cached_property
    def _settled(self) -> tuple[dict[frozenset[str], frozenset[str]], set[int]]:
        """The one method that has the numbers beside a name such as midpoint, by all that the name may mean.

        It has at least three times as many of the numbers as only others have, whose numbers are undecided; if none has
        so many, no method is meant.
        """
        has = defaultdict[frozenset[str], dict[str, set[int]]](lambda: defaultdict(set))
        for number in self._numbers if self.values.stated else ():
            place = self._unsettled(number)
            if len(place.methods) > 1 and len(digits_of(number.text)) > 2 and is_one_name(place.methods):
                for known in (x for x in self.values.written_like(number) if x.stated and x.keys):
                    if known.keys < place.methods and place.means(known.question, known.keys):
                        has[place.methods][min(known.keys)].add(number.start)
        meanings, undecided = dict[frozenset[str], frozenset[str]](), set[int]()
        for of, numbers in has.items():
            key, own = max(numbers.items(), key=lambda one: len(one[1]))
            rest = set[int]().union(*numbers.values()) - own
            if [*numbers.values()].count(own) == 1:
                meanings[of] = frozenset({key} if len(own) >= 3 * len(rest) else ())
                undecided |= rest
        return meanings, undecided

    @cached_property
    def _not_meant(self) -> set[str]:
        """The methods that names of the text may mean, but do not."""
        others = {key for of, meant in self._settled[0].items() for key in of - meant}
        return others - methods_in_full(self._lower) if others else others

    def _unsettled(self, number: TextNumber) -> Place:
        """The place of the number, with all the methods that a name there may mean."""
        if number.start not in self._places:
            place, table = self._named_at(number), self.tables.column_place(number)[0]
            if table in self._methods and not self._names_method(number):
                place = replace(place, methods=frozenset(self._methods[table]))
            if table >= 0 and self.values.stated and leaves_quantity(self.tables.column_of(number), self._unknowns):
                place = replace(place, quantity=self._quantities.get(table, place.quantity))
            if "h" not in place.near and ((sizes := self._sizes_of_program(number)) or table in self._steps):
                step = min(sizes) if len(sizes) == 1 else self._steps.get(table)
                place = replace(place, settings=place.with_step(step), near=place.near | ({"h"} if step else set()))
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
    def _methods(self) -> dict[int, frozenset[str]]:
        """The method of a table that does not name it, by where it begins: the text may name others in between."""
        return self._most_of_tables("method", lambda x: not self._names_method(x))

    def _names_method(self, number: TextNumber) -> bool:
        """True if a head or a cell of the number's row names a method, or says in words what the row is of."""
        row = self.tables.row_of(number)
        label = next((cell.text for cell in row if cell.text), "")
        return (
            any(methods_named(f"{cell.head} | {cell.text}") for cell in row)
            or re.search(r"[^\W\d]{2}", label) is not None
        )

    @cached_property
    def _steps(self) -> dict[int, Fraction]:
        """The one step size of a table that does not say it, by where it begins."""
        return self._most_of_tables("h", lambda x: "h" not in self._named_at(x).near)

    def agrees_jointly(self, number: TextNumber) -> bool:
        """True for a number of two digits or more in a table, and a column, half of whose numbers are what is meant.

        One of two digits is another one by chance as often as a number begins with 10, 1 time in 24, and one of the two
        that a name such as midpoint means 1 time in 12. That half of n are, and at least 3, is so once in 600 tables of
        six numbers, once in 100 if all have such a name, and less often in others.
        """
        place = self.tables.column_place(number)
        return place[0] >= 0 and all(self._agree_jointly.get(x, False) for x in (place, (place[0], -1)))

    @cached_property
    def _agree_jointly(self) -> dict[tuple[int, int], bool]:
        """For each column of a table, and each table as column -1, whether half of it and 2 or 3 numbers agree."""
        tally = defaultdict[tuple[int, int], list[bool]](list)
        for (table, column), numbers in self._company.items() if self.values.stated else ():
            for x in numbers if table >= 0 else ():
                meant = [known for known in self._meant_at(x) if known.stated]
                if 0 < len(meant) < 3 and len(digits_of(x.text)) > 1:
                    agrees = self.only_meant(x) is not None
                    tally[table, column].append(agrees)
                    tally[table, -1].append(agrees)
        return {x: sum(of) >= max(2 + (x[1] < 0), len(of) / 2) for x, of in tally.items()}

    def tables_off(self) -> Iterator[tuple[list[TextNumber], KnownValue]]:
        """The numbers of each table none of which, of four or more, is what its place means, and what the first is not.

        Numbers of three digits are so by chance once in 900 each: such a table is of another problem than the one read.
        """
        tables = defaultdict[int, list[tuple[TextNumber, list[KnownValue]]]](list)
        for (table, _), numbers in self._company.items() if self.values.stated else ():
            told = [x for x in numbers if table >= 0 and len(digits_of(x.text)) > 2]
            meant = [[known for known in self._meant_at(x) if known.stated] for x in told]
            tables[table] += [pair for pair in zip(told, meant, strict=True) if pair[1]]
        for of in tables.values():
            alike = [(self.values.written_like(x), meant) for x, meant in of]
            right = any(known in found for found, meant in alike for known in meant)
            others = sum(bool(found) for found, _ in alike)  # of which half are something else, such as orders
            if len(of) >= _FEWEST_OFF and not right and 2 * others < len(of):
                yield [x for x, _ in of], of[0][1][0]

    def says_all(self, number: TextNumber) -> bool:
        """True if its sentence says all of what a number is: of the start, or with method, step size and quantity.

        A percentage is an error, or of the energy, at a time that is given.
        """
        place, near = self._place_of(number), self._place_of(number).near
        if place.quantity == "part_of_energy":
            return place.sure or "t" in near
        if place.quantity == "percent":
            return place.sure and "t" in near and self.says_error(number)
        if place.compared:
            return near >= {"h"} and "t" in place.settings
        at_start = "t" in near and not place.settings["t"] and place.quantity == "energy"
        whole = place.own and near >= {"h"} and "t" in place.settings and place.quantity in ("energy", "error", "steps")
        return not self.tables.row_of(number) and (at_start or whole)

    def _is_of_unsaid_runs(self, number: TextNumber) -> bool:
        """True for one of several ratios of a sentence, if the step sizes that they compare are not said."""
        place = self._place_of(number)
        if place.quantity not in COMPARED or "h" in place.settings or self.tables.row_of(number):
            return False
        before, after = sentence_around(self._lower, number.start, number.end)
        first, last = number.start - len(before), number.end + len(after)
        others = [x for x in self._numbers if first <= x.start < last and x != number and "." in x.text]
        return any(self._place_of(x).quantity in COMPARED for x in others)

    @cached_property
    def _methods_run(self) -> set[str]:
        """The methods that have values on the problems of the text."""
        return set().union(*(known.keys for known in self.values.known if known.stated))

    def _is_of_unnamed_method(self, number: TextNumber) -> bool:
        """True in a row whose label is no name of a method, if those of other rows of its column are."""
        if self._place_of(number).methods or not (self.tables.row_of(number) and self._names_method(number)):
            return False
        return any(self._place_of(x).methods for x in self._company[self.tables.column_place(number)])

    def methods_beside(self, number: TextNumber) -> set[str]:
        """The methods that the row and the head of the number, or its sentence, name."""
        row = self.tables.row_of(number)
        said = [self.tables.column_of(number), *(cell.text for cell in row)] if row else []
        return methods_named(" | ".join(said or sentence_around(self._lower, number.start, number.end)))

    def _is_of_another_cell(self, question: str, number: TextNumber) -> bool:
        """True if the number's row and column give another method, step size, time or number of steps than asked."""
        if not (row := self.tables.row_of(number)):
            return False
        beside, place = self.methods_beside(number), self._place_of(number)
        if beside and (keys := methods_asked(question)) and keys.isdisjoint(beside):
            return True
        if question.startswith("exact ") and methods_named(self.tables.column_of(number)) and place.settings.get("t"):
            return place.quantity != "exact"
        of_row = asked_quantity(question)[0] in COMPARED
        asked = {**(place.named_of(question) if of_row else asked_settings(question))}
        counts = [Fraction(n) for n in COUNT_OF_STEPS.findall(question)]
        counts = counts or [t / h for h, t in product(asked["h"], asked["t"])]
        asked["t"] = asked["t"] or [n * h for h, n in product(asked["h"], counts)]
        if any(asked[x] and place.settings[x] not in asked[x] for x in place.near & asked.keys()):
            return True
        said = [int(cell.text) for cell in row if is_head_of("n", cell.head) and re.fullmatch("[1-9][0-9]*", cell.text)]
        return bool(counts and said) and said[-1] not in counts

    def is_signed(self, number: TextNumber) -> bool:
        """True if a number of its column has a sign."""
        column = self.tables.column_place(number)
        return column[0] >= 0 and any(x.text[0] == "-" for x in self._company[column])

    def says_error(self, number: TextNumber) -> bool:
        """True if the sentence says that a percentage is an error."""
        before, after = sentence_around(self._lower, number.start, number.end)
        return _ERROR.search(before) is not None or _OFF.match(after) is not None

    def only_meant(self, number: TextNumber) -> KnownValue | None:
        """The one value of a stated problem that the number's place names and that is spelled like it."""
        alike = {known.question for known in self.values.written_like(number)}
        found = [known for known in self._meant_at(number) if known.stated and known.question in alike]
        found = [known for known in found if "abs(" not in known.question] or found  # of a positive one both
        return found[0] if len(found) == 1 else None

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
            said: Any = {"quantity": quantity, "method": frozenset(known.keys)}.get(
                what, next(map(Fraction, sizes), None)
            )
            of = place.with_step(said) if what == "h" else place.settings
            at = replace(place, settings=of, quantity=quantity if what == "quantity" else place.quantity)
            at = replace(at, methods=said) if what == "method" and said else at
            if known.stated and said and at.means(known.question, known.keys):
                found.add(said)
        return found

    @cached_property
    def _sizes(self) -> set[Fraction]:
        """The step sizes that the text gives."""
        return {*map(Fraction, SETTING["h"].findall(self._lower))}

    @cached_property
    def _unknowns(self) -> dict[str, str]:
        """The names of the unknowns in questions, in lower case, by those of a text: v is also dx, if x' = v.

        The name of an energy is `ENERGY_OF_ALL`.
        """
        asked = " ".join((*self.values.asked, *self.values.stated)).lower()
        names = dict.fromkeys(re.findall(r"(\w+)'=", asked))
        speeds = {f"d{x}": v for x, v in re.findall(r"(\w+)'=(\w+),", asked) if v in names}
        own = {*speeds.values()}
        if len(own) == 1 and own <= {*speeds}:  # of x'' = F(x)
            speeds |= dict.fromkeys(speeds_named(self._lower, min(own)[1:]), min(own))
        given = any("energy=" in one for one in (*self.values.asked, *self.values.stated))
        energies = dict.fromkeys(energies_named(self.text, names), ENERGY_OF_ALL) if given else {}
        return speeds | energies | {name: name for name in names}

    def _meant_at(self, number: TextNumber) -> list[KnownValue]:
        """The values that the place of the number names."""
        if number.start not in self._meant:
            place = self._place_of(number)
            meant = [each for each in self.values.known if place.means(each.question, each.keys)]
            either = "abs(" if self.is_signed(number) else "\n"  # beside -0.3, 0.2 is no change in either direction
            self._meant[number.start] = [each for each in meant if either not in each.question]
        return self._meant[number.start]

    def names_near(self, number: TextNumber) -> dict[str, int]:
        """For each value, how many of its names stand near the number plus how many of its numbers on the same line."""
        near = self._lower[max(0, number.start - _NEIGHBOURHOOD) : number.end + _NEIGHBOURHOOD]
        near += f" | {self.tables.column_of(number)}"
        stand = {name for name, said in self._all_names.items() if said.search(near)}
        single = set[str]()  # one digit looks like much: not like a readout that only another sentence names
        if len(digits_of(number.text)) < 2 and not self.tables.row_of(number):
            said = " ".join(sentence_around(self._lower, number.start, number.end))
            single = {name for name in stand if not self._all_names[name].search(said)}
        spoken, line = methods_named(near), self._on_line_of(number)
        return {
            known.question: sum(x in stand and not (x in single and known.of_lesson) for x in known.names)
            + sum(not line.isdisjoint(x) for x in known.numbers)
            + sum(not spoken.isdisjoint(x) for x in known.methods)
            for known in self.values.known
        }

    @cached_property
    def _all_names(self) -> dict[str, re.Pattern[str]]:
        return {name: re.compile(rf"(?<![a-z]){name}") for known in self.values.known for name in known.names}

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
