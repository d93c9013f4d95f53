"""Every number that the lesson prints, one row each: its claim, its text, and the quantity that it stands for."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.numbers.rationals import parse_rational
from driftproof.symbolic.algebra.certified import CertifiableReal, fixed, scientific, significant
from driftproof.texts.writing.answers import exact_and_decimal
from proofs.claims import CERTIFIED, COUNTED, GIVEN, PROVED
from proofs.quantities import QUANTITIES, Quantity

DIGITS = 30
EQUALS, ROUNDS = "=", "≈"
TECHNIQUES = {
    PROVED: "exact rational arithmetic",
    CERTIFIED: "ball enclosure",
    COUNTED: "counted calls",
    GIVEN: "chosen by the lesson",
}


@dataclass(frozen=True)
class Printed:
    """A number in the lesson: claim, "=" if the text is the exact value or "≈" if it is rounded, text, quantity id."""

    claim: str
    relation: str
    text: str
    id: str

    @property
    def quantity(self) -> Quantity:
        """The quantity that the text stands for."""
        return QUANTITIES[self.id]

    @property
    def sentence(self) -> str:
        """The claim as a sentence, for the ledger."""
        words = self.quantity.words
        return f"{words[0].upper()}{words[1:]} {self.relation} {self.text}."

    def spelling(self, text: str) -> str:
        """The value in the format of `text`: exact for "=", else rounded to as many digits."""
        value = self.quantity.value()
        if self.relation == EQUALS:
            return text if parse_rational(text) == value else str(value)
        return _rounded_like(text, value)


def _rounded_like(text: str, value: CertifiableReal) -> str:
    if "e" in text:
        return scientific(value, sum(map(str.isdigit, text.split("e")[0])))
    return fixed(value, len(text.partition(".")[2]))


def published(claim: str, evidence: str, key: str, text: str, value: CertifiableReal) -> dict[str, Any]:
    """The entry of values.json for a value, with the claim that prints it as `text`; the digits are computed here.

    Raises ValueError unless the text is the value: exactly, rounded to its digits, or √ and the value's square.
    """
    answer = exact_and_decimal(value, DIGITS)
    assert answer is not None
    root, exact = text.startswith("√"), isinstance(value, Fraction) and parse_rational(text) == value
    if not (square_root(int(text[1:])) == value if root else exact or text == _rounded_like(text, value)):
        raise ValueError(f"{claim} prints {text}, and {key} is {answer['decimal']}")
    return {"id": key, "claim": claim, "text": text, "evidence": evidence, **answer}


# The statements whose number is in claims.json and not published by their proof, and two with whom it is otherwise.
NOT_IN_BOTH = {f"L{n:03}" for n in (50, 58, 94, 155, 179, 191, 203, 209, 246, 239, 247)}


def slips_of(entry: Mapping[str, Any], proved: Mapping[str, tuple[str, str]]) -> Iterator[str]:
    """What is wrong with the numbers of an entry of claims.json: a sentence for each.

    `proved` has the text and the decimal of the number that a proof publishes for a claim. The text of the entry is
    that of the proof, and is in the quote, unless the quote has its numbers in words; the decimal is the value.
    """
    key, printed, decimal = entry["id"], entry["printed"], entry["decimal"]
    text, value = proved.get(key, (None, None))
    if printed != text and key not in NOT_IN_BOTH:
        here = f"its proof, or a row of proofs/printed.py, {text}" if text else "no proof publishes it"
        yield f"{key}: in claims.json it prints {printed or 'no number'}; {here}"
    quote = entry["quote"].replace("−", "-")
    if printed and re.search(r"\d", quote) and not _stands_in(quote, printed):
        yield f"{key}: in claims.json it prints {printed}, which is not in its quote {entry['quote']!r}"
    exact = parse_rational(value or printed or decimal or "0")
    digits = max(1, len((decimal or "").lstrip("-0.").replace(".", "")))
    if decimal and parse_rational(decimal) != parse_rational(significant(exact, digits)):
        yield f"{key}: its decimal in claims.json is {decimal}; to as many digits it is {significant(exact, digits)}"


def _stands_in(quote: str, number: str) -> bool:
    """True if the quote has the number, as a whole unless the cells of a table run together in it."""
    together = re.search(r"[A-Za-z]\d", quote)
    return number in (quote if together else re.findall(r"(?<![\d.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?:/\d+)?", quote))


ROWS: tuple[Printed, ...] = (
    Printed("L023", "=", "0.5", "exact.energy"),
    Printed("L066", "=", "0.5", "first_step.h"),
    Printed("L067", "=", "1", "forward_euler.first_step.q"),
    Printed("L068", "=", "-0.5", "forward_euler.first_step.v"),
    Printed("L069", "=", "-0.5", "symplectic_euler.first_step.v"),
    Printed("L070", "=", "0.75", "symplectic_euler.first_step.q"),
    Printed("L071", "=", "4", "rk4.stages"),
    Printed("L072", "=", "0", "rk4.first_step.k1.q"),
    Printed("L073", "=", "-1", "rk4.first_step.k1.v"),
    Printed("L074", "=", "-0.25", "rk4.first_step.k2.q"),
    Printed("L075", "=", "-1", "rk4.first_step.k2.v"),
    Printed("L076", "=", "-0.25", "rk4.first_step.k3.q"),
    Printed("L077", "=", "-0.9375", "rk4.first_step.k3.v"),
    Printed("L078", "=", "-0.46875", "rk4.first_step.k4.q"),
    Printed("L079", "=", "-0.875", "rk4.first_step.k4.v"),
    Printed("L080", "=", "337/384", "rk4.first_step.q"),
    Printed("L081", "=", "-23/48", "rk4.first_step.v"),
    Printed("L082", "≈", "0.877604", "rk4.first_step.q"),
    Printed("L083", "≈", "-0.479167", "rk4.first_step.v"),
    Printed("L084", "≈", "0.877583", "exact.first_step.q"),
    Printed("L085", "≈", "-0.479426", "exact.first_step.v"),
    Printed("L086", "=", "0.500000", "exact.energy"),
    Printed("L087", "=", "0.625000", "forward_euler.first_step.energy"),
    Printed("L088", "=", "0.406250", "symplectic_euler.first_step.energy"),
    Printed("L089", "≈", "0.499895", "rk4.first_step.energy"),
    Printed("L096", "=", "0.5", "exact.energy"),
    Printed("L112", "≈", "-3.129", "forward_euler.default.q"),
    Printed("L113", "≈", "1.229", "forward_euler.default.v"),
    Printed("L114", "≈", "-0.839", "exact.default.q"),
    Printed("L115", "≈", "0.544", "exact.default.v"),
    Printed("L116", "≈", "2.390297", "forward_euler.default.state_error"),
    Printed("L117", "≈", "5.651029", "forward_euler.default.energy"),
    Printed("L118", "≈", "5.151029", "forward_euler.default.energy_change"),
    Printed("L119", "≈", "-11.508", "forward_euler.default.phase_error"),
    Printed("L120", "=", "40", "default.steps"),
    Printed("L121", "=", "40", "forward_euler.default.evaluations"),
    Printed("L122", "≈", "2.390297", "forward_euler.default.state_error"),
    Printed("L124", "=", "0.25", "default.h"),
    Printed("L125", "≈", "2.390", "forward_euler.default.state_error"),
    Printed("L126", "≈", "5.151", "forward_euler.default.energy_change"),
    Printed("L127", "=", "40", "forward_euler.default.evaluations"),
    Printed("L128", "≈", "0.090", "symplectic_euler.default.state_error"),
    Printed("L129", "≈", "-0.054", "symplectic_euler.default.energy_change"),
    Printed("L130", "=", "40", "symplectic_euler.default.evaluations"),
    Printed("L131", "≈", "3.3e-4", "rk4.default.state_error"),
    Printed("L132", "≈", "-6.7e-5", "rk4.default.energy_change"),
    Printed("L133", "=", "160", "rk4.default.evaluations"),
    Printed("L140", "=", "40", "default.steps"),
    Printed("L141", "≈", "5.651029", "forward_euler.default.energy"),
    Printed("L142", "=", "0.1", "small_steps.h"),
    Printed("L144", "=", "100", "small_steps.steps"),
    Printed("L145", "=", "0.5", "compare.h"),
    Printed("L166", "=", "-3", "symplectic_euler.stability_boundary.step1.q"),
    Printed("L167", "=", "-2", "symplectic_euler.stability_boundary.step1.v"),
    Printed("L168", "=", "5", "symplectic_euler.stability_boundary.step2.q"),
    Printed("L169", "=", "4", "symplectic_euler.stability_boundary.step2.v"),
    Printed("L170", "=", "-7", "symplectic_euler.stability_boundary.step3.q"),
    Printed("L171", "=", "-6", "symplectic_euler.stability_boundary.step3.v"),
    Printed("L172", "=", "-11", "symplectic_euler.stability_boundary.step5.q"),
    Printed("L173", "=", "-10", "symplectic_euler.stability_boundary.step5.v"),
    Printed("L181", "=", "2.5", "largest_h"),
    Printed("L195", "=", "40", "forward_euler.default.evaluations"),
    Printed("L196", "=", "160", "rk4.default.evaluations"),
    Printed("L210", "=", "1.000000", "forward_euler.first_step.q"),
    Printed("L211", "=", "-0.500000", "forward_euler.first_step.v"),
    Printed("L212", "=", "0.625000", "forward_euler.first_step.energy"),
    Printed("L213", "=", "0.750000", "symplectic_euler.first_step.q"),
    Printed("L214", "=", "-0.500000", "symplectic_euler.first_step.v"),
    Printed("L215", "=", "0.406250", "symplectic_euler.first_step.energy"),
    Printed("L216", "≈", "0.877604", "rk4.first_step.q"),
    Printed("L217", "≈", "-0.479167", "rk4.first_step.v"),
    Printed("L218", "≈", "0.499895", "rk4.first_step.energy"),
    Printed("L219", "≈", "-0.839072", "exact.default.q"),
    Printed("L220", "≈", "0.544021", "exact.default.v"),
    Printed("L221", "≈", "2.390297", "forward_euler.default.state_error"),
    Printed("L222", "≈", "5.651029", "forward_euler.default.energy"),
    Printed("L223", "≈", "0.089779", "symplectic_euler.default.state_error"),
    Printed("L224", "≈", "0.446303", "symplectic_euler.default.energy"),
    Printed("L225", "≈", "0.000325", "rk4.default.state_error"),
    Printed("L226", "≈", "0.499933", "rk4.default.energy"),
    Printed("L229", "=", "0.5", "forward_euler.exercise_1.q"),
    Printed("L230", "=", "1", "forward_euler.exercise_1.v"),
    Printed("L231", "=", "1", "symplectic_euler.exercise_1.v"),
    Printed("L232", "=", "0.5", "symplectic_euler.exercise_1.q"),
    Printed("L233", "=", "0.625", "forward_euler.exercise_1.energy"),
    Printed("L234", "=", "0.625", "symplectic_euler.exercise_1.energy"),
    Printed("L237", "=", "0.5", "symplectic_euler.exercise_1.invariant"),
    Printed("L241", "=", "100", "forward_euler.exercise_2.steps"),
    Printed("L242", "=", "25", "rk4.exercise_2.steps"),
    Printed("L243", "=", "100", "rk4.exercise_2.evaluations"),
)
