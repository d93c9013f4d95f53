"""Explanations of a reading in words: methods and their relatives that rounding cannot tell from it, simplest first."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from driftproof.blackbox.linear import relatives
from driftproof.blackbox.linear.facts import MatrixFacts, Undo, facts_of_model
from driftproof.blackbox.linear.reading import Reading, swapped
from driftproof.blackbox.linear.score import FORWARDS, Scored, scored
from driftproof.blackbox.linear.search import Fit, Search
from driftproof.blackbox.probes.simple_rationals import rational_text

NONE, INPUT, OUTPUT, BOTH = "", "in its input", "in its output", "in its input and its output"
# The map without its exchange of q and v, from the entries of the map with it; each undoes itself.
_UNDONE: dict[str, Undo] = {
    NONE: lambda m: m,
    INPUT: lambda m: (m[1], m[0], m[3], m[2]),
    OUTPUT: lambda m: (m[2], m[3], m[0], m[1]),
    BOTH: lambda m: (m[3], m[2], m[1], m[0]),
}
MOST_EXPLANATIONS = 4
# As many times as the roundings of one program may exceed those of another.
MUCH_FARTHER = 1 << 10
# A rate that is wrong in a program, and not a little by accident, is wrong by this much.
LEAST_OFF = Fraction(1, 1024)


@dataclass(frozen=True)
class Explanation:
    """A scored fit of the reading, position and velocity being exchanged where `exchange` says so.

    With `known`, the system is q' = v, v' = -q; else its stiffness and its drag are the stepper's own.
    """

    scored: Scored
    exchange: str
    known: bool

    @property
    def extras(self) -> int:
        """How many things make it differ from a method of the catalogue on its system."""
        fit = self.scored.fit
        off = fit.position != 1 or (self.known and fit.stiffness != 1)
        return fit.model.extras + bool(self.exchange) + bool(self.scored.restriction) + off

    @property
    def rates_are_right(self) -> bool:
        """True for q' = v, v' = -q."""
        return self.scored.fit.position == self.scored.fit.stiffness == 1

    @property
    def naturalness(self) -> tuple[int, str, bool, bool]:
        """The least of these is the most natural explanation."""
        return self.extras, self.exchange, self.scored.fit.model.unlikely, not self.rates_are_right

    @property
    def words(self) -> str:
        """What the stepper is, if this is it."""
        exchange = f", with q and v exchanged {self.exchange}" if self.exchange else ""
        restriction = f", {self.scored.restriction}" if self.scored.restriction else ""
        return f"{_model_in_words(self.scored.fit)}{exchange}{self._rates_in_words()}{restriction}"

    def _rates_in_words(self) -> str:
        a, k = self.scored.fit.position, self.scored.fit.stiffness
        if a == k == -1 or (a == -1 and not self.known):
            return ", with -h for h: it steps back in time"
        if a == k != 1 and self.known:
            return f", with {rational_text(a)} h for h"
        wrong = [f"the position moves by {rational_text(a)} h v"] * (a != 1)
        wrong += [f"the force enters {rational_text(k)} times"] * (self.known and k != 1)
        return f", but {' and '.join(wrong)}" if wrong else ""

    def facts(self) -> MatrixFacts:
        """The facts of its exact matrix, for the system that it should solve."""
        fit = self.scored.fit
        damping = Fraction(0) if fit.model.keeps_damping_per_step else fit.damping
        system = (Fraction(1) if self.known else fit.stiffness), damping
        return facts_of_model(fit.model, (fit.position, fit.stiffness, fit.damping), system, _UNDONE[self.exchange])


def _model_in_words(fit: Fit) -> str:
    words = fit.model.words
    if fit.kept is not None:
        words = words.replace("exp(-{g} h)", f"{rational_text(fit.kept)}**h")
    return words.format(g=rational_text(fit.damping))


def explanations(reading: Reading, *, known: bool) -> list[Explanation]:
    """What explains the reading, the most natural first: of the fewest extras, and what leaves the oscillator as it is.

    Empty if nothing does.
    """
    found = _found(reading, known=known) or _found_forwards(reading, known=known)
    everywhere = [each for each in found if not each.scored.restriction]
    near = _as_near_as_any(everywhere or found, float(reading.format.u))
    near.sort(key=lambda each: each.naturalness)
    doubtful = near and not near[0].rates_are_right
    kept = [each for each in near if each.extras == near[0].extras or (doubtful and each.rates_are_right)]
    return kept[:MOST_EXPLANATIONS]


def _found(reading: Reading, *, known: bool) -> list[Explanation]:
    """What passes, stage by stage until something does at all steps with the rates of the oscillator."""
    readings = {name: _exchanged(reading, undo) for name, undo in _UNDONE.items()}
    searches = {name: Search(each) for name, each in readings.items() if each.at_zero and not swapped(each.at_zero)}
    found: list[Explanation] = []
    for damped, stage in _STAGES:
        for name, search in searches.items():
            if search.may_have(damping=damped) and (name != BOTH or search.stiffness > 0):
                fits = (scored(fit, search.reading) for fit in stage(search) if _is_sensible(fit, known=known))
                found += [Explanation(each, name, known) for each in fits if each.passes]
        everywhere = [each for each in found if not each.scored.restriction]
        if any(each.rates_are_right for each in everywhere) or (everywhere and stage is not _methods):
            break
    return found


def _found_forwards(reading: Reading, *, known: bool) -> list[Explanation]:
    """What passes where steps back in time, which many codes refuse or leave undone, are no part of the reading."""
    forwards = tuple((h, m) for h, m in reading.steps if h > 0)
    if len(forwards) == len(reading.steps):
        return []
    found = _found(replace(reading, steps=forwards), known=known)
    where = [replace(each.scored, restriction=each.scored.restriction or FORWARDS) for each in found]
    return [replace(each, scored=scored) for each, scored in zip(found, where, strict=True)]


def _as_near_as_any(found: Sequence[Explanation], u: float) -> list[Explanation]:
    """Those that are not much farther off than others, as what passes by the width of its own bound alone is."""
    least = min((each.scored.error.relative for each in found), default=0.0)
    return [each for each in found if each.scored.error.relative <= MUCH_FARTHER * (least + u)]


def _is_sensible(fit: Fit, *, known: bool) -> bool:
    """False for rates that are neither right nor clearly something else: those of another map, bent to fit."""
    rates = (fit.position, fit.stiffness) if known else (fit.position,)
    return all(rate == 1 or abs(rate - 1) >= LEAST_OFF for rate in rates)


def _methods(search: Search) -> Iterable[Fit]:
    return search.classes()


def _close_relatives(search: Search) -> Iterator[Fit]:
    yield from search.with_part_left_out()
    yield from search.undamped(relatives.substeps())
    yield from search.undamped(relatives.adjoints())
    yield from search.frozen(damped=False)


def _with_damping(search: Search) -> Iterator[Fit]:
    yield from search.with_drag(relatives.with_drag_in_the_force())
    yield from search.frozen(damped=True)
    yield from search.with_velocity_damped()


def _with_damping_in_substeps(search: Search) -> Iterator[Fit]:
    yield from search.with_drag(relatives.damped_in_substeps())


# With damping or without, and what may fit then: the most natural first.
_STAGES: tuple[tuple[bool, Callable[[Search], Iterable[Fit]]], ...] = (
    (False, _methods),
    (False, _close_relatives),
    (True, _with_damping),
    (True, _with_damping_in_substeps),
)


def _exchanged(reading: Reading, undo: Undo) -> Reading:
    steps = tuple((h, undo(m)) for h, m in reading.steps)
    return replace(reading, steps=steps, at_zero=None if reading.at_zero is None else undo(reading.at_zero))
