"""Detect that a sentence cannot mean a value: it names another method, step size, time, component or quantity."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from functools import cache

from driftproof.texts.readers.number_words import UNIT_BEHIND
from driftproof.texts.values.published import published_values
from driftproof.texts.words.method_names import (
    flat,
    keys_by_name,
    last_methods_named,
    lists_of_methods,
    methods_asked,
    methods_named,
    names_in_order,
    places_named,
    spoken_names,
)

# The energy of a problem, and what else a text may call it.
ENERGY = "(?:energy|hamiltonian|invariant|conserved quantity|first integral)"
# What begins the name of a quantity that is largest on the way of a run, not at its end.
LARGEST = "largest_"
# Quantity -> the words that name it, and the words of quantities that are confused with it.
_QUANTITIES = {
    "imaginary_limit": ("imaginary", "real"),
    "real_limit": ("real", "imaginary"),
    "angle": ("angle|α|alpha", "imaginary|real"),
    "error_constant": ("error constant", "dispersion|dissipation|limit|r|weights?|coefficients?|nodes?"),
    "state_error": ("state|distance|off", "phase|energy|angle"),
    "phase_error": ("phase|angle", "state|distance|energy"),
    **dict.fromkeys(("energy", "energy_change"), (ENERGY, "phase|imaginary|error")),
    "order": ("orders?", "stable|stability|limit|axis"),
    "steps": ("steps?", "calls?|evaluations?"),
    "evaluations": ("calls?|evaluations?", "steps?"),
}
# Counts are small integers that often coincide, so the word nearest to the number decides which count is meant.
_COUNTED = {
    **{"order": "orders?", "stages": "stages?", "steps": "steps?"},
    **dict.fromkeys(("evaluations", "evaluations_per_step"), "calls?|evaluations?"),
}
# The name of a component right before a number.
_COMPONENT = re.compile(r"(?:(?<![a-z])([qxvp])|(position)|(velocity))(?: is| of| to)?\s*[=≈:]?\s*\Z")
# A symbol right before a number, and those of quantities: a number of two digits is of no other quantity.
_SYMBOL = re.compile(r"(?<!\w)(?:'')?([^\W\d_])(?:'')? ?= ?\Z")
_SYMBOLS = {"order": "p", "stages": "s", "steps": "n", "evaluations": "n", "q": "qx", "v": "vp"}
_SYMBOLS |= {"real_limit": "hzxλ", "imaginary_limit": "hzyωλ"}
# A linear equation that oscillates, such as x'' = -x, or decays: whose limit is imaginary or real.
LINEAR = re.compile(r"(?<!\w)(?P<name>[^\W\d]\w*)'(?P<second>'?)(?:\(t\))? ?= ?-(?:[\w./^]+ ?[*·]? ?)?(?P=name)\b")
_CHOSEN = "htzkγλ"  # what a text chooses, so no other quantity
# Before and after the 2 of 2√2, and the 1 of 1 - h.
_IN_FORMULA = (r"(?:[+*·×/^√]\(?|(?:\)|\b[a-z]) ?-)\s?\Z", r"\s?(?:[+*·×/^√]|-\s?(?:[^\sa-z]|[a-z]\b))")
# What ends a sentence. A line that ends in a word, such as RK4, or a comma goes on in the next one, unless an item or a
# row begins.
_ENDS = re.compile(r"[.;?!]\s|(?<![^\W\d_])(?<![^\W\d_][0-9])(?<![,(])\n|\n(?=\s*(?:[\n|!*#:{-]|[0-9]+[.)]\s))")
# Numbers in a list, what joins them, and settings; words before a method that is compared with.
LISTED_NUMBER = (
    r"(?<![\w.^])[-+]?[0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?(?:e[-+]?[0-9]+|(?: ?[×·] ?10\^\{?-?[0-9]+\}?))?(?![\w.]*\w)%?"
)
_JOINED = r"(?:, ?(?:and |or |but )?| (?:and|or|/) )"
_SETTINGS = re.compile(rf"\b\w+ ?= ?{LISTED_NUMBER}")
_NO_SUBJECT = re.compile(
    r"\b(?:than|(?:un)?like|as|vs\.?|versus|against|to|from|(?:compared|contrast) \w+)(?: the)? \Z"
)
# Behind the ratio of the errors of two methods, up to the second of them.
_TIMES_AS = re.compile(
    r" times (?:(?P<of>that|the error) of (?:the )?|"
    r"(?:(?P<closer>(?:as|more) (?:accurate|precise|exact|good|small)|smaller|better|closer|less)|"
    r"(?:as|more) (?:large|big|great|inaccurate|bad)|less (?:accurate|precise|exact)|larger|bigger|greater|worse)"
    r"(?:(?P<than>[^.;,]{0,40}? ?\b(?:than|as)(?: (?:that|those|the error) of| with)?(?: the)? )|"
    r"(?=[ .]*(?:[,;)]|\Z))))"
)
_ERROR_IS = re.compile(r"\berrors? of [^,;]*\Z")
# Before such a ratio without the second method; steps, or errors of another kind, that it may be of instead.
_AN_ERROR = re.compile(r"\b(?:an?|its|whose) errors?(?: (?:is|about|some|only|roughly|nearly))* \Z")
_OF_ELSE = re.compile(
    r"\b(?:hal[fv]\w*|doubl\w*|twice|smaller|shorter|finer|longer|coarser|larger|each|every|from|"
    r"energy|phase|position|velocity|largest|max\w*|relative|local)\b"
)
# Characters between a method and the number that it has.
_LONGEST_GAP = 60
# Characters on each side of a number that may belong to its sentence.
_LONGEST = 400
# A number above 0, and a step size or time that a text gives: whole, so not the 10 of t = 10^6 or the 2 of t = 2*pi.
POSITIVE = r"(?=[0.]*[1-9])([0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?)(?!\^|[\w./*]*\w)"
# Not the 1.2 of x, v, h = 1.2, 0.0, 0.1.
_OF_TUPLE = r"(?<=\w, )\w+\s?=\s?[-0-9.e]+, ?-?[0-9]"
SETTING = {
    x: re.compile(rf"(?<![\w./])(?!{_OF_TUPLE}){said}\s?=\s?{POSITIVE}")
    for x, said in (("h", "(?:h|[dδΔ]t)"), ("t", "t"))
}
# The argument of a stability function, as in z = -10, h*lambda = -1.6 and R(-10).
_ARGUMENT = (
    r"(?<![\w.])(?:(?:z|h ?[*·]? ?(?:λ|lambda))\s?=\s?(?:-?[0-9.]+ ?[*·] ?[0-9.]+ ?= ?)?|[rR]\((?=-?[0-9./]+\)))"
)
SETTING["z"] = re.compile(rf"{_ARGUMENT}(-?[0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?)(?!\^|[\w./*]*\w| ?[-+*·/] ?[\w(])")
# Before a number that bounds the orders of several methods, as in zero-stable up to order 6.
_BOUND = re.compile(r"\b(?:up to|at (?:most|least)|below|above|beyond|than) (?:the )?order \Z")


def contradicted(question: str, text: str, start: int, end: int, asked: bool) -> bool:
    """True if the sentence around the number from `start` to `end` names something other than the question does.

    Compared are the method, step size, time, component and quantity: the last one named before the number counts or, if
    there is none, the first after it; several in a list contradict nothing. A question that was `asked` is contradicted
    only by a method before the number, a formula around it, and another symbol before two digits. Text in lower case.
    """
    before, after = sentence_around(text, start, end)
    head, _, readout = question.rpartition(" : ") if " : " in question else (question, "", question.split(" ")[0])
    quantity = readout.rpartition(".")[2]
    in_formula = re.search(_IN_FORMULA[0], before) or re.match(_IN_FORMULA[1], after)
    if in_formula and (end - start == 1 or quantity in _COUNTED):
        return True
    if len(re.sub("[^0-9]", "", text[start:end])) < 3 and (symbol := _SYMBOL.search(before)):
        own_symbols = _SYMBOLS.get(quantity, quantity if len(quantity) == 1 else "")
        if symbol[1] not in own_symbols if own_symbols else symbol[1] in _CHOSEN:
            return True
    key = min(methods_asked(question), default="")
    (own, other), (own_after, other_after) = (_methods(part, key) for part in (before, after))
    if other and not own:  # of another method, unless its own follows before the next number
        own_after = [at for at in own_after if not re.search(r"(?<![\w.])[0-9]|[,;]", after[:at])]
    other_method = bool(key) and _differs(own, other, before, () if asked else other_after, own_after)
    if asked or other_method:
        return other_method
    if quantity in ("real_limit", "imaginary_limit") and not _words("real|imaginary", before + after):
        said = [*LINEAR.finditer(text, max(0, start - _LONGEST), start)][-1:]
        if said and bool(said[0]["second"]) != (quantity == "imaginary_limit"):
            return True
    other_setting = any(_gives_another_value(letter, head, before, after) for letter in "ht")
    return other_setting or _names_another_quantity(quantity, before, after)


def _names_another_quantity(quantity: str, before: str, after: str) -> bool:
    """True if the sentence names another quantity, counts something else, or gives the other component."""
    own, other = _QUANTITIES.get(quantity, ("", ""))
    if own and _differs(_words(own, before), _words(other, before), before, _words(other, after), _words(own, after)):
        return True
    if quantity == "order" and _BOUND.search(before):
        return True
    if quantity in _COUNTED and _next_to(before, after) not in ("", _COUNTED[quantity]):
        return True
    found = _COMPONENT.search(before) if quantity in ("q", "v") else None
    return found is not None and (quantity == "q") != (found[1] in ("q", "x") or bool(found[2]))


@cache
def asked_settings(question: str) -> dict[str, list[Fraction]]:
    """The step sizes, times and arguments of stability functions in a question, by letter."""
    return {x: [*map(Fraction, pattern.findall(question))] for x, pattern in SETTING.items()}


def runs_asked(question: str) -> tuple[str, ...]:
    """The keys of the methods of the runs in a question, in their order."""
    return (*re.findall(r"\brun (\w+)", question),)


@cache
def asked_quantity(question: str) -> tuple[str, str]:
    """The quantity that a question asks for, and the unknown whose value it is, if it is one's."""
    readout = re.sub(r"\).*", "", question.removesuffix(", 1)").rpartition(" : ")[2])
    kind, _, unknown = readout.rpartition(".")
    unknown = (
        "" if "rates=" in question or " : " not in question else unknown
    )  # y0, y1, ... need not be the names in the text
    if question.startswith("stability_function "):
        return "stability", ""
    if question.startswith(("ratio(", "R(", "log2(ratio(", "ln(ratio(")):
        return "observed_order" if question.startswith("l") else "ratio", readout.partition(".")[2]
    if " : " not in question:
        return question.partition(" ")[0], ""
    if question.startswith("percent("):
        return {"relative_error": "percent", "relative_energy_change": "part_of_energy"}.get(readout, "share"), ""
    if readout.startswith(LARGEST):
        return readout, ""
    if readout in ("error", "state_error", "position_error", "relative_error", "evaluations", "steps"):
        return readout.removeprefix("state_").removeprefix("position_"), ""
    if readout in ("energy", "energy_change", "relative_energy_change"):
        return "relative_energy" if readout[0] == "r" else "energy", ""
    if kind[:1] == "k" or kind in ("embedded", "estimate"):
        return kind, "" if kind[:1] == "k" else unknown
    if kind == "error":
        return kind, unknown
    return "exact" if kind == "exact" or question.startswith("exact ") else "state", unknown


def names_another_axis(axis: str, text: str, start: int, end: int, head: str) -> bool:
    """True if the sentence around a limit of stability, or the head of its column, names the other axis instead."""
    before, after = (head, "") if head else sentence_around(text, start, end)
    return _names_another_quantity(f"{axis}_limit", before, after)


def sentence_around(text: str, start: int, end: int) -> tuple[str, str]:
    """The sentence before and after the number from `start` to `end`."""
    return _ENDS.split(text[max(0, start - _LONGEST) : start])[-1], _ENDS.split(text[end : end + _LONGEST])[0]


def sentence_before(text: str, start: int) -> str:
    """The sentence before the one with the place, "" for none."""
    return [*_ENDS.split(text[max(0, start - 2 * _LONGEST) : start]), ""][-3:][0]


def _differs(
    own: Sequence[int], other: Sequence[int], before: str, other_after: Sequence[int], own_after: Sequence[int]
) -> bool:
    """True if the words name another quantity rather than this one; words after the number are a fallback."""
    if not own:
        return bool(other or other_after) and not own_after
    if not other or max(other) < max(own):
        return False
    between = re.sub(r"[a-z]+[0-9]+", "", before[max(own) : max(other)])  # ignore numbers in names: RK4, k1, 3/8 rule
    return bool(re.search("[0-9]", spoken_names().sub("", flat(between))))


def _next_to(before: str, after: str) -> str:
    """The kind of count whose word stands nearest to the number; "" if there is none."""
    gaps: list[tuple[int, str]] = []
    for kind in _COUNTED.values():
        gaps += [(len(before) - match.end(), kind) for match in re.finditer(rf"\b(?:{kind})\b", before)]
        gaps += [(gap, kind) for gap in _words(kind, after)]
    return min(gaps)[1] if gaps else ""


def _words(pattern: str, text: str) -> list[int]:
    return [match.start() for match in re.finditer(rf"\b(?:{pattern})\b", text)]


def _methods(text: str, key: str) -> tuple[list[int], list[int]]:
    """The positions that name the method, and those that name other methods only."""
    found = places_named(text)
    return [at for at, keys in found if key in keys], [at for at, keys in found if key not in keys]


def rest_of_list(before: str, after: str, joined: str = _JOINED) -> tuple[str, str]:
    """What stands before a number, and after it, of a list of numbers that are `joined` by such words; "" for none."""
    runs = re.search(rf"(?:{LISTED_NUMBER}{joined})*\Z", before), re.match(rf"(?:{joined}{LISTED_NUMBER})*", after)
    return runs[0][0] if runs[0] else "", runs[1][0] if runs[1] else ""


def methods_said_of(before: str, after: str) -> set[str]:
    """The keys of the method that a number is of where the lower-case sentence around it says so; none elsewhere.

    It does in "x for A", "x (A)" and "A is off by x", and of the numbers of a list in "A and B are x and y", "x and y
    for A and B", and "A and B have x, if h = 1, and y, respectively".
    """
    before, after = (UNIT_BEHIND.sub("", part) for part in (before, after))
    before, after = (re.sub(r"--+|(?<=[a-df-z])-|-(?!\.?[0-9])|[_\n]", " ", part) for part in (before, after))
    left, right = rest_of_list(before, after)
    if behind := _methods_behind().match(after[len(right) :]):
        listed = places_named(behind[0])
        left = left if right or listed[1:] else ""  # 0.1 (A) and 0.2 (B)
    else:
        lists = [*lists_of_methods().finditer(before)]
        listed = places_named(lists[-1][0]) if lists else []
        between = before[lists[-1].end() : len(before) - len(left)] if lists else ""
        if "respectively" in after and listed[1:]:
            left, right = (spoken_names().sub("", part) for part in (between + left, after))
        else:
            compared = lists and _NO_SUBJECT.search(before[: lists[-1].start()])
            ends = re.search(r"[0-9;:]|\band\b", _SETTINGS.sub("", between.lstrip(":"))) or len(between) > _LONGEST_GAP
            if ends or (len(listed) == 1 and ("," in between or compared)):
                return set()
    at, more = (len(re.findall(LISTED_NUMBER, part)) for part in (left, right))
    return listed[at][1] if len(listed) == at + 1 + more else set()


def methods_compared(before: str, after: str, earlier: str = "") -> tuple[str, ...]:
    """The keys of the methods with the larger and the smaller error in "A is 20 times as accurate as B"; () for none.

    In "B has an error 20 times smaller" the other method is the only one named before, in the sentence `earlier` too.

    >>> methods_compared("the error of ab3 is ", " times smaller than that of ab2.")
    ('adams_bashforth2', 'adams_bashforth3')
    """
    found, first = _TIMES_AS.match(flat(after)), last_methods_named(before)
    if found and found["of"] and not _ERROR_IS.search(flat(before)):  # of a cost, say
        return ()
    other = spoken_names().match(flat(after), found.end()) if found and (found["than"] or found["of"]) else None
    second = keys_by_name()[other[0]] if other else set[str]()
    if found and not found["than"] and _AN_ERROR.search(flat(before)):
        both = next((x for x in (before, f"{earlier}. {before}") if len(names_in_order(x)) > 1), "")
        named = [methods_named(name) for name in names_in_order(both)]
        alike = len({*SETTING["h"].findall(both)}) < 2 and not _OF_ELSE.search(both)
        second = named[named[0] == first] if alike and first in named and len(named) == 2 else second
    if not found or len(first) != 1 or len(second) != 1 or first == second:
        return ()
    return (*second, *first) if found["closer"] else (*first, *second)


@cache
def _methods_behind() -> re.Pattern[str]:
    """Methods right behind the number that is theirs: "for A and B", or "(A)" and nothing else in the brackets."""
    methods = lists_of_methods().pattern
    return re.compile(
        rf"(?: (?:by|in|with|for|using|of) (?:the )?{methods}| ?[(\[](?:the |with |by |for )?{methods}[\]),;])"
    )


def _gives_another_value(letter: str, head: str, before: str, after: str) -> bool:
    """True if the sentence gives `letter`, h or t, another value than the question does."""
    said = SETTING[letter].findall(before)[-1:] or SETTING[letter].findall(after)[:1]
    asked = re.search(rf"(?<![a-z]){letter}=(\S+)", head)
    run = head.split(".")[-2:-1] if letter == "h" else []
    published = published_values().get(f"{run[0]}.h") if run else None  # the step size of a published run
    own = asked[1] if asked else str(published["exact"]) if published else ""
    return bool(said and own) and Fraction(*said) != Fraction(own)
