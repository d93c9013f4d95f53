"""A clause of a stepper's contract: one sentence, whether it holds, and the calls that show it."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

# What methods have or have not. All other clauses are what anybody expects of a stepper without asking.
TRAITS = frozenset(("symmetric", "reversible", "area_preserving", "norm_preserving", "linear"))


@dataclass(frozen=True)
class Trial:
    """One call, as a line of Python, and what came of it: numbers; or, where there are none, what was seen instead.

    `given` is (q, v, h).
    """

    call: str
    given: tuple[float, float, float]
    answer: tuple[float, ...] | None = None
    failure: str = ""

    @property
    def finite(self) -> bool:
        """True when numbers came, none of them NaN or infinite."""
        return self.answer is not None and all(map(isfinite, self.answer))

    @property
    def overflowed(self) -> bool:
        """True where Python's own powers and functions say so instead of returning infinity."""
        return self.failure.startswith("raises OverflowError")

    @property
    def seen(self) -> str:
        """What came, as a reader writes it: (1.0, 0.75), or `raises ValueError: ...`."""
        return self.failure if self.answer is None else shown(self.answer)

    @property
    def refusal(self) -> str:
        """What was seen instead of numbers, as the end of a sentence."""
        return f"it {self.failure}" if self.failure.startswith(("raises", "returns")) else self.failure

    @property
    def line(self) -> str:
        """The call and what came, to be tried again."""
        return f"{self.call} -> {self.seen}"

    def as_dict(self) -> dict[str, Any]:
        """For JSON; numbers are strings which give them back to the last bit."""
        answer = None if self.answer is None else [repr(x) for x in self.answer]
        given = dict(zip("qvh", map(repr, self.given), strict=True))
        return {"call": self.call, "given": given, "answer": answer, "failure": self.failure or None}


@dataclass(frozen=True)
class Clause:
    """One sentence about a stepper; `key` says what it is about, `holds` is None where it was not or cannot be asked.

    `holds` is True where a duty is done, and where a trait is there.
    """

    key: str
    holds: bool | None
    words: str
    example: tuple[Trial, ...] = ()

    @property
    def is_fault(self) -> bool:
        """True when something does not hold that anybody expects to."""
        return self.holds is False and self.key not in TRAITS

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        example = [trial.as_dict() for trial in self.example]
        return {"key": self.key, "holds": self.holds, "words": self.words, "example": example}


def shown(numbers: tuple[float, ...]) -> str:
    """(1.0, 0.75), to the last bit."""
    return f"({', '.join(map(repr, numbers))})"
