"""What a stepper is compared with: a method, the errors allowed beyond rounding, and the domain of its arguments."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf

from driftproof.blackbox.stepper.starts import Start
from driftproof.methods.catalogue import Entry
from driftproof.methods.numbers.rationals import parse_rational


@dataclass(frozen=True)
class Allowance:
    """The errors that a stepper is allowed beyond the rounding of the definition's sums and products in any order.

    `step_in_binary32`: h is rounded to binary32 before it is used. `velocity_from_positions`: v is formed as a
    difference of positions over h, which adds u (|q| + |q₁|)/h to its error. `flush_to_zero`: subnormal arguments and
    results become 0. `solver_tolerance`: how far the solution of implicit stages may be off, both absolutely and
    relative to the sum of |monomials| of the larger component; required for implicit methods, and refused for explicit
    ones. Raises ValueError unless it is finite and above 0.

    >>> from driftproof import Allowance, verify
    >>> step = lambda q, v, h: (q + h * v, ((q + h * v) - q) / h - h * q)
    >>> allowance = Allowance(velocity_from_positions=True)
    >>> verify(step, "forward_euler", allowance=allowance, examples=50, isolate=False).passed
    True
    """

    step_in_binary32: bool = False
    velocity_from_positions: bool = False
    flush_to_zero: bool = False
    solver_tolerance: Fraction | float | str | None = None

    def __post_init__(self) -> None:
        """Raise ValueError unless `solver_tolerance`, which may be text, is finite and above 0."""
        given = self.solver_tolerance
        if isinstance(given, str):
            given = parse_rational(given, "solver_tolerance")
            object.__setattr__(self, "solver_tolerance", given)
        if given is not None and not 0 < given < inf:
            raise ValueError(f"solver_tolerance={given}: must be a finite number > 0, e.g. 1e-10")


@dataclass(frozen=True)
class Domain:
    """The sizes of h > 0, q and v at which a stepper is tried; q and v are also tried at 0.

    The smallest sizes keep arguments away from underflow, where codes that convert units lose digits harmlessly; if
    they are 0, all floats are tried. In narrow formats they are raised to the square root of the smallest normal
    number. Where the largest size is not above the smallest by default, that is so many times smaller than the largest.
    Raises ValueError unless 0 <= smallest < largest < inf.

    Where a code raises outside of what it is for, `start` says where a step with a system given may be asked: it has a
    number, or a range of it, for each number of a state, "280:400", or "7e6, -1e5:1e5, 0; 0, 7500, 0" for two arrays;
    commas part the numbers of an array, semicolons the parts of a state. A number stands for those around it, up to an
    eighth of it; a 0, up to an eighth of the smallest other of its part. No other states are tried then.

    >>> from driftproof import Domain, verify
    >>> step = lambda q, v, h: (q + h * v, v - h * q)
    >>> verify(step, "forward_euler", domain=Domain(largest_step=0.5), examples=50, isolate=False).passed
    True
    """

    largest_step: float = 2.0
    largest_state: float = 1000.0
    smallest_step: float = 2.0**-20
    smallest_state: float = 2.0**-60
    start: Start | str | None = None

    def __post_init__(self) -> None:
        """Put smallest sizes by default below the largest. Raises ValueError unless 0 <= smallest < largest < inf."""
        for what, (low, high) in zip(("smallest_step", "smallest_state"), self.ranges, strict=True):
            if 0 < high <= low == getattr(Domain, what):
                object.__setattr__(self, what, low := low * high)
            if not 0 <= low < high < inf:
                raise ValueError(f"from {low:g} to {high:g}: need 0 <= smallest < largest < infinity")
        if isinstance(self.start, str):
            object.__setattr__(self, "start", Start.of(self.start))

    @property
    def begins(self) -> Start | None:
        """The start that is given, read."""
        return None if isinstance(self.start, str) else self.start

    @property
    def ranges(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The smallest and largest sizes, first of steps, then of states."""
        return (self.smallest_step, self.largest_step), (self.smallest_state, self.largest_state)

    @property
    def words(self) -> str:
        """The domain as inequalities."""
        return f"{self.smallest_step:.3g} <= h <= {self.largest_step:g}, |q|, |v| <= {self.largest_state:g}"


ORDINARY_DOMAIN = Domain()
NO_ALLOWANCE = Allowance()


@dataclass(frozen=True)
class Specification:
    """A method of any family, as a stepper is to be compared with it."""

    method: Entry
    allowance: Allowance = NO_ALLOWANCE
    domain: Domain = ORDINARY_DOMAIN
