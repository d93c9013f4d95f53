"""Names of methods in a text: which methods each may mean, lists of them, and what starts multistep methods."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from functools import cache, lru_cache
from itertools import product

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.names import AMBIGUOUS_NAMES, also_known_as, counted_names

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
# A method with the words behind its name.
METHOD_SAID = "(?:METHOD)(?:'s)?(?: (?:method|rule|scheme))?"
# Sentences and questions whose names of methods are kept: a draft asks for those of each of them hundreds of times.
_MOST_KEPT = 2**13


def methods_named(text: str) -> set[str]:
    """The keys of all methods named in the lower-case text by key, title or another name.

    An ambiguous name, such as Verlet, stands for those of its methods that a narrower name means, if there are any.
    """
    found = [keys for _, keys in places_named(text)]
    return set[str]().union(*(keys for keys in found if not any(narrower < keys for narrower in found)))


def methods_in_full(text: str) -> set[str]:
    """The keys of the methods that the lower-case text names by a name of no other method."""
    return set[str]().union(*(keys for _, keys in places_named(text) if len(keys) == 1))


def is_one_name(keys: Collection[str]) -> bool:
    """True if these are the keys of the methods that one name, such as midpoint, may mean."""
    return {*keys} in keys_by_name().values()


def with_names_settled(text: str, meanings: Mapping[frozenset[str], frozenset[str]]) -> str:
    """The lower-case text with the key of the one method that is meant in place of names that may mean several."""
    if not meanings:
        return text
    return spoken_names().sub(
        lambda name: min(meanings.get(frozenset(keys_by_name()[name[0]]), ()), default=name[0]), text
    )


def methods_asked(question: str) -> set[str]:
    """The keys of the methods that a question is about, without one that starts them."""
    return methods_named(re.sub(r" started=\S+", "", question.lower()))


def last_methods_named(*texts: str) -> set[str]:
    """The keys of the method named last in the first of the texts that names one."""
    return next((found[-1][1] for text in texts if (found := places_named(text))), set())


def names_in_order(text: str) -> list[str]:
    """The first name of each of the methods that the lower-case text names, in their order."""
    found = dict[frozenset[str], str]()
    for name in spoken_names().findall(flat(text)):
        found.setdefault(frozenset(keys_by_name()[name]), name)
    return [*found.values()]


def without_starters(text: str) -> str:
    """The lower-case text, blanks in place of the methods of one step that it says start a multistep method."""

    def blank(name: re.Match[str]) -> str:
        return name[0] if keys_by_name()[flat(name[0])] & {*FURTHER_METHODS} else " " * len(name[0])

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
    return next(reversed(names_before(text, rf"\)?{words}")), None)


def names_before(text: str, words: str) -> list[str]:
    """The names of the last methods in the lower-case text that are joined by commas or and, before these words.

    >>> names_before("so heun and rk4 are ", " are ")
    ['heun', 'rk4']
    """
    last = next(reversed([*lists_of_methods().finditer(text)]), None)
    return names_in_order(last[0]) if last and re.fullmatch(words, text[last.end() :]) else []


def begins_with_method(text: str) -> bool:
    """True if the lower-case text begins with the name of a method."""
    return spoken_names().match(flat(text)) is not None


@lru_cache(maxsize=_MOST_KEPT)
def places_named(text: str) -> list[tuple[int, set[str]]]:
    """The positions of the names of methods in the lower-case text, and the methods that each may mean."""
    spoken = flat(text)
    named = (match for match in spoken_names().finditer(spoken) if not _PLAIN.match(spoken, match.start()))
    return [(match.start(), keys_by_name()[match[0]]) for match in named]


def flat(text: str) -> str:
    """The text with blanks for hyphens and ends of lines, as names of methods have them."""
    return _BY_ORDER.sub(r"\1 \2 ", re.sub("--+|[-_\n]", " ", text))


@cache
def keys_by_name() -> dict[str, set[str]]:
    """The keys of the methods that each name may mean, which is in lower case with blanks for hyphens."""
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
def lists_of_methods() -> re.Pattern[str]:
    """One method, or several that are joined, as in "A, B and C"."""
    return re.compile(
        rf"{METHOD_SAID}(?:(?:,|,? (?:and|or|/)) (?:the )?{METHOD_SAID})*".replace("METHOD", spoken_names().pattern)
    )


@cache
def spoken_names() -> re.Pattern[str]:
    """A pattern that matches the longest method name at each place."""
    return re.compile(
        rf"\b(?:{'|'.join(map(re.escape, sorted(keys_by_name(), key=len, reverse=True)))})(?!\w|[.,/][0-9])"
    )
