"""The search for the map behind a reading: candidates tried in floats, then certified by balls against their bounds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import exp, log, nan, sqrt

from driftproof.blackbox.linear import relatives
from driftproof.blackbox.linear.arithmetics import FLOATS
from driftproof.blackbox.linear.classes import Rates, all_matrices, method_classes
from driftproof.blackbox.linear.parts import CONSTANT, DAMPINGS, Model, damping_rate
from driftproof.blackbox.linear.reading import LINEARITY_ROUNDINGS, Floats, Reading, growing
from driftproof.blackbox.probes.simple_rationals import simple_rational

# The roundings, at most, in a rate read at a tiny step: there the slopes of all stages are equal, and only summed.
RATE_ROUNDINGS = 1 << 8
# Where candidates are tried in floats, in units of the reading's own time: exact steps.
TRIED, TRIED_LAST = (0.25, 0.5), 1.0
SECANT_STEPS = 12
# A d**h with a damping beyond this has no d that anybody would write.
MOST_DAMPED = 64


@dataclass(frozen=True)
class Fit:
    """A model with the rates that fit best: q' = a v, v' = -k q, and its damping, a rate or a factor.

    `kept` is exp(-damping), what is kept of v in a unit of time, where that is a simple rational and the rate is not.
    """

    model: Model
    position: Fraction
    stiffness: Fraction
    damping: Fraction
    kept: Fraction | None = None


class Search:
    """The models that fit a reading, to half the digits.

    `exact_rates` are the rates read, a and k, as simple rationals where they are some; those of a model are these
    divided by its own.
    """

    def __init__(self, reading: Reading) -> None:
        """Take the rates from the tiny step. Raises ValueError for a reading without one."""
        if reading.at_zero is None:
            raise ValueError("the reading has no tiny step, so no rates")
        self.reading = reading
        in_position, in_velocity = growing(reading.at_zero)
        self.unit, self.u = reading.unit, float(reading.format.u)
        self.coefficient_error = RATE_ROUNDINGS * self.u
        self.slack = max(self.coefficient_error, 8 * (reading.tiny / reading.unit) ** 2)
        self.exact_rates = self._simple(in_position / reading.tiny), self._simple(-in_velocity / reading.tiny)
        self.position, self.stiffness = map(float, self.exact_rates)
        self.tried = sorted((h, m) for h, m in reading.steps if h / reading.unit in TRIED)
        self.last = [(h, m) for h, m in reading.steps if h / reading.unit == TRIED_LAST]
        self.closeness = sqrt(self.u)

    def may_have(self, *, damping: bool) -> bool:
        """Without damping M_qq and M_vv are even in h, and 1 at h = 0. Where no step went back, both may be."""
        at_zero, steps = self.reading.at_zero, dict(self.reading.steps)
        back = [(m, steps[-h]) for h, m in self.tried if -h in steps]
        at_rest = [(at_zero, (1.0, 0.0, 0.0, 1.0))] if at_zero else []
        damped = any(
            abs(x[i] - y[i]) > LINEARITY_ROUNDINGS * self.u * (1 + abs(x[i])) for x, y in back + at_rest for i in (0, 3)
        )
        return damped == damping or not (damped or back)

    def classes(self) -> list[Fit]:
        """The exact solution, and the methods of the catalogue that fit."""
        near = [True] * len(method_classes())
        for h, m in self.tried:
            found = all_matrices(h, self.position, self.stiffness).tolist()
            near = [was and self._near(x, m) for was, x in zip(near, found, strict=True)]
        fits = [model for model, is_near in zip(relatives.whole_methods(), near, strict=True) if is_near]
        return [self.exact(model, 0.0) for model in (relatives.EXACT, *fits)]

    def undamped(self, models: Iterable[Model]) -> Iterator[Fit]:
        """Those of the models without damping that fit."""
        return (self.exact(model, 0.0) for model in models if self._fits(model, 0.0))

    def with_part_left_out(self) -> Iterator[Fit]:
        """The splittings without a part that fit, the rates being those of the whole method."""
        return self.undamped(model for model in relatives.parts_left_out() if self._whole_rates(model, 0.0))

    def frozen(self, *, damped: bool) -> Iterator[Fit]:
        """The map with one force for the whole step that fits, if one does: its β is read off M_qq."""
        h, (qq, _, _, vv) = self.tried[-1]
        s = self.position * self.stiffness * h * h
        error = 8 * self.u
        beta = simple_rational((1 - qq) / s, error / abs(s) + self.slack) if s else None
        if beta in (None, 0, 1):  # no such map, or one of the two Euler methods
            return
        damping = (1 - vv) / h if damped else 0.0
        model = relatives.frozen_force(beta, damped=damped)
        if damped == (abs(damping * h) > error) and self._fits(model, damping):
            yield self.exact(model, damping)

    def with_drag(self, models: Iterable[Model]) -> Iterator[Fit]:
        """Those of the models with drag in the force that fit, the drag being such that the determinant is right."""
        for model in models:
            drag = self._drag(model)
            if abs(drag * self.unit) > self.closeness and self._fits(model, drag):
                yield self.exact(model, drag)

    def with_velocity_damped(self) -> Iterator[Fit]:
        """The models that multiply the velocity by a factor that fit; the factor is a quotient of determinants."""
        own = [all_matrices(h, self.position, self.stiffness).tolist() for h, _ in self.tried]
        for each, *matrices in zip(method_classes(), *own, strict=True):
            determinants = [_determinant(m) for m in matrices]
            for form in DAMPINGS:
                for pieces, models in ((1, relatives.with_velocity_damped), (2, relatives.with_velocity_damped_twice)):
                    rate = self._factor_rate(form, determinants, pieces)
                    if rate == rate:
                        yield from self._damped(models(each, form), rate)

    def _damped(self, models: Iterable[Model], rate: float) -> Iterator[Fit]:
        for model in models:
            right = self._whole_rates(model, rate) if model.keeps_damping_per_step else True
            if right and self._fits(model, rate):
                yield self.exact(model, rate)

    def exact(self, model: Model, damping: float) -> Fit:
        """The fit with rates that are simple rationals, where such are near; else the floats read."""
        position, stiffness = (self._simple(x) for x in self._rates(model, damping))
        error = self.coefficient_error / self.tried[-1][0]
        rate = simple_rational(damping, error)
        if rate is not None:
            return Fit(model, position, stiffness, rate)
        left = exp(-damping) if abs(damping) <= MOST_DAMPED else 0.0
        return Fit(model, position, stiffness, Fraction(damping), simple_rational(left, error * left) if left else None)

    def _simple(self, x: float) -> Fraction:
        found = simple_rational(x, abs(x) * self.slack)
        return Fraction(x) if found is None else found

    def _factor_rate(self, form: str, own: list[float], pieces: int) -> float:
        """The rate of `pieces` equal factors, for a map with determinants `own` without them; NaN where none fits."""
        found = []
        for (h, m), determinant in zip(self.tried, own, strict=True):
            try:
                factor = _determinant(m) / determinant
                found.append(damping_rate(form, factor if pieces == 1 else sqrt(factor), h / pieces))
            except (ArithmeticError, ValueError):
                return nan
        none = 1.0 if form == CONSTANT else 0.0
        if abs(found[0] - found[-1]) * self.unit > self.closeness or abs(found[-1] - none) * self.unit < self.closeness:
            return nan
        return found[-1]

    def _drag(self, model: Model) -> float:
        """The drag with which the determinant is right at the largest step tried, by the secant method; NaN if none.

        On its logarithm, which is the straighter curve, unless it is negative.
        """
        h, m = self.tried[-1]
        goal = _determinant(m)
        curve = log if goal > 0 else float
        before, x = 0.0, (1 - goal) / h
        try:
            aim = curve(goal)
            y_before, y = (curve(_determinant(self._floats(model, h, g))) - aim for g in (before, x))
            for _ in range(SECANT_STEPS):
                if y == y_before or abs(x - before) <= 4 * self.u * abs(x):
                    break
                before, x, y_before = x, x - y * (x - before) / (y - y_before), y
                y = curve(_determinant(self._floats(model, h, x))) - aim
        except (ArithmeticError, ValueError):
            return nan
        return x

    def _rates(self, model: Model, damping: float) -> tuple[float, float]:
        """a and k such that the model has the rates read. Raises ZeroDivisionError."""
        position, stiffness = model.own_rates(damping)
        return self.position / position, self.stiffness / stiffness

    def _whole_rates(self, model: Model, damping: float) -> bool:
        """True when the rates read are the model's own, so that a = k = 1."""
        own = model.own_rates(damping)
        return bool(model.parts) and all(
            abs(x - y) <= self.slack * abs(y) for x, y in zip((self.position, self.stiffness), own, strict=True)
        )

    def _floats(self, model: Model, h: float, damping: float) -> Floats:
        position, stiffness = self._rates(model, damping)
        qq, qv, vq, vv = model.matrix(FLOATS, Rates(h, position, stiffness, damping))
        return qq, qv, vq, vv

    def _fits(self, model: Model, damping: float) -> bool:
        """True when the model is near the reading at the steps tried, half of all digits first, then most."""
        most = LINEARITY_ROUNDINGS * self.u
        try:
            return all(self._near(self._floats(model, h, damping), m) for h, m in self.tried) and all(
                self._near(self._floats(model, h, damping), m, most) for h, m in self.last
            )
        except ArithmeticError:
            return False

    def _near(self, found: Sequence[float], read: Floats, closeness: float | None = None) -> bool:
        most = self.closeness if closeness is None else closeness
        return all(abs(x - y) <= most * (1 + abs(y)) for x, y in zip(found, read, strict=True))


def _determinant(m: Sequence[float]) -> float:
    return m[0] * m[3] - m[1] * m[2]
