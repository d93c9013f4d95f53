"""All that Coq is given, in the order in which it is read: theory by hand, and what is written from exact objects."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from proofs.kernel.a_stability import a_stability
from proofs.kernel.coq import Theorem, theorems
from proofs.kernel.engines import engines
from proofs.kernel.float_runs import float_runs
from proofs.kernel.orders import orders
from proofs.kernel.programs import programs
from proofs.kernel.tables import tables
from proofs.kernel.values import values
from proofs.setting import LESSON_METHODS

THEORY = Path(__file__).with_name("theory")
# Methods that the lesson's are compared with.
COMPARED = ("symplectic_euler_position_first", "velocity_verlet", "midpoint2", "rk38")
WRITTEN: dict[str, Callable[[], str]] = {
    "Tables": partial(tables, (*LESSON_METHODS, *COMPARED)),
    "Values": values,
    "Programs": programs,
    "OrdersOfTables": orders,
    "AStability": a_stability,
    "FloatRuns": float_runs,
    "Engines": engines,
}
ORDER = (
    *("Methods", "Runs", "Readouts", "Arithmetic", "Identities", "Tables", "Values", "Programs"),
    *("OneStep", "Energy", "ExactFlow", "Stability", "Phase", "Trees", "Orders", "OrdersOfTables", "Convergence"),
    *("Problems", "Jets", "OneStepErrors", "GlobalErrors", "LeadingErrors"),
    *("LeftHalfPlane", "Contraction", "AStability", "Floats", "FloatRuns", "Halving", "Rounding", "ManySteps"),
    "Engines",
)


@dataclass(frozen=True)
class Certificate:
    """A theorem that is named for claims, and the file that holds it."""

    file: str
    theorem: Theorem


@cache
def source(name: str) -> str:
    """The text of a file."""
    return WRITTEN[name]() if name in WRITTEN else (THEORY / f"{name}.v").read_text(encoding="utf-8")


@cache
def all_theorems() -> tuple[Certificate, ...]:
    """Every theorem, in order."""
    return tuple(Certificate(name, theorem) for name in ORDER for theorem in theorems(source(name)))


@cache
def certificates() -> dict[str, Certificate]:
    """Claim -> its certificate. Raises ValueError if two theorems are named for one claim."""
    found: dict[str, Certificate] = {}
    for certificate in all_theorems():
        for claim in certificate.theorem.claims:
            if claim in found:
                raise ValueError(f"{claim} has a certificate in {found[claim].file}.v and one in {certificate.file}.v")
            found[claim] = certificate
    return found


def technique(claim: str) -> str:
    """How the claim's certificate is right, or "-" where there is none."""
    certificate = certificates().get(claim)
    return certificate.theorem.technique if certificate else "-"
