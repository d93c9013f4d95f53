"""Write Tables.v: the methods of the lesson as Coq data, its scenes, and the hand-written steppers as programs."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Method, RungeKutta, Splitting
from driftproof.numeric.scenes import PRESETS
from proofs.kernel.coq import argument, coq_list, file_text, rational
from proofs.kernel.programs import programs

IMPORTS = """\
From Coq Require Import QArith List.
From driftproof Require Import Methods.
Import ListNotations.
Open Scope Q_scope."""


def explicit_rows(method: RungeKutta) -> list[list[Fraction]]:
    """The rows of A below its diagonal. Raises ValueError for an implicit method and for irrational coefficients."""
    if not method.explicit:
        raise ValueError(f"{method.key} is implicit")
    return [_rational(row[:i]) for i, row in enumerate(method.a)]


def definition(method: Method) -> str:
    """The Coq definition of a method, under its key. Raises ValueError for other than Runge-Kutta and splitting."""
    if isinstance(method, RungeKutta):
        rows = coq_list(coq_list(map(rational, row)) for row in explicit_rows(method))
        body = f"RungeKutta {rows} {coq_list(map(rational, _rational(method.b)))}"
    elif isinstance(method, Splitting):
        cs = _rational(c for _, c in method.parts)
        kinds = (kind for kind, _ in method.parts)
        body = f"Splitting {coq_list(f'{kind} {argument(c)}' for kind, c in zip(kinds, cs, strict=True))}"
    else:
        raise ValueError(f"{method.key} is of no family that the kernel has a step of")
    return f"Definition {method.key} := ({body})%Q.\n"


def scenes() -> str:
    """The Coq definition of the presets of the lesson."""
    shown = (
        f"{{| methods := {coq_list(scene.methods)}; initial := ({', '.join(map(rational, scene.start))}); "
        f"size := {rational(scene.h)}; steps := {scene.steps}%nat; duration := {rational(scene.t)} |}}"
        for scene in PRESETS.values()
    )
    return "Definition scenes : list scene :=\n  " + coq_list(shown) + ".\n"


def tables(keys: Iterable[str]) -> str:
    """The text of Tables.v."""
    definitions = (definition(METHODS[key]) for key in keys)
    purpose = "The methods of the lesson, those they are compared with, and the steppers that are written by hand."
    return file_text(purpose, IMPORTS, [*definitions, scenes(), *programs()])


def _rational(coefficients: Iterable[Exact]) -> list[Fraction]:
    found = list(coefficients)
    if not all(isinstance(x, Fraction) for x in found):
        raise ValueError("irrational coefficients have files of their own")
    return [x for x in found if isinstance(x, Fraction)]
