"""Values in templates: the result of value(...), and the filters that format it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NoReturn

from driftproof.texts.questions.answer import EVIDENCE_KINDS, LONGEST_DECIMAL, STATED, Answer
from driftproof.texts.questions.decimals import PLAIN, PRINTED, Style
from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
from driftproof.texts.templates.sandbox import Refusal
from driftproof.texts.templates.text_kinds import LATEX, MARKDOWN, TextKind
from driftproof.texts.writing import markup

_STYLES = {"plain": PLAIN, "printed": PRINTED}


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
        if value.evidence not in {*EVIDENCE_KINDS} - {STATED}:
            raise Refusal(f"{value.question!r} is only {value.evidence}; templates print only what is derived")
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
