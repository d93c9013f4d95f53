"""Write Values.v: each number that the lesson prints, as a theorem on the exact run that it comes from."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from driftproof.methods.numbers.rationals import step_count
from driftproof.numeric.scenes import PRESETS
from proofs.claims import CERTIFIED, COUNTED, GIVEN
from proofs.kernel.coq import Theorem, argument, file_text, rational
from proofs.printed import EQUALS, ROWS, Printed
from proofs.quantities import EXERCISE_H, EXERCISE_START
from proofs.setting import BOUNDARY_H, END, FIRST_H, RK4

IMPORTS = (
    "From Coq Require Import QArith Reals List.\nFrom driftproof Require Import Runs Tables.\nImport ListNotations."
)
# Runs of at most this many steps are computed by definition, longer ones with the one-step matrix.
FEW_STEPS = 5
COMPONENTS = {"q": "fst", "v": "snd"}


def values() -> str:
    """The text of Values.v."""
    return file_text("The numbers that the lesson prints.", IMPORTS, (theorem.text() for theorem in value_theorems()))


def value_theorems() -> Iterator[Theorem]:
    """One theorem for each printed number that is not GIVEN."""
    return (_theorem(row) for row in ROWS if row.quantity.evidence != GIVEN)


def _theorem(row: Printed) -> Theorem:
    relation = "==" if row.relation == EQUALS else "≈"
    if row.id == "exact.energy":
        return Theorem(row.claim, f"(forall t, energy (flow t) = {row.text})%R", "by_circle.")
    if row.quantity.evidence == COUNTED:
        return Theorem(row.claim, f"({_counted(row.id)} = {row.text})%nat", "by_vm.")
    if row.quantity.evidence == CERTIFIED:
        tactic = "by_angle." if row.id.endswith("phase_error") else "by_interval."
        return Theorem(row.claim, f"({_enclosed(row.id)} {relation} {row.text})%R", tactic)
    expression, steps = _rational_value(row.id)
    return Theorem(row.claim, f"({expression} {relation} {row.text})%Q", "by_vm." if steps <= FEW_STEPS else "by_run.")


def _run(key: str, h: Fraction, steps: int, start: str = "start") -> str:
    return f"(run {key} {argument(h)} {steps} {start})"


def _scene_run(key: str, scene: str) -> tuple[str, int]:
    """The Coq expression of the run of a scene, the first step or exercise 1, and its number of steps."""
    if scene == "first_step":
        return _run(key, FIRST_H, 1), 1
    if scene == "exercise_1":
        q, v = map(rational, EXERCISE_START)
        return _run(key, FIRST_H, 1, f"({q}, {v})"), 1
    return _run(key, PRESETS[scene].h, PRESETS[scene].steps), PRESETS[scene].steps


def _rational_value(quantity: str) -> tuple[str, int]:
    """The Coq expression of a rational quantity in Q_scope, and the number of steps of its run."""
    match quantity.split("."):
        case [scene, "steps"]:
            return f"{rational(END)} / {argument(PRESETS[scene].h)}", 0
        case [key, "exercise_2", "steps"]:
            return f"{rational(END)} / {argument(EXERCISE_H[key])}", 0
        case [key, "first_step", rate, component] if rate.startswith("k"):
            rates = f"rates {key} {argument(FIRST_H)} start"
            return f"{COMPONENTS[component]} (nth {int(rate[1:]) - 1} ({rates}) start)", 1
        case [key, "stability_boundary", after, component]:
            steps = int(after.removeprefix("step"))
            return f"{COMPONENTS[component]} {_run(key, BOUNDARY_H, steps)}", steps
        case [key, "exercise_1", "invariant"]:
            return f"modified_energy {argument(FIRST_H)} {_scene_run(key, 'exercise_1')[0]}", 1
        case [key, scene, readout]:
            run, steps = _scene_run(key, scene)
            if readout == "energy_change":
                return f"energy {run} - energy start", steps
            return f"{COMPONENTS.get(readout, readout)} {run}", steps
    raise ValueError(f"{quantity} has no expression in Coq yet")


def _enclosed(quantity: str) -> str:
    """The Coq expression of an irrational quantity in R_scope."""
    match quantity.split("."):
        case ["exact", scene, component]:
            return f"{COMPONENTS[component]} (flow {_time(scene)})"
        case [key, scene, "state_error"]:
            return f"distance (to_R {_scene_run(key, scene)[0]}) (flow {_time(scene)})"
        case [key, scene, "phase_error"]:
            return f"phase_error (to_R {_scene_run(key, scene)[0]}) (flow {_time(scene)})"
    raise ValueError(f"{quantity} has no expression in Coq yet")


def _time(scene: str) -> str:
    return f"({FIRST_H})" if scene == "first_step" else str(END)


def _counted(quantity: str) -> str:
    """The Coq expression of a count in nat."""
    match quantity.split("."):
        case [_, "stages"]:
            return f"length (rates {RK4} {argument(FIRST_H)}%Q start)"
        case [key, "exercise_2", "evaluations"]:
            return f"{step_count(END, EXERCISE_H[key])} * evaluations {key}"
        case [key, scene, "evaluations"]:
            return f"{PRESETS[scene].steps} * evaluations {key}"
    raise ValueError(f"{quantity} has no expression in Coq yet")
