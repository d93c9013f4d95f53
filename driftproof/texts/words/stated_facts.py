"""The facts of methods that a sentence gives: order, stages, evaluations, limits, also of step sizes, and properties.

A limit of h on y' = -50y is the real limit of the method / 50, and on x'' = -4x the imaginary one / 2.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.texts.questions.evaluate import limit_of_rates, value
from driftproof.texts.readers.number_words import counts_of_steps
from driftproof.texts.words.contradictions import LINEAR
from driftproof.texts.words.method_names import (
    flat,
    last_methods_named,
    methods_named,
    name_before,
    names_in_order,
    spoken_names,
)
from driftproof.texts.words.stated_problems import stated_problems

# Words near an order that is not the method's own.
OF_SOMETHING_ELSE = re.compile(
    r"\b(?:local\w*|embedded|estimat\w+|phase|dispersi\w+|dissipat\w+|reduc\w+|drops?|observed|linear|nonlinear|stiff|"
    r"weak|strong|stage|step|interpol\w+|dense|not|no|only|false|myth|true|wrong|energy|at infinity for|"
    r"extrapolat\w+|compos\w+)\b"
)
# Right before a number that bounds step sizes, or h times an eigenvalue; and what happens beyond the bound.
_BOUND = re.compile(
    r"(?:(?<![\w'])(?:(?P<scaled>h ?[*·]? ?(?:\|?(?:λ|lambda)\|?)|\|?(?:λ|lambda)\|? ?[*·]? ?h)|h|[dδ]t)|"
    r"(?<!fixed )(?:time ?)?step ?sizes?)"
    r"(?: ?(?:[<≤>≥]=?|\\leq?)|(?<=up to h) ?=|"
    r" (?:up to|below|above|beyond|at most|of at most|less than|smaller than)) ?\Z"
)
_BEYOND = re.compile(r"\b(?:unstable|blow\w* up|diverge\w*|explode\w*|grow\w*|beyond)\b")
_OF_STABILITY = re.compile(
    rf"\b(?:stab\w+|needs?|requires?|allows?|takes?|limits?|{_BEYOND.pattern[4:-3]}|overflow\w*|oscillat\w+)\b"
)
# Stages and evaluations behind a number, and before those that follow it, as in "10 evaluations, midpoint 20".
_UNIT = re.compile(
    r"[- \n](?:new |more |function )?(?:(?P<stages>stages?)|evaluations?|calls?)\b"
    r"(?P<each>(?: of [^.,;]{1,30})? (?:(?:per|each|in each|in every|for each) step|a step))?"
)
_EVALUATIONS = re.compile(
    r"\bevaluations?\b(?: (?:per|each|in each|every) step)?"
    r"(?:(?!\b(?:steps?|stages?|errors?|order)\b)[^;])*(?<![=≤≥<>] )\Z"
)
# What a sentence gives of one method after another, as in "on the imaginary axis RK4 reaches 2.83 and Heun 0".
_AXIS = re.compile(r"\b(?:(?P<axis>real|imaginary) axis|(?P<angle>angles?|sectors?))\b|[.?!]\s")
_REACHES = r"(?:,? (?:is|has|reaches|only|stable|up to|until|[α=≈≤<]|\|?h ?λ\|?))* ?"
_OF_STEPS = re.compile(r"[- \n](?:time )?steps?\b")
_EACH = re.compile(r"\bevaluations?\b[^.;]{0,40}\b(?:per|each|every) step\b")
_VERBS = (
    "(?: has| have| is| needs| takes| makes| uses| used| costs?| requires)?"
    "(?: has| used| only| just| exactly| already| a| an)*(?: \\w+ steps(?: and| or|,? which is|,? that is))? ?"
)


# Characters of the text about a problem in which its first equation stands.
_NEAR = 150

# Property -> the fact of that name.
_PROPERTIES = {"a-stable": "a_stable", "l-stable": "l_stable", "symplectic": "symplectic", "symmetric": "symmetric"}
# Words before a sentence, or in it, that ask, deny or doubt what it says, and how far before.
IN_DOUBT = re.compile(
    r"\b(?:myth|false|whether|if|unless|claims?|believes?|wrong|say|cannot|nobody|never|neither|nor)\b"
)
_FARTHEST = 250
# Before methods that are no subject, as in "the regions of A and B are", "but not A is"; and that are not both.
_OF_METHODS = re.compile(r"\b(?:of|for|by|in|with|to|from|on|between|not|than|(?:un)?like)(?: the)? ?\Z")
_NO_TWO = re.compile(r"\b(?:(?:un)?like|than|instead|compared|whereas|while|but)\b")


class Linear(NamedTuple):
    """A linear equation of a text from `at`: which limit is that of step sizes there, and what it is divided by."""

    at: int
    limit: str
    size: str


@lru_cache(maxsize=4)
def linear_equations(text: str) -> list[Linear]:
    """The equations of a text, where they begin; the limit is "" for those that are no y' = -cy or x'' = -cx.

    The size is "" for a letter that has no value.

    >>> linear_equations("On y' = -50y RK4 needs h <= 0.05.")
    [Linear(at=4, limit='real_limit', size='50')]
    """
    found = list[Linear]()
    for problem in stated_problems(text):
        at = problem.at + problem.part.index("'") if "'" in problem.part else problem.at
        named = LINEAR.search(problem.part[:_NEAR].lower()) if not problem.rates else None  # y' = -λy
        unsized = ("imaginary_limit" if named["second"] else "real_limit", "") if named else ("", "")
        found.append(Linear(at, *(limit_of_rates(problem.rates) or unsized)))
    return found


def is_bound(before: str) -> bool:
    """True if the lower-case sentence before a number says that the number bounds step sizes."""
    return _BOUND.search(before) is not None


def is_on_the_safe_side(before: str, x: Fraction, limit: Fraction) -> bool:
    """True if what is said of step sizes up to x, or beyond it, is true of a method with this limit."""
    return x > limit if _BEYOND.search(before) else x < limit


def fact_said(
    before: str, after: str, own: frozenset[str], equation: Linear | None, steps: Fraction | None, far: str = ""
) -> str | None:
    """The fact, as a question, that a number of a sentence in lower case gives, or None.

    That is so in "RK4, of order 4", "Heun has two stages", "R(∞) = 0" and "RK4 needs h ≤ 0.05"; the number is one of
    the methods `own`, if it is said whose it is, also of "A and B have orders 2 and 4". An axis or an angle is named
    in `far`, the text before.
    """
    if re.search(r"\b(?:neither|nor)\b", before):
        return None
    if bound := _BOUND.search(before):
        methods = own or last_methods_named(before)
        return limit_of_steps(methods, equation, bound["scaled"]) if _OF_STABILITY.search(before) else None
    if count := _count_said(before, after, steps):
        return count
    if (reach := name_before(flat(before), _REACHES)) and not _UNIT.match(after):
        axis, angle = next((x.groups() for x in reversed([*_AXIS.finditer(far)])), (None, None))
        in_degrees = after.lstrip("^{ ")[:1] == "°"
        if (angle if in_degrees else axis) is not None:
            return fact_of("angle" if in_degrees else f"{axis}_limit", _own_name(reach))
    before = re.sub(r"\b[\w-]+ stages? (?:per step )?and(?= order)", "", before)
    if OF_SOMETHING_ELSE.search(before) or OF_SOMETHING_ELSE.search(re.split("[.,;:]", after)[0]):
        return None
    if re.search(r"(?<![|\w])r\((?:∞|oo)\) ?= ?\Z", before):
        return fact_of("limit_at_infinity", own or last_methods_named(before))
    has = r"(?::|,?(?: with)?| has| is| have)?(?: (?:a|the|\w+'s)(?: \w+)? method)?(?: (?:of|the|a))*"
    found = name_before(re.sub('["“”]', "", flat(before)), rf"(?:{has} +| \()order (?:is |= ?)?")
    if re.search(r"\borders (?:of |are |= ?)?(?:[0-9]+(?:, ?| )(?:and )?)*\Z", before) and own:
        return fact_of("order", own)
    only = found and not re.match(r" ?(?:\(|to\b|or\b|[-+*/^])", after)
    return fact_of("order", _own_name(found)) if found and only else None


def limit_of_steps(methods: Iterable[str], equation: Linear | None, scaled: str | None = None) -> str | None:
    """The limit of h of a method on a linear equation, of hλ if it is `scaled`; None for other equations."""
    fact = fact_of(equation.limit, methods) if equation and equation.limit else None
    if not (fact and equation) or not (scaled or equation.size):
        return None
    size = f"({equation.size})" if "/" in equation.size else equation.size
    return fact if scaled or size == "1" else f"{fact} / {size}"


def _count_said(before: str, after: str, steps: Fraction | None) -> str | None:
    """The stages or evaluations of a method behind whose name the number stands; the latter in each step, or in all."""
    unit = _UNIT.match(after)
    name = name_before(re.sub(r"(?: with| and)? [htn] ?= ?[0-9./]+", "", flat(before)), _VERBS)
    if unit and unit[1]:
        return fact_of("stages", _own_name(name)) if name else None
    named = {key: METHODS.get(key) for key in (_own_name(name) if name else ())}
    schemes = {key: scheme for key, scheme in named.items() if getattr(scheme, "explicit", True)}
    if _OF_STEPS.match(after) or re.match(r"[^.;,]*\bwith\b", after):  # the latter of an estimate of the error
        return None
    if not (unit or _EVALUATIONS.search(before)) or not all(isinstance(x, RungeKutta) for x in schemes.values()):
        return None
    fact = fact_of("evaluations_per_step", schemes)
    if (unit and unit["each"]) or _EACH.search(before):
        return fact
    count = next(iter(counts_of_steps(before)[::-1]), steps)
    return f"{count}*{fact}" if count and fact else None


def _own_name(name: str) -> set[str]:
    """The methods that a name means; "a Runge-Kutta method of order two" is of a family."""
    return set() if re.fullmatch(r"(?:explicit )?runge[- ]kutta(?: method)?", name) else methods_named(name)


def fact_of(fact: str, methods: Iterable[str]) -> str | None:
    """The question for the fact of a method, or of several that have the same; None for another or no value."""
    keys = sorted(methods)
    if len(keys) == 1 and fact not in ("stages", "evaluations_per_step"):
        return f"{fact} {keys[0]}"
    found = {}
    for key in keys:  # the stages and evaluations of a splitting are counted in several ways
        if fact != "order" and isinstance(METHODS.get(key), Splitting):
            return None
        with suppress(ValueError):
            found[key] = value(f"{fact} {key}").exact
        with suppress(ValueError):  # a last stage that is the first one of the next step counts or not
            if fact == "stages" and value(f"evaluations_per_step {key}").exact != found[key]:
                return None
    return f"{fact} {keys[0]}" if len({*found.values()}) == 1 and len(found) == len(keys) else None


class Said(NamedTuple):
    """A phrase of the text at `start`, the fact that it states as a question, yes or no, and whether that is so."""

    start: int
    phrase: str
    question: str
    answer: str
    holds: bool


def properties_in(text: str) -> Iterator[Said]:
    """The sentences of a text in canonical spelling that say of methods that they have a property or have it not.

    They name one method or several, as in "neither A nor B is", and one or two properties, as in "is neither A- nor
    L-stable"; "both are" is said of the two that are named before.
    """
    what, of = "|".join(_PROPERTIES), rf"(?:{spoken_names().pattern})(?:'s)?(?: (?:method|rule|scheme))?"
    said = rf"(?:(?:(?P<none>neither )(?:the )?)?(?P<of>{of}(?:(?:, | and |, and | nor )(?:the )?{of})*)"
    said += r"(?:, [^,.;]{1,30},)?|(?P<two>both|neither)) (?:is|are)(?: both| also)? "
    # "not A- and L-stable" may deny one of them only.
    both = rf"(?<!not )[al]-(?=,? (?:and|but) (?:not )?[al]-stable)|(?:{what})\b"
    said += rf"(?:(?P<no>not )?(?P<what>{both})(?:,? (?:and|but|or) (?P<no2>not )?(?P<what2>{what})\b)?|"
    said += rf"neither (?P<first>a-|l-|{what}) nor (?P<second>{what})\b)(?! ?\?)"
    lower = text.lower()
    # A hyphen or the end of a line may stand for each blank of a name.
    for match in re.finditer(re.sub(r"\\? ", "[-_ \n]", said), lower):
        before = re.split(r"[.?!]\s|\n\n", lower[max(0, match.start() - _FARTHEST) : match.start()])[-1]
        names = names_in_order(match["of"] or before)
        none = "neither" in (match["none"] or match["two"] or "") or match["first"] is not None
        said_of = re.sub("neither|nor" if none else "\n\n", "", match[0])  # what else is in doubt
        if IN_DOUBT.search(before + said_of) or _OF_METHODS.search(before):
            continue
        if match["two"] and (len(names) != 2 or _NO_TWO.search(before)):
            continue
        phrase = text[slice(*match.span())].replace("\n", " ")
        found = (("no", "what"), ("no2", "what2"), ("no", "first"), ("no", "second"))
        for no, fact in ((x, _PROPERTIES[re.sub("-$", "-stable", match[y])]) for x, y in found if match[y]):
            for name in names:
                answer, has = "no" if match[no] or none else "yes", dict[str, str | None]()
                for key in sorted(methods_named(name)):  # of leapfrog, both
                    with suppress(ValueError):  # a fact that a multistep method has not
                        has[key] = value(f"{fact} {key}").exact_text
                if {*has.values()} in ({"yes"}, {"no"}):
                    question = f"{fact} {next(iter(has))}"
                    yield Said(match.start(), phrase, question, answer, answer in has.values())
