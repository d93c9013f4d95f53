"""The rounding error of a run of N steps, bounded for every start and every N.

Let M = rho times an isometry of a norm |.|, and let one step of the program err by at most c|z| + r in it. Then the
error e_n = fl^n(z0) - M^n z0 obeys |e_(n+1)| <= rho|e_n| + c|fl^n(z0)| + r <= (rho + c)|e_n| + c rho^n |z0| + r, so

    |e_N| <= ((rho + c)^N - rho^N) |z0| + r (1 + (rho + c) + ... + (rho + c)^(N-1)),

and every state on the way has |fl^n(z0)| <= (rho + c)^n |z0| + r (1 + ... + (rho + c)^(n-1)), which must not overflow.
Both bounds grow with rho, c, r and |z0|, so irrational ones are replaced by rationals above them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, TypeAlias

from flint import arb, ctx

from driftproof.methods.programs.stepping import Force, oscillator
from driftproof.symbolic.algebra.certified import enclose, endpoints, scientific, settled
from driftproof.symbolic.rounding.adapted_norm import AdaptedNorm, NoAdaptedNorm, adapted_norm
from driftproof.symbolic.rounding.fixed_step_bound import fixed_step_bound
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat
from driftproof.symbolic.rounding.step_bound import (
    LinearBound,
    StepOrMethod,
    linear_form,
    magnitude,
    operations_of,
    state_terms,
    trace_step,
)

_State: TypeAlias = tuple[Fraction, Fraction]
# Upper bounds are rounded up from enclosures with at least this many accurate bits.
_SETTLED_BITS = 40
_FIRST_BITS = 256
# A magnitude beyond 2**4096 is shown as a power of two.
_LARGEST_WRITTEN_OUT = 4096


class HypothesisFails(ValueError):
    """The theorem on N steps does not apply; the message names the hypothesis that fails."""


@dataclass(frozen=True)
class RunBound:
    """|fl^N(z0) - M(h)^N z0| <= `own` in the method's own norm, and <= `euclidean` in the Euclidean one.

    `growth` is c and `underflow` is r, per step and in the method's own norm. All bounds are rational, rounded up.
    """

    format: FloatFormat
    h: Fraction
    steps: int
    start: _State
    norm: AdaptedNorm
    growth: Fraction
    underflow: Fraction
    own: Fraction

    @property
    def euclidean(self) -> Fraction:
        """The bound on sqrt(dq² + dv²)."""
        return self.norm.euclidean_per_unit * self.own


def run_bound(
    subject: StepOrMethod,
    h: Fraction,
    steps: int,
    start: _State,
    fmt: FloatFormat = BINARY64,
    local: LinearBound | None = None,
    force: Force = oscillator,
) -> RunBound:
    """The rounding bound of `steps` steps of size h from `start`, by the theorem above.

    `local` is a proved bound of one step at h, by default the linear one of `fixed_step_bound`. h and `start` are the
    floats themselves. Raises HypothesisFails if h or the start is not a number of the format, if the step is not a
    rotation times a factor, or if a state might overflow.
    """
    for what, x in (("h", h), ("the start's q", start[0]), ("the start's v", start[1])):
        _require_number(what, x, fmt)
    if steps < 0:
        raise HypothesisFails(f"N = {steps}: the number of steps must not be negative")
    derived = fixed_step_bound(subject, h, fmt, force)
    try:
        norm = adapted_norm((*derived.matrix[0], *derived.matrix[1]))
    except NoAdaptedNorm as reason:
        raise HypothesisFails(f"at h = {h}: {reason}") from None
    growth, underflow = growth_per_step(norm, local or derived.linear)
    run = _Run(norm, norm.length(*start), growth, underflow, steps)
    _require_safe(run, largest_safe_state(subject, h, fmt, force), fmt)
    return RunBound(fmt, h, steps, start, norm, growth, underflow, run.error)


def growth_per_step(norm: AdaptedNorm, local: LinearBound) -> tuple[Fraction, Fraction]:
    """(c, r) with |error of one step| <= c|z| + r in the norm, rounded up, for any error within `local`."""
    return norm.gain(local.error), norm.largest_of_signs(*local.underflow)


def largest_safe_state(
    subject: StepOrMethod, h: Fraction, fmt: FloatFormat = BINARY64, force: Force = oscillator
) -> Fraction:
    """The largest s for which |q|, |v| <= s proves that no operation of the step at h overflows.

    Each operation's result is a q + b v + c up to its error, both linear in the state, so each requires
    (|a| + |b| + error per unit of state) s + |c| + error at the origin <= largest finite number; s is the largest that
    satisfies all. This is sufficient, not necessary; `StepBound.is_safe` tests a given state.
    Raises OverflowError if not even the origin is safe, NotLinear, RefusedOperation.
    """
    safe = fmt.largest
    for x in operations_of(trace_step(subject, fmt, force, h)):
        a, b, free = linear_form(state_terms(magnitude(x), fmt))
        if free > fmt.largest:
            raise OverflowError(f"at h = {h} the step may overflow {fmt.name} from every state")
        if a or b:
            safe = min(safe, (fmt.largest - free) / (a + b))
    return safe


def safe_state_text(safe: Fraction) -> str:
    """The largest power of ten that is not above a safe state, e.g. "1e307"; "0" where only the origin is safe."""
    if not safe:
        return "0"
    k = int(scientific(safe, 1).partition("e")[2])  # a rounding up may have led into the next decade
    return f"1e{k if Fraction(10) ** k <= safe else k - 1}"


class _Run(NamedTuple):
    """The quantities of the theorem; the methods give balls at the current precision."""

    norm: AdaptedNorm
    length: Fraction
    growth: Fraction
    underflow: Fraction
    steps: int

    @property
    def factor(self) -> Fraction:
        return self.norm.rho + self.growth

    @property
    def error(self) -> Fraction:
        """The bound on |e_N|, rounded up."""
        if not self.growth and not self.underflow:
            return Fraction(0)
        length, factor, rho, n = self.length, self.factor, self.norm.rho, self.steps
        return _above(lambda: enclose(length) * (enclose(factor) ** n - enclose(rho) ** n) + self._spread())

    def reach(self) -> arb:
        """A bound on |q| and |v| of every state on the way: the powers grow or shrink monotonically."""
        power = enclose(max(self.factor, Fraction(1))) ** self.steps
        return enclose(self.norm.component_per_unit) * (enclose(self.length) * power + self._spread())

    def _spread(self) -> arb:
        if self.factor == 1:
            return enclose(self.underflow * self.steps)
        excess = self.factor - 1
        return enclose(self.underflow) * (enclose(self.factor) ** self.steps - 1) / enclose(excess)


def _require_number(what: str, x: Fraction, fmt: FloatFormat) -> None:
    if abs(x) > fmt.largest:
        raise HypothesisFails(f"{what} is larger than the largest {fmt.name} number")
    if not fmt.holds(x):
        raise HypothesisFails(f"{what} = {x} is not a {fmt.name} number; the nearest is {fmt.nearest(x)}")


def _require_safe(run: _Run, safe: Fraction, fmt: FloatFormat) -> None:
    with ctx.workprec(_FIRST_BITS):
        reach = run.reach()
        if reach <= enclose(safe):
            return
        power = int((reach.log() / arb(2).log()).upper().floor().unique_fmpz())
    size = scientific(run.reach, 4) if power < _LARGEST_WRITTEN_OUT else f"2**{power}"
    raise HypothesisFails(
        f"overflow of {fmt.name} cannot be excluded within {run.steps} steps: "
        f"states might reach {size}, but a step is safe only up to {scientific(safe, 4)}"
    )


def _above(ball: Callable[[], arb]) -> Fraction:
    """An upper bound of a positive number, within a relative 2**-_SETTLED_BITS of it."""

    def above() -> Fraction | None:
        value = ball()
        accurate = value.is_exact() or value.rel_accuracy_bits() >= _SETTLED_BITS
        return endpoints(value)[1] if accurate else None

    return settled(above, _FIRST_BITS)
