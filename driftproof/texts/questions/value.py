"""The answer to a question: a number known exactly, or a formula or a word, with its evidence and its unit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from driftproof.methods.number_field import Algebraic
from driftproof.texts.questions.decimals import Tie, to_digits, to_places
from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
from driftproof.texts.questions.style import AWAY, PLAIN, Style

if TYPE_CHECKING:
    from driftproof.symbolic.algebra.certified import Exact

MOST_DIGITS = 10_000
PROVED, COUNTED, CERTIFIED, STATED = "PROVED", "COUNTED", "CERTIFIED", "STATED"
# From what is exact to what nobody checked: an answer made of several has the last of theirs.
EVIDENCE = (PROVED, COUNTED, CERTIFIED, STATED)


@dataclass(frozen=True)
class Value:
    """The answer to `question`. `exact` is the number, None where the answer is a formula or a word.

    `evidence`: PROVED for what is exact, COUNTED for what was counted, CERTIFIED for what is enclosed, STATED for what
    the catalogue says of a method and nobody proves, as its title. `form` is the exact form in SymPy's syntax where
    `exact` does not say it, and `words` the TeX of a `form` that is no formula. `is_bound` marks a bound, which is
    rounded away from zero where the style names no policy.
    """

    question: str
    exact: Exact | None
    evidence: str = PROVED
    unit: str | None = None
    form: str | None = None
    is_bound: bool = False
    words: str | None = None

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
            from flint import fmpq

            # fmpq prints fractions of any length; Python's own str() refuses beyond 4300 digits.
            return str(fmpq(self.exact.numerator, self.exact.denominator))
        # A generator such as "gamma3" says nothing by itself; roots do.
        named = not isinstance(self.exact, Algebraic) or self.exact.field.name.isidentifier()
        return None if named else str(self.exact)

    def digits(self, n: int, style: Style = PLAIN) -> str:
        """The number correctly rounded to n significant digits, certified.

        Raises AmbiguousRounding on a tie for which the style names no policy, QuestionError for what is no number, for
        n below 1 or above MOST_DIGITS, and where no enclosure decides.
        """
        return self._decimal(to_digits, n, style)

    def places(self, n: int, style: Style = PLAIN) -> str:
        """The number correctly rounded to n digits after the point, certified. Raises what `digits` raises."""
        return self._decimal(to_places, n, style)

    def tex(self, *, digits: int | None = None, places: int | None = None, style: Style = PLAIN) -> str:
        """What stands between dollar signs: the exact form, or a decimal if digits or places are asked for.

        Raises what `digits` raises, and QuestionError where there is no exact form.
        """
        return self._marked_up("TEX", digits, places, style)

    def mathml(self, *, digits: int | None = None, places: int | None = None, style: Style = PLAIN) -> str:
        """A <math> element with what `tex` says. Raises what `tex` raises."""
        return f"<math>{self._marked_up('MATHML', digits, places, style)}</math>"

    def _marked_up(self, name: str, digits: int | None, places: int | None, style: Style) -> str:
        from driftproof.texts.writing import markup

        write: markup.Writer = getattr(markup, name)
        plain = Style(rounding=style.rounding)
        if digits is not None:
            return markup.decimal(self.digits(digits, plain), write)
        if places is not None:
            return markup.decimal(self.places(places, plain), write)
        text = self.exact_text
        if text is None:
            raise QuestionError(self.question, 1, "the number has no exact form; ask for digits")
        if self.words is not None:
            return write.words(self.words if write is markup.TEX else text)
        if isinstance(self.exact, Fraction) and self.form is None:
            numerator, _, denominator = text.partition("/")
            return markup.rational(numerator, denominator or "1", write)
        return markup.formula(text, write)

    def _decimal(self, write: Callable[[Exact, int, Style, str | None], str], n: int, style: Style) -> str:
        if self.exact is None:
            raise QuestionError(self.question, 1, f"{self.exact_text} is no number and has no decimals")
        if n > MOST_DIGITS:
            raise QuestionError(self.question, 1, f"{n} digits are asked for; at most {MOST_DIGITS}")
        try:
            return write(self.exact, n, style, AWAY if self.is_bound else None)
        except Tie as tie:
            raise AmbiguousRounding(self.question, 1, str(tie)) from None
        except (ValueError, ArithmeticError) as error:
            raise QuestionError(self.question, 1, str(error)) from None
