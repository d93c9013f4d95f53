"""The setting of the lesson in exact numbers: methods, start, interval, step sizes and runs."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction as Q
from functools import total_ordering

from sympy.polys.matrices import DomainMatrix

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import PRESETS, Scene
from driftproof.numeric.steppers import HAND_WRITTEN, CountedForce
from driftproof.symbolic.algebra.certified import CertifiableReal, is_less, significant
from driftproof.symbolic.derivation.one_step import (
    StepPolynomial,
    exact_stepper,
    matrix_at,
    one_step_matrix,
    symbolic_step,
)
from driftproof.symbolic.runs import OscillatorRun, apply, power

EULER, SYMPLECTIC, RK4 = LESSON_METHODS = ("forward_euler", "symplectic_euler", "rk4")
START = (Q(1), Q(0))
END = Q(10)
FIRST_H = Q(1, 2)
DEFAULT_H, SMALL_H, COMPARE_H, BOUNDARY_H = (
    PRESETS[name].h for name in ("default", "small_steps", "compare", "stability_boundary")
)


@total_ordering
@dataclass(frozen=True)
class Real:
    """A real number to compare by enclosures; in failed assertions it shows as a decimal."""

    value: CertifiableReal

    def __lt__(self, other: Real) -> bool:
        """True if disjoint balls show that self is less than other."""
        return is_less(self.value, other.value)

    def __repr__(self) -> str:
        """The number to twenty significant digits."""
        return significant(self.value, 20)


def M(key: str) -> DomainMatrix:
    """The one-step matrix of the method `key`, over Q[h]. Looked up per call, so that planted errors take effect."""
    return one_step_matrix(METHODS[key])


def step_of(key: str) -> tuple[StepPolynomial, StepPolynomial]:
    """(q₁, v₁) of one step of `key`, in Q[q, v, h]."""
    return symbolic_step(exact_stepper(METHODS[key]))


def run(key: str, h: Q, t: Q = END, start: tuple[Q, Q] = START) -> OscillatorRun:
    """The exact run of `key` over [0, t]."""
    return OscillatorRun(METHODS[key], h, t, start)


def state_after(key: str, n: int, h: Q, start: tuple[Q, Q] = START) -> tuple[Q, Q]:
    """The exact state after n steps."""
    return apply(power(matrix_at(M(key), h), n), *start)


def rates(key: str, h: Q, start: tuple[Q, Q] = START) -> list[tuple[Q, Q]]:
    """The slopes kᵢ = F(z + h Σⱼ aᵢⱼ kⱼ) of one step of an explicit Runge-Kutta method, with F(q, v) = (v, -q)."""
    slopes: list[tuple[Q, Q]] = []
    for row in METHODS[key].a:
        q, v = (start[i] + h * sum(a * k[i] for a, k in zip(row, slopes, strict=False)) for i in (0, 1))
        slopes.append((v, -q))
    return slopes


def calls_of_a_step(key: str) -> int:
    """The number of calls of the force in one step in fractions; no step branches on a value, so all make as many."""
    force = CountedForce(oscillator)
    HAND_WRITTEN[key](force, *START, FIRST_H)
    return force.calls


def counted_evaluations(key: str, h: Q) -> int:
    """The number of calls of the force, counted during a float run over the interval of the lesson."""
    scene = Scene("cost", key, h, END, START, readouts=("evaluations",))
    return int(run_method(scene, key)["evaluations"])


def energy(q: Q, v: Q) -> Q:
    """The energy ½(q² + v²)."""
    return (q * q + v * v) / 2
