"""The problems y' = f(t, y) that a text states, with their starts and energies."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, pairwise
from typing import NamedTuple

from driftproof.methods.formulas.field_text import rate_of_text
from driftproof.methods.formulas.vector_fields import FUNCTIONS
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.parser import parse_question
from driftproof.texts.questions.pieces import with_calls_bracketed, with_greek_spelled, with_roots_spelled, with_time
from driftproof.texts.words.method_names import spoken_names

# So many problems of a text are read, each with the values that it gives to a parameter.
MOST_PROBLEMS = 4
NUMBER = r"[-+]?[0-9]+(?:\.[0-9]+)?(?:/[1-9][0-9]*)?(?![\w/^√]|\.[0-9])"
_ROOT = r"(?:√|sqrt ?)\(?[0-9]+(?:\.[0-9]+)?(?:/[0-9]+)?\)?"
_VALUE = rf"-?(?:[0-9]+ ?[*·/]? ?)?(?:pi|{_ROOT})(?: ?/ ?[0-9]+)?|{NUMBER}"
# Between two equations of one system, and before the first of them, no sentence ends.
_GAP = 80
_TOGETHER = re.compile(rf"(?:(?![.;?!]\s)[\s\S]){{0,{_GAP}}}")
# What multiplies the derivative, as in m x'' = -k x.
_FACTOR = r"(?:[0-9]+(?:\.[0-9]+)?|(?:[A-Za-z]|[α-ω])(?:_\w)?(?![A-Za-z]))"
_LEAD = re.compile(rf"(?<![\w'.])(?:{_FACTOR}(?: ?[*·]? ?{_FACTOR})* ?[*·]? ?)?\Z")
_LONGEST_LEAD = 40
_ENERGY = re.compile(
    r"(?<!\w)(?:(?P<name>H|E|[Ee]nergy|[Hh]amiltonian)(?: ?\([^()]*\))? ?= ?|[Ee]nergy (?=[-(0-9])|"
    r"(?P<letter>[A-Z]) ?= ?(?=(?:(?![.;]\s)[^=]){1,200}(?:conserved|constant|invariant)))"
    r"(?P<energy>[^=≤≥≈<>:;]{1,200})"
)
_EQUATION = re.compile(
    r"(?:(?<![\w'])|(?<=[α-ω]))(?:d(?P<d>[^\W\d]\w*) ?/ ?d[tx]|\(?d\^2 ?(?P<dd>[^\W\d]\w*)\)? ?/ ?\(?dt\^2\)?|"
    r"(?P<name>[α-ω](?:_\w|[0-9])?|(?![α-ω])[^\W\d][^\Wα-ω]{0,9})'(?P<second>'?)(?: ?\([tx]\))?)"
    r"(?P<left> ?[-+][^=≤≥≈<>:;|]{1,100}?)? ?(?:\| ?)?= ?"
    r"(?=(?P<rate>[^=≤≥≈<>:;]{1,200}))"
)
# A sentence or a line ends, or a word follows that is no function.
_ENDS_RATE = re.compile(rf"\n|[.;](?!\d)| (?!(?:{'|'.join(FUNCTIONS)})\b)(?=[a-z]{{2,}}\b(?!\())")
_ZERO = re.compile(r"0(?:\.0*)?(?![.\d])")
_ALONE = re.compile(rf"{NUMBER}\s*(?:[,.;)]|and\b|$)")
# Characters after the last equation in which x = 1 without a time is a start.
_NEAR = 150
_WORD = re.compile(r"[^\W\d]\w*")
_ANGLES = {"theta", "phi", "alpha", "varphi"}


@dataclass(frozen=True)
class StatedProblem:
    """Rates by the names of the unknowns, an energy if it is given, and the part of the text, from `at`, about them.

    It is an `aside` where the text says what an unknown is in those of a problem before, as in A = 0.3 N.
    """

    rates: dict[str, str]
    part: str
    at: int
    energy: str | None = None
    aside: bool = False

    @property
    def equations(self) -> str | None:
        """The equations and the start as a question has them; None if the text gives no start."""
        starts = [self._start(name, i) for i, name in enumerate(self.rates)]
        if None in starts:
            return None
        given = [f"{name}(0)={start}" for name, start in zip(self.rates, starts, strict=True)]
        found = ", ".join([*(f"{name}'={rate}" for name, rate in self.rates.items()), *given])
        with suppress(QuestionError):
            parse_question(f"exact {found}, t=1 : {next(iter(self.rates))}")
            return found
        return None

    def going_on(self, other: StatedProblem) -> StatedProblem:
        """The problem with the part about the other one, too, if that is the next part of the text."""
        end = self.at + len(self.part)
        goes_on = other.at <= end < other.at + len(other.part)
        return replace(self, part=self.part + other.part[end - other.at :]) if goes_on else self

    def _start(self, name: str, index: int) -> str | None:
        """What the text says that the unknown is at first: at 0, "at rest", in a list of all, or near the equations."""
        part, n = with_greek_spelled(self.part.replace("| =", "=")), len(self.rates)
        of = next((other for other, rate in self.rates.items() if rate == name), name)
        near = part[: part.rindex("'") + _NEAR] if "'" in part else part[:_NEAR]
        zero = r"(?:_0| ?\(0(?:\.0)?\)) ?= ?"
        at_zero = re.search(rf"(?<![\w'])(?:{name}|{of}'){zero}(?:\w+'?{zero})*({_VALUE})", part)
        if not at_zero and of != name and re.search(r"\b(?:at|from) rest\b", part):
            return "0"
        of_all = rf"(?:\b(?:from|at|in)|=) ?\(({_VALUE})" + rf", ?({_VALUE})" * (n - 1) + r"\)"
        if n > 1 and not at_zero and (found := re.search(of_all, part)):
            return _start_of(found[index + 1])
        speed = "" if of == name else f"|{of}'"
        later = r"(?! (?:at|for|when) t ?= ?(?!0(?![.\d])))(?! ?[-+*·/] ?[\w(])"  # no z = 1 - y
        found = at_zero or re.search(rf"(?<![\w'(])(?:{name}{speed}) ?= ?({_VALUE}){later}", near)
        return _start_of(found[1]) if found else None


def _start_of(spelled: str) -> str:
    return re.sub(r"([0-9]) ?(?=pi|sqrt)", r"\1*", plain(spelled))


def speeds_named(text: str, name: str) -> list[str]:
    """The other names of the derivative of an unknown: what is defined so, else v, or omega for an angle.

    >>> speeds_named("θ'' = -sin θ", "theta"), speeds_named("θ'' = -ω² sin θ", "theta")
    (['v', 'omega'], ['v'])
    """
    said = rf"(?<![\w'])(\w+) ?= ?(?:{name}'|d{name} ?/ ?dt)(?!['\w])(?! ?[-+*/=^])"
    equations = with_greek_spelled(" ".join(text[start:end] for start, end in equations_in(text)))
    usual = ["v", *["omega"] * (name in _ANGLES)]
    usual = [speed for speed in usual if not re.search(rf"(?<![A-Za-z]){speed}(?![A-Za-z])", equations)]
    return [*re.findall(said, with_greek_spelled(text)), *usual]


def energies_named(text: str, unknowns: Collection[str]) -> set[str]:
    """The letters, in lower case, that the text defines as energies or invariants in these unknowns; not h, a step.

    >>> energies_named("The quantity V = x - ln x + y - ln y is conserved.", ["x", "y"])
    {'v'}
    """
    found = (x for x in _ENERGY.finditer(text) if not {*unknowns}.isdisjoint(_WORD.findall(plain(x["energy"]).lower())))
    return {(x["letter"] or x["name"] or "").lower() for x in found} - {*unknowns, "h", ""}


def equations_in(text: str) -> Iterator[tuple[int, int]]:
    """The spans of equations such as y' = -2y, whose numbers the text chooses; not of slopes, as in y' = -9."""
    for match in _EQUATION.finditer(text):
        if _ALONE.match(match["rate"]) and not _ZERO.match(match["rate"]):
            continue
        rate = _ENDS_RATE.split(_first(match["rate"]))[0]
        if method := spoken_names().search(rate.lower(), 1):  # -50y Euler's method
            rate = rate[: method.start()]
        yield match.start(), match.start("rate") + len(rate)


def parameters_in(text: str) -> set[str]:
    """The letters of equations of the text that are no unknowns: what it gives as k = 3 is chosen."""
    found = [match for match in _EQUATION.finditer(text) if not _ALONE.match(match["rate"])]
    words = {word for match in found for word in _WORD.findall(_first(match["rate"]))}
    letters = {
        letter for word in words for letter in ([word] if len(word) < 2 or "_" in word else re.findall("[α-ω]", word))
    }
    return letters - {match[kind] for match in found for kind in ("name", "d", "dd")} - {"t", "e"}


class _System(NamedTuple):
    """Equations that stand together, from `start`: rates of unknowns as written, and factors of their derivatives."""

    start: int
    raw: dict[str, str]
    leads: dict[str, str]


def stated_problems(text: str) -> Iterator[StatedProblem]:
    """The systems of equations of the text, each with the text from a little before it to the next one.

    One that is not understood has no rates.
    """
    systems, spelled = _systems(text), with_greek_spelled(text)
    before = list[str]()
    for (start, raw, leads), (end, *_) in pairwise([*systems, _System(len(text), {}, {})]):
        own, part = [*raw], text[:end]
        raw, energies = _with_speeds(raw, text)
        if not any("x" in one.raw for one in systems):  # y' = x + y: the time is called x
            raw, leads = ({of: with_time(one, raw) for of, one in texts.items()} for texts in (raw, leads))
            part = with_time(part, raw)
        begins = start - len(re.split(r"[.;?!]\s", text[max(0, start - _GAP) : start])[-1])
        known = list[dict[str, str]]()
        for given in ("", *_other_values(raw, spelled)):
            known_as = partial(_rate, names=own, text=given + spelled)
            rates = _rates(raw, leads, known_as)
            if rates and rates not in known:
                known.append(rates)
                energy = next((x for x in map(known_as, energies) if x and {*_WORD.findall(x)} & {*own}), None)
                yield StatedProblem(rates, part[begins:], begins, energy, _is_aside(raw, before, spelled))
        if not known:
            yield StatedProblem({}, part[begins:], begins)
        before += own


def _systems(text: str) -> list[_System]:
    """The equations of the text, those in one that stand near each other and are of different unknowns."""
    systems, last = list[_System](), len(text)
    for match in _EQUATION.finditer(text):
        name, lead = with_greek_spelled(match["name"] or match["d"] or match["dd"]), _lead(text, match.start())
        if name == "t" or name in FUNCTIONS or lead is None:
            continue
        is_second = match["second"] or match["dd"]
        base = re.sub("_?[0-9]$", "", name)  # theta_1', the slope after a step
        others = chain(*(one.raw for one in (systems if base != name else systems[-1:])))
        if not is_second and {base, f"d{base}"}.intersection(others) and _ALONE.match(match["rate"]):
            continue  # x' = 0, a slope or the velocity at the start of x'' = F(x)
        near = _TOGETHER.fullmatch(text, min(last, match.start()), match.start())
        if not (systems and near and name not in systems[-1].raw):
            systems.append(_System(match.start(), {}, {}))
        _, raw, leads = systems[-1]
        if is_second:
            raw[name] = name = f"d{name}"
        left = f"-({match['left'].lstrip(' +')}) + " if match["left"] else ""  # y'' + 4y = 0
        raw[name], leads[name] = with_greek_spelled(left + match["rate"]), lead
        last = match.start("rate") + len(_ENDS_RATE.split(_first(match["rate"]))[0])
    return systems


def _with_speeds(raw: dict[str, str], text: str) -> tuple[dict[str, str], list[str]]:
    """The rates, and the energies of the text, with dx for x' and its other names where x has a second derivative."""
    energies = [match["energy"] for match in _ENERGY.finditer(with_greek_spelled(text))]
    for name in [name for name in raw if f"d{name}" in raw]:
        own = [one for one in speeds_named(text, name) if one not in raw and (len(raw) == 2 or one != "v")]
        speeds = "".join(rf"|(?<!\w){speed}(?![\w'(])" for speed in own)
        rated = re.compile(rf"(?<![A-Za-z_]){name}'|(?<![A-Za-z])d{name} ?/ ?dt\b{speeds}")  # also 0.4x'
        raw = {of: rated.sub(f"d{name}", rate) for of, rate in raw.items()}
        energies = [rated.sub(f"d{name}", energy) for energy in energies]
    return raw, energies


def _rates(raw: dict[str, str], leads: dict[str, str], known_as: Callable[[str], str | None]) -> dict[str, str] | None:
    """The rates divided by what multiplies their derivatives; None unless all of them are understood."""
    rates = {of: rate for of, one in raw.items() if (rate := known_as(one))}
    over = {of: known_as(lead) for of, lead in leads.items() if lead}
    if len(rates) < len(raw) or None in over.values():
        return None
    return {of: f"({rate})/({over[of]})" if of in over else rate for of, rate in rates.items()}


def _is_aside(names: Iterable[str], before: Collection[str], text: str) -> bool:
    """True if the text says that one of the names is a formula in the unknowns `before`, themselves no names."""
    said = rf"(?<![\w'(])(?:{'|'.join(names)}) ?= ?([^=≤≥≈<>:;,]{{1,100}})"
    formulas = (_ENDS_RATE.split(found[1])[0] for found in re.finditer(said, text))
    return any({*_WORD.findall(re.sub(r"\w+'", "", one))} & {*before} - {*names} for one in formulas)


def _lead(text: str, at: int) -> str | None:
    """What multiplies the derivative that begins there, as a product; None if it stands in a sum or a product."""
    line = text[:at].rpartition("\n")[2][-_LONGEST_LEAD:]
    found = _LEAD.search(line)
    before = line[: found.start() if found else at].rstrip()
    if (before[-1:] and before[-1] in "+-*/^" and before[:-1].strip(" |>")) or re.search(r"=[^=,;:|]*\)\Z", before):
        return None
    factors = re.findall(_FACTOR, found[0]) if found and before[-1:] != "=" else []
    article = factors[:1] in (["a"], ["A"]) and not re.search(rf"(?<!\w){factors[0]} ?=", text)
    return with_greek_spelled("*".join(factors[article:]))


def _other_values(raw: dict[str, str], text: str) -> Iterator[str]:
    """The values but the first that the text gives to words of the rates, as "k = 3; ", to stand before the text."""
    for word in dict.fromkeys(word for rate in raw.values() for word in _WORD.findall(rate)):
        values = re.findall(rf"(?<![\w'(/*^]){re.escape(word)} ?= ?({NUMBER})", text)
        yield from (f"{word} = {value}; " for value in [*dict.fromkeys(values)][1:MOST_PROBLEMS])


def _rate(raw: str, names: Collection[str], text: str) -> str | None:
    """The longest beginning of `raw` that is a rate in the names, others replaced by what the text says they are."""
    raw = re.sub(rf"\b({'|'.join(names)}) ?\(t\)", r"\1", _first(raw))  # y(t)
    for ratio, value in re.findall(rf"(?<![\w'/(])([^\W\d]\w*/[^\W\d]\w*) ?= ?({NUMBER})", text):
        raw = raw.replace(ratio, value)
    raw = re.sub(rf"(\^[0-9]+) (?=(?:{'|'.join(names)})\b)", r"\1*", plain(raw))  # L^2 dtheta^2
    # Not before a sign, an unknown, another letter or a power, so that x' = 2/3 k x is not read as x' = 2/3.
    factor = rf"[-+*/^]|(?:{'|'.join(FUNCTIONS)})\b|(?:{'|'.join(names)}|[^\W\d])\b(?! ?['(=_])|[^\W\d]\w* ?\^"
    bracket = rf"\((?:[-+0-9(]|(?:{'|'.join(names)})\b)"
    ends = re.finditer(rf"\n|\.(?!\d)|\s(?!\s*(?:{factor}|{bracket}))", raw)
    for end in (len(raw), *reversed([match.start() for match in ends])):
        try:
            written = _WORD.sub(lambda match: _factor(match, [*names], text), raw[:end].strip(" .\n"))
            rate_of_text(written, dict.fromkeys(names, "y0"))
        except (ValueError, LookupError):
            continue
        written = re.sub(rf"\b({'|'.join(names)}|t) ?\(", r"\1*(", written)  # p(1 - p) is no start of p
        return re.sub(r"\s+", " ", written)
    return None


def _factor(match: re.Match[str], names: list[str], text: str) -> str:
    """What a name of a rate means there: a number after another factor has a sign, so that 2k is no 20.1."""
    meant, after = _meant(match[0], names, text), re.search(r"[\w)] *\Z", match.string[: match.start()])
    return f"*{meant}" if after and meant[0].isdigit() else meant


def _meant(word: str, names: list[str], text: str) -> str:
    """A name of a rate as it stands, as its definition, or as a product of names. Raises LookupError for none."""
    if word in ("t", "pi", *FUNCTIONS, "ln", "tan", *names):
        return word
    # Not the end of a sum, as in m x'' + kx = 0.
    said = rf"{re.escape(word)} ?= ?(?:[A-Za-z ]{{1,9}}= ?)?"  # also as in tau = RC = 0.2
    found = re.search(rf"(?<![\w'(/*^])(?<![-+*/] ){said}(?:({NUMBER})|([^=,;]{{1,100}}))", text)
    if found and found[1] and found[1][0].isdigit() and "/" not in found[1]:
        return found[1]
    if found and (written := found[1] or _rate(found[2], names, "")):
        return f"({written})"
    product = word[-1] in names or (len(word) == 2 and not word.islower())  # such as gL
    if {*word} <= {"t", *names} or (product and word.isalpha() and word != "by"):
        return "*".join(_meant(letter, names, text) for letter in word)
    raise LookupError(word)


def _first(rate: str) -> str:
    """The rate up to its first comma outside brackets, or the first bracket that was not opened."""
    depth = 0
    for i, sign in enumerate(rate):
        depth += (sign == "(") - (sign == ")")
        if depth < 0 or (sign in ",|" and not depth):
            return rate[:i]
    return rate


def plain(formula: str) -> str:
    """A formula of a text as a question has it: sqrt, exp and brackets spelled out."""
    formula = formula.replace("π", "pi").replace("·", "*").replace("[", "(").replace("]", ")")
    formula = with_roots_spelled(formula)
    formula = re.sub(r"\be ?\^\{([^{}]*)\}|\be ?\^\(?(-?\w+)\)?", lambda to: f"exp({to[1] or to[2]})", formula)
    formula = re.sub(r"\^\{(-?[0-9]+(?:/[0-9]+)?)\}", r"^(\1)", formula)
    formula = re.sub(r"(\^[0-9]+) (?=(?:d?[A-Za-z]|[A-Za-z]+_\w)\b|\()", r"\1*", formula)  # x^2 y
    formula = re.sub(r"(?<![\w./^])((?:\w+|\([^()]*\))/\w+) (?=[A-Za-z(])", r"(\1) ", formula)  # 2/3 x, no 2/(3x)
    return with_calls_bracketed(formula)
