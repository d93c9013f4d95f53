"""A value in a template, and the filters that write it: digits, places, exact, tex, mathml."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NoReturn

from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
from driftproof.texts.questions.style import Style
from driftproof.texts.questions.value import CERTIFIED, COUNTED, MOST_DIGITS, PROVED, Value
from driftproof.texts.templates.kinds import MARKDOWN, STYLES, TEX, Kind
from driftproof.texts.templates.problems import Refusal
from driftproof.texts.writing import markup
from driftproof.texts.writing.text import LONGEST_SHOWN

FORMS = "| digits(6), | places(6), | exact, | tex or | mathml"


@dataclass(frozen=True)
class Manner:
    """How numbers are written: the kind of text, "plain" or "printed", and the rounding policy, None for none named."""

    kind: Kind
    style: str
    rounding: str | None

    def __post_init__(self) -> None:
        """Refuse unknown names."""
        if self.style not in STYLES:
            raise Refusal(f"the style {str(self.style)[:20]!r} is unknown; choose one of {', '.join(STYLES)}")
        try:
            Style(self.rounding)
        except ValueError as error:
            raise Refusal(str(error)) from None

    def decimal(self, write: Callable[[Style], str]) -> str:
        """What `write` makes of a style. In TeX the printed style is mathematics wherever it stands."""
        if self.kind is not TEX or self.style == "plain":
            return write(replace(STYLES[self.style], rounding=self.rounding))
        return in_mathematics(write(Style(self.rounding)))


def in_mathematics(decimal: str) -> str:
    """A decimal in TeX: digits as they are; with a sign or an exponent mathematics, in a text and in a formula."""
    plain = decimal.replace(".", "").isdigit()
    return decimal if plain else rf"\ensuremath{{{markup.decimal(decimal, markup.TEX)}}}"


class Quantity:
    """What value(...) is in a template: it prints itself where there is one obvious way, and is no condition."""

    def __init__(self, value: Value, kind: Kind) -> None:
        """Raises Refusal for a value that is not proved."""
        if value.evidence not in (PROVED, CERTIFIED, COUNTED):
            raise Refusal(f"{value.question!r} is only {value.evidence}; a text prints what is proved")
        self._value, self._kind = value, kind

    @property
    def unit(self) -> str:
        """Its unit in words. Raises Refusal where it has none."""
        if self._value.unit is None:
            raise Refusal(f"{self._value.question!r} has no unit")
        return self._value.unit

    def __str__(self) -> str:
        """A short rational, or a word. Raises Refusal for others."""
        value, text = self._value, self._value.exact_text or ""
        short = isinstance(value.exact, Fraction) and len(text) <= LONGEST_SHOWN
        if short and self._kind is TEX and value.exact is not None:
            return in_mathematics(text) if "/" not in text else text.replace("-", r"\ensuremath{-}")
        if short or (not value.is_number and text.replace(" ", "").isalpha()):
            return text
        raise Refusal(f"{value.question!r} can be written in many ways; say which: {FORMS}")

    def _no_condition(self, *_: object) -> NoReturn:
        raise Refusal(f"{self._value.question!r} is no condition and is not compared; ask for what you mean")

    __bool__ = __eq__ = __lt__ = __le__ = __gt__ = __ge__ = _no_condition
    __hash__ = None  # type: ignore[assignment]


def digits(x: object, count: object, manner: Manner) -> str:
    """To `count` significant digits."""
    n, value = _count(count, 1), value_of(x)
    return _written("digits", n, lambda: manner.decimal(lambda style: value.digits(n, style)))


def places(x: object, count: object, manner: Manner) -> str:
    """To `count` digits after the point."""
    n, value = _count(count, 0), value_of(x)
    return _written("places", n, lambda: manner.decimal(lambda style: value.places(n, style)))


def exact(x: object, manner: Manner, in_code: bool) -> str:
    """The exact form in SymPy's syntax, as it stands in code, else so that nothing in it is markup."""
    text = value_of(x).exact_text
    if text is None:
        raise Refusal(f"{value_of(x).question!r} has no exact form; write | digits(6)")
    # Of HTML the template itself escapes what is no markup.
    return manner.kind.escape(text) if manner.kind in (MARKDOWN, TEX) and not in_code else text


def tex(x: object) -> str:
    """The exact form as TeX, without dollar signs."""
    return _written("tex", None, value_of(x).tex)


def mathml(x: object, manner: Manner) -> str:
    """The exact form as a <math> element."""
    if manner.kind is TEX:
        raise Refusal("MathML has no place in TeX; write | tex")
    return _written("mathml", None, value_of(x).mathml)


def value_of(x: object) -> Value:
    """The value that a filter is applied to. Raises Refusal for anything else."""
    if not isinstance(x, Quantity):
        raise Refusal(f"a {type(x).__name__} is no value; apply filters to value(...)")
    return x._value


def _count(n: object, least: int) -> int:
    if isinstance(n, bool) or not isinstance(n, int) or not least <= n <= MOST_DIGITS:
        raise Refusal(f"{str(n)[:20]!r} is no number of digits; write a whole number from {least} to {MOST_DIGITS}")
    return n


def _written(name: str, n: int | None, write: Callable[[], str]) -> str:
    """What `write` gives, its refusals for the author of a template."""
    try:
        return write()
    except AmbiguousRounding as error:
        raise Refusal(f'{error.question!r}: {error.reason}, as in {name}({n}, rounding="half-even")') from None
    except QuestionError as error:
        raise Refusal(f"{error.question!r}: {error.reason}") from None
