"""What the place of a number says about it: the method, step size, time and quantity that its row or sentence names."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from driftproof.texts.questions.pieces import with_greek_spelled
from driftproof.texts.readers.number_words import (
    PERCENT,
    UNIT_BEHIND,
)
from driftproof.texts.words.contradictions import (
    ENERGY,
    LARGEST,
    LISTED_NUMBER,
    SETTING,
    asked_quantity,
    asked_settings,
    methods_compared,
    methods_said_of,
    rest_of_list,
    runs_asked,
    sentence_around,
    sentence_before,
)
from driftproof.texts.words.heads import (
    HEAD_OF_UNKNOWN,
    ORDER_OF_COLUMN,
    PAIR,
    QUANTITY,
    QUANTITY_WORDS,
    SETTING_HEADS,
    is_head_of,
    leaves_quantity,
    without_methods,
)
from driftproof.texts.words.method_names import (
    begins_with_method,
    last_methods_named,
    methods_asked,
    methods_named,
    names_in_order,
)
from driftproof.texts.words.settings_named import BESIDE_NUMBER, FARTHEST, settings_named
from driftproof.texts.words.tables import Cell

# The solution as the subject of a number, and a pronoun for the subject of the sentence before.
_SOLUTION_IS = re.compile(
    rf"\b(?:{QUANTITY_WORDS['exact']})(?: (?:value|solution|answer|there|then|at|for|when|t ?= ?[0-9./]+|\w+ ?=))*"
    r" (?:is|reads|=|≈)(?: \w+ ?[=≈])? ?\Z"
)
_IT_IS = re.compile(r"\b(?:it|this) (?:is|was|equals|reads|has|reaches)\b[^,;]{0,20}\Z")
# A quantity whose own value is given, so that what follows is another one.
_WITH_VALUE = re.compile(rf"(?:{QUANTITY.pattern})(?:(?: \w+){{0,2}} is| ?[=≈]) ?[-+]?[0-9]")
_AFTER = re.compile(
    rf"(?P<percent>{PERCENT})| ?(?:times (?:as|less|more|smaller|larger|that of)|"
    r"(?P<count>evaluations|calls|(?:time )?steps))"
)
# An unknown with its sign right before a number, as in x = 0.5, or its value at a time, as in y(1) ≈ 0.5.
_NAME = r"(?<![\w/*^])(?<![-+*/] )(?P<name>[^\W\d_][a-z]*'?)(?:\([0-9][0-9./]*\)|_?(?P<n>[0-9]))? ?[=≈] ?"
_UNKNOWN = re.compile(rf"{_NAME}\Z")
# The same before a calculation, as in y_1 = 1 + 0.5 = 1.5.
_WORKED_OUT = re.compile(rf"{_NAME}(?:(?![A-Za-z]{{2}})[^=≈,;:\n]){{1,60}}[=≈] ?\Z")
# The head of the solution's column beside those of methods.
_SOLUTION = re.compile(r"[^\W\d_]'?\(t(?:_\{?[nijk]\}?)?\)")
_OF_UNKNOWN = re.compile(r"errors? (?:of|in|for) (?P<name>[^\W\d_]'?)(?:_(?P<n>[1-9]))?(?![\w'])")
# Quantities that compare the errors of two runs; and those whose words leave no other meaning to a number.
COMPARED = {"ratio", "observed_order"}
_CERTAIN = {"stability", "order", "observed_order", *(name for name in QUANTITY_WORDS if name.startswith(LARGEST))}
# Words of a change, which is one of the energy if that is spoken of.
_CHANGES = (
    "grow[ns]?|gr[eo]wing|grew|gain(?:s|ed)|los(?:es|t|e)|increase[sd]?|decrease[sd]?|chang\\w+|rises?|rose|risen|"
    "drift\\w*|f[ae]ll(?:s|en)?|drop(?:s|ped)?|shr[aiu]nk\\w*"
)
_CHANGED = re.compile(rf"(?<![\w.])([a-z]) (?:(?:has|is|still|only) )*(?:{_CHANGES})\b")
# The change of each step, which is that of the first one where all are alike.
OF_EACH_STEP = re.compile(rf"{PERCENT}[^.;:,]{{0,30}} (?:per|in each|in every|each|every) (?:\w+ )?step\b")
# What may be the ratio of two errors is before it.
_TIMES = re.compile(r"[-_\s]+times\b")
# A ratio of errors follows, but for other words, or has been said.
_DIVIDES = re.compile(r"\bdivide[sd]?\b.*\sby\s(?:[-+]?[0-9.]+)?\Z", re.DOTALL)
# A list of orders follows.
_ORDERS = re.compile(r"\borders (?:\w+ ){0,3}\Z")
# Beside a column of energies, the head of that of their changes.
_RELATIVE = re.compile(r"relative (?:change|drift|gain|loss)|(?:change|drift|gain|loss)(?:,? ?[(\[]?%[)\]]?)?")
_SAME_STEP = re.compile(r"\bsame (?:h\b|(?:time ?)?step)")
_LABEL_OF_ITEM = re.compile(r"\s*[-*+•]\s+[*_]*[^\W\d][^\W\d][^:\n]{0,60}:")
# Methods as the columns and rows of a table have them.
_SHORT_NAMES = {"forward": "forward euler", "backward": "backward euler", "trapezoidal": "trapezoidal rule"}
_SHORT_NAMES["kutta"] = "kutta's third-order method"
# What the letter of an energy stands for, which is of all unknowns.
ENERGY_OF_ALL = "energy"
# Characters before a number that are searched for a method.
_NEAR = 400


@dataclass(frozen=True)
class Place:
    """What is named where a number stands, None or an empty set if nothing is; `sure` with a quantity and its time.

    The row or the sentence of the number gives the settings `near`, and each of them one value, n the number of a step
    from which h tells the time; `own` methods are said
    to be the number's, or it is said to be `of_solution`. Of the two runs that a question compares, one of `of_row` has
    the step size here. A ratio of the errors of two methods has these as `compared`, the larger first.
    """

    methods: frozenset[str]
    settings: dict[str, Fraction]
    quantity: str | None
    unknown: str | None
    sure: bool = False
    near: frozenset[str] = frozenset()
    own: bool = False
    of_solution: bool = False
    of_row: tuple[int, ...] = (0, 1)
    compared: tuple[str, ...] = ()

    @property
    def steps(self) -> Fraction | None:
        """The number of steps to the time that is named nearby, None if it is no whole one."""
        h, t = (self.settings.get(x) for x in "ht")
        return t / h if h and t and "t" in self.near and (t / h).denominator == 1 else None

    def with_step(self, h: Fraction | None) -> dict[str, Fraction]:
        """The settings with another step size, None for none that is known, and with the time of a numbered step."""
        n, own = self.settings.get("n"), {} if h is None else {"h": h}
        own |= {"t": n * h} if n is not None and h is not None else {}
        return {x: given for x, given in self.settings.items() if x != "h" and not (x == "t" and n is not None)} | own

    def names(self, question: str, methods: set[str], sizes: Collection[Fraction]) -> bool:
        """True if a method of the question is named here, no other time, and its step size among `sizes`."""
        asked = asked_settings(question)
        timed = not asked["t"] or self.settings.get("t") in (None, *asked["t"])
        return not methods.isdisjoint(self.methods) and timed and {*sizes} >= {*asked["h"]}

    def denies(self, question: str) -> bool:
        """True if the row or the sentence gives another step size or time than asked for."""
        asked = self.named_of(question)
        return any(asked[x] and self.settings[x] not in asked[x] for x in self.near)

    def named_of(self, question: str) -> dict[str, list[Fraction]]:
        """The step sizes, times and arguments in a question that name its value, of two runs those of this place."""
        of = self.of_row if asked_quantity(question)[0] in COMPARED else (0,)
        return {x: [given[i] for i in of if given[i:]] for x, given in asked_settings(question).items()}

    def is_of_others(self, question: str) -> bool:
        """True if the number is said to be of other methods than the question is about, or of the solution."""
        keys, (quantity, _) = methods_asked(question), asked_quantity(question)
        if quantity == "energy" and question.startswith("exact "):  # of the start, or where no method is named
            return self.own or (self.settings.get("t") != 0 and bool(self.methods))
        if self.of_solution:
            return quantity in {"state", "error"}
        return self.own and (keys.isdisjoint(self.methods) if keys else {quantity, self.quantity} == {"exact", None})

    def is_of_another(self, question: str) -> bool:
        """True if the words here are those of stability functions or observed orders, and the question is not."""
        return self.quantity in _CERTAIN and asked_quantity(question)[0] != self.quantity

    def counts_steps(self, question: str) -> bool:
        """True if steps are counted here, to the time of the question: any count is one to some time."""
        return self.quantity == "steps" and self.settings.get("t") in asked_settings(question)["t"]

    def means(self, question: str, methods: set[str]) -> bool:
        """True if a question about one of these methods asks for what is named here, and all that it asks for is."""
        quantity, unknown = asked_quantity(question)
        if self.compared if len(methods) < 2 else self.compared != runs_asked(question):
            return False
        if (methods and not methods & self.methods) or (self.unknown and unknown.lower() not in ("", self.unknown)):
            return False
        alike = (self.quantity,) if self.quantity else ("state", "error", *["exact"] * (not self.own))
        if quantity not in alike or self.is_of_others(question):
            return False
        return all(self.settings.get(x) in given for x, given in self.named_of(question).items() if given)


def place_of(text: str, start: int, end: int, row: Sequence[Cell], unknowns: Mapping[str, str]) -> Place:
    """The place of the number from `start` to `end` of a text in lower case; `row` is its table's, else empty.

    The names of `unknowns`, in lower case, may have an index, as N_1 does; the index of any other is that of a step.
    They are the names in questions, by those in the text: v by dx too, if x' = v.
    """
    return _Reader(text, start, end, row, unknowns).place()


class _Reader:
    """The reading of one place: first what the sentence or the heads say, then what stands right beside the number."""

    def __init__(self, text: str, start: int, end: int, row: Sequence[Cell], unknowns: Mapping[str, str]) -> None:
        self.text, self.start, self.end, self.row, self.unknowns = text, start, end, row, unknowns
        self.heads = [_SHORT_NAMES.get(cell.head, cell.head) for cell in row if cell.start <= start]
        self.head = self.heads[-1] if self.heads else ""
        self.label = next((cell.text for cell in row if cell.text), "")
        self.before, self.after = sentence_around(text, start, end)
        around = (start, end), (self.before, self.after)
        self.settings, self.near, self.sure = settings_named(text, *around, row, self.head)
        self.about = self._about()
        self.quantity = self._quantity_said()
        self.name: str | None = None
        self.of_solution, self.of_subject = False, set[str]()
        self.compared: tuple[str, ...] = ()
        self.of_row = Place.of_row

    def place(self) -> Place:
        """All that is named there; what is read later overrides what is said farther away."""
        if not self.row:
            self._read_subject()
        self._read_unknown()
        self._read_solution()
        self._read_behind()
        self._read_head()
        self._read_comparison()
        own = self._own_methods()
        methods = {*self.compared} or own or self._methods_near()
        if self.quantity == "energy" and not (methods or self.row):
            self.settings.setdefault("t", Fraction(0))  # of no run, and constant
        name = self.name and (f"d{self.name[:-1]}" if self.name.endswith("'") else self.name)
        if name:
            name = self.unknowns.get(spelled := with_greek_spelled(name), spelled)
        return Place(
            frozenset(methods),
            self.settings,
            self.quantity,
            name,
            self.sure and self.quantity is not None,
            self.near & self.settings.keys(),
            bool(own or self.compared),
            self.of_solution,
            self.of_row,
            self.compared,
        )

    def _is_at(self, t: Fraction) -> None:
        """Take a time that the place itself gives."""
        self.settings["t"], self.near = t, self.near | {"t"}

    def _about(self) -> str:
        """The words that say what the number is: its head, the line above the table, or the sentence before it."""
        if not leaves_quantity(self.head, self.unknowns):
            return self.head if self.row else self.before
        above = re.findall(r"^[^|\n]+$", self.text[max(0, self.start - FARTHEST) : self.start], re.MULTILINE)
        return _WITH_VALUE.sub("", above[-1] if above else self.head)

    def _quantity_said(self) -> str | None:
        """The quantity that the words name last, or else the label of the row; a state under any other head."""
        said, label = [*QUANTITY.finditer(self.about)], QUANTITY.search(self.label)
        told = label if label and leaves_quantity(self.head, self.unknowns) else said[-1] if said else label
        return told.lastgroup if told else "state" if self.head else None

    def _read_subject(self) -> None:
        """Read what a sentence is about: an energy that changes, the solution, or "it", the subject of the last one."""
        changed = _CHANGED.search(self.before)
        if not self.quantity and changed and self.unknowns.get(changed[1], changed[1]) in ("e", "h", ENERGY_OF_ALL):
            self.quantity = "energy"
        self.of_solution = _SOLUTION_IS.search(self.before) is not None
        if self.quantity or not _IT_IS.search(self.before) or methods_named(self.before):
            return
        subject = re.sub(r"\A\s*(?:the|its|whose) ", "", sentence_before(self.text, self.start))
        found = QUANTITY.match(subject)
        self.quantity = found.lastgroup if found else "ratio" if _DIVIDES.search(subject) else None
        self.of_solution = self.quantity == "exact"
        self.of_subject = methods_named(subject) if begins_with_method(subject) else set()

    def _read_unknown(self) -> None:
        """Read the name of an unknown, or of a slope k1, with the index of a step: before the number, or as a head."""
        direct = _UNKNOWN.search(self.before)
        said = QUANTITY.search(self.about)
        if found := direct or _WORKED_OUT.search(self.before):
            name, n = found["name"], found["n"]
            if n and name == "k":
                self.quantity, self.sure = f"k{n}", "h" in self.settings
                return
            exact = self.quantity == "exact"
            self.quantity = "exact" if exact else "state" if direct or n or self.sure else "calculation"
            if f"{name}_{n}" in self.unknowns:
                name, n = f"{name}_{n}", None
        elif found := (
            _OF_UNKNOWN.search(self.about) if said else HEAD_OF_UNKNOWN.fullmatch(without_methods(self.head))
        ):
            name, n = found["name"], said and found["n"]
        else:
            return
        self.name = name
        if self.unknowns.get(name) == ENERGY_OF_ALL:
            self.quantity, self.name = "energy", None
        if n and "h" in self.settings:  # of one step, which begins at 0
            self.settings["t"], self.sure = int(n) * self.settings["h"], True

    def _read_solution(self) -> None:
        """Read the column of the solution beside those of methods, and the label of a row below times."""
        if _SOLUTION.fullmatch(self.head) and any(methods_named(cell.head) for cell in self.row):
            self.quantity = "exact"
        if SETTING["t"].fullmatch(self.head) and (unknown := HEAD_OF_UNKNOWN.fullmatch(self.label)):
            self.quantity = "exact" if _SOLUTION.fullmatch(self.label) else self.quantity
            self.name = unknown["name"]

    def _read_behind(self) -> None:
        """Read what stands right before and behind the number: "divides by", %, "times as large", "steps"."""
        if _DIVIDES.search(self.before) or re.search(r"\blog ?_?2 ?\(?\Z", self.before):
            self.quantity = "ratio"
        elif not self.quantity and _ORDERS.search(self.before.removesuffix(rest_of_list(self.before, "")[0])):
            self.quantity = "order"
        if more := _AFTER.match(self.text, self.end):
            of_energy = more["percent"] and (
                self.quantity in ("energy", "relative_energy")
                or re.match(rf"{PERCENT} of (?:the|its) (?:\w+ ){{0,3}}{ENERGY}", self.text[self.end :])
            )
            counted = "steps" if (more["count"] or "").endswith("steps") else "evaluations" if more["count"] else ""
            self.quantity = "part_of_energy" if of_energy else "percent" if more["percent"] else counted or "ratio"
        if self.quantity == "part_of_energy" and OF_EACH_STEP.match(self.text, self.end) and "h" in self.settings:
            self._is_at(self.settings["h"])
            self.sure = False
        from_to = self.before.endswith("from ") and re.match(" to [-0-9]", self.text[self.end :])
        if self.quantity == "energy" and from_to:  # of the start
            self._is_at(Fraction(0))

    def _read_head(self) -> None:
        """Read the heads of columns that say what their numbers are, whatever else is said: t, h, order, E, change."""
        heads = [cell.head for cell in self.row]
        decimal = "." in self.text[self.start : self.end]
        if re.fullmatch(ORDER_OF_COLUMN, self.head) and decimal and any(is_head_of("h", x) for x in heads):
            self.quantity = "observed_order"
        if _RELATIVE.fullmatch(self.head) and any(re.search(ENERGY, x) for x in heads):
            more = _AFTER.match(self.text, self.end)
            self.quantity = "part_of_energy" if more and more["percent"] else "relative_energy"
        written = [cell.head_written for cell in self.row if cell.start <= self.start][-1:]
        if is_head_of("".join(SETTING_HEADS), self.head):
            self.quantity = "chosen"
        elif written in (["E"], ["H"]) and not {"e", "h"} & {*self.unknowns}:
            self.quantity, self.name = "energy", None
        if (not self.quantity or (self.row and self.quantity == "state")) and self.near & {*"hzt"} == {"z"}:
            self.quantity = "stability"

    def _read_comparison(self) -> None:
        """Read which errors a ratio or an order compares: of two methods, or of two step sizes as in "0.1 to 0.05"."""
        if not self.row:
            if _TIMES.match(self.after):
                self.compared = methods_compared(self.before, self.after, sentence_before(self.text, self.start))
            self.near |= {"h"} if _SAME_STEP.search(self.before) else set()
        if self.compared or self.quantity not in {"steps", *COMPARED}:
            return
        said = self.text[max(0, self.start - _NEAR) : self.start].rpartition("\n\n")[2]
        if self.row:
            said = self.head if PAIR.fullmatch(self.head) else self.row[0].text or self.row[1].text
        if self.quantity in COMPARED and (pairs := PAIR.findall(said)):
            self.settings["h"], self.near, self.of_row = Fraction(pairs[-1][1]), self.near | {"h"}, (1,)
        elif "h" not in self.near:
            self.settings.pop("h", None)  # which of several is not said

    def _own_methods(self) -> set[str]:
        """The methods that a sentence says the number to be of, also by its place in a list of methods."""
        if self.row:
            return set()
        before, after = self.before, self.after
        own = methods_said_of(before, after) or self.of_subject
        if own or self.compared or self.quantity not in COMPARED:
            return own
        if methods_named(before):
            return _methods_by_order(before, after, before)
        if methods_named(after):
            return set()
        far = self.text[max(0, self.start - FARTHEST) : self.start]
        heads_above = re.findall(r"(?:\A|\n\n|\n(?!\|).*\n)(\|.*)", far)
        return _methods_by_order(before, after, sentence_before(self.text, self.start), *heads_above[-1:])

    def _methods_near(self) -> set[str]:
        """The methods of the head, the row, what follows "by" or "with", or the last ones named before."""
        labels = (_SHORT_NAMES.get(cell.text, cell.text) for cell in self.row)
        if named := next(filter(None, map(methods_named, (*reversed(self.heads), *labels))), None):
            return named
        behind = UNIT_BEHIND.sub("", self.text[self.end : self.end + 2 * BESIDE_NUMBER])
        by = re.match(rf" ?\(?(?:by|with|for|using|from)\b([^,;.]{{1,{BESIDE_NUMBER}}})", behind)
        named = methods_named(by[1]) if by else set()
        if named or _is_labelled(self.text, self.start, self.row):  # by a name that is none of a method
            return named
        return last_methods_named(self.text[max(0, self.start - _NEAR) : self.start], self.after)


def _methods_by_order(before: str, after: str, *sources: str) -> set[str]:
    """The keys of the method that a number of a list is of: of as many that the first such source names, in order."""
    left, right = rest_of_list(before, after)
    at, rest = (len(re.findall(LISTED_NUMBER, part)) for part in (left, right))
    lists = (names_in_order(source) for source in sources if at + rest)
    return next((methods_named(names[at]) for names in lists if len(names) == at + 1 + rest), set())


def _is_labelled(text: str, start: int, row: Sequence[Cell]) -> bool:
    """True if the row of a table, or the item of a list, begins with words, which name what its numbers are of."""
    if row:
        label = next((cell.text for cell in row if cell.text), "")
        return re.search(r"[^\W\d]{2}", label) is not None
    return _LABEL_OF_ITEM.match(text, text.rfind("\n", 0, start) + 1, start) is not None
