"""The step of a method as straight-line Python text without zero terms, and as a function of numbers of any type.

The same text is run in floats, compiled, traced with polynomials, and used to derive rounding bounds. It contains no
number and no branch on a value, so it works in every arithmetic to which the coefficients are converted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

from driftproof.methods.number_field import Exact
from driftproof.methods.program_text import (
    ProgramText,
    SecondOrder,
    indented,
    looping_maker_text,
    maker,
    maker_text,
    used_stages,
)
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta, require_method

FORCE = "force({})"
# Any type with + and * (and what its force needs); the arithmetic is the type's own.
Number: TypeAlias = Any
Force: TypeAlias = Callable[[Number], Number]
Step: TypeAlias = Callable[[Force, Number, Number, Number], tuple[Number, Number]]
# Converts an Exact; not typed so, because an arithmetic may accept rational coefficients only.
Lift: TypeAlias = Callable[[Any], Number]


@dataclass(frozen=True)
class Source:
    """The lines of a step, which define q1 and v1, and the coefficients that they name.

    The lines read q, v, h and the coefficients. Those of a compensated step also update e_q and e_v, the rounding
    errors of the additions so far; only `run` can use them.
    """

    lines: tuple[str, ...]
    coefficients: tuple[tuple[str, Exact], ...]
    compensated: bool

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the coefficients, in the order of their first use."""
        return tuple(name for name, _ in self.coefficients)

    def run(self) -> str:
        """The text of make(coefficients...) -> run(q, v, h, steps) -> (q, v), which takes `steps` steps in one loop."""
        loop = ["for _ in range(steps):", *indented([*self.lines, "q, v = q1, v1"])]
        start = ["e_q, e_v = q - q, v - v"] if self.compensated else []
        return looping_maker_text(self.names, "q, v, h, steps", [*start, *loop, "return q, v"])

    def step(self) -> str:
        """The text of make(coefficients...) -> step(force, q, v, h) -> (q1, v1)."""
        lines = ["def step(force, q, v, h):", *indented([*self.lines, "return q1, v1"])]
        return maker_text(self.names, "step", lines)


def step_source(method: Method, force: str = FORCE, *, compensated: bool = False) -> Source:
    """The step of `method` for q' = v, v' = F(q), with F(x) written as `force.format(x)`, x always a name.

    Sums are taken from the left, h multiplies a sum once, and factors 1 and -1 are left out, which is exact in every
    arithmetic. A stage that nothing uses is left out. In a `compensated` step the additions that advance the state keep
    their rounding errors; `tests/witnesses/compensated.py` derives what is gained. Raises MethodError for an implicit
    method, whose stages are equations rather than formulas.
    """
    if not method.explicit or isinstance(method, Collocation):
        raise MethodError(f"{method.key} is implicit: its stages are equations, so it has no explicit step")
    text = ProgramText(compensated=compensated)
    if isinstance(method, RungeKutta):
        _runge_kutta(method, force, text)
    else:
        SecondOrder(("q",), ("v",), lambda names: [force.format(names["q"])], "1").write(method, text)
    return Source(tuple(text.lines), tuple(text.coefficients.items()), compensated)


def _runge_kutta(method: RungeKutta, force: str, text: ProgramText) -> None:
    """Write the stages qᵢ with slopes (kᵢ_q, kᵢ_v), then the sums of both components."""
    slopes: dict[str, dict[int, str]] = {"q": {}, "v": {}}
    for i in used_stages(method.a, [method.b]):
        moved = {x: text.sum(" + h *", f"a{i + 1}", method.a[i], slopes[x]) for x in slopes}
        slopes["q"][i] = text.named(f"k{i + 1}_q", "v", moved["v"])
        place = text.named(f"q_{i + 1}", "q", moved["q"])
        slopes["v"][i] = f"k{i + 1}_v"
        text.lines.append(f"k{i + 1}_v = {force.format(place)}")
    for x in slopes:
        text.advance(x, f"{x}1", x, text.sum(" + h *", "b", method.b, slopes[x]))


def stepper(method: Method, lift: Lift) -> Step:
    """The step (force, q, v, h) → (q₁, v₁) of `method` for q' = v, v' = force(q): the text of `step_source`.

    `lift` converts each exact coefficient to the number type of q, v and h. It is needed because coercion would turn
    `Fraction * ndarray` into an object array and `Fraction * float32` into a Python float.
    Raises MethodError for an implicit method, whose stages are equations rather than formulas.

    >>> from fractions import Fraction
    >>> from driftproof import METHODS, stepper
    >>> step = stepper(METHODS["rk4"], Fraction)
    >>> step(lambda q: -q, Fraction(1), Fraction(0), Fraction(1, 2))
    (Fraction(337, 384), Fraction(-23, 48))
    """
    require_method(method)
    make, coefficients = _compiled(method)
    step: Step = make(*(lift(c) for c in coefficients))
    return step


@cache
def _compiled(method: Method) -> tuple[Callable[..., Step], tuple[Exact, ...]]:
    source = step_source(method)
    return maker(source.step(), method.key), tuple(c for _, c in source.coefficients)


def oscillator(q: Number) -> Number:
    """F(q) = -q, the acceleration of the normalised oscillator q' = v, v' = -q."""
    return -q
