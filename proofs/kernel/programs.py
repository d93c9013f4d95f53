"""Write the hand-written steppers and the energy readout as Coq programs, by tracing their operations on symbols."""

from __future__ import annotations

from collections.abc import Callable

from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric import readouts
from driftproof.numeric.steppers import HAND_WRITTEN

# The notations name the instance: to infer it for each of forty operations would take Coq minutes.
HEAD = """\
(** The steppers as they are written by hand, operation by operation. *)
Section Programs.
Context {T : Type} {A : Arithmetic T}.
Local Notation "x + y" := (@plus T A x y).
Local Notation "x * y" := (@times T A x y).
Local Notation "x / y" := (@over T A x y).
Local Notation "- x" := (@negative T A x).
Local Notation integer := (@integer T A)."""


class Trace:
    """The operations recorded so far, one line each."""

    def __init__(self) -> None:
        """Start with no operation."""
        self.lines: list[str] = []

    def result(self, operation: str) -> Name:
        """Record the operation and return a new name for its result."""
        name = f"x{len(self.lines) + 1}"
        self.lines.append(f"  let {name} := {operation} in")
        return Name(self, name)


class Name:
    """A symbolic number: operations on it are recorded in the order in which the program makes them."""

    def __init__(self, trace: Trace, text: str) -> None:
        """Name an argument or a result."""
        self.trace, self.text = trace, text

    def __add__(self, other: Name | int) -> Name:
        """Record a sum."""
        return self._operation("+", self, other)

    def __mul__(self, other: Name | int) -> Name:
        """Record a product."""
        return self._operation("*", self, other)

    def __rmul__(self, other: Name | int) -> Name:
        """Record a product with an integer on the left."""
        return self._operation("*", other, self)

    def __truediv__(self, other: Name | int) -> Name:
        """Record a quotient."""
        return self._operation("/", self, other)

    def __neg__(self) -> Name:
        """Record a negation."""
        return self.trace.result(f"- {self.text}")

    def __pow__(self, exponent: int) -> Name:
        """Record a square. Raises ValueError for any other power."""
        if exponent != 2:
            raise ValueError(f"the power {exponent} is no square")
        return self * self

    def _operation(self, sign: str, a: Name | int, b: Name | int) -> Name:
        return self.trace.result(f"{_argument(a)} {sign} {_argument(b)}")


def _argument(x: Name | int) -> str:
    return x.text if isinstance(x, Name) else f"integer {x}"


def program(name: str, arguments: str, run: Callable[..., object]) -> str:
    """The Coq definition `name`_program of the function `run` with these arguments."""
    trace = Trace()
    result = run(*(Name(trace, argument) for argument in arguments.split()))
    returned = f"({', '.join(map(_argument, result))})" if isinstance(result, tuple) else _argument(result)  # type: ignore[arg-type]
    head = f"Definition {name}_program ({arguments} : T) :="
    return "\n".join([head, *trace.lines, f"  {returned}.", ""])


def programs() -> list[str]:
    """The lines of the Coq section with all programs."""
    steppers = (
        program(key, "h q v", lambda h, q, v, step=step: step(oscillator, q, v, h))
        for key, step in HAND_WRITTEN.items()
    )
    energy = program("energy", "q v", lambda q, v: readouts.energy((q, v)))
    return [HEAD, *steppers, energy, "End Programs.\n"]
