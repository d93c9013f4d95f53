"""Solutions enclosed in balls by Taylor series with Lagrange's remainder.

y(t + h) is in Σ yₖ(t) hᵏ, k < K, plus y_K(B) hᴷ, where the box B holds the solution on the whole step: it does if
y(t) + [0, h] f([t, t + h], B) lies in B (Picard). Balls grow by exp(∫ ‖f'‖) at most, stiff or not, which bits pay for.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from fractions import Fraction

from flint import arb

from driftproof.methods.vector_fields import VectorField
from tests.witnesses.references.closed_forms import ball

Series = list[arb]


class NoEnclosure(ArithmeticError):
    """The step is too large for the box, or the balls have grown too large."""


class Taylor:
    """The flow of one field at Arb's current precision, by series of `order` terms."""

    def __init__(self, field: VectorField, order: int) -> None:
        self.field, self.order = field, order
        self.parsed = [ast.parse(rate, mode="eval").body for rate in field.rates]

    def flow(self, y: Sequence[arb], t: Fraction, end: Fraction, steps: int) -> list[arb]:
        """y(end) from y(t), both in balls, by equal steps. Raises NoEnclosure."""
        h, state = (end - t) / steps, list(y)
        for i in range(steps):
            state = self.step(state, t + i * h, h)
        return state

    def step(self, y: list[arb], t: Fraction, h: Fraction) -> list[arb]:
        """y(t + h). Raises NoEnclosure."""
        size = ball(h)
        inner = self.series(ball(t), y, self.order)
        outer = self.series(ball(t).union(ball(t + h)), self._box(y, t, h), self.order + 1)
        power, total = arb(1), [arb(0)] * len(y)
        for k in range(self.order):
            total = [a + s[k] * power for a, s in zip(total, inner, strict=True)]
            power *= size
        return [a + s[self.order] * power for a, s in zip(total, outer, strict=True)]

    def _box(self, y: list[arb], t: Fraction, h: Fraction) -> list[arb]:
        time, way = ball(t).union(ball(t + h)), arb(0).union(ball(h))
        box = y
        for _ in range(30):
            slopes = [s[1] for s in self.series(time, box, 2)]
            moved = [a + way * f for a, f in zip(y, slopes, strict=True)]
            if not all(a.is_finite() for a in moved):
                break
            if all(b.contains(a) for a, b in zip(moved, box, strict=True)):
                return box
            box = [a + (a - b).abs_upper() * arb(0, 0.1) for a, b in zip(moved, y, strict=True)]
        raise NoEnclosure(f"no box holds the solution from t = {t} to {t + h}")

    def series(self, t: arb, y: Sequence[arb], terms: int) -> list[Series]:
        """The first coefficients of the solution through (t, y), one list a component."""
        solution = [[x] for x in y]
        names: dict[str, Series] = {f"y{i}": s for i, s in enumerate(solution)}
        names |= {name: [ball(value)] for name, value in self.field.parameters}
        names["t"] = [t, arb(1)]
        graph = _Graph(names)
        rates = [graph.node(rate) for rate in self.parsed]
        for k in range(terms - 1):
            graph.extend(k)
            for s, rate in zip(solution, rates, strict=True):
                s.append(_at(rate, k) / (k + 1))
        return solution


class _Graph:
    """The operations of the rates, each a series that grows by one coefficient at a time."""

    def __init__(self, names: dict[str, Series]) -> None:
        self.names, self.nodes = names, dict[str, Series]()
        self.rules: list[tuple[str, list[Series], list[Series]]] = []

    def node(self, x: ast.expr) -> Series:
        """The series of an expression; equal expressions share one."""
        if isinstance(x, ast.Name):
            return self.names[x.id]
        key = ast.dump(x)
        if key not in self.nodes:
            self.nodes[key] = self._new(x)
        return self.nodes[key]

    def _new(self, x: ast.expr) -> Series:
        if isinstance(x, ast.Constant):
            return [arb(x.value)]
        if isinstance(x, ast.UnaryOp):
            return self._rule("Neg", [self.node(x.operand)], 1)[0]
        if isinstance(x, ast.BinOp):
            return self._rule(type(x.op).__name__, [self.node(x.left), self.node(x.right)], 1)[0]
        assert isinstance(x, ast.Call)
        assert isinstance(x.func, ast.Name)
        name = x.func.id
        if name in ("sin", "cos"):
            pair = self._rule("sin and cos", [self.node(x.args[0])], 2)
            return pair[name == "cos"]
        return self._rule(name, [self.node(x.args[0])], 1)[0]

    def _rule(self, name: str, inputs: list[Series], outputs: int) -> list[Series]:
        made: list[Series] = [[] for _ in range(outputs)]
        self.rules.append((name, inputs, made))
        return made

    def extend(self, k: int) -> None:
        """Coefficient k of every operation, in the order of their inputs."""
        for name, inputs, outputs in self.rules:
            new = _RULES[name](k, *inputs, *outputs)
            for series, x in zip(outputs, new if isinstance(new, tuple) else (new,), strict=True):
                series.append(x)


def _at(a: Series, k: int) -> arb:
    """A series that has ended goes on with zeros: constants, and t."""
    return a[k] if k < len(a) else arb(0)


def _product(a: Series, b: Series, k: int, first: int = 0, last: int = 0) -> arb:
    """Σ aᵢ bₖ₋ᵢ for i = first, ..., k - last."""
    low, high = max(first, k - len(b) + 1), min(k - last, len(a) - 1)
    return sum((a[i] * b[k - i] for i in range(low, high + 1)), arb(0))


def _weighted(a: Series, b: Series, k: int, last: int = 0) -> arb:
    """Σ i aᵢ bₖ₋ᵢ / k for i = 1, ..., k - last."""
    low, high = max(1, k - len(b) + 1), min(k - last, len(a) - 1)
    return sum((i * a[i] * b[k - i] for i in range(low, high + 1)), arb(0)) / k


def _sine_and_cosine(k: int, a: Series, s: Series, c: Series) -> tuple[arb, arb]:
    return (a[0].sin(), a[0].cos()) if k == 0 else (_weighted(a, c, k), -_weighted(a, s, k))


def _root(k: int, a: Series, r: Series) -> arb:
    return a[0].sqrt() if k == 0 else (_at(a, k) - _product(r, r, k, 1, 1)) / (2 * r[0])


# griewank-walther-2008, table 13.1 and 13.2
_RULES = {
    "Neg": lambda k, a, _: -_at(a, k),
    "Add": lambda k, a, b, _: _at(a, k) + _at(b, k),
    "Sub": lambda k, a, b, _: _at(a, k) - _at(b, k),
    "Mult": lambda k, a, b, _: _product(a, b, k),
    "Div": lambda k, a, b, q: (_at(a, k) - _product(b, q, k, 1)) / b[0],
    "sqrt": _root,
    "exp": lambda k, a, e: a[0].exp() if k == 0 else _weighted(a, e, k),
    "log": lambda k, a, b: a[0].log() if k == 0 else (_at(a, k) - _weighted(b, a, k, 1)) / a[0],
    "sin and cos": _sine_and_cosine,
}
