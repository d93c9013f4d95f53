"""The verdict of `identify`: which method a stepper is, in one line, by the most certain answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from driftproof.blackbox.checks.step_size import IGNORED
from driftproof.blackbox.checks.trials import CheckResult
from driftproof.blackbox.families.damping import Damping
from driftproof.blackbox.findings import NO_EVIDENCE, ArgumentsExchanged, Outcome, StaleSlope, UnsupportedCall
from driftproof.blackbox.judging.measured_order import MeasuredOrder
from driftproof.blackbox.judging.systems.own_system import OwnMethods
from driftproof.blackbox.matching.candidates import EMBEDDED
from driftproof.blackbox.matching.linear_candidates import LinearCandidate
from driftproof.blackbox.matching.linear_match import LinearFit
from driftproof.blackbox.matching.match import Identity, Match, match_tableau, matched
from driftproof.blackbox.matching.near_misses import Near
from driftproof.blackbox.matching.read_order import ReadOrder, read_order
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.linear_steps import LINEAR
from driftproof.blackbox.probes.questions import CoefficientReading
from driftproof.blackbox.probes.stage_solutions import SOLVED, UNSOLVED
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import NO_ANSWER, NOT_KNOWN, UNDECIDED, Basis, Naming
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.support.plain_text import counted

# Of the methods that agree on a system of its own so many are named, as on a constant force, which many solve exactly.
_MOST_NAMED = 4


class Recognised(NamedTuple):
    """The coefficients read, the methods that have them, and their order; `untimed` ignores the nodes."""

    reading: CoefficientReading
    identity: Identity
    order: ReadOrder
    untimed: Identity | None = None

    @property
    def row(self) -> str:
        """The remark that a pair propagates its embedded row, with the orders of both; "" if it does not."""
        match = self.identity.matches[0]
        pair = METHODS[match.key] if match.relation == EMBEDDED else None
        if not isinstance(pair, RungeKutta):
            return ""
        return f": the row of order {pair.embedded_order}, not that of order {pair.claimed_order}"

    @property
    def solved(self) -> str:
        """The remark that the implicit stages are solved less accurately than by most solvers; "" if they are not."""
        solved = self.reading.solved
        return f", but {solved.words}" if solved and (solved.skipped or solved.curved > SOLVED) else ""

    def beyond_plain_forces(self, measured: Sequence[MeasuredOrder]) -> str:
        """How coefficients read from a force fail beyond q'' = F(q): as a tableau, in times or for velocities."""
        reading = self.reading
        if not isinstance(reading, ForceReading):
            return ""
        if reading.refused and isinstance(METHODS[self.identity.matches[0].key], RungeKutta):
            return f" on q'' = F(q), but not on y' = f(t, y): {reading.refused}"
        if reading.wrong_time:
            return f" called at wrong times: {reading.wrong_time}"
        order = 1 if reading.velocities_limit_order else next((found.order for found in measured), None)
        if reading.a_velocity is None or order is None or order >= self.order.order:
            return ""
        first, *rest = reading.stale_velocities or [""]
        why = f": {first}" + (f", and {len(rest)} more" if rest else "") if first else ""
        lost = f"order {order} where the force depends on the velocity, not {self.order.order}"
        return f" on q'' = F(q), but of {lost}{why}"


@dataclass(frozen=True)
class Seen:
    """The outcome of each question; `damping` and `twins` are asked only where no tableau was read."""

    introduction: Outcome
    coefficients: Outcome
    linear: Outcome
    order: Outcome
    estimate: Outcome
    dense: Outcome
    damping: Outcome
    twins: Outcome
    checks: tuple[CheckResult, ...]
    own: OwnMethods | None = None  # what it is on another system than q'' = -q
    arithmetic: str = ""  # a change of the rounding mode or of subnormal numbers, in words

    @cached_property
    def read(self) -> Recognised | None:
        """The coefficients with the methods that have them; None if none were read."""
        reading: CoefficientReading | None = self.coefficients.result
        if reading is None:
            return None
        identity = matched(reading)
        order = read_order(reading, next(iter(identity.matches), None))
        if isinstance(reading, TableauReading) and order.untimed_order > order.order:
            return Recognised(reading, identity, order, match_tableau(replace(reading, c=None)))
        return Recognised(reading, identity, order)

    @property
    def fit(self) -> LinearFit | None:
        """The fit to linear steps; None if there was no answer."""
        fit: LinearFit | None = self.linear.result
        return fit

    @property
    def key(self) -> str | None:
        """The catalogue key of the unchanged method that it is on the plain oscillator; None if it is none.

        An implicit method is recognised by its coefficients only. Of several methods with the same coefficients or the
        same matrix the first is named: they have one rounding bound here.
        """
        if self.read is not None:
            keys: Sequence[str] = self.read.identity.keys
            if self.read.reading.implicit:
                return next(iter(keys), None)
        else:
            best = None if self.fit is None or self._besides_one_number else self.fit.best
            keys = best.methods if best is not None and best.extras == 0 and best.rates_are_right else ()
        return next((key for key in keys if METHODS[key].explicit), None)

    @property
    def size(self) -> float:
        """The size of the states at which it is that method: less than 1 if larger states meet a limit."""
        read = 1.0 if self.read is None else self.read.reading.amplitude
        return min(read, self.fit.amplitude) if self.fit is not None and self.fit.kind == LINEAR else read

    @cached_property
    def naming(self) -> Naming:
        """The verdict, by the most certain answer."""
        if self.introduction.kind in NO_EVIDENCE:
            return Naming(Basis.UNDECIDED, f"{UNDECIDED}: {self.introduction.seen}")
        if self.introduction.failed:
            answered = self.introduction.kind in (StaleSlope.kind, ArgumentsExchanged.kind)
            basis, words = (Basis.UNKNOWN, NOT_KNOWN) if answered else (Basis.NO_ANSWER, NO_ANSWER)
            return Naming(basis, f"{words}: {self.introduction.seen}")
        read, fit = self.read, self.fit
        if read is not None and read.identity.matches:
            return self._known(read)
        if read is not None and read.untimed is not None and read.untimed.matches:
            match, late = read.untimed.matches[0], f"order {read.order.order} where the right-hand side depends on t"
            return _varied(Basis.ADDED, (match,), f" called at wrong times: {late}")
        if read is not None and (read.reading.implicit or (fit is not None and fit.best and not self.twins.result)):
            return self._unknown_stages(read)
        if self._besides_one_number:
            return self._unknown
        twins = tuple(self.twins.result or ())
        alike = f"; its nonlinear steps are those of {', '.join(twins)}" if twins else ""
        if fit is not None and fit.best is not None:
            best, nearest = fit.best, fit.nearly or fit.nearest
            keys = (*best.methods, *(nearest.methods if nearest is not None else ()), *twins)
            own = "" if self.own is None else f"; {self.own.system}"
            if self.own is not None and self.own.keys is not None:
                return self._on_own_system(self.own.system, self.own.keys, _in_words(fit, best))
            reserved = bool(best.restriction) or not best.rates_are_right or (nearest is not None and nearest.off > 0)
            words = f"judging by linear steps only, it is {_in_words(fit, best)}{alike}{own}"
            return Naming(Basis.LINEAR_ONLY, words, keys, reserved)
        if read is not None and read.identity.near:
            return _near(read.identity.near[0])
        if read is not None and not self.ignores_step:
            return self._unknown_stages(read)
        if fit is not None and read is None and (nearly := fit.nearly):
            name = "nearly " * bool(nearly.off) + " or ".join(nearly.methods)
            few_bits = " in numbers of few bits, not in all numbers"
            off = f", to {nearly.off:.1e} at states of size 1" if nearly.off else few_bits
            words = f"judging by linear steps only, it is {name}{off}{alike}"
            return Naming(Basis.LINEAR_ONLY, words, (*nearly.methods, *twins), reserved=True)
        of_one_number = self.linear.kind == UnsupportedCall.kind and self.coefficients.failed
        open_questions = [o for o in (self.coefficients, self.linear) if o.kind in NO_EVIDENCE or of_one_number]
        return Naming(Basis.UNDECIDED, f"{UNDECIDED}: {open_questions[0].seen}") if open_questions else self._unknown

    def _on_own_system(self, system: str, keys: Sequence[str], linear: str) -> Naming:
        """The methods whose steps it takes on a system that is linear near (0, 0) only, where it is `linear`."""
        if not keys:
            alone = f"and on it its steps are those of no method; near (0, 0) it is {linear}"
            return Naming(Basis.UNKNOWN, f"{NOT_KNOWN}: {system}, {alone}")
        words = f"judging by one system only, it is {_named(keys)}; {system}"
        return Naming(Basis.LINEAR_ONLY, words, tuple(keys), reserved=True)

    def _known(self, read: Recognised) -> Naming:
        """All methods with the coefficients read, and what is to be added: rows, stages, forces, faults besides y1."""
        matches, elsewhere = read.identity.matches, read.beyond_plain_forces(self.measured)
        judged = filter(None, (self.estimate.result, self.dense.result))
        faults = "".join(f"; {fault}" for each in judged for fault in each.faults)
        more = _at(self.size) + read.row + read.solved + elsewhere + faults
        basis = Basis.ADDED if more or matches[0].relation else Basis.KNOWN
        named = _varied(basis, matches, more, _at(self.size) or read.solved)
        return named._replace(reserved=bool(read.solved or elsewhere))

    @property
    def _besides_one_number(self) -> bool:
        """True if it acts on vectors in a way that linear steps of one number do not show."""
        found: Damping | None = self.damping.result
        return found is not None and len(found.at_once) > 1

    @property
    def ignores_step(self) -> str:
        """The fault of a step that is the same whatever h is, "" if it is not; it damps nothing, unless v becomes 0."""
        stops = self.damping.result is not None and self.damping.result.at_once == ((0.0,),)
        return next((check.words for check in self.checks if check.what == IGNORED and not stops), "")

    @property
    def damps(self) -> Sequence[str]:
        """The fault of a damping in every step, however short, of a step that does not ignore h."""
        found: Damping | None = self.damping.result
        return [] if found is None or self.ignores_step else found.faults

    @property
    def _unknown(self) -> Naming:
        """The verdict without a method of the catalogue: that h is ignored, or else the damping, if it was read."""
        found: Damping | None = self.damping.result
        if self.ignores_step:
            return Naming(Basis.UNKNOWN, f"{NOT_KNOWN}: {self.ignores_step}")
        if self.own is not None and self.own.keys == ():
            return Naming(Basis.UNKNOWN, f"{NOT_KNOWN}: {self.own.system}, and on it its steps are those of no method")
        if self.own is not None:
            alike = f"on it its steps are those of {_named(self.own.keys)}" if self.own.keys else "verify shows more"
            return Naming(Basis.UNDECIDED, f"{UNDECIDED}: {self.own.system}: {alike}", self.own.keys or ())
        return Naming(Basis.UNKNOWN, NOT_KNOWN if found is None else found.verdict)

    def _unknown_stages(self, read: Recognised) -> Naming:
        """The nearest method to unknown stages, or else their number, their order and their linear method."""
        if read.identity.near:
            return _near(read.identity.near[0], read.solved)
        calls, implicit = read.reading.calls, "implicit " * read.reading.implicit
        stages = counted(calls, f"{implicit}stage")
        best = None if self.fit is None or self.fit.best is None else _in_words(self.fit, self.fit.best)
        linear = f", though on linear problems it is {best}" if best is not None else ""
        words = f"{NOT_KNOWN}, but has {stages} and {read.order.words}{linear}{read.solved}"
        return Naming(Basis.UNKNOWN, words, () if self.fit is None or self.fit.best is None else self.fit.best.methods)

    @property
    def measured(self) -> tuple[MeasuredOrder, ...]:
        """The orders measured, first that on problems of the kind that the coefficients were read on."""
        orders: tuple[MeasuredOrder, ...] = self.order.result or ()
        partitioned = self.read is not None and isinstance(self.read.reading, ForceReading)
        return orders[::-1] if partitioned else orders


def _named(keys: Sequence[str]) -> str:
    """The first of the methods, and how many there are besides."""
    more = len(keys) - _MOST_NAMED
    return " or ".join([*keys[:_MOST_NAMED], *[f"{more} more methods"] * (more > 0)])


def _varied(basis: Basis, matches: Sequence[Match], more: str, limited: str = "") -> Naming:
    """The naming by matches with equal coefficients; `more` begins with a comma if it is `limited`."""
    first, *others = matches
    same = f"the same step as {', '.join(match.name for match in others)}" if others else ""
    rest = "".join(f", {words}" for words in (first.relation, same) if words) + more
    variant = rest.removeprefix(", ") if first.relation or others or limited else ""
    keys, parted = tuple(match.key for match in matches), any(match.steps > 1 for match in matches)
    return Naming(basis, f"it is {first.key}{rest}", keys, variant=variant, parted=parted)


def _near(near: Near, solved: str = "") -> Naming:
    words = f"it is {near.name}{solved}"
    return Naming(Basis.NEAR, words, (near.key,), reserved=bool(solved), differences=near.differences)


def _in_words(fit: LinearFit, best: LinearCandidate) -> str:
    """The candidate in words, with its keys if it is an unchanged method, and the size of states that it is seen at."""
    others = [key for key in best.methods if key != best.words]
    keys = f" ({', '.join(others)})" if others and best.extras == 0 else ""
    nearest = fit.nearly or fit.nearest
    if nearest is None or nearest.off > UNSOLVED:
        return f"{best.words}{keys}{_at(fit.amplitude) if nearest or fit.kind == LINEAR else ''}"
    key, off = nearest.methods[0], nearest.off
    near = f"nearly {key} at states of size 1, to {off:.1e}" if off else f"{key} at h = {nearest.h:g} and size 1"
    return f"{near}; at states of size {fit.amplitude:.1e}, {best.words}{keys}"


def _at(size: float) -> str:
    return "" if size == 1 else f", at states of size {size:.1e}, not at every size"
