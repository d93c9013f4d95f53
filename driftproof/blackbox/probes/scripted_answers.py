"""Steps with scripted answers, as all probes make them, and how far rounding may carry the numbers they show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias, TypeVar

from driftproof.blackbox.findings import Misbehaviour, NoAnswer
from driftproof.support.plain_text import counted
from driftproof.symbolic.rounding.formats import FloatFormat

CoefficientRow: TypeAlias = tuple[float, ...]
Result = TypeVar("Result")
# Sizes below the limits on speeds and distances in use, and above those that are put to rest.
BELOW_LIMITS = (2.0**-5, 2.0**-10)
# A limit takes away more than this part of a number; a nonlinearity takes away less.
_FAR = 2.0**-10
# More calls in one step than any method in use makes: it iterates, or is adaptive.
MOST_CALLS = 200
# What a step without readable coefficients may be: of a size of its own; another one each time; moved without slopes.
ADAPTIVE, REMEMBERS, MOVES = "adaptive", "remembers", "moves"


class NotReadable(ValueError):
    """No coefficients of the step could be read; the message says what was seen, `traits` what the step may be."""

    kind = "not_readable"

    def __init__(self, seen: str, *traits: str) -> None:
        super().__init__(seen)
        self.traits = traits


class FarFromPrediction(NotReadable):
    """A number of a control is far from what the coefficients say, as numbers beyond a limit are."""


class _TooManyCalls(Misbehaviour):
    """Ends a step from inside; it never leaves this module."""


class Listener:
    """A function that answers by `answer`, records what it is called with, and ends the step after `most` calls."""

    def __init__(self, answer: Callable[[Any], Any], most: int = MOST_CALLS) -> None:
        self._answer, self._most = answer, most
        self.calls: list[Any] = []

    def __call__(self, asked: Any) -> Any:
        """Answer one call. Ends the step after `most` calls."""
        if len(self.calls) == self._most:
            raise _TooManyCalls(f"one step makes more than {self._most} calls: an iteration or an adaptive solver")
        self.calls.append(asked)
        return self._answer(asked)


class Script(Listener):
    """A function that answers its j-th call by `answers[j]` and later ones by `silence`, and records its calls."""

    def __init__(self, answers: Sequence[Any], silence: Any) -> None:
        super().__init__(lambda _: answers[len(self.calls) - 1] if len(self.calls) <= len(answers) else silence)


def result_of(step: Callable[[], Result]) -> Result:
    """What the step returns. Raises NotReadable after too many calls."""
    try:
        return step()
    except _TooManyCalls as ended:
        raise NotReadable(str(ended)) from None


def read_at_some_size(read: Callable[[float], Result]) -> tuple[Result, tuple[str, ...]]:
    """The result of `read` at size 1, or else at a small size, below a limit that a step may have; and remarks.

    Scaling by a power of two keeps all products and sums exact. Raises the NotReadable of size 1.
    """
    try:
        return read(1.0), ()
    except FarFromPrediction as refusal:
        for size in BELOW_LIMITS:
            with suppress(NotReadable, Misbehaviour):
                return read(size), (f"read with numbers of size {size:.1e}; of size 1, {refusal}",)
        raise refusal


def remarks_of(control: Callable[[], object]) -> tuple[str, ...]:
    """What a control says against a reading that is kept all the same: one line or none."""
    try:
        control()
    except (Misbehaviour, NoAnswer, NotReadable) as error:
        return (str(error),)
    return ()


def require_calls(expected: int, seen: int) -> None:
    """Raise NotReadable if the number of calls is another one than with other answers."""
    if seen != expected:
        differ = f"the number of calls depends on the answers: {expected}, then {seen}"
        raise NotReadable(f"{differ}: the step is adaptive or iterative", ADAPTIVE)


def require_same(rounding: Rounding, first: Sequence[float], second: Sequence[float]) -> None:
    """Raise NotReadable if a step that is taken again shows other numbers, beyond rounding."""
    allowed = rounding.of(max(map(abs, first), default=0.0))
    if len(first) != len(second) or not all(abs(x - y) <= allowed for x, y in zip(first, second, strict=True)):
        seen = f"the same step of {counted(rounding.calls, 'call')} taken twice is not the same"
        raise NotReadable(f"{seen}: it remembers the previous step, or is random", REMEMBERS)


def unit(size: int, place: int) -> list[float]:
    """The answers 0, ..., 0, 1, 0, ..., 0 with the 1 at `place`."""
    return [0.0] * place + [1.0] + [0.0] * (size - place - 1)


def varied(size: int, salt: int) -> list[float]:
    """Answers of both signs and sizes from 1/4 to 4, all powers of two: products with coefficients are exact."""
    return [(-1.0) ** (j * (j + salt) // 2) * 2.0 ** ((3 * j + salt) % 5 - 2) for j in range(size)]


class Control(NamedTuple):
    """A step that shows whether all was read: its start, time and h, and the `salt` of the answers that it gets.

    `broken` says what the step is like if it departs from the coefficients.
    """

    name: str
    broken: str
    h: float = 1.0
    start: float = 0.0
    time: float = 0.0
    salt: int = 1


# The step that coefficients are read from.
AT_REST = Control("no answers", "")
_SCALE = "it does not scale with h as a step of a method does"
CONTROLS = (
    Control("other answers", "the step is not linear in them: a limiter, an iteration or an error control", salt=2),
    Control("h = 2", _SCALE, h=2.0),
    Control("h = 1/2", _SCALE, h=0.5, salt=3),
    Control("h = 3", _SCALE, h=3.0, salt=4),
    Control("another start", "the step depends on where it starts", start=5.0, salt=5),
    Control("the time 7", "the step depends on the time", time=7.0),
    Control("everything changed", "the step is not made of these terms alone", h=0.75, start=-3.0, time=2.0, salt=2),
)
# Many codes refuse to step back in time, so that a failure of this one says nothing against the others.
BACKWARD = Control("h = -1", "it does not step backward as it steps forward", h=-1.0, salt=3)


def shown_apart(x: float, y: float, digits: int = 6) -> tuple[str, str]:
    """Both numbers in at least so many digits, and in as many as tell them apart."""
    n = next((n for n in range(digits, 17) if f"{x:.{n}g}" != f"{y:.{n}g}"), 17)
    return f"{x:.{n}g}", f"{y:.{n}g}"


@dataclass(frozen=True)
class Rounding:
    """How far rounding may carry one number of a step that makes `calls` calls.

    A program makes each number from the start and the answers by sums and products with constants. In the longest form
    in use, low storage, an answer then passes a product and a sum in each of two registers at every later call: four
    roundings a call, and a few more where it enters and where the result is formed. A sum that passes k roundings errs
    by at most k u, to first order, times its largest intermediate number, which is of the size of the terms. `besides`
    is what the solver of implicit stages leaves in a number of size 1 or less; in larger ones it grows in proportion.
    """

    format: FloatFormat
    calls: int
    besides: float = 0.0

    @property
    def most(self) -> int:
        """The number k of roundings that a program may spend on one number."""
        return 4 * (self.calls + 2)

    def of(self, size: float) -> float:
        """How far a number of this size may be off: k u size, k underflows, and what a solver leaves."""
        rounded = self.most * (float(self.format.u) * size + float(self.format.eta))
        return rounded + self.besides * max(1.0, size)


def require_predicted(control: Control, name: str, seen: float, said: float, allowed: float) -> None:
    """Raise NotReadable if a number of a control is farther than `allowed` from what the coefficients say."""
    if not abs(seen - said) <= allowed:
        found = FarFromPrediction if abs(seen - said) > _FAR * max(abs(seen), abs(said)) else NotReadable
        ends = "{} where the coefficients read give {}".format(*shown_apart(seen, said))
        raise found(f"with {control.name}, {name} is {ends}: {control.broken}")
