"""Values in templates: the result of value(...), the filters that format it, and tables of methods."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NoReturn, TypeAlias

from driftproof.methods.given_methods import subject_of
from driftproof.methods.multistep import Multistep
from driftproof.texts.questions.answer import CERTIFIED, COUNTED, GIVEN, LONGEST_DECIMAL, PROVED, Answer
from driftproof.texts.questions.decimals import PLAIN, PRINTED, Style
from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
from driftproof.texts.questions.runs import RUN_READOUTS
from driftproof.texts.templates.sandbox import Refusal
from driftproof.texts.templates.text_kinds import LATEX, MARKDOWN, TextKind
from driftproof.texts.writing import markup

_STYLES = {"plain": PLAIN, "printed": PRINTED}
_MOST_CELLS = 10_000
_COLUMN = re.compile(r"(?P<asked>.*?)(?: (?P<form>(?:digits|places)(?= [0-9]{1,6}$)|exact$)(?P<count>.*))?", re.DOTALL)


@dataclass(frozen=True)
class NumberStyle:
    """The style of numbers: the kind of text, "plain" or "printed", and a rounding policy or None.

    `in_code` is true inside Markdown code, where nothing is escaped.
    """

    kind: TextKind
    style: str
    rounding: str | None
    in_code: bool = False

    def __post_init__(self) -> None:
        """Raise Refusal for an unknown style or rounding policy."""
        if self.style not in _STYLES:
            raise Refusal(f"the style {str(self.style)[:20]!r} is unknown; choose one of {', '.join(_STYLES)}")
        try:
            Style(self.rounding)
        except ValueError as error:
            raise Refusal(str(error)) from None

    def decimal(self, write: Callable[[Style], str]) -> str:
        """The decimal that `write` returns for this style; in TeX the printed style is set in mathematics."""
        if self.kind is not LATEX or self.style == "plain":
            return write(replace(_STYLES[self.style], rounding=self.rounding))
        return markup.in_any_mode(markup.decimal_markup(write(Style(self.rounding)), markup.TEX))


class TemplateValue:
    """The result of value(...): prints itself if there is one obvious way, and refuses to be a condition."""

    def __init__(self, value: Answer, kind: TextKind) -> None:
        """Take the answer. Raises Refusal for one that is only STATED."""
        if value.evidence not in (GIVEN, PROVED, COUNTED, CERTIFIED):
            raise Refusal(f"{value.question!r} is only {value.evidence}; templates print only what is proved")
        self._value, self._kind = value, kind

    @property
    def unit(self) -> str:
        """The name of the unit. Raises Refusal if there is none."""
        if self._value.unit is None:
            raise Refusal(f"{self._value.question!r} has no unit")
        return self._value.unit

    def __str__(self) -> str:
        """The text of a short rational number or of words. Raises Refusal for other values."""
        value, text = self._value, self._value.exact_text or ""
        short = isinstance(value.exact, Fraction) and len(text) <= markup.LONGEST_IN_TEXT
        if short and self._kind is LATEX:
            return text.replace("-", r"\ensuremath{-}") if "/" in text else markup.in_any_mode(text)
        if short or (not value.is_number and text.replace(" ", "").isalpha()):
            return text
        ways = "| digits(6), | places(6), | exact, | tex or | mathml"
        raise Refusal(f"{value.question!r} needs a format: write {ways}")

    def _no_condition(self, *_: object) -> NoReturn:
        raise Refusal(f"{self._value.question!r} is not a condition and cannot be compared; ask for what you mean")

    __bool__ = __eq__ = __lt__ = __le__ = __gt__ = __ge__ = _no_condition
    __hash__ = None  # type: ignore[assignment]


def _decimal_filter(name: str, least: int) -> Callable[..., str]:
    """The filter `name`, digits or places, which takes a count from `least` to LONGEST_DECIMAL."""

    def apply(style: NumberStyle, x: object, count: object) -> str:
        value = _value_of(x)
        if isinstance(count, bool) or not isinstance(count, int) or not least <= count <= LONGEST_DECIMAL:
            allowed = f"write a whole number from {least} to {LONGEST_DECIMAL}"
            raise Refusal(f"{str(count)[:20]!r} is not a number of digits; {allowed}")
        ask = getattr(value, name)
        return _written(lambda: style.decimal(lambda style: ask(count, style)), f"{name}({count}")

    return apply


def exact_filter(style: NumberStyle, x: object) -> str:
    """The exact form in SymPy's syntax, with markup escaped except in code. Raises Refusal if there is none."""
    text = _value_of(x).exact_text
    if text is None:
        raise Refusal(f"{_value_of(x).question!r} has no exact form; write | digits(6)")
    # In HTML the template escapes it.
    return style.kind.escape(text) if style.kind in (MARKDOWN, LATEX) and not style.in_code else text


def mathml_filter(style: NumberStyle, x: object) -> str:
    """The exact form as a <math> element. Raises Refusal in TeX."""
    if style.kind is LATEX:
        raise Refusal("MathML is not allowed in TeX; write | tex")
    return _written(_value_of(x).mathml)


VALUE_FILTERS: dict[str, Callable[..., str]] = {
    "digits": _decimal_filter("digits", 1),
    "places": _decimal_filter("places", 0),
    "exact": exact_filter,
    "tex": lambda style, x: _written(_value_of(x).tex),
    "mathml": mathml_filter,
}


def _value_of(x: object) -> Answer:
    if not isinstance(x, TemplateValue):
        raise Refusal(f"a {type(x).__name__} is not a value; apply filters to value(...)")
    return x._value


def _written(write: Callable[[], str], call: str = "") -> str:
    """The result of `write`; its errors become Refusals that suggest what the author of the template can write."""
    try:
        return write()
    except AmbiguousRounding as error:
        raise Refusal(f'{error.text!r}: {error.reason}, as in {call}, rounding="half-even")') from None
    except QuestionError as error:
        raise Refusal(f"{error.text!r}: {error.reason}") from None


# The function that answers a question of a template.
_Ask: TypeAlias = Callable[[NumberStyle, str], TemplateValue]


def methods_table(
    ask: _Ask,
    style: NumberStyle,
    methods: Sequence[str],
    columns: Sequence[str] | Mapping[str, str],
    h: str | None = None,
    t: str | None = None,
) -> str:
    """A table with a row per method and a column per fact, or per readout of the run to t with steps of size h.

    A column may say how to write its numbers: "state_error digits 4", "energy_change places 3", "imaginary_limit
    exact"; otherwise they must be short. ∞ stands for oo, and a dash where a method has no such fact. A mapping gives
    the titles of the columns: {"Calls": "evaluations"}. Raises Refusal, and what `ask` raises.
    """
    if isinstance(methods, str) or not all(isinstance(key, str) for key in methods):
        raise Refusal('methods are a list of keys, as in ["rk4", "forward_euler"]')
    asked = list(columns.values() if isinstance(columns, Mapping) else columns)
    if isinstance(columns, str) or not all(isinstance(column, str) for column in asked):
        raise Refusal('columns are a list, as in ["state_error digits 4", "evaluations"], or named in a mapping')
    parsed = [match for column in asked if (match := _COLUMN.fullmatch(column))]
    names = columns if isinstance(columns, Mapping) else [match["asked"].replace("_", " ") for match in parsed]
    titles = [name[:1].upper() + name[1:] if name[1:] and not isinstance(columns, Mapping) else name for name in names]
    if not 0 < len(methods) * len(parsed) <= _MOST_CELLS:
        raise Refusal(f"a table of methods has from 1 to {_MOST_CELLS} cells; name methods and columns")
    run = "" if h is None and t is None else f"h={h} t={t}"
    rows = [[style.kind.escape(name) for name in ("Method", *titles)]]
    try:
        subjects = {key: subject_of(key) for key in methods}
    except ValueError as error:
        raise Refusal(str(error)) from None
    multistep = {isinstance(one, Multistep) for one in subjects.values()}
    if len(multistep) > 1 and any(match["asked"].startswith("error_constant") for match in parsed):
        raise Refusal("error constants of one-step and multistep methods differ in sign; give them in two tables")
    for key in methods:
        cells = (_cell(ask, style, key, column, run) for column in parsed)
        rows.append([style.kind.escape(subjects[key].title), *cells])
    return style.kind.table(rows)


def _cell(ask: _Ask, style: NumberStyle, key: str, column: re.Match[str], run: str) -> str:
    head, _, rest = column["asked"].partition(" ")
    of_run = head in RUN_READOUTS
    if of_run and not run:
        raise Refusal(f"the column {head!r} is a readout of a run; give h and t")
    none, infinity = (r"\textendash{}", r"\ensuremath{\infty}") if style.kind is LATEX else ("–", "∞")
    try:
        found = ask(style, f"run {key} {run} : {column['asked']}" if of_run else f"{head} {key} {rest}".rstrip())
    except QuestionError as error:
        if of_run or not re.search(r"\bhas no \w+(?:[:;]|\Z)", error.reason):
            raise
        return none
    if found._value.exact_text == "oo":
        return infinity
    if column["form"] is None:
        return str(found)
    return VALUE_FILTERS[column["form"]](style, found, *map(int, column["count"].split()))
