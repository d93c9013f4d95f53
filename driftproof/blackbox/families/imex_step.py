"""Both tables of an IMEX step, read by marking its stages in each of its two right-hand sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from driftproof.blackbox.findings import UnsupportedCall, first_taken
from driftproof.blackbox.probes.marked_stages import MarkedSteps, Setting
from driftproof.blackbox.probes.scripted_answers import CoefficientRow, NotReadable, Rounding
from driftproof.blackbox.probes.stage_chains import StageChains, StageTable
from driftproof.blackbox.probes.stage_solutions import UNSOLVED, step_by_iteration
from driftproof.blackbox.stepper.calling_conventions import IMEX, IMPLICIT
from driftproof.blackbox.stepper.foreign_code import FieldFunction
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.second_functions import SecondFunction, with_functions
from driftproof.symbolic.rounding.formats import FloatFormat

IMEX_PARTS = ("explicit", "implicit")
# The size of h f' and h g', so that our own iteration contracts, and the rounds after which less than 2**-80 is left.
_BEND, _ROUNDS = 0.125, 80


@dataclass(frozen=True)
class ImexReading:
    """The tables aᵢⱼ and bⱼ of f, which is explicit, and of g, which is solved for, with the same stages at t + cᵢh.

    `c` is None if the functions get no time. `stage_error` is the error that the solver leaves in the entries, `curved`
    the error of a step with nonlinear f and g.
    """

    a: tuple[StageTable, StageTable]
    b: tuple[CoefficientRow, CoefficientRow]
    c: CoefficientRow | None
    format: FloatFormat
    stage_error: float
    curved: float = 0.0

    @property
    def stages(self) -> int:
        """The number of stages that y₁ depends on."""
        return len(self.b[0])

    @property
    def rounding(self) -> Rounding:
        """How far entries may be off: rounding, and four times the difference of two readings."""
        return Rounding(self.format, self.stages, 4 * self.stage_error)


class _SplitSteps(MarkedSteps):
    """Steps of y' = f + g: `part` is 0 while f is called, 1 while g is."""

    parts = 2

    def step(self, rate: FieldFunction, t: float, y: list[float], h: float) -> list[float]:
        """One step in which both functions answer by `rate`."""

        def asked(part: int) -> SecondFunction:
            def answered(at: float, z: Sequence[float]) -> Any:
                self.part = part
                return rate(at, list(z))

            return answered

        return with_functions(self.subject, {IMPLICIT: asked(1)}, t).step_field(asked(0), t, y, h)


def read_imex_step(subject: ForeignStepper) -> ImexReading:
    """Read both tables of a step(f_explicit, f_implicit, t, y, h), as exactly as its solver allows.

    They are read like implicit stages (`probes.implicit_tableau`), with each link of a chain in f or in g, so that
    entries of one table show in stages that only the other one weights. Raises NotReadable, UnsupportedCall.
    """
    if subject.convention.kind != IMEX:
        raise UnsupportedCall(f"the stepper is called as {subject.convention.kind!r}, which takes one right-hand side")
    steps = _SplitSteps(subject)
    return first_taken(partial(_read, steps), range(not steps.timed, steps.size), NotReadable)


def _read(steps: _SplitSteps, clocks: int) -> ImexReading:
    chains = StageChains(steps, steps.marks(clocks))
    (a, a_implicit), (b, b_implicit), c = chains.tables()
    reading = ImexReading((a, a_implicit), (b, b_implicit), c, steps.subject.format, chains.left)
    chains.require_chain(reading.a, reading.b, reading.rounding)
    curved = max(_bent(steps, reading, Setting(0.5, t, h)) for t, h in ((0.0, 1.0), (2.0, 0.5)))
    if curved > UNSOLVED:
        raise NotReadable(
            f"on nonlinear problems the step is off by {curved:.1e} from what its coefficients give: a solver that "
            "stops too early, or other stages"
        )
    return replace(reading, curved=curved)


def _bent(steps: _SplitSteps, reading: ImexReading, setting: Setting) -> float:
    """The difference of a step with nonlinear f and g from our own iteration of its stages."""
    h = setting.h

    def rates(node: float | None, moved: Sequence[float], part: int) -> list[float]:
        clock, following = 1 / (2 + (node or 0.0)), [*moved[1:], moved[0]]
        pairs = enumerate(zip(moved, following, strict=True))
        drawn = [(x - 2 * z) / (1 + x * x + z * z + i) for i, (x, z) in pairs]
        return [(1 - 2 * part) * (0.5 + clock * i) + _BEND / h * x * (1 + part) for i, x in enumerate(drawn)]

    run = steps.smooth(setting, lambda node, moved: rates(node, moved, steps.part))
    nodes, still = reading.c or (None,) * reading.stages, [0.0] * steps.size
    slopes = lambda i, y, part: rates(nodes[i], y, part)
    said, _ = step_by_iteration(reading.a, reading.b, slopes, still, h, _ROUNDS)
    return max(abs(x - setting.start - float(y)) for x, y in zip(run.result, said, strict=True))
