"""The hand-written steppers and the energy readout, as Coq programs in Tables.v, traced by running them on names."""

from __future__ import annotations

from collections.abc import Callable

from driftproof.methods.stepping import oscillator
from driftproof.numeric import readouts
from driftproof.numeric.steppers import HAND_WRITTEN

# With the instance in its place from the start: found anew for each of forty operations, it takes Coq minutes.
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
    """The operations made so far, one line each."""

    def __init__(self) -> None:
        """Start with none."""
        self.lines: list[str] = []

    def result(self, operation: str) -> Name:
        """A name for what the operation gives."""
        name = f"x{len(self.lines) + 1}"
        self.lines.append(f"  let {name} := {operation} in")
        return Name(self, name)


class Name:
    """A number by its name: operations with it are written down, in the order in which the program makes them."""

    def __init__(self, trace: Trace, text: str) -> None:
        """A name that stands for an argument or for a result."""
        self.trace, self.text = trace, text

    def __add__(self, other: Name | int) -> Name:
        """Write an addition."""
        return self._operation("+", self, other)

    def __mul__(self, other: Name | int) -> Name:
        """Write a product."""
        return self._operation("*", self, other)

    def __rmul__(self, other: Name | int) -> Name:
        """Write a product with an integer."""
        return self._operation("*", other, self)

    def __truediv__(self, other: Name | int) -> Name:
        """Write a quotient."""
        return self._operation("/", self, other)

    def __neg__(self) -> Name:
        """Write a negative."""
        return self.trace.result(f"- {self.text}")

    def __pow__(self, exponent: int) -> Name:
        """Write a square. Raises ValueError for any other power."""
        if exponent != 2:
            raise ValueError(f"the power {exponent} is no square")
        return self * self

    def _operation(self, sign: str, a: Name | int, b: Name | int) -> Name:
        return self.trace.result(f"{_argument(a)} {sign} {_argument(b)}")


def _argument(x: Name | int) -> str:
    return x.text if isinstance(x, Name) else f"integer {x}"


def program(name: str, arguments: str, run: Callable[..., object]) -> str:
    """The definition of what `run` computes from arguments of these names."""
    trace = Trace()
    result = run(*(Name(trace, argument) for argument in arguments.split()))
    returned = f"({', '.join(map(_argument, result))})" if isinstance(result, tuple) else _argument(result)  # type: ignore[arg-type]
    head = f"Definition {name}_program ({arguments} : T) :="
    return "\n".join([head, *trace.lines, f"  {returned}.", ""])


def programs() -> list[str]:
    """The section of them."""
    steppers = (
        program(key, "h q v", lambda h, q, v, step=step: step(oscillator, q, v, h))
        for key, step in HAND_WRITTEN.items()
    )
    energy = program("energy", "q v", lambda q, v: readouts.energy((q, v)))
    return [HEAD, *steppers, energy, "End Programs.\n"]
