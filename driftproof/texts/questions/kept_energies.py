"""Whether the true solution keeps the energy whose change by a method is asked for: a remark beside the answer."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from flint import arb, ctx

from driftproof.enclosure.arithmetic.evaluations import Evaluation
from driftproof.enclosure.arithmetic.numbers import OWN_SLOPE, Enclosed
from driftproof.enclosure.certificate import decimal
from driftproof.enclosure.fields.fields import enclosable, enclosed_values
from driftproof.enclosure.fields.text_fields import field_function
from driftproof.enclosure.solution.solutions import BITS_AT_FIRST

if TYPE_CHECKING:
    from driftproof.texts.questions.problems import ProblemRun

CHANGES_OF_ENERGY = ("energy_change", "relative_energy_change", "largest_energy_change")
# A double 9.81 in f and the exact one in an energy make it change by some u of its terms: less than a million u of
# them is taken for that, which hides a true change of one part in 10^10 of them in a step.
_CONSTANTS_OFF = arb(10) ** 6 * arb(2) ** -53


def energy_remark(run: ProblemRun) -> str | None:
    """What is to be said of a run's change of an energy that the true solution changes as well; None if it is not seen.

    It is looked for where the solution is after the first step of the run, which is cheap to enclose.
    """
    if run.energy is None or run.method is None:
        return None
    with ctx.workprec(BITS_AT_FIRST), suppress(ArithmeticError, ValueError):
        first, then = run.true(range(2))
        change = run.energy_change(run.h, then, first)
        if abs(change) > _CONSTANTS_OFF * _terms(run, then):
            changed = f"which the true solution changes by {decimal(change)} to t = {float(run.h):.6g}"
            return f"f does not conserve this energy, {changed}"
    return None


def _terms(run: ProblemRun, y: Sequence[arb]) -> arb:
    """Σ |yᵢ ∂E/∂yᵢ|, in units of which roundings of numbers in E and in f show."""
    evaluation, function = Evaluation(), enclosable(field_function(run.rates, [run.energy or ""]))
    state = [Enclosed(evaluation, x, {i: OWN_SLOPE}) for i, x in enumerate(y)]
    (energy,) = enclosed_values("energy", partial(function, Enclosed(evaluation, arb(0))), state, evaluation)
    return sum((abs(y[i] * slope) for i, slope in (energy.partials or {}).items()), arb(0))
