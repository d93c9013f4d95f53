"""The coefficients of an implicit Runge-Kutta step, read from its floats by marking its stages."""

from __future__ import annotations

from dataclasses import replace

from driftproof.blackbox.probes.marked_stages import MarkedSteps
from driftproof.blackbox.probes.scripted_answers import BACKWARD, NotReadable, remarks_of
from driftproof.blackbox.probes.stage_chains import StageChains
from driftproof.blackbox.probes.stage_solutions import UNSOLVED, StageEquations
from driftproof.blackbox.probes.tableau import TableauReading, is_explicit
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

# If two clocks tell no more stages apart than one, more of them do so only in contrived tables.
_MOST_CLOCKS = 2
# A solver that goes on leaves less than this; if more is left, several stages may have been taken for one.
_DOUBTFUL = 2.0**-30
_AS_ONE = "stages at one time, if there are several, are read as one: its solver does not tell them apart"


def read_implicit_tableau(subject: ForeignStepper) -> TableauReading:
    """The A, b and c of a step(f, t, y, h) with implicit stages, as near as its solver comes to them.

    They are read by `StageChains`, whose stage equations are affine and nilpotent: one step of Newton's method with any
    Jacobian by differences solves them up to rounding, and so do as many fixed-point iterations as the chain has links.
    What a solver that stops earlier leaves shows in a second reading with other numbers, as the `stage_error` of the
    first. Stages are known by their time, or, if times coincide or are not passed on, by clocks that run along in y.
    Stages that are equal on every problem are read as one; stages that do not count are not read.

    Further steps check that the coefficients account for everything, and how well the stages are solved
    (`stage_solutions`). Raises NotReadable, saying what was seen.
    """
    return read_by_chains(MarkedSteps(subject))[0]


def read_by_chains(steps: MarkedSteps) -> tuple[TableauReading, StageChains]:
    """The coefficients of such steps and the chains that show them, with as few clocks as tell the stages apart.

    These account for nonlinear steps, unless a solver that stops early explains the rest; otherwise raises NotReadable.
    """
    found: list[tuple[TableauReading, StageChains]] = []
    refusals: list[NotReadable] = []
    for clocks in range(not steps.timed, min(_MOST_CLOCKS, steps.size - 1) + 1):
        try:
            chains = StageChains(steps, steps.marks(clocks))
            found.append((_controlled(chains), chains))
        except NotReadable as refusal:
            refusals.append(refusal)
            continue
        if _curved(found[-1][0]) <= _DOUBTFUL:
            break
    if not found:
        raise refusals[0]
    best, chains = next((pair for pair in found if _curved(pair[0]) <= _DOUBTFUL), found[0])
    if _curved(best) > UNSOLVED:
        if best.solved is None or not best.solved.power:
            raise NotReadable(
                f"on nonlinear problems the step is off by {_curved(best):.1e} from what its coefficients give: a "
                "solver that stops too early, or other stages"
            )
        if len(found) == 1:
            best = replace(best, remarks=(*best.remarks, _AS_ONE))
    # Without a clock all slopes but those of one stage are 0. It tells apart whatever has times of its own.
    if chains.marks.hands and best.solved and best.c and len({*best.c}) == best.calls:
        best = replace(best, solved=replace(best.solved, skipped=True))
    return best, chains


def _curved(reading: TableauReading) -> float:
    return 0.0 if reading.solved is None else reading.solved.curved


def _controlled(chains: StageChains) -> TableauReading:
    """The tableau that chains show with one set of marks, after its controls."""
    (a,), (b,), c = chains.tables()
    if is_explicit(a) and not chains.steps.may_be_explicit:
        raise NotReadable("none of its stages is implicit")
    reading = TableauReading(a, b, c, chains.steps.subject.format, stage_error=chains.left)
    chains.require_chain((reading.a,), (reading.b,), reading.rounding)
    equations = StageEquations(chains.steps, reading)
    equations.require_solver()
    reading = replace(reading, solved=equations.solved())
    return replace(reading, remarks=remarks_of(lambda: equations.require_solved(BACKWARD)))
