"""Detect that a sentence cannot mean a value: it names another method, step size, time, component or quantity."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache, lru_cache
from itertools import product

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.names import AMBIGUOUS_NAMES, also_known_as, counted_names
from driftproof.texts.readers.number_words import UNIT_BEHIND
from driftproof.texts.values.published import published_values

# The energy of a problem, and what else a text may call it.
ENERGY = "(?:energy|hamiltonian|invariant|conserved quantity|first integral)"
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
# Names of several methods that a text may have for other reasons.
_PEOPLE = {"Butcher", "Verner", "Gauss", "Suzuki", "Yoshida"}
# What is no name of a method: the midpoint of a step, and a fraction.
_PLAIN = re.compile(r"midpoint of |3/8(?! (?:rule|method|runge))")
# A method with its order in brackets, as in RK(4).
_BY_ORDER = re.compile(r"\b(rk|ab|am|bdf)\(([1-9])\)")
# What a text says about the first values of a multistep method.
_START = r"\b(?:start|bootstrap|initiali[sz]|first (?:step|value)|initial steps)"
STARTING = re.compile(rf"(?:(?![.;,]\s)[^|()]){{0,60}}{_START}(?:(?!\.\s|;\s(?!we\b))[^|()]){{0,100}}")
# Where the sentence goes on with another subject.
_OF_OTHERS = re.compile(rf"{_START}.*?,\s(?=(?:and|but|while|whereas)\b)", re.DOTALL)
_STARTED = re.compile(r"\bstarted\b|bootstrap|initiali[sz]|\b(?:starting|first) values?\b")
_STARTS_WITH = re.compile(r"\bstarts? (?:with|by|from) (?:\w+ ){0,2}steps? (?:of|with|by)\b")
_FROM_SOLUTION = re.compile(r"\bexact|\b(?:from|of|by|on|with) (?:the |its )?(?:true |known |analytic\w* )?solution\b")
# A method with the words behind its name; numbers in a list, and settings; words before a method that is compared with.
_METHOD = "(?:METHOD)(?:'s)?(?: (?:method|rule|scheme))?"
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
# Sentences and questions whose names of methods are kept: a draft asks for those of each of them hundreds of times.
_MOST_KEPT = 2**13
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
    found = _named(text)
    return [at for at, keys in found if key in keys], [at for at, keys in found if key not in keys]


def methods_named(text: str) -> set[str]:
    """The keys of all methods named in the lower-case text by key, title or another name.

    An ambiguous name, such as Verlet, stands for those of its methods that a narrower name means, if there are any.
    """
    found = [keys for _, keys in _named(text)]
    return set[str]().union(*(keys for keys in found if not any(narrower < keys for narrower in found)))


def methods_in_full(text: str) -> set[str]:
    """The keys of the methods that the lower-case text names by a name of no other method."""
    return set[str]().union(*(keys for _, keys in _named(text) if len(keys) == 1))


def is_one_name(keys: Collection[str]) -> bool:
    """True if these are the keys of the methods that one name, such as midpoint, may mean."""
    return {*keys} in _names().values()


def with_names_settled(text: str, meanings: Mapping[frozenset[str], frozenset[str]]) -> str:
    """The lower-case text with the key of the one method that is meant in place of names that may mean several."""
    if not meanings:
        return text
    return spoken_names().sub(lambda name: min(meanings.get(frozenset(_names()[name[0]]), ()), default=name[0]), text)


def methods_asked(question: str) -> set[str]:
    """The keys of the methods that a question is about, without one that starts them."""
    return methods_named(re.sub(r" started=\S+", "", question.lower()))


def last_methods_named(*texts: str) -> set[str]:
    """The keys of the method named last in the first of the texts that names one."""
    return next((found[-1][1] for text in texts if (found := _named(text))), set())


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
        listed = _named(behind[0])
        left = left if right or listed[1:] else ""  # 0.1 (A) and 0.2 (B)
    else:
        lists = [*_lists_of_methods().finditer(before)]
        listed = _named(lists[-1][0]) if lists else []
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
    second = _names()[other[0]] if other else set[str]()
    if found and not found["than"] and _AN_ERROR.search(flat(before)):
        both = next((x for x in (before, f"{earlier}. {before}") if len(names_in_order(x)) > 1), "")
        named = [methods_named(name) for name in names_in_order(both)]
        alike = len({*SETTING["h"].findall(both)}) < 2 and not _OF_ELSE.search(both)
        second = named[named[0] == first] if alike and first in named and len(named) == 2 else second
    if not found or len(first) != 1 or len(second) != 1 or first == second:
        return ()
    return (*second, *first) if found["closer"] else (*first, *second)


def names_in_order(text: str) -> list[str]:
    """The first name of each of the methods that the lower-case text names, in their order."""
    found = dict[frozenset[str], str]()
    for name in spoken_names().findall(flat(text)):
        found.setdefault(frozenset(_names()[name]), name)
    return [*found.values()]


def without_starters(text: str) -> str:
    """The lower-case text, blanks in place of the methods of one step that it says start a multistep method."""

    def blank(name: re.Match[str]) -> str:
        return name[0] if _names()[flat(name[0])] & {*FURTHER_METHODS} else " " * len(name[0])

    def without(clause: re.Match[str]) -> str:
        end = found.end() if (found := _OF_OTHERS.search(clause[0])) else len(clause[0])
        return spoken_names().sub(blank, clause[0][:end].replace("-", " ")) + clause[0][end:]

    return STARTING.sub(without, text)


def starters_said(text: str) -> list[str]:
    """The keys of the methods that the lower-case text says start a multistep method, "exact" for a solution."""
    said = " ".join(STARTING.findall(text))
    named = methods_named(said)
    return [*(key for key in METHODS if key in named), *["exact"] * bool(_FROM_SOLUTION.search(said))]


def starts_said(text: str) -> Iterator[tuple[int, int]]:
    """The spans in which the lower-case text surely says, without a number, what starts a multistep method."""
    for clause in STARTING.finditer(text):
        subject = clause[0][: found.start()] if (found := _STARTS_WITH.search(clause[0])) else ""
        is_said = _STARTED.search(clause[0]) or methods_named(subject) & {*FURTHER_METHODS}
        if is_said and starters_said(clause[0]) and not re.search(r"(?<![a-z])[0-9]", clause[0]):
            yield clause.start(), clause.start() + len(clause[0].rstrip(" ,;:\n"))


def lowered(text: str, questions: Iterable[str]) -> str:
    """The text in lower case, without the methods that start another one if a question says what starts it."""
    lower = text.lower()
    return without_starters(lower) if any(" started=" in one for one in questions) else lower


def name_before(text: str, words: str) -> str | None:
    """The last name of a method in the lower-case text, if only these words stand behind it.

    >>> name_before("so heun's method is ", " (?:is|has) ")
    'heun'
    """
    last = next(reversed([*spoken_names().finditer(text)]), None)
    behind = rf"(?:'s)?(?: (?:method|rule|scheme))?\)?{words}"
    return last[0] if last and re.fullmatch(behind, text[last.end() :]) else None


def names_before(text: str, words: str) -> list[str]:
    """The names of the last methods in the lower-case text that are joined by commas or and, before these words.

    >>> names_before("so heun and rk4 are ", " are ")
    ['heun', 'rk4']
    """
    last = next(reversed([*_lists_of_methods().finditer(text)]), None)
    return names_in_order(last[0]) if last and re.fullmatch(words, text[last.end() :]) else []


def begins_with_method(text: str) -> bool:
    """True if the lower-case text begins with the name of a method."""
    return spoken_names().match(flat(text)) is not None


@lru_cache(maxsize=_MOST_KEPT)
def _named(text: str) -> list[tuple[int, set[str]]]:
    """The positions of the names of methods in the lower-case text, and the methods that each may mean."""
    spoken = flat(text)
    named = (match for match in spoken_names().finditer(spoken) if not _PLAIN.match(spoken, match.start()))
    return [(match.start(), _names()[match[0]]) for match in named]


def flat(text: str) -> str:
    """The text with blanks for hyphens and ends of lines, as names of methods have them."""
    return _BY_ORDER.sub(r"\1 \2 ", re.sub("--+|[-_\n]", " ", text))


@cache
def _names() -> dict[str, set[str]]:
    found = {flat(name.lower()): {*keys} for name, keys in AMBIGUOUS_NAMES.items() if name not in _PEOPLE}
    for kind, name in product(("velocity", "position"), ("verlet", "störmer verlet", "stoermer verlet")):
        forms = (f" ({kind} form)", f" ({kind} version)", f" in {kind} form", f" ({kind})")
        found |= {name + form: {f"{kind}_verlet"} for form in forms}
    found |= {f"{name.lower()}'s {kind}": {*AMBIGUOUS_NAMES[name]} for name in _PEOPLE for kind in ("method", "scheme")}
    for key, method in (*METHODS.items(), *FURTHER_METHODS.items()):
        names = (key, method.title, *also_known_as(key), *counted_names(method.title))
        pairs = [pair[0].replace("-", " and ") for name in names if (pair := re.fullmatch(r"[A-Z]\w+-[A-Z]\w+", name))]
        for name in (*names, *(f"{kind} of {pair}" for pair in pairs for kind in ("pair", "method", "scheme"))):
            name = flat(name.lower())
            for form in (
                name,
                re.sub(r"(?<=[a-z])(?=[0-9])", " ", name),
                re.sub(r" (?:method|rule|scheme)$", "", name),
                re.sub(r"(?<='s )(second|third|fourth) order method$", r"\1", name),
            ):
                found.setdefault(form, set()).add(key)
    return found


@cache
def _lists_of_methods() -> re.Pattern[str]:
    """One method, or several that are joined, as in "A, B and C"."""
    return re.compile(
        rf"{_METHOD}(?:(?:,|,? (?:and|or|/)) (?:the )?{_METHOD})*".replace("METHOD", spoken_names().pattern)
    )


@cache
def _methods_behind() -> re.Pattern[str]:
    """Methods right behind the number that is theirs: "for A and B", or "(A)" and nothing else in the brackets."""
    methods = _lists_of_methods().pattern
    return re.compile(
        rf"(?: (?:by|in|with|for|using|of) (?:the )?{methods}| ?[(\[](?:the |with |by |for )?{methods}[\]),;])"
    )


@cache
def spoken_names() -> re.Pattern[str]:
    """A pattern that matches the longest method name at each place."""
    return re.compile(rf"\b(?:{'|'.join(map(re.escape, sorted(_names(), key=len, reverse=True)))})(?!\w|[.,/][0-9])")


def _gives_another_value(letter: str, head: str, before: str, after: str) -> bool:
    """True if the sentence gives `letter`, h or t, another value than the question does."""
    said = SETTING[letter].findall(before)[-1:] or SETTING[letter].findall(after)[:1]
    asked = re.search(rf"(?<![a-z]){letter}=(\S+)", head)
    run = head.split(".")[-2:-1] if letter == "h" else []
    published = published_values().get(f"{run[0]}.h") if run else None  # the step size of a published run
    own = asked[1] if asked else str(published["exact"]) if published else ""
    return bool(said and own) and Fraction(*said) != Fraction(own)
