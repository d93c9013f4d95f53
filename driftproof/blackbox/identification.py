"""What `identify` reports: the verdict, what to do first, the evidence by its importance, and data for programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from driftproof.blackbox.checks.trials import TRAITS, CheckResult
from driftproof.blackbox.families.damping import Damping
from driftproof.blackbox.findings import Outcome
from driftproof.blackbox.judging.measured_order import MeasuredOrder
from driftproof.blackbox.matching.dense_outputs import JudgedDense
from driftproof.blackbox.matching.estimates import JudgedEstimate
from driftproof.blackbox.naming import Seen
from driftproof.blackbox.probes.questions import Introduction
from driftproof.blackbox.report import Report, Section, sections, verification, without_duplicates
from driftproof.blackbox.stepper.calling_conventions import SIGNATURES
from driftproof.methods.catalogue import METHODS
from driftproof.support.plain_text import Json

# What to do about a stepper that gives no answer at all, by the kind of its failure.
_HELPS = {
    "time_limit": "give it more time: --time-limit, in Python time_limit",
    "killed": "try again where nothing kills its process; running out of memory also kills processes",
    "instrument_failed": "report this to us",
    "own_clock": "examine the wrapper in its place",
}


@dataclass(frozen=True)
class Identification:
    """What was seen of a stepper, and the rounding errors of the method that it is, if that was judged.

    `later` says what is known of its later steps if these depend on earlier ones.
    """

    name: str
    seen: Seen
    rounding: Outcome
    later: str = ""

    @property
    def report(self) -> Report:
        """The report, whose verdict is the stepper's name, with what makes that name less than certain."""
        seen, found = self.seen, self.rounding.result
        otherwise_named = seen.read or (seen.fit and seen.fit.nearly)
        failing = None if found is None or found.but_for or otherwise_named else found.failing
        beyond = failing and failing.answer and failing.error_over_bound
        off = f"but a step is off by {beyond:.3g} times the bound on its rounding" if beyond else ""
        verdict = "; ".join(filter(None, [seen.naming.words, off, self.later, seen.arithmetic]))
        return Report(self.name, verdict, None, self._sections, self._data)

    @property
    def _opened(self) -> Introduction | None:
        opened: Introduction | None = self.seen.introduction.result
        return opened

    @property
    def _unanswered(self) -> list[Outcome]:
        seen = self.seen
        asked = seen.introduction, seen.coefficients, seen.linear, seen.order, seen.estimate, seen.dense, self.rounding
        return [outcome for outcome in asked if outcome.failed]

    @property
    def _sections(self) -> tuple[Section, ...]:
        seen, opened = self.seen, self._opened
        damping: Damping | None = seen.damping.result
        damps = damping.faults if damping and not seen.ignores_step else []
        faults = [*damps, *(check.words for check in seen.checks if check.is_fault)]
        stepper = [SIGNATURES[opened.calls], f"takes {opened.numbers}, works in {opened.format}"] if opened else []
        evidence = sections(
            ("What to do", self._what_to_do),
            ("Faults", faults),
            ("Coefficients", [] if seen.read is None else [*seen.read.identity.lines, *seen.read.reading.lines]),
            ("Order", _orders(seen)),
            ("One-step matrix", [] if seen.fit is None else seen.fit.lines),
            ("Damping", damping.lines if damping and not damping.faults else []),
            ("Error estimate", _returned_besides_y1(seen.estimate)),
            ("Dense output", _returned_besides_y1(seen.dense)),
            ("Rounding", [] if self.rounding.result is None else self.rounding.result.lines),
            ("Stepper", [*stepper, *filter(None, [seen.arithmetic])]),
        )
        said = without_duplicates(o.said for o in self._unanswered if o.kind != "unsupported_call")
        checks = _checks([check for check in seen.checks if not check.is_fault])
        return (*evidence, *checks, *sections(("Not answered", said)))

    @property
    def _what_to_do(self) -> list[str]:
        seen, held = self.seen, verification(self.name)
        if seen.introduction.failed:
            return [_HELPS.get(seen.introduction.kind or "", "make this one call return an answer, then try again")]
        lines = ["fix the faults first"] if any(check.is_fault for check in seen.checks) else []
        near = seen.read.identity.near if seen.read is not None else ()
        if near:
            key, wrong = near[0].key, "; ".join(near[0].differences)
            lines.append(f"if it should be {key}, correct this: {wrong}; then {held} {key}")
        elif seen.key is not None:
            solved = "" if seen.key not in METHODS or METHODS[seen.key].explicit else " --solver-tolerance 1e-10"
            verified = f"{held} {seen.key}{solved}, or assert_verified in a test"
            lines.append(f"if it should be {seen.key}, verify it: {verified}")
        else:
            lines.append(f"name the method it should be: {held} METHOD, or your own tableau in a .toml file")
        if seen.coefficients.failed and "is adaptive" in seen.coefficients.seen:
            advice = "let a large tolerance accept each step, or examine a solver: --solver"
            lines.append(f"if it adapts its step size, {advice}")
        if seen.coefficients.kind == "unsupported_call":
            advice = "make the right-hand side or force an argument: step(f, t, y, h)"
            lines.append(f"to have its coefficients read, {advice}")
        return lines

    @property
    def _data(self) -> dict[str, Json]:
        seen, read, fit, opened = self.seen, self.seen.read, self.seen.fit, self._opened
        measured = next(iter(seen.measured), None)
        return {
            "calls": None if opened is None else opened.calls,
            "arithmetic": seen.arithmetic or None,
            "format": None if opened is None else opened.format,
            "method": seen.key,
            "coefficients": None if read is None else [*read.identity.lines, *read.reading.lines],
            "matrix": None if fit is None else list(fit.lines),
            "order": None if read is None else read.order.order,
            "order_fails": None if read is None else read.order.failing_tree,
            "linear_order": None if fit is None or fit.facts is None else fit.facts.linear_order,
            "measured_order": None if measured is None else measured.order,
            "estimate": _data_of(seen.estimate),
            "dense": _data_of(seen.dense),
            "rounding": _data_of(self.rounding),
            "damping": _data_of(seen.damping),
            "checks": [check.as_dict() for check in seen.checks],
            "not_answered": [{"kind": o.kind, "seen": o.seen} for o in self._unanswered],
        }


def _data_of(outcome: Outcome) -> Json:
    found: Json = None if outcome.result is None else outcome.result.data
    return found


def _checks(checks: Sequence[CheckResult]) -> tuple[Section, ...]:
    """The section of the checks that found no fault, with one line that counts those kept, traits and undecided."""
    traits = sum(check.key in TRAITS and check.holds is not None for check in checks)
    undecided = sum(check.holds is None for check in checks)
    counts = {"passed": len(checks) - traits - undecided, "on traits such as areas": traits, "undecided": undecided}
    brief = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    brief += "; --all (in Python, .text(True)) shows each"
    lines = tuple(check.words for check in checks)
    return (Section("Checks", lines, brief * (len(lines) > 1)),) if lines else ()


def _returned_besides_y1(outcome: Outcome) -> list[str]:
    found: JudgedEstimate | JudgedDense | None = outcome.result
    return [] if found is None else [*found.lines, *found.faults]


def _orders(seen: Seen) -> list[str]:
    by_trees = [] if seen.read is None else seen.read.order.lines
    damped: MeasuredOrder | None = None if seen.damping.result is None else seen.damping.result.order
    measured = [found.words for found in (seen.measured if damped is None else (damped,))]
    linear_only = seen.order.kind == "unsupported_call"
    return [*by_trees, *measured, *(["the order on nonlinear problems is not known"] if linear_only else [])]
