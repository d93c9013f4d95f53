"""Rounding bounds as text: formulas in u, d, eta and h."""

from __future__ import annotations

from fractions import Fraction

from driftproof.symbolic.algebra.certified import AWAY, significant
from driftproof.symbolic.rounding.polynomials import ErrorPolynomial, terms
from driftproof.symbolic.rounding.step_bound import StepBound

# chosen: the bound that is usually quoted is of the first power of d; from the third power of d and the second of eta
# on, the formulas are long and say nothing new.
SHOWN_POWERS = (2, 1)
# A fraction of more bits than this, some 24 digits, is shown as a decimal instead, rounded up to SHOWN_DIGITS.
LONGEST_BITS = 80
SHOWN_DIGITS = 6


def first_order_text(bound: StepBound) -> list[str]:
    """The two lines |dq| <= u (...|q| + ...|v|) and |dv| <= ..., the bound up to u**2 and eta, for h >= 0."""
    lines = []
    for name, row in zip("qv", bound.first_order, strict=True):
        columns = [
            (_sum(_by_d_and_eta(entry).get((0, 0), {})), state)
            for entry, state in zip(row, ("|q|", "|v|"), strict=True)
        ]
        lines.append(f"|d{name}| <= u ({' + '.join(_times(c, state) for c, state in columns if c != '0')})")
    return lines


def full_text(bound: StepBound, powers: tuple[int, int] | None = SHOWN_POWERS) -> list[str]:
    """One line for each component and each power of d and eta up to `powers`; None shows every power.

    If lines are left out, the last line says how many.
    """
    lines, hidden = [], []
    for name, row, free in zip("qv", bound.error, bound.underflow, strict=True):
        grouped: dict[tuple[int, int], list[str]] = {}
        for entry, state in zip((*row, free), ("|q|", "|v|", ""), strict=True):
            for key, by_step in sorted(_by_d_and_eta(entry).items()):
                grouped.setdefault(key, []).append(_times(_sum(by_step), state))
        for (in_eta, in_d), parts in sorted(grouped.items()):
            if powers is not None and (in_d > powers[0] or in_eta > powers[1]):
                hidden.append(in_eta > powers[1])
                continue
            lines.append(f"|d{name}|: {_power('eta', in_eta)}{_power('d', in_d)}({' + '.join(parts)})")
    higher = "d or eta" if any(hidden) else "d"
    return [*lines, f"and {len(hidden)} lines with higher powers of {higher}"] if hidden else lines


def format_text(bound: StepBound) -> str:
    """The line that defines u, d and eta for the bound's format."""
    fmt = bound.format
    return f"{fmt.name}: u = 2**-{fmt.precision}, d = u/(1 + u), eta = 2**{fmt.emin - fmt.precision + 1}"


def _by_d_and_eta(entry: ErrorPolynomial) -> dict[tuple[int, int], dict[int, Fraction]]:
    """{(power of eta, power of d): {power of h: coefficient}}."""
    grouped: dict[tuple[int, int], dict[int, Fraction]] = {}
    for (in_d, in_eta, in_h, *_), c in terms(entry):
        grouped.setdefault((in_eta, in_d), {})[in_h] = c
    return grouped


def _sum(by_step: dict[int, Fraction]) -> str:
    return " + ".join(_term(c, k) for k, c in sorted(by_step.items())) or "0"


def _term(c: Fraction, k: int) -> str:
    step = _power("h", k).rstrip(" ")
    return (step if c == 1 else f"{_above(c)} {step}") if step else _above(c)


def _above(c: Fraction) -> str:
    """The coefficient as text; a long one is rounded up, as a larger bound holds as well."""
    is_short = c.numerator.bit_length() + c.denominator.bit_length() <= LONGEST_BITS
    return str(c) if is_short else significant(c, SHOWN_DIGITS, AWAY)


def _power(name: str, k: int) -> str:
    return "" if not k else f"{name} " if k == 1 else f"{name}**{k} "


def _times(coefficient: str, state: str) -> str:
    if not state:
        return coefficient
    if coefficient == "1":
        return state
    return f"({coefficient}) {state}" if " + " in coefficient else f"{coefficient} {state}"
