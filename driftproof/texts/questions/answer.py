"""Answers to questions: an exact number, a formula or words, with evidence and unit, and their printed forms."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any

from driftproof.methods.numbers.number_field import Algebraic
from driftproof.support.plain_text import DIGITS_UNASKED, as_json
from driftproof.support.results import Printable
from driftproof.texts.questions.decimals import FIXED, HALF_EVEN, PLAIN, SIGNIFICANT, Style, Tie, rounded
from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
from driftproof.texts.writing import markup

if TYPE_CHECKING:
    from flint import arb

    from driftproof.symbolic.algebra.certified import CertifiableReal

LONGEST_DECIMAL = 10_000
GIVEN, PROVED, DERIVED, COUNTED, CERTIFIED, STATED = "GIVEN", "PROVED", "DERIVED", "COUNTED", "CERTIFIED", "STATED"
# From exact to unchecked; an answer computed from several others has the weakest evidence among them.
EVIDENCE_KINDS = (GIVEN, PROVED, DERIVED, COUNTED, CERTIFIED, STATED)


@dataclass(frozen=True, repr=False)
class Answer(Printable):
    """The answer to `question`: `exact` is the number, None if the answer is a formula or words.

    `evidence` is GIVEN for a number that a text chose, PROVED for a published one that the ledger proves, DERIVED for
    any other exact one, COUNTED for a count, CERTIFIED for an enclosed number, and STATED for an unproved statement of
    the catalogue, such as a title. `form` is the exact form in SymPy's syntax if `exact` does not give it, `words` the
    TeX of a `form` that is no formula, and `remark` qualifies the evidence.
    """

    question: str
    exact: CertifiableReal | None
    evidence: str = DERIVED
    unit: str | None = None
    form: str | None = None
    words: str | None = None
    remark: str | None = None

    def written(self, form: str, *, digits: int | None = None, places: int | None = None, style: Style = PLAIN) -> str:
        """The answer as "text", "json", "tex", "mathml" or "md"; with `digits` or `places` as text or "md" a decimal.

        Raises what `tex` raises.
        """
        if form in ("tex", "mathml"):
            return (self.tex if form == "tex" else self.mathml)(digits=digits, places=places, style=style)
        named = digits is not None or places is not None
        if form == "json":
            decimal = self._to_length(digits, places, style) if self.is_number or named else None
            said = {"question": self.question, "exact": self.exact_text, "decimal": decimal}
            return as_json({**said, "rounding": self._rounding(style), "unit": self.unit, "evidence": self.evidence})
        if named:
            return self._to_length(digits, places, style)
        return f"${self.tex()}$" if form == "md" else self._as_text(style)

    def __float__(self) -> float:
        """The double nearest to the number, inf for oo. Raises QuestionError for a formula or words."""
        from driftproof.symbolic.algebra.certified import decide_by_enclosure

        return inf if self.form == "oo" else decide_by_enclosure(self._number(), float)

    def _number(self) -> CertifiableReal:
        if self.exact is None:
            raise QuestionError(self.question, 1, f"{self.exact_text} is not a number and has no decimals")
        return self.exact

    @property
    def is_number(self) -> bool:
        """True for a number; False for a formula or words, which have no decimals."""
        return self.exact is not None

    @property
    def exact_text(self) -> str | None:
        """The exact form, e.g. "337/384", "2*sqrt(2)", "1 - h**6/72 + h**8/576" or "yes"; None if there is none."""
        if self.form is not None:
            return self.form
        if isinstance(self.exact, Fraction):
            from driftproof.symbolic.algebra.rational_functions import exact_text

            return exact_text(self.exact)
        # A form in a generator such as "gamma3" is meaningless by itself, unlike one in roots.
        named = not isinstance(self.exact, Algebraic) or self.exact.field.name.isidentifier()
        return None if named else str(self.exact)

    def digits(self, n: int, style: Style = PLAIN) -> str:
        """The number correctly rounded to n significant digits, certified.

        Raises AmbiguousRounding on a tie for which the style names no policy; QuestionError for a formula or words,
        for n below 1 or above LONGEST_DECIMAL, and if no enclosure decides the digits.
        """
        return self._decimal(SIGNIFICANT, n, style)

    def places(self, n: int, style: Style = PLAIN) -> str:
        """The number correctly rounded to n digits after the point, certified. Raises what `digits` raises."""
        return self._decimal(FIXED, n, style)

    def tex(self, *, digits: int | None = None, places: int | None = None, style: Style = PLAIN) -> str:
        """The TeX to put between dollar signs: the exact form, or a decimal if `digits` or `places` is given.

        Raises what `digits` raises, and QuestionError if there is no exact form.
        """
        return self._marked_up(markup.TEX, digits, places, style)

    def mathml(self, *, digits: int | None = None, places: int | None = None, style: Style = PLAIN) -> str:
        """The content of `tex` as a <math> element. Raises what `tex` raises."""
        return f"<math>{self._marked_up(markup.MATHML, digits, places, style)}</math>"

    def _marked_up(self, write: markup.Writer, digits: int | None, places: int | None, style: Style) -> str:
        if digits is not None or places is not None:
            return markup.decimal_markup(self._to_length(digits, places, Style(rounding=style.rounding)), write)
        text = self.exact_text
        if text is None:
            raise QuestionError(self.question, 1, "the number has no exact form; add digits or places")
        if self.words is not None:
            return write.words(self.words if write is markup.TEX else text)
        if isinstance(self.exact, Fraction) and self.form is None:
            numerator, _, denominator = text.partition("/")
            return markup.rational_markup(numerator, denominator or "1", write)
        return markup.formula(text, write)

    def _as_text(self, style: Style) -> str:
        """The answer with its unit, its exact form if that is short, and the evidence."""
        exact = self.exact_text
        if not self.is_number or (isinstance(self.exact, Fraction) and self.exact.denominator == 1):
            shown, exact = style.written(str(exact)) if self.is_number else str(exact), None
        else:
            shown = self._to_length(None, None, style)
        unit = f" {self.unit}" if self.unit else ""
        exactly = f", exactly {exact}" if exact and len(exact) <= markup.LONGEST_IN_TEXT else ""
        remark = f"; {self.remark}" if self.remark else ""
        return f"{shown}{unit}{exactly}  ({self.evidence}{remark})"

    def _to_length(self, digits: int | None, places: int | None, style: Style) -> str:
        """The decimal to the given length, else to DIGITS_UNASKED, where a tie is no error."""
        if places is not None:
            return self.places(places, style)
        if digits is not None:
            return self.digits(digits, style)
        return self.digits(DIGITS_UNASKED, replace(style, rounding=self._rounding(style)))

    def _rounding(self, style: Style) -> str:
        return style.rounding or HALF_EVEN

    def _decimal(self, form: str, n: int, style: Style) -> str:
        x = self._number()
        if n > LONGEST_DECIMAL:
            raise QuestionError(self.question, 1, f"{n} digits are too many; at most {LONGEST_DECIMAL} are written")
        try:
            return rounded(x, form, n, style)
        except Tie as tie:
            raise AmbiguousRounding(self.question, 1, str(tie)) from None
        except (ValueError, ArithmeticError) as error:
            raise QuestionError(self.question, 1, str(error)) from None


def as_printed(entry: dict[str, Any]) -> Answer:
    """The answer for a published number known only by its decimal, to within half a unit of the last digit.

    More digits than it decides raise ValueError.
    """
    from flint import ctx

    from driftproof.symbolic.algebra.certified import FIRST_BITS, enclose

    mantissa, _, exponent = entry["decimal"].partition("e")
    places = len(mantissa.partition(".")[2]) - int(exponent or 0)
    middle, half = Fraction(entry["decimal"]), Fraction(1, 2) * Fraction(10) ** -places

    def enclosure() -> arb:
        if ctx.prec > FIRST_BITS:
            raise ValueError(f"only its decimal {entry['decimal']} is published, which does not determine more digits")
        return enclose(middle - half).union(enclose(middle + half))

    return Answer("", enclosure, entry["evidence"])
