"""Orders measured: on power series in h exactly, and by the program at two small steps. No tree is used.

On series, steps are written out here from the definitions, for fields that no stepper takes, and implicit stages are
iterated, which gains a power of h a pass. Over Q where the coefficients are rational; else in balls, where a
coefficient either excludes zero or is known to be below 2**-64.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction as Q
from typing import Any, TypeAlias

from flint import arb, arb_mat, arb_poly, ctx, fmpq, fmpq_poly

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import Step, stepper
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import enclose

Series: TypeAlias = Any
Vector: TypeAlias = tuple[Series, Series]
Field: TypeAlias = Callable[[Vector], Vector]
Rows: TypeAlias = Sequence[Sequence[Any]]

BITS = 600


@dataclass(frozen=True)
class Truncated:
    """Power series up to h**(length - 1), over Q or in balls: `poly` is FLINT's type, `lift` makes its coefficients."""

    poly: Any
    lift: Callable[[Exact], Any]
    length: int

    def cut(self, p: Series) -> Series:
        return p.truncate(self.length)

    def product(self, p: Series, q: Series) -> Series:
        return self.cut(p * q)

    def reciprocal(self, p: Series) -> Series:
        """1/p, by Newton's iteration, each pass right to twice as many terms."""
        q = self.poly([1 / p[0]])
        for _ in range(self.length.bit_length()):
            q = self.product(q, 2 - self.product(p, q))
        return q

    @property
    def start(self) -> Vector:
        return self.poly([self.lift(Q(1, 3))]), self.poly([self.lift(Q(-1, 2))])

    def general(self, y: Vector) -> Vector:
        """A vector field all of whose derivatives are there, and no two alike."""
        u, v = y
        uv = self.product(u, v)
        first = self.reciprocal(2 - u + uv) + v
        return first, self.product(u, u) - 2 * self.product(v, uv) + self.reciprocal(1 + u + v)

    def separable(self, y: Vector) -> Vector:
        """q' = f(v), v' = g(q)."""
        q, v = y
        cube = self.product(q, self.product(q, q))
        return self.reciprocal(1 - v + self.product(v, v)), self.reciprocal(2 + q) - cube

    def second_order(self, y: Vector) -> Vector:
        """q' = v, v' = F(q)."""
        return y[1], self.separable(y)[1]

    def solution(self, field: Field) -> Vector:
        """Picard's iteration, each pass right to one term more."""
        y = self.start
        for _ in range(self.length):
            u, v = (self.cut(a + f.integral()) for a, f in zip(self.start, field(y), strict=True))
            y = u, v
        return y

    def combined(self, weights: Sequence[Any], slopes: Sequence[Vector], i: int) -> Series:
        """h Σ wₖ kₖ, its component i."""
        total = sum((w * k[i] for w, k in zip(weights, slopes, strict=True) if w != 0), self.poly([]))
        return self.cut(total.left_shift(1))

    def runge_kutta_step(self, a: Rows, b: Sequence[Any], field: Field, explicit: bool) -> Vector:
        """Stages in their order, each from the newest slopes: one pass if explicit, else one for each power of h."""
        (q, v), slopes = self.start, [field(self.start)] * len(b)
        for _ in range(1 if explicit else self.length):
            for i, row in enumerate(a):
                slopes[i] = field((q + self.combined(row, slopes, 0), v + self.combined(row, slopes, 1)))
        return q + self.combined(b, slopes, 0), v + self.combined(b, slopes, 1)

    def splitting_step(self, parts: Sequence[tuple[str, Any]], field: Field) -> Vector:
        q, v = self.start
        for kind, c in parts:
            if kind == "kick":
                v = v + self.combined([c], [field((q, v))], 1)
            else:
                q = q + self.combined([c], [field((q, v))], 0)
        return q, v

    def nystrom_step(self, method: Nystrom) -> Vector:
        (q, v), forces = self.start, list[Series]()
        drift, nothing = self.cut(v.left_shift(1)), self.poly([])
        for c, row in zip(method.c, method.a, strict=True):
            inner = sum((self.lift(x) * k for x, k in zip(row, forces, strict=False)), nothing)
            forces.append(self.second_order((q + self.lift(c) * drift + self.cut(inner.left_shift(2)), v))[1])
        in_q, in_v = (
            sum((self.lift(x) * k for x, k in zip(row, forces, strict=True)), nothing)
            for row in (method.b_position, method.b_velocity)
        )
        return self.cut(q + drift + in_q.left_shift(2)), self.cut(v + in_v.left_shift(1))


def numbers_for(method: Method, length: int) -> Truncated:
    if method.field is None and not isinstance(method, Collocation):
        return Truncated(fmpq_poly, _rational, length)
    return Truncated(arb_poly, enclose, length)


def step_on_series(method: Method, numbers: Truncated, field: Field) -> Vector:
    """One step from the start, in the method's own definition."""
    if isinstance(method, Nystrom):
        return numbers.nystrom_step(method)
    if isinstance(method, Splitting):
        return numbers.splitting_step([(kind, numbers.lift(c)) for kind, c in method.parts], field)
    a, b = tableau_in_balls(method) if isinstance(method, Collocation) else _lifted(method, numbers.lift)
    return numbers.runge_kutta_step(a, b, field, method.explicit)


def program_is_its_definition(run: Method, defined: Method) -> bool:
    """The program of `run` on q'' = F(q), run on series, gives what `defined` means, for as long as its order shows."""
    with ctx.workprec(BITS):
        numbers = numbers_for(defined, defined.claimed_order + 3)
        q, v = numbers.start
        force = lambda q: numbers.second_order((numbers.cut(q), q))[1]
        found = stepper(run, numbers.lift)(force, q, v, numbers.poly([0, 1]))
        pairs = zip(found, step_on_series(defined, numbers, numbers.second_order), strict=True)
        return all(_vanishes(numbers.cut(x - y)[k]) for x, y in pairs for k in range(numbers.length))


def differences(method: Method, problem: str, length: int) -> list[Any]:
    """The larger difference of step and solution for each power of h, on the problem that `Truncated` has by name."""
    with ctx.workprec(BITS):
        numbers = numbers_for(method, length)
        field: Field = getattr(numbers, problem)
        pairs = list(zip(step_on_series(method, numbers, field), numbers.solution(field), strict=True))
        return [max((abs(x[k] - y[k]) for x, y in pairs), key=_size) for k in range(length)]


def order_on_series(differences_: Sequence[Any]) -> int:
    """The power of h up to which step and solution agree."""
    return next(k for k, x in enumerate(differences_) if not _vanishes(x)) - 1


def tableau_in_balls(method: Collocation) -> tuple[Rows, Sequence[arb]]:
    """A and b at the nodes themselves: Σⱼ aᵢⱼ cⱼᵏ = cᵢᵏ⁺¹/(k + 1), Σⱼ bⱼ cⱼᵏ = 1/(k + 1) for k below s."""
    roots = fmpq_poly([_rational(x) for x in method.node_polynomial]).complex_roots()
    nodes = [root.real for root, _ in roots]
    powers = arb_mat([[c**k for c in nodes] for k in range(len(nodes))])
    ends = arb_mat([[c ** (k + 1) / (k + 1) for c in (*nodes, arb(1))] for k in range(len(nodes))])
    *a, b = powers.solve(ends).transpose().tolist()
    return a, b


def _lifted(method: RungeKutta, lift: Callable[[Exact], Any]) -> tuple[Rows, Sequence[Any]]:
    return [[lift(x) for x in row] for row in method.a], [lift(x) for x in method.b]


def _rational(x: Exact) -> fmpq:
    assert isinstance(x, Q)
    return fmpq(x.numerator, x.denominator)


def _size(x: Any) -> Any:
    return x.upper() if isinstance(x, arb) else x


def _vanishes(x: Any) -> bool:
    if not isinstance(x, arb):
        return bool(x == 0)
    assert x.rad() < arb(2) ** -64
    return x.contains(0)


# --- two small steps in balls, on q'' = 2q³, which q = 1/(1 - t) solves -----------------------------------------------

SMALL = fmpq(1, 2**110)


def local_error(step: Step, h: arb) -> arb:
    """The larger of the errors of q and v after one step from (1, 1)."""
    q, v = step(lambda q: 2 * q**3, arb(1), arb(1), h)
    return abs(q - 1 / (1 - h)).max(abs(v - 1 / (1 - h) ** 2))


def order_in_balls(method: Method) -> int:
    """The order of its steps agree with the method's own on this problem; a coefficient off by 10⁻¹⁴ makes it 0.

    error(h)/error(h/2) = 2ᵖ⁺¹ (1 + O(h)): with h = 2⁻¹¹⁰ its logarithm is an integer to fifteen digits, and certain.
    """
    with ctx.workprec(2000):
        step, h = stepper(method, enclose), arb(SMALL)
        measured = (local_error(step, h) / local_error(step, h / 2)).log() / arb.const_log2()
        order = round(float(measured.mid())) - 1
        assert abs(measured - (order + 1)) < arb(2) ** -50
        return order
