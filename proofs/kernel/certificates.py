"""All files for Coq, in the order of compilation: hand-written theory, and files generated from exact objects."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from proofs.kernel.a_stability import a_stability
from proofs.kernel.coq import Theorem, theorems
from proofs.kernel.engines import engines
from proofs.kernel.float_runs import float_runs
from proofs.kernel.orders import orders
from proofs.kernel.tables import tables
from proofs.kernel.values import values
from proofs.setting import LESSON_METHODS

THEORY = Path(__file__).with_name("theory")
# Methods that the lesson's are compared with.
COMPARED = ("symplectic_euler_position_first", "velocity_verlet", "midpoint2", "rk38")
WRITTEN: dict[str, Callable[[], str]] = {
    "Tables": partial(tables, (*LESSON_METHODS, *COMPARED)),
    "Values": values,
    "OrdersOfTables": orders,
    "AStability": a_stability,
    "FloatRuns": float_runs,
    "Engines": engines,
}
ORDER = (
    *("Methods", "Readouts", "Runs", "Tables", "Values"),
    *("OneStep", "Energy", "ExactFlow", "Stability", "Phase"),
    *("Trees", "Orders", "RoundedOrders", "OrdersOfTables", "Convergence"),
    *("Problems", "Jets", "OneStepErrors", "GlobalErrors", "LeadingErrors"),
    *("LeftHalfPlane", "Contraction", "AStability", "FloatRuns", "Halving", "Rounding", "Engines"),
)
# Claims whose Coq statement is weaker than the sentence, and what it leaves out.
IN_PART = {
    "L039": "that the steps 2 and 5/2 are on offer is given",
    "L064": "that no consistent method errs where y' = 1 is said of Runge-Kutta methods, not of splittings",
    "L182": "that 5/2 is the largest step on offer is given",
    "L185": "that an error h/6 is not O(h^4): Coq computes it for h = 1/2 to 1/256 only",
    "L244": "equal work: Coq counts the evaluations; that the other operations differ is a test",
    "T01": "Coq compares two tables of numbers; that these are what the engines give rests on who writes the file",
}

_WORD = re.compile(rf"(?:({'|'.join(ORDER)})\.)?([^\W\d]\w*)")
_DEFINED = re.compile(r"^ *(?:Definition|Fixpoint|Inductive|Record) (\w+)", re.M)


@dataclass(frozen=True)
class Certificate:
    """A theorem and the name of the file that holds it."""

    file: str
    theorem: Theorem


@cache
def source(name: str) -> str:
    """The text of the file with this name."""
    return WRITTEN[name]() if name in WRITTEN else (THEORY / f"{name}.v").read_text(encoding="utf-8")


@cache
def all_theorems() -> tuple[Certificate, ...]:
    """Every theorem of every file, in order."""
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


def definitions(certificate: Certificate) -> dict[str, list[str]]:
    """File -> the words of the certificate's statement that it defines, needed to understand the statement."""
    place = {}
    for name in ORDER[: ORDER.index(certificate.file) + 1]:
        place |= dict.fromkeys(_DEFINED.findall(source(name)), name)
    found: dict[str, list[str]] = {}
    for file, word in dict.fromkeys(_WORD.findall(certificate.theorem.statement)):
        if word in place:
            found.setdefault(file or place[word], []).append(word)
    return found


def technique(claim: str) -> str:
    """The technique of the claim's certificate, with ", in part" if it is weaker than the claim; "-" without one."""
    certificate = certificates().get(claim)
    return "-" if certificate is None else certificate.theorem.technique + ", in part" * (claim in IN_PART)
