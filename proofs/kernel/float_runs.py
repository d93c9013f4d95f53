"""FloatRuns.v: the lesson's float runs, bit for bit, as the hand-written steppers make them."""

from __future__ import annotations

from collections.abc import Iterator

from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import PRESETS
from proofs.kernel.coq import Theorem, file_text
from proofs.setting import LESSON_METHODS

IMPORTS = """\
From Coq Require Import QArith Floats.
From driftproof Require Import Arithmetic Programs Floats.
Open Scope float_scope."""


def float_runs() -> str:
    """The text of FloatRuns.v."""
    default = PRESETS["default"]
    runs = " /\\\n  ".join(_run("default", key) for key in LESSON_METHODS)
    whole = f"({default.steps} * (1 # 4) == 10)%Q /\\ {default.steps} * {float(default.h)} = 10"
    claim = Theorem("L203", f"{whole} /\\\n  {runs}", "by_bits.")
    tactic = "Ltac by_bits := repeat match goal with |- _ /\\ _ => split end; vm_compute; reflexivity.\n"
    others = [Theorem(f"float_run_{name}_{key}", _run(name, key), "by_bits.") for name, key in _other_runs()]
    return file_text("The float runs of the lesson.", IMPORTS, [tactic, *(each.text() for each in (claim, *others))])


def _other_runs() -> Iterator[tuple[str, str]]:
    return ((name, key) for name in PRESETS if name != "default" for key in LESSON_METHODS)


def _run(name: str, key: str) -> str:
    scene = PRESETS[name]
    q, v = (_bits(x) for x in run_method(scene, key)["final_state"])
    return f"float_run {key}_program {_bits(float(scene.h))} {scene.steps} (1, 0) = ({q}, {v})"


def _bits(x: float) -> str:
    return f"({x.hex()})"
