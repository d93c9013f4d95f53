"""What words say of methods and runs: "of second order", "halves the error", "stable for no h", "falls by", "too low".

Each is read as a question for what it says: an order, a power of 2 to it, a limit, or what has the sign of a change.
"""

from __future__ import annotations

import re
from fractions import Fraction

from driftproof.texts.words.contradictions import asked_quantity, asked_settings, runs_asked
from driftproof.texts.words.heads import PAIR
from driftproof.texts.words.method_names import (
    flat,
    last_methods_named,
    methods_named,
    name_before,
    names_before,
    names_in_order,
    spoken_names,
)
from driftproof.texts.words.places import COMPARED
from driftproof.texts.words.stated_facts import IN_DOUBT, OF_SOMETHING_ELSE, Linear, fact_of, limit_of_steps

# What an order is not of.
_OF_PART = re.compile(
    r"\b(?:errors?|th(?:at|ose) of|truncation|terms?|defects?|residuals?|solutions?|predict\w+|equations?)\b"
)
_IS_OF = r" (?:is|was)(?: also| indeed)?(?: an?| of(?: the)?)? "
_ARE_OF = r" (?:are|were)(?: also| both| all)? of(?: the)? "
_OF_WORD = r" (?:is|are|was|were)(?: also| both| all)? of(?: the)? \w+"
_SAID_BEFORE = re.compile(rf"{_OF_WORD} order\b")
_LISTED_BEFORE = re.compile(rf"{_OF_WORD}(?: order\b|,| and )| (?:is|was) an? \w+ order\b")
# Behind an order whose word stands at another method of the sentence.
_ENDS_LISTED = re.compile(r" ?(?:[.,;:)]|\Z)| and ")
# Behind the order of a method, before what follows of it: ", so that", ":".
_FOLLOWS = r"[:,]?(?: (?:so|and|that|hence|thus|then|is))*:? *"
_ABOUT = r"(?:about |roughly |nearly |almost |approximately )?"
_CALLED = (
    r" order (?:accurate |explicit |implicit )*(?:(?:adams \w+|runge kutta|bdf)(?: method| scheme| formula)? \(?)?"
)
# Behind the name of a method that is no part of a longer name, as in "a second-order RK4 comparison".
_ENDS_NAME = (
    r"(?:'s)?(?: ?(?:[.,;:()|]|\Z)| (?:methods?|rules?|schemes?|formulas?|integrators?|steps?|is|was|has|had|and|or|"
    r"but|with|for|at|on|in|to|of|needs?|gives?|uses?|takes?|makes?|reaches|does|can|will|which|that|as|by|than)\b)"
)
_ENDS_ORDER = re.compile(r" order(?= ?[,;:)]|\.?\s*\Z| and | but | accura| method| scheme| integrator| ones?\b)")
# Before a step that gets smaller, or larger; and the step sizes from one to another.
_GETS = {
    -1: re.compile(
        r"\bhal(?:ving|ves?|f)(?: of)?(?: the| its)? (?:(?:time )?step|h\b)|"
        r"\b(?:step(?: ?size)?|h)(?: \w+){0,2} halved|"
        r"\b(?:smaller|shorter|finer) (?:time )?step"
    ),
    1: re.compile(
        r"\b(?:doubl(?:ing|es?)|twice)(?: of)?(?: the| its)? (?:(?:time )?step|h\b)|"
        r"\b(?:step(?: ?size)?|h)(?: \w+){0,2} doubled|"
        r"\b(?:larger|longer|coarser) (?:time )?step"
    ),
}
_STEP_GIVEN = re.compile(r"\bh ?=|\bfrom\b")
# Of what is good, not of an error.
_GOOD = re.compile(r"\b(?:accura\w+|precis\w+|digits?|efficien\w+|speed|cost|work|time|evaluations?|stable|interval)\b")
_NUMBER_BEHIND = re.compile(
    r"(?: (?!and\b|or\b|but\b)[a-z][\w'-]*){0,8}?,? by (?:(?:about|only|roughly|some|an?|the|factors?|of) )*\Z"
)
_NUMBER_BEFORE = re.compile(r" ?(?:(?:\w{1,2}|%|percent) )?(?:(?:times(?: as)?|too) )?\Z")
_POWERS_OF_TWO = ("two", "four", "eight", "sixteen")


def fact_in_word(word: str, before: str, after: str, equation: Linear | None) -> str | None:
    """The fact, as a question, that a word of a sentence in lower case gives, or None.

    >>> fact_in_word("third", "heun's method is of ", " order.", None)
    'order heun2'
    >>> fact_in_word("doubles", "halving the step ", " the error of rk4.", None)
    '1/power(2, order rk4)'
    """
    adjective, before, after = after.startswith("-order"), flat(before), flat(after)
    steps, before = before, _GETS[-1].sub("", _GETS[1].sub("", before))
    if OF_SOMETHING_ELSE.search(before):
        return None
    if after.startswith(" order") or (before.endswith(" of ") and _ENDS_LISTED.match(after)):
        clause = re.split(r", (?:and|but|while|whereas) ", before)[-1]  # of a method that it names itself
        if _OF_PART.search(clause) or IN_DOUBT.search(before) or OF_SOMETHING_ELSE.search(re.split("[.,;:]", after)[0]):
            return None
        # RK4 is of fourth order, Heun of second
        verb = rf"{_IS_OF}| (?:of|an?) " if _LISTED_BEFORE.search(before) else _IS_OF
        ends = _ENDS_ORDER.match(after) or _ENDS_LISTED.match(after)
        name = name_before(before, verb) if ends else None
        name = name or (_name_behind(after, _CALLED, _ENDS_NAME) if adjective and not before.endswith("'s ") else None)
        listed = names_before(before, _ARE_OF) if ends else []
        own = methods_named(name) if name else methods_named(", ".join(listed)) if listed[1:] else set[str]()
        return fact_of("order", own) if own else None
    if found := re.search(r"\bstable (?:for|at|with) \Z", before):
        only = re.match(r" (?:h|(?:time )?step ?sizes?)(?= at all|[,;:)]|\.? ?\Z| and | but | > 0)", after)
        return limit_of_steps(last_methods_named(before[: found.start()]), equation, "h") if only else None
    smaller = _signs_of_step(steps)
    if len(smaller) != 1 or _STEP_GIVEN.search(before + after):
        return None
    name = _name_of_error(word, re.sub(" +", " ", before), after)
    order = fact_of("order", methods_named(name)) if name else None
    inverse = "1/" * (smaller == [-1] and word not in _POWERS_OF_TWO)
    return f"{inverse}power(2, {order})" if order else None


def _name_of_error(word: str, before: str, after: str) -> str | None:
    """The name of the method whose error a word says to change: beside it, or that whose order was just told."""
    said = _SAID_BEFORE.search(before)
    subject, rest = (name_before(before[: said.start()], ""), before[said.end() :]) if said else (None, "")
    if word not in _POWERS_OF_TWO:
        own = re.match(r" the errors?(?= ?(?:[.,;:)]|\Z)| and )", after) and re.fullmatch(_FOLLOWS, rest)
        return subject if own else _name_behind(after, " the errors? of (?:the )?")
    if not re.match(" times (?!.*than)", after):
        return None
    if re.search(r"\b(?:errors?|that) of (?:the )?\S+(?: \S+){0,4} \Z", before):
        return name_before(before, rf" (?:is |becomes )?{_ABOUT}")
    follows = rf"{_FOLLOWS}(?:makes )?(?:the|its) errors? (?:is |becomes )?{_ABOUT}"
    return subject if re.fullmatch(follows, rest) else None


def _name_behind(after: str, words: str, ends: str = "") -> str | None:
    """The name of a method behind these words, with which the rest of a sentence begins, before what `ends` it."""
    said = re.match(words, after)
    name = spoken_names().match(after, said.end()) if said else None
    return name[0] if name and re.match(ends, after[name.end() :]) else None


def gap_to_number(before: str, after: str) -> bool:
    """True if what stands between a word for a change and a number says that the number is by how much."""
    between = (before or after).replace("\n", " ")
    return (_NUMBER_BEHIND if after else _NUMBER_BEFORE).match(between) is not None


def signed_by(question: str, far: str, before: str, after: str) -> str | None:
    """The question whose sign the direction said of a value is, from the sentence in lower case; None if unclear.

    That is a change of energy, an error as numerical minus exact, and of a ratio of two errors what the step, or the
    method, does to the error. The text `far` before the sentence of its clauses may say how the step changes.
    """
    if question.startswith("power(") and (sign := _direction(far + before + after)):
        return f"{'-' * (sign < 0)}{question}"
    question = re.sub(r"\Apercent\((.*), 1\)\Z", r"\1", question)
    quantity, runs = asked_quantity(question)[0], runs_asked(question)
    clause = flat(before.rpartition(",")[2])
    if _GOOD.search(clause):
        return None
    if quantity == "energy" and "_change" in question and not re.search(r"\b(?:errors?|drift)\b", clause):
        return re.sub(r"\Aabs\((.*)\)\Z", r"\1", question)
    if quantity in ("error", "relative_error"):
        unknowns = re.findall(r"(\w+)'+=", question)
        run, _, of = question.rpartition(f" : {quantity}")
        name = of.removeprefix(".") or unknowns[0] if of or len(unknowns) == 1 else None
        return f"{run} : {name} - {run} : exact.{name}" if name and run.startswith("run ") else None
    if quantity not in COMPARED or not question.startswith("ratio(") or len(runs) != 2:
        return None
    if runs[0] == runs[1]:
        sizes, sign = asked_settings(question)["h"], _direction(far + before + after)
        clear = len({*sizes}) == 2 and sign and not after.startswith(" than")
        return _minus_one(question, (sizes[0] > sizes[1]) == (sign < 0)) if clear else None
    named, keys = [methods_named(x) for x in names_in_order(far + before)], [methods_named(run) for run in runs]
    told = re.search(r"\bits error is \S+ times(?: as)? \Z", clause) and named in (keys, keys[::-1])
    return _minus_one(question, keys[1] == named[0]) if told else None


def _minus_one(question: str, divided: bool) -> str:
    """The sign of what happens to an error from the one to the other of two."""
    return f"1 - {question}" if divided else f"{question} - 1"


def _direction(text: str) -> int:
    """-1 where the text says that a step gets smaller, 1 for larger, 0 for both or neither."""
    signs = [-1 if Fraction(y) < Fraction(x) else 1 for x, y in PAIR.findall(text)[-1:]] or _signs_of_step(text)
    return signs[0] if len(signs) == 1 else 0


def _signs_of_step(text: str) -> list[int]:
    """-1 if words say that a step gets smaller, 1 if they say that one gets larger."""
    return [sign for sign, words in _GETS.items() if words.search(text)]
