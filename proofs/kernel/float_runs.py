"""Write FloatRuns.v: theorems that state the float runs of the hand-written steppers bit for bit."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import PRESETS
from driftproof.numeric.steppers import HAND_WRITTEN
from proofs.kernel.coq import Theorem, argument, file_text, rational
from proofs.setting import END, LESSON_METHODS, RK4

IMPORTS = """\
From Coq Require Import QArith Floats.
From driftproof Require Import Methods Tables.
Open Scope float_scope.

(** RK4's run in binary32 from (1, 0) to 10 with n steps of 10/n, where that is a binary32 number. *)
Definition single_rk4 (n : positive) : Q * Q :=
  let number x := single_of_Z (Zpos x) in
  let (q, v) := single_run (@rk4_program _ single_arithmetic)
                  (@over _ single_arithmetic (number 10%positive) (number n)) (Pos.to_nat n)
                  (number 1%positive, single_of_Z 0) in
  (rational_of q, rational_of v)."""
# Numbers n of steps of the runs in binary32 that NumPy makes; 10/n is dyadic.
BINARY32_STEPS = (640, 1280)


def float_runs() -> str:
    """The text of FloatRuns.v."""
    default = PRESETS["default"]
    runs = " /\\\n  ".join(_run("default", key) for key in LESSON_METHODS)
    clock = f"Nat.iter {default.steps} (fun t => t + {_bits(float(default.h))}) 0 = 10"
    whole = f"({default.steps} * {argument(default.h)} == 10)%Q /\\ {clock}"
    claim = Theorem("L203", f"{whole} /\\\n  {runs}", "by_bits.")
    tactic = (
        "Ltac by_bits := repeat match goal with |- _ /\\ _ => split end;\n"
        "  match goal with |- _ = ?bits => vm_cast_no_check (eq_refl bits) | |- _ => reflexivity end.\n"
    )
    others = [Theorem(f"float_run_{name}_{key}", _run(name, key), "by_bits.") for name, key in _other_runs()]
    others += map(_binary32_run, BINARY32_STEPS)
    return file_text("The float runs of the lesson.", IMPORTS, [tactic, *(each.text() for each in (claim, *others))])


def _binary32_run(n: int) -> Theorem:
    """The theorem that states the result of NumPy's run of n steps in binary32."""
    state = np.float32(1), np.float32(0)
    for _ in range(n):
        state = HAND_WRITTEN[RK4](oscillator, *state, np.float32(END / n))
    q, v = (rational(Fraction(float(x))) for x in state)
    return Theorem(f"binary32_run_{n}", f"single_rk4 {n} = ({q}, {v})%Q", "by_bits.")


def _other_runs() -> Iterator[tuple[str, str]]:
    return ((name, key) for name in PRESETS if name != "default" for key in LESSON_METHODS)


def _run(name: str, key: str) -> str:
    scene = PRESETS[name]
    q, v = (_bits(x) for x in run_method(scene, key)["final_state"])
    return f"float_run {key}_program {_bits(float(scene.h))} {scene.steps} (1, 0) = ({q}, {v})"


def _bits(x: float) -> str:
    return f"({x.hex()})"
