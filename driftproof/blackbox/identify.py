"""Which method a float stepper really is: what its calling convention lets us read, in words, the surest first."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.checks.trials import TRAITS, CheckResult
from driftproof.blackbox.families.damping import Damping, read_damping
from driftproof.blackbox.families.multistep_recurrence import NoRecurrence
from driftproof.blackbox.families.reports import family_report, read_family, unread_report
from driftproof.blackbox.findings import NO_EVIDENCE, Outcome, UnsupportedCall, arithmetic_of
from driftproof.blackbox.isolation import TIME_LIMIT, IsolatedRunner
from driftproof.blackbox.judging.agreement import ORDINARY_DOMAIN
from driftproof.blackbox.judging.habits import explained
from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_orders
from driftproof.blackbox.judging.nonlinear_step import nonlinear_twins
from driftproof.blackbox.matching.candidates import EMBEDDED
from driftproof.blackbox.matching.dense_outputs import JudgedDense, judged_dense
from driftproof.blackbox.matching.estimates import JudgedEstimate, judged_estimate
from driftproof.blackbox.matching.linear_candidates import LinearCandidate
from driftproof.blackbox.matching.linear_match import LinearFit, linear_fit
from driftproof.blackbox.matching.match import Identity, match_tableau, matched
from driftproof.blackbox.matching.read_order import ReadOrder, read_order
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.linear_steps import LINEAR
from driftproof.blackbox.probes.questions import CoefficientReading, Introduction, introduction, read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.report import NO_ANSWER, UNDECIDED, Report, Section, each_once, sections
from driftproof.blackbox.stepper.calling_conventions import OF_FAMILIES, SIGNATURES
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.support.plain_text import Json

# Examples of the rounding errors of a method that was recognised: a fifth of what `verify` takes shows their size.
_EXAMPLES = 200
# Solvers in use stop at 1e-6 or below of numbers of size 1.
_SOLVED = 1e-6


def identify(
    step: Callable[..., Any] | str,
    *,
    calls: str | None = None,
    array: Callable[[Any], Any] | str | None = None,
    time_limit: float = TIME_LIMIT,
    isolate: bool = True,
) -> Report:
    """Which method a float stepper is, of which order, how near to roundoff, and what it does besides.

    `step` is a callable or "package.module:name". Its coefficients are read where it takes a right-hand side or a
    force, its one-step matrix in any case; what is read is compared with the catalogue and with variants of it. Of a
    stepper that remembers, the recurrence of many steps is read, and its start.
    `calls`, `array`, `time_limit` and `isolate` are as for `verify`. Raises ValueError where the stepper cannot be
    imported, or is called in no known way.

    >>> from driftproof import identify
    >>> print(identify(lambda q, v, h: (q + h * v, v - h * q), isolate=False).verdict)
    it is, as far as linear steps tell, forward_euler
    """
    with IsolatedRunner(Target(step, calls, array), time_limit, isolate) as runner:
        of_run = partial(read_family, runs_only=True)
        read, order, dense, family = runner.run([read_coefficients, measured_orders, judged_dense, of_run])
        if read.failed and read.kind not in (UnsupportedCall.kind, *NO_EVIDENCE):
            family = runner.run([read_family])[0]
        if family.result is not None or read.kind == UnsupportedCall.kind:
            opened = runner.run([introduction])[0].result
            if family.result is not None:
                return family_report(runner.target.name, opened, family.result)
            if opened is not None and opened.calls in OF_FAMILIES:
                return unread_report(runner.target.name, family)
        # A run whose later steps remember, but keep no recurrence: what was read is its first step.
        remembering = family.kind in (NotReadable.kind, NoRecurrence.kind)
        return identified(
            runner, read, order, dense, f"that is its first step only: {family.seen}" if remembering else ""
        )


def identified(runner: IsolatedRunner, read: Outcome, order: Outcome, dense: Outcome, later: str = "") -> Report:
    """The report on the runner's stepper, of which some questions are answered, in the time that it has left."""
    if read.kind == "bad_input":
        raise ValueError(read.seen)
    introduced, fit, estimate, *answers = outcomes = runner.run(
        [introduction, linear_fit, judged_estimate, *CHECKS.values()]
    )
    checks, arithmetic = checks_of(answers), arithmetic_of([read, order, dense, *outcomes])
    damping = runner.run([read_damping])[0] if read.failed and not introduced.failed else Outcome()
    known = isinstance(read.result, TableauReading) or getattr(read.result, "implicit", False)
    best = None if fit.failed or known else fit.result.nearly or fit.result.best
    implicit = [key for key in (best.methods if best is not None else ()) if not METHODS[key].explicit]
    twins = runner.run([partial(nonlinear_twins, keys=implicit)])[0] if implicit else Outcome()
    seen = Seen(introduced, read, fit, order, estimate, dense, damping, twins, tuple(checks), arithmetic)
    explicit = METHODS[seen.key] if seen.key is not None and METHODS[seen.key].explicit else None
    rounding = None if explicit is None else _rounding(runner, explicit, seen.size)
    verdict = "; ".join(filter(None, [seen.verdict, later, arithmetic]))
    name = runner.target.name
    return Report(name, verdict, None, _sections(name, seen, rounding), _data(seen, rounding))


class _Recognised(NamedTuple):
    """Coefficients, the methods that have them, and the order that they give; `untimed` are those but for the times."""

    reading: CoefficientReading
    identity: Identity
    order: ReadOrder
    untimed: Identity | None = None


@dataclass(frozen=True)
class Seen:
    """What came of each question; `damping` and `twins` are asked only of what is no tableau."""

    introduction: Outcome
    coefficients: Outcome
    linear: Outcome
    order: Outcome
    estimate: Outcome
    dense: Outcome
    damping: Outcome
    twins: Outcome
    checks: tuple[CheckResult, ...]
    arithmetic: str = ""  # who changed the rounding mode, or what becomes of subnormal numbers

    @cached_property
    def read(self) -> _Recognised | None:
        """The coefficients, where its calls let them be read and there are any, and what they are."""
        reading: CoefficientReading | None = self.coefficients.result
        if reading is None:
            return None
        identity = matched(reading)
        order = read_order(reading, next(iter(identity.matches), None))
        if isinstance(reading, TableauReading) and order.untimed_order > order.order:
            return _Recognised(reading, identity, order, match_tableau(replace(reading, c=None)))
        return _Recognised(reading, identity, order)

    @property
    def fit(self) -> LinearFit | None:
        """The linear fit, where the stepper answered."""
        fit: LinearFit | None = self.linear.result
        return fit

    @property
    def key(self) -> str | None:
        """The one method of the catalogue that it is, as it stands and on the plain oscillator, if it is one.

        An implicit one only by its coefficients. Where several have the same ones, or the same matrix, the first:
        they have one rounding bound here.
        """
        if self.read is not None:
            keys: Sequence[str] = self.read.identity.keys
            if self._implicit:
                return next(iter(keys), None)
        else:
            best = None if self.fit is None or self._besides_one_number else self.fit.best
            keys = best.methods if best is not None and best.extras == 0 and best.rates_are_right else ()
        return next((key for key in keys if METHODS[key].explicit), None)

    @property
    def size(self) -> float:
        """The size of the states at which it is that method, where larger ones meet a limit; else 1."""
        read = 1.0 if self.read is None else self.read.reading.amplitude
        return min(read, self.fit.amplitude) if self.fit is not None and self.fit.kind == LINEAR else read

    @property
    def verdict(self) -> str:
        """Which method it is, in one line."""
        if self.introduction.kind in NO_EVIDENCE:
            return f"{UNDECIDED}: {self.introduction.seen}"
        if self.introduction.failed:
            return f"{NO_ANSWER}: {self.introduction.seen}"
        if self.read is not None and self.read.identity.matches:
            first, *others = [match.name for match in self.read.identity.matches]
            name = f"it is {first}" + (f", the same step as {', '.join(others)}" if others else "") + _at(self.size)
            beyond = self._refused + self._wrong_time + self.of_velocities
            return name + self._row + self._solved + beyond + self._beside_at_fault
        if self.read is not None and self.read.untimed is not None and self.read.untimed.matches:
            name, order = self.read.untimed.matches[0].name, self.read.order.order
            return f"it is {name} called at wrong times: order {order} where the right-hand side depends on t"
        if self.read is not None and self._implicit:
            return f"it is {self._unknown_stages(self.read)}{self._solved}"
        if self._besides_one_number:
            return self._unknown
        alike = f"; its nonlinear steps are those of {', '.join(self.twins.result)}" if self.twins.result else ""
        if self.fit is not None and self.fit.best is not None:
            return f"it is, as far as linear steps tell, {_in_words(self.fit, self.fit.best)}{alike}"
        if self.read is not None and self.read.identity.near:
            return f"it is {self.read.identity.near[0].name}"
        if self.fit is not None and self.read is None and (nearly := self.fit.nearly):
            off = f"to {nearly.off:.1e} at states of size 1"
            return f"it is, as far as linear steps tell, nearly {' or '.join(nearly.methods)}, {off}{alike}"
        open_questions = [o for o in (self.coefficients, self.linear) if o.kind in NO_EVIDENCE]
        return f"{UNDECIDED}: {open_questions[0].seen}" if open_questions else self._unknown

    @property
    def _besides_one_number(self) -> bool:
        """Whether it does to vectors what linear steps of one number do not show."""
        found: Damping | None = self.damping.result
        return found is not None and len(found.at_once) > 1

    @property
    def _unknown(self) -> str:
        """No method of the catalogue; or what it takes from v, which a method does not."""
        found: Damping | None = self.damping.result
        return "it is no method that is known here" if found is None else found.verdict

    @property
    def _row(self) -> str:
        """Of a pair whose embedded weights are propagated, which order that is."""
        match = None if self.read is None else self.read.identity.matches[0]
        pair = None if match is None or match.relation != EMBEDDED else METHODS[match.key]
        if not isinstance(pair, RungeKutta):
            return ""
        return f": the row of order {pair.embedded_order}, not that of order {pair.claimed_order}"

    @property
    def _implicit(self) -> bool:
        return self.read is not None and self.read.reading.implicit

    def _unknown_stages(self, read: _Recognised) -> str:
        """What is near to implicit stages of no method known here; or how many they are, and what they are linearly."""
        if read.identity.near:
            return read.identity.near[0].name
        stages = f"{read.reading.calls} implicit stage{'s' * (read.reading.calls > 1)}"
        best = None if self.fit is None or self.fit.best is None else _in_words(self.fit, self.fit.best)
        linear = f", though on linear problems {best}" if best is not None else ""
        return f"no method that is known here, but one of {stages} and order {read.order.order}{linear}"

    @property
    def _solved(self) -> str:
        """How well its implicit stages are solved, where that is not as well as solvers do by default."""
        solved = None if self.read is None else self.read.reading.solved
        return f", but {solved.words}" if solved is not None and solved.curved > _SOLVED else ""

    @property
    def _beside_at_fault(self) -> str:
        judged = filter(None, (self.estimate.result, self.dense.result))
        return "".join(f"; {fault}" for each in judged for fault in each.faults)

    @property
    def _refused(self) -> str:
        """What keeps a method of y' = f(t, y) from being that beyond q'' = F(q), where something does."""
        if self.read is None or not isinstance(self.read.reading, ForceReading) or not self.read.reading.refused:
            return ""
        general = isinstance(METHODS[self.read.identity.matches[0].key], RungeKutta)
        return f" on q'' = F(q), but not on y' = f(t, y): {self.read.reading.refused}" if general else ""

    @property
    def _wrong_time(self) -> str:
        reading = None if self.read is None else self.read.reading
        wrong = reading.wrong_time if isinstance(reading, ForceReading) and not self._refused else ""
        return f" called at wrong times: {wrong}" if wrong else ""

    @property
    def of_velocities(self) -> str:
        """The order on forces of velocity where it is lower than on q'' = F(q), and which velocities are to blame."""
        reading = None if self.read is None else self.read.reading
        if self.read is None or not isinstance(reading, ForceReading) or reading.a_velocity is None:
            return ""
        if reading.wrong_time:  # costs orders by itself
            return ""
        seen = next((found.order for found in self.measured), None)
        order = 1 if reading.velocities_limit_order else seen
        if order is None or order >= self.read.order.order:
            return ""
        lost = f"order {order} where the force depends on the velocity, not {self.read.order.order}"
        first, *rest = reading.stale_velocities or [""]
        why = f": {first}" + (f", and {len(rest)} more" if rest else "") if first else ""
        return f" on q'' = F(q), but of {lost}{why}"

    @property
    def measured(self) -> tuple[MeasuredOrder, ...]:
        """The orders measured, if there are any, first the one on problems of the kind that it is read on."""
        orders: tuple[MeasuredOrder, ...] = self.order.result or ()
        partitioned = self.read is not None and isinstance(self.read.reading, ForceReading)
        return orders[::-1] if partitioned else orders


def _in_words(fit: LinearFit, best: LinearCandidate) -> str:
    """The candidate, with its keys where it is a method as it stands, and at which states if not at all of them."""
    others = [key for key in best.methods if key != best.words]
    keys = f" ({', '.join(others)})" if others and best.extras == 0 else ""
    nearest = fit.nearly or fit.nearest
    if nearest is None:
        return f"{best.words}{keys}{_at(fit.amplitude) if fit.kind == LINEAR else ''}"
    key, off = nearest.methods[0], nearest.off
    near = f"nearly {key} at states of size 1, to {off:.1e}" if off else f"{key} at h = {nearest.h:g} and size 1"
    return f"{near}; at states of size {fit.amplitude:.1e}, {best.words}{keys}"


def _at(size: float) -> str:
    return "" if size == 1 else f", at states of size {size:.1e}, not of all sizes"


def _rounding(runner: IsolatedRunner, method: Method, size: float) -> Outcome:
    domain = ORDINARY_DOMAIN if size >= 1 else replace(ORDINARY_DOMAIN, largest_state=size)
    return runner.run([partial(explained, method=method, domain=domain, examples=_EXAMPLES)])[0]


def _sections(name: str, seen: Seen, rounding: Outcome | None) -> tuple[Section, ...]:
    """What to do, then the evidence, the weightiest first."""
    damping: Damping | None = seen.damping.result
    faults = [*(damping.faults if damping else ()), *(check.words for check in seen.checks if check.is_fault)]
    failed = [o for o in _questions(seen, rounding) if o.failed and o.kind != "unsupported_call"]
    evidence = sections(
        ("What to do", _what_to_do(name, seen)),
        ("Faults", faults),
        ("Coefficients", [] if seen.read is None else [*seen.read.identity.lines, *seen.read.reading.lines]),
        ("Order", _orders(seen)),
        ("One-step matrix", [] if seen.fit is None else seen.fit.lines),
        ("Damping", damping.lines if damping and not damping.faults else []),
        ("Error estimate", _beside(seen.estimate)),
        ("Dense output", _beside(seen.dense)),
        ("Rounding", [] if rounding is None or rounding.failed else rounding.result.lines),
        ("Stepper", [*_introduced(seen), *filter(None, [seen.arithmetic])]),
    )
    answers = sections(("Not answered", each_once(f"{o.kind}: {o.seen}" for o in failed)))
    return (*evidence, *_checks([check for check in seen.checks if not check.is_fault]), *answers)


def _checks(checks: Sequence[CheckResult]) -> tuple[Section, ...]:
    """The checks that find no fault, and in one line how many are kept, tell a trait, or were not decided."""
    traits = sum(check.key in TRAITS and check.holds is not None for check in checks)
    undecided = sum(check.holds is None for check in checks)
    counts = {"kept": len(checks) - traits - undecided, "of traits such as areas": traits, "open": undecided}
    brief = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    lines = tuple(check.words for check in checks)
    return (Section("Checks", lines, f"{brief}; --all shows each" if len(lines) > 1 else ""),) if lines else ()


def _what_to_do(name: str, seen: Seen) -> list[str]:
    """The next step, from what was found; nothing where nothing is known to help."""
    held = f"driftproof verify {name} --method"
    if seen.introduction.failed:
        helps = {"time_limit": "give it more time: --time-limit", "instrument_failed": "report this to us"}
        return [helps.get(seen.introduction.kind or "", "make this one call answer; then ask again")]
    lines = ["see to the faults first"] if any(check.is_fault for check in seen.checks) else []
    near = seen.read.identity.near if seen.read is not None else ()
    if near:
        key, wrong = near[0].key, "; ".join(near[0].differences)
        lines.append(f"if it should be {key}, this is to mend: {wrong}; then {held} {key}")
    elif seen.key is not None:
        solved = "" if seen.key not in METHODS or METHODS[seen.key].explicit else " --solver-tolerance 1e-10"
        lines.append(
            f"if it should be {seen.key}, hold it there: {held} {seen.key}{solved}, or assert_verified in a test"
        )
    else:
        lines.append(f"say what it should be: {held} METHOD, or your own tableau, a .toml file")
    if seen.coefficients.kind == "unsupported_call":
        lines.append("to have its coefficients read, let it take its right-hand side or its force: step(f, t, y, h)")
    return lines


def _questions(seen: Seen, rounding: Outcome | None) -> Sequence[Outcome]:
    questions = seen.introduction, seen.coefficients, seen.linear, seen.order, seen.estimate, seen.dense
    return questions if rounding is None else (*questions, rounding)


def _introduced(seen: Seen) -> list[str]:
    if seen.introduction.failed:
        return []
    opened: Introduction = seen.introduction.result
    return [SIGNATURES[opened.calls], f"takes {opened.numbers}, works in {opened.format}"]


def _beside(outcome: Outcome) -> list[str]:
    """What is said of something that is returned beside y1."""
    found: JudgedEstimate | JudgedDense | None = outcome.result
    return [] if found is None else [*found.lines, *found.faults]


def _orders(seen: Seen) -> list[str]:
    by_trees = [] if seen.read is None else seen.read.order.lines
    damped: MeasuredOrder | None = None if seen.damping.result is None else seen.damping.result.order
    measured = [found.words for found in (seen.measured if damped is None else (damped,))]
    linear_only = seen.order.kind == "unsupported_call"
    return [*by_trees, *measured, *(["on other than linear problems the order is not known"] if linear_only else [])]


def _data(seen: Seen, rounding: Outcome | None) -> dict[str, Json]:
    read, fit = seen.read, seen.fit
    measured = seen.measured[0] if seen.measured else None
    return {
        "calls": None if seen.introduction.failed else seen.introduction.result.calls,
        "arithmetic": seen.arithmetic or None,
        "format": None if seen.introduction.failed else seen.introduction.result.format,
        "method": seen.key,
        "coefficients": None if read is None else [*read.identity.lines, *read.reading.lines],
        "matrix": None if fit is None else list(fit.lines),
        "order": None if read is None else read.order.order,
        "order_fails": None if read is None else read.order.failing_tree,
        "linear_order": None if fit is None or fit.facts is None else fit.facts.linear_order,
        "measured_order": None if measured is None else measured.order,
        "estimate": None if seen.estimate.result is None else seen.estimate.result.data,
        "dense": None if seen.dense.result is None else seen.dense.result.data,
        "rounding": None if rounding is None or rounding.failed else rounding.result.data,
        "damping": None if seen.damping.result is None else seen.damping.result.data,
        "checks": [check.as_dict() for check in seen.checks],
        "not_answered": [{"kind": o.kind, "seen": o.seen} for o in _questions(seen, rounding) if o.failed],
    }
