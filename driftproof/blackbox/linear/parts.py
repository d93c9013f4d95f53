"""What one-step maps are made of: whole methods, kicks, drifts, drags; and maps composed of them, in any arithmetic."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import log
from typing import Protocol

from driftproof.blackbox.linear.arithmetics import FLOATS, SIZES, Arithmetic, Number, identity, inverse
from driftproof.blackbox.linear.classes import MethodClass, Rates, exact_flow, exact_flow_sizes
from driftproof.methods.number_field import Exact
from driftproof.symbolic.runs import Entries, multiply

# Ways in which a velocity is damped at the rate g over a time h: by the factor
EXPLICIT, IMPLICIT, TRAPEZOIDAL = "explicit", "implicit", "trapezoidal"
EXPONENTIAL, CONSTANT = "exponential", "constant"
# A matrix of a higher degree in h is nothing to be read.
LONGEST_DEGREE = 40
DAMPINGS = (EXPONENTIAL, EXPLICIT, IMPLICIT, TRAPEZOIDAL, CONSTANT)


def damping_factor(form: str, x: Number, rate: Number, arithmetic: Arithmetic) -> Number:
    """exp(-x), 1 - x, 1/(1 + x), (1 - x/2)/(1 + x/2) for x = hg, or the rate itself, which then is no rate."""
    one, half = arithmetic.number(Fraction(1)), arithmetic.number(Fraction(1, 2))
    if form == EXPONENTIAL:
        return arithmetic.exponential(-x)
    if form == EXPLICIT:
        return one - x
    if form == IMPLICIT:
        return one / (one + x)
    return (one - half * x) / (one + half * x) if form == TRAPEZOIDAL else rate


def damping_rate(form: str, factor: float, h: float) -> float:
    """The g for which the factor of this form is `factor`. Raises ValueError or ZeroDivisionError if there is none."""
    if form == EXPONENTIAL:
        return -log(factor) / h
    if form == EXPLICIT:
        return (1 - factor) / h
    if form == IMPLICIT:
        return (1 / factor - 1) / h
    return 2 * (1 - factor) / (1 + factor) / h if form == TRAPEZOIDAL else factor


class Part(Protocol):
    """A linear map of (q, v), given by the rates and the step."""

    def after(self, m: Entries, a: Arithmetic, r: Rates) -> Entries:
        """The matrix of the map m followed by this one."""


@dataclass(frozen=True)
class Whole:
    """A step of a method of the catalogue; `in_field`: with the drag inside the right-hand side."""

    methods: MethodClass
    in_field: bool = False

    def after(self, m: Entries, a: Arithmetic, r: Rates) -> Entries:
        """R(hL) m, or M(h) m."""
        if a is SIZES:
            sizes = self.methods.damped_sizes if self.in_field else self.methods.plain_sizes
            return multiply(sizes(_values(r)), m)
        return multiply((self.methods.damped if self.in_field else self.methods.plain)(a, r), m)


def _values(r: Rates) -> Rates:
    """Rates that have sizes, as floats."""
    return Rates(r.h.value, r.position.value, r.stiffness.value, r.damping.value)


@dataclass(frozen=True)
class ExactFlow:
    """The exact solution, of the system with its drag."""

    def after(self, m: Entries, a: Arithmetic, r: Rates) -> Entries:
        """exp(hL) m."""
        if a is SIZES:
            return multiply(exact_flow_sizes(_values(r)), m)
        return multiply(exact_flow(a, r), m)


@dataclass(frozen=True)
class _Timed:
    """A part that lasts for c h."""

    c: Exact

    @cached_property
    def _converted(self) -> dict[str, Number]:
        return {}

    def time(self, a: Arithmetic, r: Rates) -> Number:
        """c h."""
        if a.name not in self._converted:
            self._converted[a.name] = a.number(self.c)
        return self._converted[a.name] * r.h


@dataclass(frozen=True)
class Kick(_Timed):
    """v ← v - c h k q; with a drag, v ← v - c h (k q + g v), or another form of it."""

    drag: str | None = None

    def after(self, m: Entries, a: Arithmetic, r: Rates) -> Entries:
        """Changes the lower row only."""
        qq, qv, vq, vv = m
        h = self.time(a, r)
        if self.drag is None:
            return qq, qv, vq - h * r.stiffness * qq, vv - h * r.stiffness * qv
        x, one, half = h * r.damping, a.number(Fraction(1)), a.number(Fraction(1, 2))
        kept = damping_factor(self.drag, x, r.damping, a)
        if self.drag == IMPLICIT:
            h = h * kept
        elif self.drag == TRAPEZOIDAL:
            h = h / (one + half * x)
        return qq, qv, kept * vq - h * r.stiffness * qq, kept * vv - h * r.stiffness * qv


@dataclass(frozen=True)
class Drift(_Timed):
    """q ← q + c h a v."""

    def after(self, m: Entries, a: Arithmetic, r: Rates) -> Entries:
        """Changes the upper row only."""
        qq, qv, vq, vv = m
        h = self.time(a, r) * r.position
        return qq + h * vq, qv + h * vv, vq, vv


@dataclass(frozen=True)
class Damp(_Timed):
    """v ← f v, with the factor f of this form for c h."""

    form: str

    def after(self, m: Entries, a: Arithmetic, r: Rates) -> Entries:
        """Changes the lower row only."""
        qq, qv, vq, vv = m
        f = damping_factor(self.form, self.time(a, r) * r.damping, r.damping, a)
        return qq, qv, f * vq, f * vv


@dataclass(frozen=True)
class FrozenForce:
    """q ← q + h a v + β h² a F, v ← v + h F, with F = -k q - g v taken once, before the step."""

    beta: Fraction

    def after(self, m: Entries, a: Arithmetic, r: Rates) -> Entries:
        """One matrix, times m."""
        one, h = a.number(Fraction(1)), r.h
        moved = a.number(self.beta) * h * h * r.position
        step = (
            one - moved * r.stiffness,
            h * r.position - moved * r.damping,
            -(h * r.stiffness),
            one - h * r.damping,
        )
        return multiply(step, m)


@dataclass(frozen=True)
class Model:
    """The map of `parts`, first to last, `repeats` times with h/repeats each; `adjoint`: the inverse map for -h.

    `words` name it for people, {g} being the damping. `methods` are the keys of the methods it is made from, `extras`
    the number of things that make it differ from them; with the same number, what is `unlikely` is named last.
    """

    parts: tuple[Part, ...]
    words: str
    methods: tuple[str, ...] = ()
    extras: int = 0
    repeats: int = 1
    adjoint: bool = False
    unlikely: bool = False

    def matrix(self, a: Arithmetic, r: Rates) -> Entries:
        """M(h). Raises ZeroDivisionError or OverflowError where floats have no answer."""
        h = r.h if self.repeats == 1 else r.h * a.number(Fraction(1, self.repeats))
        rates = replace(r, h=-h if self.adjoint else h)
        m = identity(a)
        for _ in range(self.repeats):
            for part in self.parts:
                m = part.after(m, a, rates)
        return inverse(m) if self.adjoint else m

    @property
    def as_method(self) -> MethodClass | None:
        """The methods that it is, if it is nothing but that."""
        part = self.parts[0] if len(self.parts) == 1 and self.repeats == 1 and not self.adjoint else None
        return part.methods if isinstance(part, Whole) and not part.in_field else None

    @property
    def has_short_matrix(self) -> bool:
        """True when its matrix is a rational function of h that is worth writing out."""
        if self.as_method:
            return True
        if any(isinstance(p, ExactFlow) or (isinstance(p, Damp) and p.form == EXPONENTIAL) for p in self.parts):
            return False
        wholes = [part.methods for part in self.parts if isinstance(part, Whole)]
        degree = len(self.parts) + sum(each.degree for each in wholes)
        return all(each.is_rational for each in wholes) and degree * self.repeats <= LONGEST_DEGREE

    @property
    def keeps_damping_per_step(self) -> bool:
        """True when the damping is a factor for each step, whatever h is: no rate."""
        return any(isinstance(part, Damp) and part.form == CONSTANT for part in self.parts)

    @cached_property
    def _times(self) -> tuple[float, float]:
        """For how many h it drifts, and for how many it kicks."""
        whole = sum(not isinstance(part, _Timed) for part in self.parts)
        drifts, kicks = (sum(float(p.c) for p in self.parts if isinstance(p, kind)) for kind in (Drift, Kick))
        return whole + drifts, whole + kicks

    def own_rates(self, damping: float) -> tuple[float, float]:
        """The a and k that it has when its parts have a = k = 1: M_qv/h and -M_vq/h for h → 0."""
        if not self.keeps_damping_per_step:
            return self._times
        h = 2.0**-60
        _, qv, vq, _ = self.matrix(FLOATS, Rates(h, 1.0, 1.0, damping))
        return qv / h, -vq / h
