"""Questions about the problems that a text states, with the methods, step sizes and times that it gives."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import chain, compress, pairwise, product

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.multistep import Multistep
from driftproof.texts.claims.contradictions import (
    SETTING,
    methods_compared,
    methods_in_full,
    methods_named,
    sentence_around,
    sentence_before,
    starters_said,
)
from driftproof.texts.claims.heads import OBSERVED, ORDER_OF_COLUMN, QUANTITY, is_head_of
from driftproof.texts.claims.places import OF_EACH_STEP
from driftproof.texts.claims.possible_values import COUNT_OF_STEPS, SHARE
from driftproof.texts.claims.stated_problems import MOST_PROBLEMS, NUMBER, StatedProblem, stated_problems
from driftproof.texts.questions.pieces import with_greek_spelled
from driftproof.texts.readers.number_words import COUNT_GIVEN, PERCENT, TIME_UNIT, counts_of_steps, durations
from driftproof.texts.readers.numbers import TextNumber, numbers_in

# Limits that keep this to some hundred questions, and to runs of so many steps in all for each problem: seconds.
_MOST_METHODS, _MOST_SIZES, _MOST_TIMES, _MOST_STEPS = 8, 8, 24, 30_000
_MOST_COUNTED, _MOST_STARTERS, _MOST_ENDS, _MOST_ARGUMENTS, _MOST_LATE = 10_000, 4, 2, 24, 4
_USUAL_STARTERS = ("forward_euler", "heun2", "rk4", "exact")
_LIST = rf"{NUMBER}(?:(?:,? (?:and |or )?|,){NUMBER})*"
_SIZES = re.compile(  # no h = 2√u and no h(3/2 f_n
    rf"(?:(?<![\w/])(?:h|dt|Δt) ?[=∈≈]|(?:[Ss]tep ?sizes?(?: of)?|[Ss]teps of)(?: ?[=∈≈])?) ?[{{(]?({_LIST})"
    r"(?! ?[*·√]| ?[^\W\d]_)"
)
# Words before the limit of a step size, as in stable up to h = 1.4.
LIMIT = re.compile(
    r"\b(?:up to|out to|until|at most|stable for|limit|largest step|allows?|tolerates?|permits?|needs?|requires?|below|"
    r"(?:may|can) (?:take|use|be)|and \w+(?: \w+)? only)\b[^.;,]{0,20}\Z"
)
# A number of steps that goes with a step size, as in "takes 20 steps of h = 0.05".
_TAKES = re.compile(r"[0-9] steps (?:of|with) |\b(?:needs?|takes?|makes?|costs?) [0-9]+ steps")
_TIMES = re.compile(rf"(?<!\w)(?:[tT] ?[=∈]|{TIME_UNIT}s?) ?[{{(]?({_LIST})")
# Characters before a step size in which a word may make it a limit.
_BEFORE = 80


def stated_questions(text: str, column_of: Callable[[TextNumber], str]) -> list[str]:
    """Questions, with braces, about the problems that a text in canonical spelling states with their starts.

    The methods, step sizes and times are those that the text names after the equations, the methods else those that it
    names anywhere; `column_of` gives the head of the column of a number.
    """
    found, known = list[tuple[StatedProblem, str]](), dict[tuple[tuple[str, str], ...], str]()
    for problem in stated_problems(text):
        rates = tuple(problem.rates.items())
        if rates not in known and len(known) == MOST_PROBLEMS:
            continue
        # Where the equations stand again without a start, it is that of before.
        if equations := (problem.equations or known.get(rates) if rates else None):
            known[rates] = equations
        if problem.aside or not equations:  # what is said in passing does not end the problem before it
            found = [(one.going_on(problem), said) for one, said in found]
        if equations:
            found.append((problem, equations))
    asked = (_questions(*one, text, column_of) for one in found)
    return list(dict.fromkeys(chain(*asked, _stability_questions(text, column_of))))


def _stability_questions(text: str, column_of: Callable[[TextNumber], str]) -> Iterator[str]:
    """What stability functions are at the arguments that a text gives, also in columns."""
    rows = [x.text for x in numbers_in(text) if re.fullmatch(NUMBER, x.text) and is_head_of("z", column_of(x))]
    arguments = list(dict.fromkeys((*SETTING["z"].findall(text.lower()), *rows)))[:_MOST_ARGUMENTS]
    if arguments and (methods := [key for key in METHODS if key in methods_named(text.lower())]):
        yield f"stability_function {{{','.join(methods[:_MOST_METHODS])}}} z={{{','.join(arguments)}}}"


def _questions(
    problem: StatedProblem, equations: str, text: str, column_of: Callable[[TextNumber], str]
) -> Iterator[str]:
    part, at = with_greek_spelled(problem.part), problem.at
    value_at = re.compile(rf"(?<!\w)(?:{'|'.join(problem.rates)})\(({NUMBER})\)")
    sizes, times, counts, also = (_listed(pattern, part) for pattern in (_SIZES, _TIMES, COUNT_GIVEN, value_at))
    times += [*also, *map(Fraction, durations(part))]
    said, rows, counts_of_runs = counts_of_steps(part), list[Fraction](), [*counts]
    counts += [Fraction(n) for n in said if n < _MOST_COUNTED]
    for number in numbers_in(text[at : at + len(problem.part)]):
        head = column_of(replace(number, start=number.start + at, end=number.end + at))
        for letter, into in (("h", sizes), ("t", times), ("n", counts_of_runs), ("s", rows)):
            if is_head_of(letter, head) and re.fullmatch(NUMBER, number.text):
                into.append(Fraction(number.text))
    sizes, times = (sorted({x for x in numbers if x > 0}) for numbers in (sizes, times))
    counts += counts_of_runs
    if (counts_of_runs and len(times) <= _MOST_ENDS) or not sizes:
        sizes = sorted({*sizes, *(t / n for t in times for n in (counts_of_runs or counts) if n)})
    times = times or sorted({n * h for n in counts for h in sizes})
    after = {int(n) for n in re.findall(rf"(?<!\w)(?:{'|'.join(problem.rates)})_([1-9])(?!\w)", part)}
    after |= {1} if re.search(r"\b(?:first|single) step\b", part.lower()) else {n for n in said if n < _MOST_TIMES}
    after |= {1} if problem.energy and OF_EACH_STEP.search(part.lower()) else set()
    with_slopes = re.search(r"k_?1\b|\bslopes\b", part) is not None
    after |= {1} if with_slopes else set()
    after |= {n for n in map(int, rows) if n}
    times = sorted({*times, *(n * h for n in after for h in sizes)})
    multistep = {
        key for key, method in FURTHER_METHODS.items() if isinstance(method, Multistep) and method.derivative == 1
    }
    known = multistep | {*METHODS}
    named_anywhere = methods_named(text.lower()) & known  # Verlet's method is that which has its whole name elsewhere
    spoken = methods_named(part.lower()) & named_anywhere or named_anywhere
    if "explicit" in text.lower() and "implicit" not in text.lower():
        spoken -= {key for key in METHODS if key.startswith("implicit")}  # of what midpoint may mean
    in_full = methods_in_full(text.lower())  # before those that Ralston may mean, too
    chosen = [key for key in sorted(METHODS, key=lambda key: key not in in_full) if key in spoken][:_MOST_METHODS]
    many, left = len(chosen) + len(spoken & multistep), Fraction(_MOST_STEPS)
    starters = starters_said(part.lower()) or _USUAL_STARTERS
    named = [f"{{{','.join(chosen)}}}"] * bool(chosen)
    named += [f"{{{key}}} started={by}" for key in sorted(spoken & multistep) for by in starters[-_MOST_STARTERS:]]
    if ends := ",".join(map(_shown, times[-_MOST_TIMES:])):
        yield f"exact {equations}, t={{{ends}}} : {{{','.join(problem.rates)}}}"
    if problem.energy:
        yield f"exact {equations}, energy={problem.energy}, t={{{','.join(['0', *filter(None, [ends])])}}} : energy"
    errors = ["error", *(f"error.{name}" for name in problem.rates if len(problem.rates) > 1)]
    errors += ["position_error"] * (2 * len({*problem.rates} & {*problem.rates.values()}) == len(problem.rates) > 2)
    spoken_of = {found.lastgroup for found in QUANTITY.finditer(part.lower())}
    changes = ["energy_change", *["largest_energy_change"] * ("largest_energy_change" in spoken_of)]
    percent = re.search(PERCENT, part)
    read = [*problem.rates, *errors, *["largest_error"] * ("largest_error" in spoken_of)]
    read += ["relative_error"] * bool(percent or "relative" in part)
    read += ["evaluations"] * bool(re.search("evaluation|calls", part)) + ["steps"] * bool(_TAKES.search(part))
    of = {key: f"{key} started={starters[-1]}" if key in multistep else key for key in spoken}
    compared = [[of[key] for key in pair] for pair in _compared(part.lower()) if {*pair} <= {*of}]
    runs, late = list[tuple[Fraction, list[Fraction]]](), list[tuple[Fraction, list[Fraction]]]()
    longer = defaultdict[Fraction, list[int]](list)  # as in "after 1000 steps", of the step size before
    for found in [x for x in COUNT_OF_STEPS.finditer(part) if _MOST_TIMES <= int(x[1]) < _MOST_COUNTED][:_MOST_LATE]:
        for size in SETTING["h"].findall(part[: found.start()])[-1:]:
            longer[Fraction(size)].append(int(found[1]))
    for group, h in product((runs, late), sizes[::-1][:_MOST_SIZES] if named else ()):
        ends_of = times if group is runs else sorted({n * h for n in longer[h]} - {*times})
        fitting = [t for t in ends_of if (t / h).denominator == 1 and many * t / h <= left]
        if fitting := fitting[-_MOST_TIMES:]:
            left -= many * max(fitting) / h
            group.append((h, fitting))
            ends = ",".join(map(_shown, fitting))
            for pair in compared:
                each = (f"run {key} {equations}, h={{{_shown(h)}}}, t={{{ends}}} : error" for key in pair)
                yield f"ratio({', '.join(each)})"
            for methods in named:
                yield f"run {methods} {equations}, h={{{_shown(h)}}}, t={{{ends}}} : {{{','.join(read)}}}"
                if problem.energy:
                    conserved = f"run {methods} {equations}, energy={problem.energy}, h={{{_shown(h)}}}, t={{{ends}}}"
                    yield f"{conserved} : {{{','.join(('energy', *changes))}}}"
                    yield from (f"abs({conserved} : {change})" for change in changes)
                    relative = [f"{conserved} : relative_energy_change", f"abs({conserved} : relative_energy_change)"]
                    shares = map(SHARE.format, relative) if percent else ()
                    yield from relative if "relative energy" in part.lower() else shares
            pairs = [key for key in chosen if getattr(METHODS[key], "b_embedded", None)]
            if pairs and re.search("embedded|companion|estimate", part):
                for name in problem.rates:
                    step = f"step {{{','.join(pairs)}}} {equations}, h={{{_shown(h)}}}"
                    yield from (f"{step} : embedded.{name}", f"abs({step} : estimate.{name})")
            if chosen and with_slopes:
                slopes = ",".join(f"k{i}.{name}" for i in (1, 2, 3, 4) for name in problem.rates)
                yield f"step {named[0]} {equations}, h={{{_shown(h)}}} : {{{slopes}}}"
    of_ratios = [
        bool(re.search(words, part.lower()))
        for words in (
            "factor|ratio|times (?:as|smaller|larger)|divides|fall by",
            rf"{OBSERVED}|\| ?{ORDER_OF_COLUMN} ?\|",
        )
    ]
    for (h, fitting), (shorter, also) in pairwise(runs) if any(of_ratios) else ():
        ends = ",".join(_shown(t) for t in fitting if t in also)
        for methods, error in product(named if ends else (), errors):
            both = [f"h={x}, t={{{ends}}} : {error}" for x in (f"{{{_shown(h)}}}", _shown(shorter))]
            ratio = f"ratio({', '.join(f'run {methods} {equations}, {rest}' for rest in both)})"
            order = f"log2({ratio})" if h == 2 * shorter else f"ln({ratio})/ln({h / shorter})"
            yield from compress((ratio, order), of_ratios)


def _compared(text: str) -> Iterator[tuple[str, ...]]:
    """The methods whose errors a text in lower case compares, each pair once, the larger error first."""
    found = [x for x in numbers_in(text) if text.startswith(" times ", x.end)]
    yield from dict.fromkeys(
        pair
        for x in found
        if (pair := methods_compared(*sentence_around(text, x.start, x.end), sentence_before(text, x.start)))
    )


def _shown(x: Fraction) -> str:
    """A decimal that is the number, if it is short, else a fraction."""
    return f"{float(x):g}" if Fraction(f"{float(x):g}") == x else str(x)


def _listed(pattern: re.Pattern[str], text: str) -> list[Fraction]:
    """The numbers of the matches; no limits of step sizes."""
    chosen = (
        x
        for x in pattern.finditer(text)
        if pattern is not _SIZES or not LIMIT.search(text[max(0, x.start() - _BEFORE) : x.start()])
    )
    lists = ("".join(group or "" for group in match.groups()) for match in chosen)
    return [Fraction(x) for one in lists for x in re.findall(NUMBER, one) if len(x) < 20]
