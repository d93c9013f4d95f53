"""Questions about the problems that a text states, with the methods, step sizes and times that it gives."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain, compress, islice, pairwise, product

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.multistep import Multistep
from driftproof.texts.drafts.possible_values import COUNT_OF_STEPS, SHARE
from driftproof.texts.questions.pieces import with_greek_spelled
from driftproof.texts.readers.number_words import COUNT_GIVEN, PERCENT, TIME_UNIT, counts_of_steps, durations
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.words.contradictions import ENERGY, SETTING, methods_compared, sentence_around, sentence_before
from driftproof.texts.words.heads import OBSERVED, ORDER_OF_COLUMN, QUANTITY, is_head_of
from driftproof.texts.words.method_names import methods_in_full, methods_named, starters_said
from driftproof.texts.words.places import OF_EACH_STEP
from driftproof.texts.words.stated_problems import MOST_PROBLEMS, NUMBER, StatedProblem, stated_problems

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
    r"\b(?:(?:up to|out to|until)(?! ?t\b)|at most|stable for|limit|largest step|allows?|tolerates?|permits?|"
    r"needs?|requires?|below|(?:may|can) (?:take|use|be)|and \w+(?: \w+)? only)\b[^.;,]{0,20}\Z"
)
# A number of steps that goes with a step size, as in "takes 20 steps of h = 0.05".
_TAKES = re.compile(r"[0-9] steps (?:of|with) |\b(?:needs?|takes?|makes?|costs?) [0-9]+ steps")
_OF_RATIOS = "factor|ratio|times (?:as|smaller|larger|that of)|divide[sd]|fall by"
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
    asked = (_OfProblem(*one, text, column_of).questions() for one in found)
    return list(dict.fromkeys(chain(*asked, _stability_questions(text, column_of))))


def _stability_questions(text: str, column_of: Callable[[TextNumber], str]) -> Iterator[str]:
    """What stability functions are at the arguments that a text gives, also in columns."""
    rows = [x.text for x in numbers_in(text) if re.fullmatch(NUMBER, x.text) and is_head_of("z", column_of(x))]
    arguments = list(dict.fromkeys((*SETTING["z"].findall(text.lower()), *rows)))[:_MOST_ARGUMENTS]
    if arguments and (methods := [key for key in METHODS if key in methods_named(text.lower())]):
        yield f"stability_function {{{','.join(methods[:_MOST_METHODS])}}} z={{{','.join(arguments)}}}"


class _OfProblem:
    """The questions about one problem, with what the text after its equations names."""

    def __init__(
        self, problem: StatedProblem, equations: str, text: str, column_of: Callable[[TextNumber], str]
    ) -> None:
        self.problem, self.equations = problem, equations
        self.part = with_greek_spelled(problem.part)
        self.lower = self.part.lower()
        self.with_slopes = re.search(r"k_?1\b|\bslopes\b", self.part) is not None
        self.sizes, self.times = self._sizes_and_times(text, column_of)
        self._read_methods(text.lower())
        self._read_quantities()

    def questions(self) -> Iterator[str]:
        """The solution, its energy, the runs of all methods, and the ratios of their errors."""
        problem, runs = self.problem, [*self._runs()]
        if ends := ",".join(map(_shown, self.times[-_MOST_TIMES:])):
            yield f"exact {self.equations}, t={{{ends}}} : {{{','.join(problem.rates)}}}"
        if problem.energy:
            ends = ",".join(["0", *filter(None, [ends])])
            yield f"exact {self.equations}, energy={problem.energy}, t={{{ends}}} : energy"
        for _, h, times in runs:
            yield from self._of_runs(h, times)
        yield from self._of_ratios([(h, times) for late, h, times in runs if not late])

    def _sizes_and_times(
        self, text: str, column_of: Callable[[TextNumber], str]
    ) -> tuple[list[Fraction], list[Fraction]]:
        """The step sizes and times that are named, in words and columns or by numbers of steps, sorted."""
        part, at, unknowns = self.part, self.problem.at, "|".join(self.problem.rates)
        value_at = re.compile(rf"(?<!\w)(?:{unknowns})\(({NUMBER})\)")
        sizes, times, of_runs, also = (_listed(pattern, part) for pattern in (_SIZES, _TIMES, COUNT_GIVEN, value_at))
        times += [*also, *map(Fraction, durations(part))]
        rows, said = list[Fraction](), counts_of_steps(part)
        for number in numbers_in(text[at : at + len(self.problem.part)]):
            head = column_of(replace(number, start=number.start + at, end=number.end + at))
            for letter, into in (("h", sizes), ("t", times), ("n", of_runs), ("s", rows)):
                if is_head_of(letter, head) and re.fullmatch(NUMBER, number.text):
                    into.append(Fraction(number.text))
        counts = [*of_runs, *(Fraction(n) for n in said if n < _MOST_COUNTED)]
        sizes, times = (sorted({x for x in numbers if x > 0}) for numbers in (sizes, times))
        if (of_runs and len(times) <= _MOST_ENDS) or not sizes:
            sizes = sorted({*sizes, *(t / n for t in times for n in (of_runs or counts) if n)})
        times = times or sorted({n * h for n in counts for h in sizes})
        after = {int(n) for n in re.findall(rf"(?<!\w)(?:{unknowns})_([1-9])(?!\w)", part)}
        after |= {1} if re.search(r"\b(?:first|single) step\b", self.lower) else {n for n in said if n < _MOST_TIMES}
        of_first_step = self.with_slopes or (self.problem.energy and OF_EACH_STEP.search(self.lower))
        after |= {1} if of_first_step else set()
        after |= {n for n in map(int, rows) if n}
        return sizes, sorted({*times, *(n * h for n in after for h in sizes)})

    def _read_methods(self, text: str) -> None:
        """Read the methods of the whole text in lower case, as what midpoint or Verlet means is said anywhere."""
        multistep = {
            key for key, method in FURTHER_METHODS.items() if isinstance(method, Multistep) and method.derivative == 1
        }
        known = multistep | {*METHODS}
        named_anywhere = methods_named(text) & known  # Verlet's method is that which has its whole name elsewhere
        spoken = methods_named(self.lower) & named_anywhere or named_anywhere
        if "explicit" in text and "implicit" not in text:
            spoken -= {key for key in METHODS if key.startswith("implicit")}  # of what midpoint may mean
        in_full = methods_in_full(text)  # before those that Ralston may mean, too
        self.chosen = [key for key in sorted(METHODS, key=lambda key: key not in in_full) if key in spoken]
        self.chosen = self.chosen[:_MOST_METHODS]
        starters, several = starters_said(self.lower) or _USUAL_STARTERS, spoken & multistep
        self.count = len(self.chosen) + len(several)
        self.named = [f"{{{','.join(self.chosen)}}}"] * bool(self.chosen)
        self.named += [f"{{{key}}} started={by}" for key in sorted(several) for by in starters[-_MOST_STARTERS:]]
        of = {key: f"{key} started={starters[-1]}" if key in multistep else key for key in spoken}
        self.compared = [[of[key] for key in pair] for pair in _compared(self.lower) if {*pair} <= {*of}]

    def _read_quantities(self) -> None:
        """Read which errors, changes and counts are spoken of, so that runs are asked for these."""
        rates, part = self.problem.rates, self.part
        self.errors = ["error", *(f"error.{name}" for name in rates if len(rates) > 1)]
        self.errors += ["position_error"] * (2 * len({*rates} & {*rates.values()}) == len(rates) > 2)
        spoken_of = {found.lastgroup for found in QUANTITY.finditer(self.lower)}
        self.changes = ["energy_change", *["largest_energy_change"] * ("largest_energy_change" in spoken_of)]
        self.percent = re.search(PERCENT, part)
        self.read = [*rates, *self.errors, *["largest_error"] * ("largest_error" in spoken_of)]
        self.read += ["relative_error"] * bool(self.percent or "relative" in part)
        self.read += ["evaluations"] * bool(re.search("evaluation|calls", part)) + ["steps"] * bool(_TAKES.search(part))

    def _runs(self) -> Iterator[tuple[bool, Fraction, list[Fraction]]]:
        """The step sizes with the times that they divide, as long as the steps last; then the ends of long runs."""
        longer = defaultdict[Fraction, list[int]](list)  # as in "after 1000 steps", of the step size before
        found = (x for x in COUNT_OF_STEPS.finditer(self.part) if _MOST_TIMES <= int(x[1]) < _MOST_COUNTED)
        for count in islice(found, _MOST_LATE):
            for size in SETTING["h"].findall(self.part[: count.start()])[-1:]:
                longer[Fraction(size)].append(int(count[1]))
        left = Fraction(_MOST_STEPS)
        for late, h in product((False, True), self.sizes[::-1][:_MOST_SIZES] if self.named else ()):
            ends = sorted({n * h for n in longer[h]} - {*self.times}) if late else self.times
            fitting = [t for t in ends if (t / h).denominator == 1 and self.count * t / h <= left][-_MOST_TIMES:]
            if fitting:
                left -= self.count * max(fitting) / h
                yield late, h, fitting

    def _of_runs(self, h: Fraction, times: Sequence[Fraction]) -> Iterator[str]:
        """The questions about the runs of all methods with one step size."""
        at = f"h={{{_shown(h)}}}, t={{{','.join(map(_shown, times))}}}"
        for pair in self.compared:
            yield f"ratio({', '.join(f'run {key} {self.equations}, {at} : error' for key in pair)})"
        for methods in self.named:
            yield f"run {methods} {self.equations}, {at} : {{{','.join(self.read)}}}"
            if self.problem.energy:
                yield from self._of_energy(f"run {methods} {self.equations}, energy={self.problem.energy}, {at}")
        step = f"{self.equations}, h={{{_shown(h)}}}"
        pairs = [key for key in self.chosen if getattr(METHODS[key], "b_embedded", None)]
        if pairs and re.search("embedded|companion|estimate", self.part):
            for name in self.problem.rates:
                of_pairs = f"step {{{','.join(pairs)}}} {step}"
                yield from (f"{of_pairs} : embedded.{name}", f"abs({of_pairs} : estimate.{name})")
        if self.chosen and self.with_slopes:
            slopes = ",".join(f"k{i}.{name}" for i in (1, 2, 3, 4) for name in self.problem.rates)
            yield f"step {self.named[0]} {step} : {{{slopes}}}"

    def _of_energy(self, run: str) -> Iterator[str]:
        """The questions about the energy of runs, with its changes as they are, as sizes and as percentages."""
        yield f"{run} : {{{','.join(('energy', *self.changes))}}}"
        yield from (f"abs({run} : {change})" for change in self.changes)
        relative = [f"{run} : relative_energy_change", f"abs({run} : relative_energy_change)"]
        shares = map(SHARE.format, relative) if self.percent else ()
        yield from relative if re.search(rf"relative {ENERGY}", self.lower) else shares

    def _of_ratios(self, runs: Sequence[tuple[Fraction, list[Fraction]]]) -> Iterator[str]:
        """The ratios of the errors with one step size and the next shorter one, and the orders that they show."""
        of_ratios = [
            bool(re.search(words, self.lower)) for words in (_OF_RATIOS, rf"{OBSERVED}|\| ?{ORDER_OF_COLUMN} ?\|")
        ]
        for (h, fitting), (shorter, also) in pairwise(runs) if any(of_ratios) else ():
            ends = ",".join(_shown(t) for t in fitting if t in also)
            for methods, error in product(self.named if ends else (), self.errors):
                both = [f"h={x}, t={{{ends}}} : {error}" for x in (f"{{{_shown(h)}}}", _shown(shorter))]
                ratio = f"ratio({', '.join(f'run {methods} {self.equations}, {rest}' for rest in both)})"
                order = f"log2({ratio})" if h == 2 * shorter else f"ln({ratio})/ln({h / shorter})"
                yield from compress((ratio, order), of_ratios)


def _compared(text: str) -> Iterator[tuple[str, ...]]:
    """The methods whose errors a text in lower case compares, each pair once, the larger error first."""
    found = [x for x in numbers_in(text) if text.startswith(" times ", x.end)]
    places = ((*sentence_around(text, x.start, x.end), sentence_before(text, x.start)) for x in found)
    yield from dict.fromkeys(filter(None, (methods_compared(*place) for place in places)))


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
