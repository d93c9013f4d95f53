"""Rosenbrock steppers, which take a Jacobian: which method it is, what it does with df/dt, and its order."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from driftproof.blackbox.families import family_walks as walks
from driftproof.blackbox.families.rosenbrock_step import RosenbrockReading, read_rosenbrock_step
from driftproof.blackbox.families.second_answers import ESTIMATE, WithEstimate, embedded_row, judged_second
from driftproof.blackbox.findings import StepFinding
from driftproof.blackbox.judging.measured_order import MeasuredOrder, order_seen, slopes_text
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.walks import there_and_back
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes.coefficients import coefficient_text, exact_shown
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.report import Criterion
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.numbers.number_field import Algebraic, Exact
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.support.plain_text import Json
from driftproof.symbolic.rosenbrock import RosenbrockFacts

# Methods that go by one name with either root of the equation for gamma: both are published, and used.
_EITHER_ROOT = ("ros2",)
# The step sizes at which errors are measured: h = 2**-k.
_HALVINGS = range(1, 9)


class _Products:
    """The products C Γᶜ E and C Γᶜ γ of a method, as in a reading, with the sizes of their terms."""

    def __init__(self, alpha: Array, gamma: Array, b: Array, powers: int) -> None:
        places = list(dict.fromkeys(map(tuple, alpha)))
        stage = [[1.0 * (tuple(row) == place) for place in places] for row in alpha]
        self.nodes = [sum(place) for place in places]
        self.table = np.array([*places, b]), gamma
        sums = gamma.sum(axis=1)
        self.weights, self.sizes = self._levels(np.array(stage), powers)
        self.time_slope, self.time_sizes = self._levels(sums[:, None], powers)

    @classmethod
    def of(cls, method: Rosenbrock, powers: int) -> _Products:
        return cls(*_floats(method), powers)

    def _levels(self, entering: Array, powers: int) -> tuple[list[Array], list[Array]]:
        """C Γᶜ times `entering`, and the sizes of the terms in programs that store αΓ⁻¹, I/γᵢᵢ - Γ⁻¹ and bΓ⁻¹.

        The terms of their stages are bounded by W = (I - |D| |I/γᵢᵢ - Γ⁻¹|)⁻¹ |D|, with D the diagonal of Γ.
        """
        c, gamma = self.table
        inverse = np.linalg.pinv(gamma)
        diagonal = np.diag(np.abs(np.diag(gamma)))
        below = np.abs(inverse - np.diag(np.diag(inverse)))
        stored = np.linalg.inv(np.eye(len(gamma)) - diagonal @ below) @ diagonal
        plain, level, size = np.abs(gamma), entering, stored @ np.abs(entering)
        direct, found, sizes = np.abs(entering), [], []
        for _ in range(powers):
            found.append(c @ level)
            sizes.append(np.maximum(np.abs(c @ inverse) @ size, np.abs(c) @ direct))
            level, size, direct = gamma @ level, stored @ size, plain @ direct
        return found, sizes

    def _rounding(self, reading: RosenbrockReading) -> Rounding:
        return Rounding(reading.format, len(self.table[1]) + reading.calls)

    def differences(self, reading: RosenbrockReading) -> list[str] | None:
        """The products that are not the method's, in words; None if it evaluates f at another number of places."""
        if reading.calls != len(self.nodes):
            return None
        rounding = self._rounding(reading)
        names = [*(f"the argument of call {i}" for i in range(reading.calls)), "the result"]
        found = []
        for power, level in enumerate(reading.weights):
            through = "" if not power else f"J^{power} h^{power + 1} times " if power > 1 else "J h^2 times "
            for (r, g), x in np.ndenumerate(np.array(level)):
                said, size = self.weights[power][r, g], self.sizes[power][r, g]
                if abs(x - said) > (allowed := rounding.of(float(size))):
                    seen = coefficient_text(float(x), reading.format, allowed)
                    found.append(f"{through}the slope of call {g} enters {names[r]} with {seen} instead of {said:.6g}")
        for i, (seen_node, node) in enumerate(zip(reading.nodes or (), self.nodes, strict=False)):
            if abs(seen_node - node) > rounding.of(1 + abs(node)):
                found.append(f"call {i} is made at t + {seen_node:.6g} h instead of t + {node:.6g} h")
        return found

    def time_slope_differs(self, reading: RosenbrockReading) -> bool:
        """True if df/dt enters with other weights, beyond rounding and the error of its differences."""
        if reading.time_slope is None:
            return False
        rounding = self._rounding(reading)
        levels = zip(reading.time_slope, self.time_slope, self.time_sizes, strict=True)
        return any(
            abs(x - float(z)) > rounding.of(float(size)) + reading.slack
            for seen, said, sizes in levels
            for x, z, size in zip(seen, said[:, 0], sizes[:, 0], strict=True)
        )


def _floats(method: Rosenbrock) -> tuple[Array, Array, Array]:
    """The coefficients without the last stages that only an error estimate uses, whose calls no step shows."""
    used = max((i for i, x in enumerate(method.b, 1) if x), default=1)
    alpha, gamma, b = (np.array(rows, dtype=float) for rows in (method.alpha, method.gamma, method.b))
    return alpha[:used, :used], gamma[:used, :used], b[:used]


def _conjugate(x: Exact) -> Exact:
    """The number with -sqrt(n) in place of sqrt(n)."""
    if isinstance(x, Algebraic) and x.field.degree == 2 and not x.field.minimal[1]:
        return Algebraic(x.field, [c * (-1) ** i for i, c in enumerate(x.coefficients)])
    return x


def _other_root(method: Rosenbrock) -> Rosenbrock:
    """The method with the other root of a quadratic equation for gamma, with which all conditions of order hold too."""
    changed = ([[_conjugate(x) for x in row] for row in rows] for rows in (method.alpha, method.gamma, [method.b]))
    alpha, gamma, (b,) = (tuple(map(tuple, rows)) for rows in changed)
    return replace(method, alpha=alpha, gamma=gamma, b=b)


def _roots(method: Rosenbrock) -> list[Rosenbrock]:
    """The methods that go by the name of one: with either root of its equation, or it alone."""
    return [method, *[_other_root(method)] * (method.key in _EITHER_ROOT)]


def _shown(reading: RosenbrockReading, numbers: Iterable[float]) -> str:
    """Entries that are computed from the reading, as text."""
    slack = Rounding(reading.format, 4 * reading.calls).of(4.0)
    return ", ".join(coefficient_text(float(x), reading.format, slack) for x in numbers)


@dataclass(frozen=True)
class RosenbrockIdentity(WithEstimate):
    """The products of a step, the method that has them, and the orders measured with f' and with half of it as J.

    `method` is of the catalogue, or the one asked for, or None if none has them, with its entries in floats, since an
    isolated process sends plain numbers; `told` says its orders, and `root` which of two roots its gamma is, in words.
    """

    reading: RosenbrockReading
    method: Rosenbrock | None
    told: str
    root: str
    measured: MeasuredOrder
    w_order: int | None
    walked: StepFinding | None = None
    estimate: StepFinding | None = None

    @property
    def order(self) -> int | None:
        """The order measured with J = f'."""
        return self.measured.order

    @property
    def faults(self) -> list[str]:
        """The faults, whatever method it is meant to be."""
        return [*self._of_derivatives, *self.of_estimate(False)]

    @property
    def _of_derivatives(self) -> list[str]:
        reading, found, order = self.reading, list[str](), self.order
        left_out = not reading.by
        claimed = 0 if self.method is None or reading.nodes is None else self.method.claimed_order
        slow = f"order {order} is observed where f depends on t, not {claimed}"
        slow = slow if order is not None and order < claimed else ""
        if slow and left_out:
            found.append(f"df/dt is left out: {slow}")
        if self.method and _Products.of(self.method, len(reading.weights)).time_slope_differs(reading):
            found.append("df/dt enters with other weights than the row sums of gamma")
        at, place = reading.jacobian_at
        if at or place:
            found.append(f"the Jacobian is evaluated at t + {at:.6g} h, and {place:.3g} from y, not at the start")
        return found or [*filter(None, [slow])]

    @property
    def named(self) -> bool:
        """True if the verdict names a method."""
        return self.method is not None

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        name = f"{self.method.key}{self.root}" if self.method is not None else "not a known Rosenbrock method"
        measured = f", of order {self.order} as measured" if self.method is None and self.order is not None else ""
        powers = len(self.reading.weights)
        partly = self.method is not None and powers < self.method.stages
        told = f", judging by {powers} components," if partly else ""
        return "; ".join([f"it is{told} {name}{measured}", *self.faults, *self.of_estimate(None)])

    @property
    def key(self) -> str | None:
        """The catalogue key of the method, if it has no fault; else None."""
        return self.method.key if self.method is not None and not self.faults else None

    @property
    def parts(self) -> list[tuple[str, list[str]]]:
        """The evidence: titles with lines."""
        estimate = (ESTIMATE, self.of_estimate(True, False, None))
        return [("Coefficients", self._coefficients), ("Order", self._orders), estimate]

    @property
    def _coefficients(self) -> list[str]:
        reading, powers = self.reading, len(self.reading.weights)
        named = "no Rosenbrock method of the catalogue"
        if self.method is not None:
            named = f"{self.method.key}: products of alpha and b with gamma up to its power {powers - 1}, to rounding"
        used = {"a function": "a function of its own", "differences": "differences of f"}.get(reading.by, "")
        clock = "f receives no time" if reading.nodes is None else f"df/dt is from {used}" if used else "no df/dt"
        return [named, *self._table, clock]

    @property
    def _table(self) -> list[str]:
        if self.method is not None or self.reading.table is None:
            return []
        alpha, gamma, b = self.reading.table
        rows = [(f"alpha[{i}]", alpha[i, :i]) for i in range(1, len(alpha))]
        rows += [*((f"gamma[{i}]", gamma[i, : i + 1]) for i in range(len(gamma))), ("b", b)]
        return [f"{name} = {_shown(self.reading, row)}" for name, row in rows]

    @property
    def _orders(self) -> list[str]:
        lines = [self.told] if self.told else []
        for order, with_what in ((self.order, "J = f'"), (self.w_order, "half of f' as J")):
            lines.append(f"{order_seen(order)} with {with_what} on {self.measured.problem}")
        lines[-2] += f" (slopes of the local error: {slopes_text(self.measured.slopes)})"
        return lines

    @property
    def data(self) -> dict[str, Json]:
        """The products and the orders for programs."""
        return {
            "method": self.key,
            "products": [[[repr(x) for x in row] for row in level] for level in self.reading.weights],
            "time_slope": self.reading.by or None,
            "measured_order": self.order,
            "measured_w_order": self.w_order,
            "remarks": self.of_estimate(None),
        }

    def criteria(self, method: Rosenbrock) -> list[Criterion]:
        """The criteria of a method: the products, the use of df/dt and of the Jacobian, the order, steps elsewhere."""
        (products, differences), *others = (
            (each, each.differences(self.reading))
            for each in (_Products.of(root, len(self.reading.weights)) for root in _roots(method))
        )
        differences = [] if any(other == [] for _, other in others) else differences
        if differences is None:
            asked = f"{method.key} evaluates f at {len(products.nodes)} places, this one at {self.reading.calls}"
            return [Criterion("Coefficients", False, (asked,), {})]
        same = not differences
        shown = self._coefficients if same else [f"not those of {method.key}", *differences[: walks.DIFFERENCES_SHOWN]]
        whole = len(self.reading.weights) >= method.stages  # by Cayley and Hamilton, higher powers tell no more
        told = "" if whole else f"a stepper of {method.stages} components, as many as there are stages"
        passed = same if whole or not same else None
        checks = [Criterion("Coefficients", passed, tuple(shown), {"differences": list(differences)}, told)]
        faults = self._of_derivatives if same else []
        seen = tuple(faults or ["J at the start", self._coefficients[-1]])
        checks.append(Criterion("Derivatives", not faults, seen, {}))
        reached = None if self.order is None else self.order >= method.claimed_order
        checks.append(Criterion("Order", reached, tuple(self._orders), {"measured": self.order}))
        if same and not faults and self.walked is not None:
            checks.append(Criterion("Steps", self.walked.holds, (self.walked.words,), {}))
        return [*checks, *(self.criteria_of_estimate if same else [])]


def read_rosenbrock(subject: ForeignStepper, asked: Rosenbrock | None = None) -> RosenbrockIdentity:
    """Identify a step with a Jacobian. Raises NotReadable, UnsupportedCall, or the stepper's Misbehaviour."""
    reading = read_rosenbrock_step(subject)
    known = [*(m for m in FURTHER_METHODS.values() if isinstance(m, Rosenbrock)), *([asked] if asked else [])]
    known = [root for each in known for root in _roots(each)]
    found = next((m for m in known if _Products.of(m, len(reading.weights)).differences(reading) == []), None)
    measured, with_half = (
        walks.measured_of_two(subject, kind, _HALVINGS, walks.DIFFERENCES * reading.slack)
        for kind in (walks.WithJacobian, walks.WithHalfJacobian)
    )
    walked = None
    root = ""
    if found and found not in FURTHER_METHODS.values() and found != asked:
        root = f" with gamma[0][0] = {exact_shown(found.gamma[0][0])}, the other root of its equation"
    if method := found if root else asked or found:
        walked = there_and_back(walks.RosenbrockWalker(subject, Specification(method), reading.slack, not reading.by))
    told, plain = "", None
    if found:
        facts, digits = RosenbrockFacts(found), ", to the precision of its decimals" * found.decimal
        orders = facts.orders_within(walks.NO_RESIDUAL) if found.decimal else facts
        told = f"order {orders.order} with J = f', {orders.w_order} with any matrix{digits}"
        alpha, gamma, b = (tuple(tuple(map(Fraction, row)) for row in np.atleast_2d(part)) for part in _floats(found))
        plain = replace(found, alpha=alpha, gamma=gamma, b=b[0], b_embedded=None, embedded_order=None)
    estimate = _judged_estimate(subject, found or asked)
    return RosenbrockIdentity(reading, plain, told, root, measured, with_half.order, walked, estimate)


def _judged_estimate(subject: ForeignStepper, method: Rosenbrock | None) -> StepFinding | None:
    """Judge what is returned besides y1 by the products of the embedded row, which may use further stages."""
    if method is None or method.b_embedded is None:
        return judged_second(subject, walks.alone(subject), method.key if method else "")

    def differing(reading: RosenbrockReading, factor: Fraction | None) -> list[str] | None:
        rows = method.b, method.b_embedded or ()
        pairs = tuple(Fraction(abs(float(x)) + abs(float(z))) for x, z in zip(*rows, strict=True))  # as y1 and y1_hat
        products, terms = (
            _Products.of(replace(method, b=row), len(reading.weights)) for row in (embedded_row(*rows, factor), pairs)
        )
        used = range(len(products.nodes))
        kept = np.ix_([*used, -1], used)
        products.sizes = [x + z[kept] for x, z in zip(products.sizes, terms.sizes, strict=True)]
        wrong = products.differences(reading)
        late = ["df/dt enters with other weights"] * products.time_slope_differs(reading)
        return wrong if wrong is None else [line.replace("the result", "the estimate") for line in wrong + late]

    return judged_second(subject, walks.alone(subject), method.key, read_rosenbrock_step, differing)
