"""The rule behind a border between states: a clamp, a wrapped angle, a reset, a wall, a refusal, overflow."""

from __future__ import annotations

from dataclasses import dataclass, replace

from driftproof.blackbox.contract.clauses import Trial, shown
from driftproof.blackbox.contract.still import NAMES, Border, Still
from driftproof.blackbox.contract.thresholds import named, rounder

CLAMPED, WRAPPED, RESET, REFLECTED = "clamped", "wrapped", "reset", "reflected"
REFUSED, OVERFLOWS, CHANGED = "refused", "overflows", "changed"
# Further out, a rule changes a state by a good part of its size; a strong force in a short step, by rounding.
_PLAIN = 2.0**-10
# Up to so many turns a remainder of a rounded number of radians is still near that of the number.
_TURNS = 2.0**20


@dataclass(frozen=True)
class Rule:
    """What happens to one component beyond a border.

    `value` is where the component is put (CLAMPED), by how much it is moved (WRAPPED), about what it is turned
    (REFLECTED); `more` is in words what happens besides.
    """

    kind: str
    component: int
    border: Border
    value: float = 0.0
    more: str = ""

    @property
    def inner(self) -> float:
        """The last value that is left alone."""
        return self.border.kept.given[self.component]

    @property
    def outer(self) -> float:
        """The first value beyond."""
        return self.border.beyond[0].given[self.component]

    @property
    def limit(self) -> float:
        """The border as somebody may have written it: the one of the two with the shorter name."""
        return rounder(self.inner, self.outer)

    @property
    def includes_limit(self) -> bool:
        """True when the limit itself is beyond the border."""
        return self.limit == self.outer

    @property
    def is_above(self) -> bool:
        """True when larger values are beyond the border."""
        return self.outer > self.inner

    @property
    def at_border(self) -> bool:
        """True when the component is put where the border is."""
        return self.value in (self.inner, self.outer)

    @property
    def example(self) -> tuple[Trial, ...]:
        """The last state that is left alone and the first that is not."""
        return self.border.kept, self.border.beyond[0]


@dataclass(frozen=True)
class _Point:
    """One component before and after a short step, and the other."""

    before: float
    after: float
    other_before: float
    other: float


def rule_of(still: Still, component: int, border: Border) -> Rule | None:
    """The rule that the border shows; None where it is only a strong force that begins to be felt."""
    first = border.beyond[0]
    if first.answer is None and not first.overflowed:
        return Rule(REFUSED, component, border, more=first.refusal)
    if not first.finite:
        return Rule(OVERFLOWS, component, border)
    points = [_point(trial, component) for trial in border.beyond if trial.finite]
    for reading in (_constant, _wrapped, _reflected):
        found = reading(still, component, border, points)
        if found is not None:
            return found
    plain = next((trial for trial in border.beyond if _is_plain(still, trial)), None)
    if plain is None or plain.answer is None:
        return None
    return Rule(CHANGED, component, border, more=f"{shown(plain.given[:2])} becomes {shown(plain.answer)}")


def _point(trial: Trial, component: int) -> _Point:
    assert trial.answer is not None
    other = 1 - component
    return _Point(trial.given[component], trial.answer[component], trial.given[other], trial.answer[other])


def _is_plain(still: Still, trial: Trial) -> bool:
    return trial.finite and still.change(trial) > _PLAIN * max(map(abs, trial.given[:2]))


def _others_kept(still: Still, points: list[_Point]) -> bool:
    return all(
        abs(p.other - p.other_before) <= 4 * still.h * abs(p.before) + still.slack * max(1.0, abs(p.before))
        for p in points
    )


def _constant(still: Still, component: int, border: Border, points: list[_Point]) -> Rule | None:
    """Clamped, alone or with the other component, or the whole state reset."""
    value, other = points[0].after, points[0].other
    if len({p.before for p in points}) < 2 or any(p.after != value for p in points):
        return None
    clamped = Rule(CLAMPED, component, border, value)
    if _others_kept(still, points):
        return clamped
    if any(p.other != other for p in points):
        return None
    if clamped.at_border:
        return replace(clamped, more=f"and {NAMES[1 - component]} becomes {named(other)}")
    return Rule(RESET, component, border, value, shown((value, other) if component == 0 else (other, value)))


def _wrapped(still: Still, component: int, border: Border, points: list[_Point]) -> Rule | None:
    """Moved by whole turns; `more` is set where it is one turn however far out the component is."""
    turn = points[0].after - points[0].before
    near = [p for p in points if abs(p.before) <= _TURNS * abs(turn)]
    if abs(turn) <= _PLAIN * abs(points[0].before) or len(near) < 2 or not _others_kept(still, near):
        return None
    turns = [(p.after - p.before) / turn for p in near]
    if any(abs(n - round(n)) > _PLAIN or round(n) < 1 for n in turns):
        return None
    outside = any(abs(p.after) > 2 * abs(turn) for p in near)
    return Rule(WRAPPED, component, border, turn, "once" if outside else "")


def _reflected(still: Still, component: int, border: Border, points: list[_Point]) -> Rule | None:
    """Turned back at a wall, with or without the velocity."""
    centre = (points[0].after + points[0].before) / 2
    if len({p.before for p in points}) < 2:
        return None
    if any(abs(p.after + p.before - 2 * centre) > still.bench.rounding * abs(p.before) for p in points):
        return None
    name = NAMES[1 - component]
    turned = all(abs(p.other + p.other_before) <= _PLAIN * abs(p.other_before) for p in points)
    return Rule(REFLECTED, component, border, centre, f"and {name} becomes -{name}" if turned else "")
