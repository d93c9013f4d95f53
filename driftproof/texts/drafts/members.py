"""The numbers of a text for a draft: what each looks like, which are chosen, and which share a phrase."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby
from typing import TypeAlias

from driftproof.texts.claims.checking import Span
from driftproof.texts.claims.phrases import digits_of
from driftproof.texts.drafts.look_alikes import LookAlike
from driftproof.texts.drafts.stated_questions import LIMIT
from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.numbers import TextNumber
from driftproof.texts.words.heads import is_head_of
from driftproof.texts.words.method_names import methods_asked

# Words before a number that the author chooses rather than computes, as in h = 0.1 or a start from (1, 0).
_SETTING = re.compile(
    r"(?<![\w./])(?:(?:h|dt|Δt|[tTNnzkλμω]|lambda|mu|omega|[ra]?tol|t_?(?:end|max|final)|n(?:um)?_?steps) ?= ?"
    r"|[^\W\d_]\w{0,9}'{0,2}\(0\) ?= ?|step ?size (?:of |= )?|[Aa]fter |from \((?:[-+]?[0-9./]+, ?)*)\Z"
)
_LONGEST_SETTING = 20
# Words before a step size or a time that is found, and before a number of steps, as in "it has doubled after".
_FOUND = re.compile(
    r"\b(?:reache[sd]|attain(?:s|ed)|cross(?:es|ed|ing)|occurs?|peaks?|peaked|maxim\w+|minim\w+|vanish\w+|hits?|lands?|"
    r"touches|falls (?:below|to)|drops (?:below|to)|exceeds|passes|blow\w*|half-life|turning point|that is|"
    r"means|hence|therefore)\b[^.;,=]{0,40}\Z"
)
_GROWN = re.compile(
    r"\b(?:(?:doubl|halv|tripl|overflow|diverg|converg|explod)\w*[^.:;,=]{0,40}|answer\b[^.;,=]{0,40})\Z"
)
_FEWEST_FOUND = 3  # significant digits of a step size or a time that nobody chooses
# Letters of settings that are also unknowns, as in ω' = -sin(θ), or eigenvalues, which have more than three digits.
_SOLVED_FOR = re.compile(r"[kznλμω]|lambda|mu|omega")
# Numbers on one line with gaps of at most this many characters share a phrase, up to this many of them.
_WIDEST_GAP, _MOST_IN_PHRASE = 25, 8

# Values that a number may be: more of them say nothing about it.
_MOST_GUESSES = 6

# What the remark on a number says that is perhaps wrong.
SLIP = "is perhaps a slip:"
# And on an error constant beside those of methods of another kind.
SIGN = "its sign is computed minus exact for methods of one step, and in most books the other one"


# A problem in a question, and its energy.
_PROBLEM = re.compile(r"\w+'+=(?:(?! : ).)*\(0\)=[^,:\s]+|\benergy=(?:(?! : ).)*?(?=, [hNt]=)")


def problems_named_once(lines: Iterable[str]) -> Iterator[str]:
    """The lines, with dots for a problem that a question before has in full."""
    named = set[str]()

    def shown(problem: re.Match[str]) -> str:
        known = problem[0] in named
        named.add(problem[0])
        return "..." if known else problem[0]

    yield from (_PROBLEM.sub(shown, line) for line in lines)


@dataclass(frozen=True)
class Member:
    """A number, the values that it looks like or is a slip for, and, if it is chosen, where h = or its cell begins.

    What is said of it goes on `until` the end of its equation.
    """

    number: TextNumber
    alike: list[LookAlike]
    slips: dict[str, str]
    strong: bool
    chosen_at: int | None
    until: int

    @classmethod
    def of(
        cls, number: TextNumber, suggestions: Suggestions, text: str, equations: Mapping[int, Span], letters: set[str]
    ) -> Member:
        """The number with what the text says about it; `letters` are parameters, and `equations` where one stands."""
        start, alike = max(0, number.start - _LONGEST_SETTING), suggestions.look_alikes(number)
        slips, of_slip = suggestions.slips(number), suggestions.has_slip_before(number)
        alike = [replace(one, strong=one.strong and not of_slip) for one in alike]
        before = text[start : number.start].replace("\n", " ")
        parameter = re.search(r"(?<![\w./√^])([^\W\d]\w*) ?= ?\Z", before)
        found = _SETTING.search(before) or (parameter if parameter and parameter[1] in letters else None)
        said = text[max(0, start - 2 * _LONGEST_SETTING) : start + found.start()].lower() if found else ""
        said, what = said.replace("\n", " "), found[0].lower() if found else ""
        digits = len(digits_of(number.text).rstrip("0"))
        of_time = digits >= _FEWEST_FOUND and what[:1] in {"t", "h"} and _FOUND.search(said)
        if (
            LIMIT.search(said)
            or (what[:1] == "h" and number.text[0] == "-")
            or of_time
            or (what == "after " and _GROWN.search(said))
        ):
            found = None  # what is found, not chosen
        setting, strong = start + found.start() if found else None, bool(alike) and alike[0].strong
        head = suggestions.tables.column_of(number)
        if is_head_of("htnsz", head) or re.fullmatch(r"[kλω](?: ?[(\[](?![0-9]).*)?", head):
            cell = re.search(r"(?m)(?:\||^) ?\Z", text[start : number.start])
            if cell and re.match(r" ?(?:[|\n]|\Z)", text[number.end :]):
                setting = start + cell.start()
        letter = _SOLVED_FOR.fullmatch(found[0].rstrip("= ") if found else head)
        if letter and (f"{letter[0]}'" in text or digits > 3):
            setting = None
        until = number.end
        if number.start in equations:
            strong, (setting, until) = False, equations[number.start]
        setting = suggestions.in_calculation.get(number.start, setting)
        return cls(number, alike, slips, strong, None if strong or slips or of_slip else setting, until)

    @property
    def chosen(self) -> bool:
        """True if the text chooses the number, as in h = 0.1."""
        return self.chosen_at is not None

    def remark(self, place: str) -> str:
        """A comment line with the other values that the number looks like, at most two of them, or a likely slip."""
        if self.slips:
            worded = self.number.is_worded
            near = {x: 0 if worded else abs(Fraction(x[1]) - self.number.value) for x in self.slips.items()}
            question, slip = min(near, key=lambda one: (near[one], one))
            other = next((one.question for one in self.alike if one.question != question), "")
            also = f"; it looks like {other}" * bool(other)
            return f"# {place}: {self.number.text} {SLIP} {question} is {slip}{also}\n"
        others = [alike.question for alike in self.alike[self.strong :]]
        more = f" and {len(rest)} more" if (rest := others[2:]) else ""
        also = "also " * self.strong
        more += f"; {SIGN}" * (not self.strong and "error_constant " in " ".join(others[:1]))
        few = self.strong and len(digits_of(self.number.text)) < 3  # a small integer looks like much
        shown = others and not self.chosen and not few and len(others) <= _MOST_GUESSES
        return f"# {self.number.text} looks {also}like {', '.join(others[:2])}{more}\n" if shown else ""


# Neighbouring numbers of one line that go into one phrase: strong look-alikes and a setting before them, or neither.
Group: TypeAlias = list[Member]
Bounded: TypeAlias = tuple[int, int, Group]


def uncovered(groups: list[Group], fences: list[int], covered: set[int]) -> Iterator[Bounded]:
    """The runs of the groups that no drafted phrase covers, each with the bounds that its phrase must stay within."""
    befores = [fences[0], *(group[-1].number.end for group in groups)]
    afters = [*(group[0].number.start for group in groups[1:]), fences[-1]]
    for before, after, group in zip(befores, afters, groups, strict=False):
        starts = [member.number.start for member in group]
        at = bisect_right(fences, min(starts))  # a number that is left out may stand in no phrase
        ends = [max(before, fences[at - 1]), *(member.number.end for member in group)]
        for is_covered, run in groupby(range(len(group)), lambda i, starts=starts: starts[i] in covered):  # type: ignore[misc]
            part = [*run]
            if not is_covered:
                end = [*starts, min(after, fences[at])][part[-1] + 1]
                yield ends[part[0]], end, group[part[0] : part[-1] + 1]


def groups(text: str, members: list[Member], fences: list[int]) -> Iterator[Group]:
    """The groups of the members; none extends over a fence, an end of a number that may stand in no phrase."""
    group: Group = []
    for member in members:
        if group:
            last = group[-1]
            between = text[last.number.end : member.number.start]
            together = len(between) <= _WIDEST_GAP and not re.search(r"[.;?!] |\S.*\n|\n.*\S", between)
            alike = (last.strong, last.chosen_at) == (member.strong, member.chosen_at) or (
                last.chosen and member.strong
            )
            fenced = bisect_right(fences, last.number.start) != bisect_right(fences, member.number.start)
            # What is perhaps a slip is told from the same number beside it by its place in the phrase.
            twice = [x for x in group if x.number.text == member.number.text and (x.slips or member.slips)]
            if not (together and not twice and alike and not fenced and len(group) < _MOST_IN_PHRASE):
                yield group
                group = []
        group.append(member)
    if group:
        yield group


def of_one_method(group: Group) -> Group:
    """The group, its values of one method if all of them may be, as those of Verlet in either form."""
    may_be = [[methods_asked(x.question) for x in one.alike if x.strong] for one in group if one.strong]
    common = [keys for keys in may_be[0] if all(keys in each for each in may_be)] if may_be else []
    if not common or all(each[0] == may_be[0][0] for each in may_be):
        return group
    return [
        replace(one, alike=sorted(one.alike, key=lambda x: methods_asked(x.question) != common[0])) for one in group
    ]
