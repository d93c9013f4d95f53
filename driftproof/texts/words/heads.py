"""What the head of a column says of its numbers: a setting, a number of a step, an unknown, a fact or a quantity."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from fractions import Fraction
from itertools import pairwise

from driftproof.texts.readers.number_words import COUNT_GIVEN, TIME_UNIT
from driftproof.texts.words.contradictions import ENERGY, POSITIVE, SETTING
from driftproof.texts.words.method_names import methods_named, spoken_names

# Words for the logarithm of the ratio of two errors.
OBSERVED = (
    r"(?:observed|experimental|measured|estimated|apparent) (?:\w+ )?(?:orders?|rates?)|orders? observed|eoc|"
    r"log ?_?2 of (?:the |a )?(?:ratio|quotient)s?(?: of (?:\w+ ){0,2}errors)?"
)
# From one step size to another, of a row or a column.
PAIR = re.compile(rf"(?:\bfrom\s|\A)(?:h\s?=\s?)?{POSITIVE}\s?(?:to|→)\s(?:h\s?=\s?)?{POSITIVE}")
# The head of a column of observed orders, beside step sizes.
ORDER_OF_COLUMN = r"(?:convergence )?(?:orders?|rates?)"
_MOST_OF = r"(?:largest|biggest|greatest|worst|max(?:imum|imal)?\.?)"
_DRIFT = r"(?:errors?|drift|change|deviation)"
# Quantity -> the words that name it; the last of these words before a number, or in its column's head, counts.
# What is largest on the way is not what is at the end; no readout gives the largest part of something.
QUANTITY_WORDS = {
    "observed_order": OBSERVED,
    "largest_part": rf"{_MOST_OF} relative \w+",
    "largest_energy_change": rf"{_MOST_OF} {ENERGY}(?: {_DRIFT})?|{_MOST_OF} {_DRIFT} (?:of|in) (?:the )?{ENERGY}",
    "largest_error": rf"{_MOST_OF} (?:\w+ )?errors?",
    "stability": r"stability functions?|amplification factors?|growth factors?|r\((?:z|h ?λ)\)",
    "relative_energy": rf"relative {ENERGY}(?: (?:errors?|drift|change))?",
    "energy": rf"{ENERGY}(?: (?:errors?|drift|change))?|δe",
    "ratio": r"factors?|ratios?|times as|divides",
    "embedded": r"embedded (?:solution|value|result|formula|method)|companion",
    "estimate": r"estimates?(?: of (?:the|its) error)?|error estimates?",
    "relative_error": r"relative(?: errors?)?",
    "error": r"errors?|distances?(?: (?:to|from) the (?:exact |true )?(?:state|solution|value|truth)s?)?|"
    r"e_n|"
    r"off(?= by)|wrong|deviat\w+|differ\w+",
    "exact": r"exact|true|truth|solution|analytical",
    "evaluations": r"evaluations|calls",
    "slope": r"slopes?|gradients?",
}
QUANTITY = re.compile("|".join(rf"(?P<{name}>\b(?:{words}))\b" for name, words in QUANTITY_WORDS.items()))
# The head of the column of an unknown, and of one that has an index, as y_n.
HEAD_OF_UNKNOWN = re.compile(r"(?P<name>[^\W\d_]'?)(?P<index>_\{?[nijk]\}?)?(?: ?\([^()]*\))?")
# The head of numbers of steps, called so once its column is known to have them.
STEP = "step number"
_STEP = re.compile(r"(?:time ?)?step(?: ?(?:no\.?|n|k|i|j|#))?|step number")
_COUNT = re.compile(r"[nkij]|N|[Ss]teps")
SETTING_HEADS = {
    "h": r"h|dt|δt|step(?: ?size)?",
    "t": rf"t(?:_[ni])?|t_\{{?n\}}?|time|{TIME_UNIT}s?",
    "n": r"n|(?:number of |n_?)?steps",
    "s": STEP,
    "z": r"z|h ?[*·]? ?λ",
}
# The head of a column of limits of step sizes, as in "h max" and "largest stable step", and the fact that it gives.
LIMIT_OF_STEPS = "limit_of_steps"
_STEP_SIZE = r"(?:h|[dδ]t|(?:time ?)?steps?(?:[ -]?sizes?)?)\b"
_LARGEST = r"(?:largest|biggest|longest|max(?:imal|imum)?\b\.?)(?: (?:stable|allowed|permitted|possible|safe))*"
# Fact of a method -> what the head of its column says.
_FACTS = {
    LIMIT_OF_STEPS: rf"(?:{_LARGEST} {_STEP_SIZE}|(?:h|[dδ]t)[_ ]?\{{?(?:max|crit)\w*\}}?|"
    rf"(?:stable (?:for|if|up to|while)|(?:limit|bound) (?:of|on|for)(?: the)?) {_STEP_SIZE}|"
    rf"{_STEP_SIZE}[ -](?:limit|bound))(?: ?[<≤(\[,].*)?\Z",
    "stages": r"stages?\b",
    "evaluations_per_step": r"(?:\w+ )?(?:evaluations?|calls?) (?:per|a|in each) step\b",
    "error_constant": r"error constant",
    "imaginary_limit": r"(?:.*\b(?:interval|limit|bound).*)?\bimaginary\b",
    "real_limit": r"(?:.*\b(?:interval|limit|bound).*)?\b(?:negative )?real\b",
    "limit_at_infinity": r"r\((?:∞|oo)\)",
    "order": r"(?:order|p\Z)\b",
}


def fact_in_column(head: str) -> str | None:
    """The fact about methods that a column with this head, in lower case, gives."""
    return next((fact for fact, said in _FACTS.items() if re.match(said, head)), None)


def leaves_quantity(head: str, unknowns: Collection[str]) -> bool:
    """True if the head of a column names a method, a step size or a time only: what is read stands above the table."""
    given = [*(SETTING[x] for x in "ht"), COUNT_GIVEN, PAIR]
    named = methods_named(head) or any(said.search(head) for said in given)
    of_unknown = HEAD_OF_UNKNOWN.fullmatch(without_methods(head))
    return bool(named) and not QUANTITY.search(head) and not (of_unknown and of_unknown["name"] in unknowns)


def without_methods(head: str) -> str:
    """The head without the name of a method, as Euler's y is y."""
    return re.sub(r"\A's? ?", "", spoken_names().sub("", head).strip())


def is_head_of(settings: str, head: str) -> bool:
    """True if the head of a column, in lower case, is that of values of one of the settings h, t, n and z."""
    return any(re.fullmatch(rf"(?:{SETTING_HEADS[x]})(?: ?[(\[](?![0-9]).*)?", head) for x in settings)


def is_of_steps(head: str, cells: Sequence[str], heads: Collection[str]) -> bool:
    """True if the cells below the head, as written, are numbers of steps: their heads say so, or they are 0, 10, 20.

    Numbers of steps of several runs go up by factors, as 10, 20 and 40 do; beside y_n, n is that of a step.
    """
    if not cells or not all(re.fullmatch("0|[1-9][0-9]{0,5}", cell) for cell in cells):
        return False
    numbers = [*map(int, cells)]
    apart = {later - earlier for earlier, later in pairwise(numbers)}
    if _STEP.fullmatch(head.lower()):
        return all(difference > 0 for difference in apart)
    indexed = any((found := HEAD_OF_UNKNOWN.fullmatch(one.lower())) and found["index"] for one in heads)
    even = len(apart) == 1 and min(apart) > 0 and numbers[0] < 2 and (len(numbers) > 2 or apart == {1})
    by_factors = len({Fraction(later, earlier) for earlier, later in pairwise(numbers) if earlier}) == 1
    return _COUNT.fullmatch(head) is not None and (even or (indexed and not by_factors))
