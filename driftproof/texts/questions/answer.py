"""The answer to a question: a number known exactly, a formula or a word, with evidence and unit; how it is printed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from driftproof.methods.number_field import Algebraic
from driftproof.support.plain_text import as_json
from driftproof.support.results import Printable
from driftproof.texts.questions.decimals import AWAY, HALF_EVEN, PLAIN, Style, Tie, to_digits, to_places
from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
from driftproof.texts.writing import markup

if TYPE_CHECKING:
    from flint import arb

    from driftproof.symbolic.algebra.certified import CertifiableReal

LONGEST_DECIMAL = 10_000
# Significant digits of a decimal that nobody asked for.
DIGITS_UNASKED = 15
GIVEN, PROVED, COUNTED, CERTIFIED, STATED = "GIVEN", "PROVED", "COUNTED", "CERTIFIED", "STATED"
# From what is exact to what nobody checked: an answer made of several has the last of theirs.
EVIDENCE_KINDS = (GIVEN, PROVED, COUNTED, CERTIFIED, STATED)


@dataclass(frozen=True, repr=False)
class Answer(Printable):
    """The answer to `question`. `exact` is the number, None where the answer is a formula or a word.

    `evidence`: GIVEN for what a text chose, PROVED for what is exact, COUNTED for what was counted, CERTIFIED for what
    is enclosed, STATED for what the catalogue says of a method and nobody proves, as its title. `form` is the exact
    form in SymPy's syntax where `exact` does not say it, and `words` the TeX of a `form` that is no formula. `is_bound`
    marks a bound, which is rounded away from zero where the style names no policy. `remark` is what a reader has to
    know beside the evidence.
    """

    question: str
    exact: CertifiableReal | None
    evidence: str = PROVED
    unit: str | None = None
    form: str | None = None
    is_bound: bool = False
    words: str | None = None
    remark: str | None = None

    def written(self, form: str) -> str:
        """As "text", "json", "tex", "mathml" or "md". Raises what `tex` raises."""
        return format_answer(self, OutputOptions(None, None, PLAIN), form)

    def __float__(self) -> float:
        """The double nearest to the number. Raises QuestionError for what is no number."""
        from driftproof.symbolic.algebra.certified import decide_by_enclosure

        return decide_by_enclosure(self._number(), float)

    def _number(self) -> CertifiableReal:
        if self.exact is None:
            raise QuestionError(self.question, 1, f"{self.exact_text} is no number and has no decimals")
        return self.exact

    @property
    def is_number(self) -> bool:
        """False for a formula and for a word, which have no decimals."""
        return self.exact is not None

    @property
    def exact_text(self) -> str | None:
        """The exact form, e.g. "337/384", "2*sqrt(2)", "1 - h**6/72 + h**8/576" or "yes"; None where there is none."""
        if self.form is not None:
            return self.form
        if isinstance(self.exact, Fraction):
            from driftproof.symbolic.algebra.rational_functions import exact_text

            return exact_text(self.exact)
        # A generator such as "gamma3" says nothing by itself; roots do.
        named = not isinstance(self.exact, Algebraic) or self.exact.field.name.isidentifier()
        return None if named else str(self.exact)

    def digits(self, n: int, style: Style = PLAIN) -> str:
        """The number correctly rounded to n significant digits, certified.

        Raises AmbiguousRounding on a tie for which the style names no policy, QuestionError for what is no number, for
        n below 1 or above LONGEST_DECIMAL, and where no enclosure decides.
        """
        return self._decimal(to_digits, n, style)

    def places(self, n: int, style: Style = PLAIN) -> str:
        """The number correctly rounded to n digits after the point, certified. Raises what `digits` raises."""
        return self._decimal(to_places, n, style)

    def tex(self, *, digits: int | None = None, places: int | None = None, style: Style = PLAIN) -> str:
        """What stands between dollar signs: the exact form, or a decimal if digits or places are asked for.

        Raises what `digits` raises, and QuestionError where there is no exact form.
        """
        return self._marked_up(markup.TEX, OutputOptions(digits, places, style))

    def mathml(self, *, digits: int | None = None, places: int | None = None, style: Style = PLAIN) -> str:
        """A <math> element with what `tex` says. Raises what `tex` raises."""
        return f"<math>{self._marked_up(markup.MATHML, OutputOptions(digits, places, style))}</math>"

    def _marked_up(self, write: markup.Writer, options: OutputOptions) -> str:
        if options.names_a_length:
            plain = replace(options, style=Style(rounding=options.style.rounding))
            return markup.decimal_markup(plain.decimal(self), write)
        text = self.exact_text
        if text is None:
            raise QuestionError(self.question, 1, "the number has no exact form; ask for digits")
        if self.words is not None:
            return write.words(self.words if write is markup.TEX else text)
        if isinstance(self.exact, Fraction) and self.form is None:
            numerator, _, denominator = text.partition("/")
            return markup.rational_markup(numerator, denominator or "1", write)
        return markup.formula(text, write)

    def _decimal(self, write: Callable[[CertifiableReal, int, Style, str | None], str], n: int, style: Style) -> str:
        x = self._number()
        if n > LONGEST_DECIMAL:
            raise QuestionError(self.question, 1, f"{n} digits are asked for; at most {LONGEST_DECIMAL}")
        try:
            return write(x, n, style, AWAY if self.is_bound else None)
        except Tie as tie:
            raise AmbiguousRounding(self.question, 1, str(tie)) from None
        except (ValueError, ArithmeticError) as error:
            raise QuestionError(self.question, 1, str(error)) from None


def as_printed(entry: dict[str, Any]) -> Answer:
    """A published number known only by its decimal, correctly rounded: within half a unit of the last digit.

    Digits beyond it raise ValueError.
    """
    from flint import arb, ctx, fmpq

    from driftproof.symbolic.algebra.certified import FIRST_BITS

    mantissa, _, exponent = entry["decimal"].partition("e")
    places = len(mantissa.partition(".")[2]) - int(exponent or 0)
    middle, half = Fraction(entry["decimal"]), Fraction(1, 2) * Fraction(10) ** -places

    def enclosure() -> arb:
        if ctx.prec > FIRST_BITS:
            raise ValueError(f"its decimal is published as {entry['decimal']}, which does not decide more digits")
        low, high = (arb(fmpq(x.numerator, x.denominator)) for x in (middle - half, middle + half))
        return low.union(high)

    return Answer("", enclosure, entry["evidence"])


@dataclass(frozen=True)
class OutputOptions:
    """How an answer is printed: to significant digits, or places after the point, or neither; and the style."""

    digits: int | None
    places: int | None
    style: Style

    @property
    def names_a_length(self) -> bool:
        """True where digits or places are asked for."""
        return self.digits is not None or self.places is not None

    def decimal(self, answer: Answer) -> str:
        """The number to the length asked for, else to DIGITS_UNASKED; then a tie is no error. Raises QuestionError."""
        if self.places is not None:
            return answer.places(self.places, self.style)
        if self.digits is not None:
            return answer.digits(self.digits, self.style)
        return answer.digits(DIGITS_UNASKED, replace(self.style, rounding=self.rounding(answer)))

    def rounding(self, answer: Answer) -> str:
        """The rounding policy that is used; a tie under half-even is an error only where digits are asked for."""
        return self.style.rounding or (AWAY if answer.is_bound else HALF_EVEN)


def format_answer(answer: Answer, options: OutputOptions, form: str) -> str:
    """The answer as text, json, tex, mathml or md. Raises what the methods of Answer raise."""
    if form == "json":
        decimal = options.decimal(answer) if answer.is_number or options.names_a_length else None
        said = {"question": answer.question, "exact": answer.exact_text, "decimal": decimal}
        return as_json({**said, "rounding": options.rounding(answer), "unit": answer.unit, "evidence": answer.evidence})
    if form in ("tex", "mathml"):
        write = answer.tex if form == "tex" else answer.mathml
        return write(digits=options.digits, places=options.places, style=options.style)
    if options.names_a_length:
        return options.decimal(answer)
    return f"${answer.tex()}$" if form == "md" else _as_text(answer, options)


def _as_text(answer: Answer, options: OutputOptions) -> str:
    """The number with its unit, its exact form where that is short, and the evidence."""
    exact = answer.exact_text
    if not answer.is_number or (isinstance(answer.exact, Fraction) and answer.exact.denominator == 1):
        shown, exact = options.style.written(str(exact)) if answer.is_number else str(exact), None
    else:
        shown = options.decimal(answer)
    unit = f" {answer.unit}" if answer.unit else ""
    exactly = f", exactly {exact}" if exact and len(exact) <= markup.LONGEST_IN_TEXT else ""
    remark = f"; {answer.remark}" if answer.remark else ""
    return f"{shown}{unit}{exactly}  ({answer.evidence}{remark})"
