"""The reports of `identify` and `verify` on steppers that no single tableau describes."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

from driftproof.blackbox.families.imex import ImexIdentity, read_imex
from driftproof.blackbox.families.magnetic import Boris, MagneticReading
from driftproof.blackbox.families.magnetic_step import read_magnetic
from driftproof.blackbox.families.multistep import ACROSS, VELOCITIES, Corrected, MultistepReading, read_multistep
from driftproof.blackbox.families.multistep_recurrence import NoRecurrence
from driftproof.blackbox.families.multistep_runs import remembers
from driftproof.blackbox.families.quaternions import QuaternionReading, read_quaternion
from driftproof.blackbox.families.rosenbrock import RosenbrockIdentity, read_rosenbrock
from driftproof.blackbox.families.second_answers import ESTIMATE
from driftproof.blackbox.findings import NO_EVIDENCE, BadInput, Outcome, UnsupportedCall
from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.probes.questions import Introduction, introduction
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.report import NO_ANSWER, NOT_KNOWN, UNDECIDED, Report, criteria_parts, sections, verification
from driftproof.blackbox.stepper.calling_conventions import FIELD, IMEX, MAGNETIC, MAP, ROSENBROCK, ROTATION, SIGNATURES
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FurtherMethod
from driftproof.methods.multistep import Multistep
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import Method
from driftproof.support.plain_text import Json

# The steppers that each kind of method can be compared with.
_NEEDED: dict[type, str] = {
    Multistep: "a stepper that takes a right-hand side or a force, and whose copies remember nothing",
    Rosenbrock: "a stepper that takes a Jacobian, in place of its own differences of f: step(f, jac, t, y, h)",
    Boris: "a stepper that takes a magnetic field, step(x, v, E, B, h) or step(v, E, B, h)",
    Additive: "a stepper that takes two right-hand sides, step(f_explicit, f_implicit, t, y, h)",
}
_TURNING_NEEDED = "a stepper that remembers nothing, and is linear in what it turns"
GOES_ON = "remark: it remembers its last step: a step from another state, or after a rejected one, is different"
# What was read of a stepper: the verdict, the evidence, and how it compares with a method.
FamilyReading: TypeAlias = MultistepReading | RosenbrockIdentity | ImexIdentity | MagneticReading | QuaternionReading
_TURNING: dict[str, Callable[[ForeignStepper], FamilyReading]] = {MAGNETIC: read_magnetic, ROTATION: read_quaternion}


def read_family(
    subject: ForeignStepper, asked: Method | FurtherMethod | Boris | None = None, *, runs_only: bool = False
) -> FamilyReading | None:
    """Read the stepper as one of the family of `asked`, or of its calls; None if it is an ordinary one-step method.

    If `runs_only`, single steps are not tried for memory. Raises NotReadable, UnsupportedCall, Misbehaviour.
    """
    if isinstance(asked, Boris):
        return read_magnetic(subject)
    if isinstance(asked, Multistep):
        return read_multistep(subject, asked.corrector if isinstance(asked, Corrected) else asked)
    if isinstance(asked, Rosenbrock) or (asked is None and subject.convention.kind == ROSENBROCK):
        return read_rosenbrock(subject, asked)
    if isinstance(asked, Additive) or (asked is None and subject.convention.kind == IMEX):
        return read_imex(subject, asked)
    if subject.convention.kind in _TURNING:
        return _TURNING[subject.convention.kind](subject)
    if subject.convention.kind == MAP or (runs_only and not subject.convention.run) or not remembers(subject):
        return None
    return read_multistep(subject)


def family_report(name: str, introduced: Introduction, read: FamilyReading) -> Report:
    """The report of `identify` on a stepper of one of the families."""
    held = verification(name)
    to_do = f"if it should be {read.key}, verify it: {held} {read.key}" if read.key else ""
    first = "fix the faults first" if read.faults else ""
    opened = [SIGNATURES[introduced.calls], f"takes {introduced.numbers}, works in {introduced.format}"]
    parts = sections(
        ("What to do", [*filter(None, [first, to_do or f"name the method it should be: {held} METHOD"])]),
        ("Faults", read.faults),
        *read.parts,
        ("Stepper", opened),
    )
    data = {"calls": introduced.calls, "format": introduced.format, "faults": list(read.faults), **read.data}
    return Report(name, read.verdict, None, parts, data, read.named)


def unread_report(name: str, outcome: Outcome) -> Report:
    """The report of `identify` on a stepper that is called like one of a family but could not be read, and why."""
    words = {NotReadable.kind: NOT_KNOWN, **dict.fromkeys(NO_EVIDENCE, UNDECIDED)}
    verdict = f"{words.get(outcome.kind or '', NO_ANSWER)}: {outcome.seen}"
    data: dict[str, Json] = {"not_answered": [{"kind": outcome.kind, "seen": outcome.seen}]}
    return Report(name, verdict, None, (), data, None if outcome.kind in NO_EVIDENCE else False)


def hand_jacobian(runner: IsolatedRunner) -> str:
    """Examine a stepper that takes the Jacobian of f as one of f alone, and say so; "" if it takes none."""
    opened, target = runner.outcome_of(introduction).result, runner.target
    if opened is None or opened.calls != ROSENBROCK or not isinstance(target, Target):
        return ""
    runner.turn_to(replace(target, calls=FIELD))
    return "; as its Jacobian it was handed differences of f"


def make_anew(runner: IsolatedRunner) -> bool:
    """Examine an object that remembers as one of which a copy makes each step; False if it is none, or that is done."""
    target = runner.target
    if not isinstance(target, Target) or target.anew or not runner.outcome_of(_of_object).result:
        return False
    runner.turn_to(replace(target, anew=True))
    return True


def _of_object(subject: ForeignStepper) -> bool:
    return inspect.ismethod(subject.function)


def turns(subject: ForeignStepper) -> bool:
    """True if the stepper turns a quaternion, or a velocity in a magnetic field."""
    return subject.convention.kind in _TURNING


def verify_family(runner: IsolatedRunner, method: Method | FurtherMethod | Boris) -> Report:
    """The report of `verify` for a method of a family. Raises ValueError if the stepper cannot be imported."""
    outcome = runner.outcome_of(partial(read_family, asked=method))
    if outcome.kind == BadInput.kind:
        raise ValueError(outcome.seen)
    name = runner.target.name
    if outcome.kind == UnsupportedCall.kind and isinstance(method, Multistep) and (handed := hand_jacobian(runner)):
        report = verify_family(runner, method)
        return replace(report, verdict=report.verdict + handed)
    if outcome.failed:
        return _not_read(name, outcome, method)
    read: FamilyReading = outcome.result
    asked: Any = method  # which the reading is one of the family of
    checks = read.criteria(asked)
    open_ones = [check for check in checks if check.passed is None]
    # What was read comes first, then measurements, of which one suffices, but for velocities and changes of h.
    decisive, others = [*checks[:2], *(each for each in checks if each.title in (VELOCITIES, ACROSS))], checks[2:]
    seen = any(check.passed for check in others) or all(check.mark == "not tested" for check in others)
    decided = seen and all(check.passed for check in decisive)
    passed = False if any(check.passed is False for check in checks) else True if decided else None
    parts, data = criteria_parts(checks, passed)
    if passed is False:
        failed = next(check for check in checks if check.passed is False)
        other = read.verdict if checks[0].passed is False else failed.lines[0]
        but = f"is {method.key}, but " if failed.title == ESTIMATE else f"is not {method.key}"
        verdict = f"{but}{'; ' if checks[0].passed is False else ': ' * (failed.title != ESTIMATE)}{other}"
        if failed is checks[0] and not read.named and (differences := failed.data.get("differences")):
            verdict += f": {differences[0]}"
        data["instead"] = read.data
    elif passed is None:
        verdict = f"{UNDECIDED} whether it is {method.key}: {open_ones[0].lines[0]}"
    else:
        _, named, more = read.verdict.partition(f"it is {method.key}")
        equal, across = " in steps of equal length" * isinstance(method, Multistep), getattr(read, "slow_across", "")
        verdict = "; ".join(filter(None, [f"is {method.key}{equal}{more * bool(named)}", across]))
        data["remarks"] = read.data.get("remarks", [])
    return Report(name, verdict, passed, sections(*parts), data)


def _not_read(name: str, outcome: Outcome, method: Method | FurtherMethod | Boris) -> Report:
    """The report of `verify` on a stepper that could not be read, and why: refuted, no answer, or undecided."""
    if outcome.kind not in (NotReadable.kind, UnsupportedCall.kind, *NO_EVIDENCE):
        refuted = f"is not {method.key}" if outcome.kind == NoRecurrence.kind else NO_ANSWER
        return Report(name, f"{refuted}: {outcome.seen}", False, (), {"not_answered": outcome.seen})
    kind = Multistep if isinstance(method, Multistep) else type(method)
    needed = NO_EVIDENCE.get(outcome.kind or "") or _NEEDED.get(kind, _TURNING_NEEDED)
    parts = sections(("Not answered", [outcome.said]), ("What would decide it", [needed]))
    verdict = f"{UNDECIDED} whether it is {method.key}: {outcome.seen}"
    return Report(name, verdict, None, parts, {"not_answered": outcome.seen})
