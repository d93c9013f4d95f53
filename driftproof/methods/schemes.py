"""RungeKutta, Splitting, Nystrom and Collocation: one-step methods as frozen, exact, validated data."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import lcm, prod
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction, dyadic
from driftproof.methods.numbers.number_field import Algebraic, Exact, NumberField, real_root_balls, total

if TYPE_CHECKING:
    from flint import arb

SUBSTEPS = ("kick", "drift")
# A residual below this is one of rounding. Chosen: those of coefficients of six digits are.
TINY = Fraction(1, 10**5)


class MethodError(ValueError):
    """A definition that is not a method: wrong shape, an inexact coefficient, an unknown sub-step."""


@dataclass(frozen=True)
class Definition:
    """The key and title of a method, its source, and the order that the source claims, 0 if it claims none."""

    key: str
    title: str
    claimed_order: int
    source: str


@dataclass(frozen=True)
class _OverOneField(Definition):
    """A method whose coefficients, which `coefficients` lists, are exact and lie in one number field."""

    @cached_property
    def field(self) -> NumberField | None:
        """The number field of the coefficients; None if all are rational."""
        return next((x.field for x in self.coefficients() if isinstance(x, Algebraic)), None)

    def coefficients(self) -> Iterable[Exact]:
        """All coefficients."""
        raise NotImplementedError

    def _require_one_field(self) -> None:
        for x in self.coefficients():
            if isinstance(x, Algebraic) and self.field and x.field != self.field:
                names = f"{x.field.name} and {self.field.name}"
                raise MethodError(f"{self.key}: coefficients lie in the fields of {names}; write them in one field")


class Staged(_OverOneField):
    """A method with square matrices and rows of coefficients, all with an entry for each stage.

    The length of `leading_row` is the number of stages. An entry n of `zero_from` demands that row i of its matrix be 0
    in the columns j >= i + n. The embedded rows are None unless the method is a pair; they come with their order.
    """

    matrices: ClassVar[tuple[str, ...]] = ("a",)
    zero_from: ClassVar[tuple[int, ...]] = ()
    rows: ClassVar[tuple[str, ...]]
    leading_row: ClassVar[str]

    def __post_init__(self) -> None:
        """Promote integers, then raise MethodError for inexact entries, wrong shapes, several fields or half a pair."""
        for name in self.matrices:
            rows = getattr(self, name)
            _require_iterable(rows, f"{self.key}: {name}")
            exact = tuple(_exact(row, f"{self.key}: {name}[{i}]") for i, row in enumerate(rows))
            object.__setattr__(self, name, exact)
        for name in self.rows:
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _exact(getattr(self, name), f"{self.key}: {name}"))
        if not self.stages:
            raise MethodError(f"{self.key}: {self.leading_row} is empty; a method has at least one stage")
        for name, length in self._lengths():
            if length != self.stages:
                entries = f"{name} has {length} entries, {self.leading_row} has {self.stages}"
                raise MethodError(f"{self.key}: {entries}; they must agree")
        self._require_one_field()
        for name, first in zip(self.matrices, self.zero_from, strict=False):
            if any(x != 0 for i, row in enumerate(getattr(self, name)) for x in row[i + first :]):
                where = "above" if first else "on or above"
                raise MethodError(f"{self.key}: {name} has a nonzero entry {where} its diagonal; order the stages")
        pair = [name for name in (*self.rows, "embedded_order") if "embedded" in name]
        if [getattr(self, name, None) for name in pair].count(None) not in (0, len(pair)):
            raise MethodError(f"{self.key}: {', '.join(pair[:-1])} and {pair[-1]} must be given together")

    @property
    def stages(self) -> int:
        """The number s of stages."""
        return len(getattr(self, self.leading_row))

    @property
    def explicit(self) -> bool:
        """True if no stage depends on itself or on a later one: the last matrix is strictly lower triangular."""
        return is_strictly_lower(getattr(self, self.matrices[-1]))

    def inconsistencies(self) -> dict[str, Exact]:
        """The nonzero residuals of Σ bᵢ = 1 for each row of weights: facts about the data, not errors."""
        weights = ((name, getattr(self, name)) for name in self.rows if name.startswith("b"))
        return nonzero_residuals({f"sum({name}) - 1": total(row) - 1 for name, row in weights if row is not None})

    def _lengths(self) -> Iterable[tuple[str, int]]:
        for name in self.matrices:
            matrix = getattr(self, name)
            yield name, len(matrix)
            yield from ((f"{name}[{i}]", len(row)) for i, row in enumerate(matrix))
        yield from ((name, len(getattr(self, name))) for name in self.rows if getattr(self, name) is not None)

    def coefficients(self) -> Iterable[Exact]:
        """Yield the entries of the matrices, then those of the rows."""
        for name in self.matrices:
            yield from (x for row in getattr(self, name) for x in row)
        for name in self.rows:
            yield from getattr(self, name) or ()


@dataclass(frozen=True)
class RungeKutta(Staged):
    """The Runge-Kutta method with tableau (A, b, c): kᵢ = F(t + cᵢh, z + h Σⱼ aᵢⱼ kⱼ), then z + h Σᵢ bᵢ kᵢ.

    `a` has s rows of s coefficients, `b` and `c` have s; integers and rational elements of a number field are promoted
    to `Fraction`. `claimed_order` is the order that the source claims, 0 if it claims none; the coefficients may have
    another. `source` is a key of `references.bib` and a place in it. `b_embedded`, of order `embedded_order`, is the
    second row of weights of a pair, of which `b` is propagated. `decimal` says that the source prints rounded numbers,
    which are taken exactly: the order conditions then hold up to residuals, which are facts about the table. A dense
    output y + h Σᵢ bᵢ(θ) kᵢ has in `dense` the polynomial of each stage in θ, constant term first. Raises MethodError
    for inexact coefficients, coefficients of two fields, and wrong shapes.

    >>> from fractions import Fraction
    >>> from driftproof import Facts, RungeKutta
    >>> b = (Fraction(1, 4), Fraction(3, 4))
    >>> mine = RungeKutta("mine", "Ralston", 2, "", a=((0, 0), (Fraction(2, 3), 0)), b=b, c=(0, Fraction(2, 3)))
    >>> Facts(mine).order
    2
    """

    rows: ClassVar[tuple[str, ...]] = ("b", "c", "b_embedded")
    leading_row: ClassVar[str] = "b"
    a: tuple[tuple[Exact, ...], ...]
    b: tuple[Exact, ...]
    c: tuple[Exact, ...]
    b_embedded: tuple[Exact, ...] | None = None
    embedded_order: int | None = None
    decimal: bool = False
    dense: tuple[tuple[Exact, ...], ...] | None = None

    def coefficients(self) -> Iterable[Exact]:
        """Yield the entries of the matrix, those of the rows, then those of the dense output."""
        yield from super().coefficients()
        yield from (x for weight in self.dense or () for x in weight)

    def embedded(self, suffix: str) -> RungeKutta:
        """The method that propagates the embedded weights of this pair; `suffix` is appended to the key."""
        assert self.b_embedded is not None
        assert self.embedded_order is not None
        method: RungeKutta = replace(
            self,
            key=f"{self.key}{suffix}",
            title=f"{self.title}, the embedded weights propagated",
            claimed_order=self.embedded_order,
            b=self.b_embedded,
            b_embedded=self.b,
            embedded_order=self.claimed_order,
            dense=None,
        )
        return method

    def inconsistencies(self) -> dict[str, Exact]:
        """The nonzero residuals of Σ bᵢ = 1 and of cᵢ = Σⱼ aᵢⱼ: facts about the data, not errors."""
        nodes = {f"c[{i}] - sum(a[{i}])": c - total(row) for i, (c, row) in enumerate(zip(self.c, self.a, strict=True))}
        return super().inconsistencies() | nonzero_residuals(nodes)


@dataclass(frozen=True)
class Splitting(_OverOneField):
    """A composition of kicks v ← v + c·h·F(q) and drifts q ← q + c·h·v, in the order given.

    `parts` has pairs such as ("kick", 1/2). Every such composition is symplectic if F is a gradient.
    `quadratic_kinetic` says that the source claims the order only for drifts that are linear in v, as they are here;
    otherwise it claims the order for every Hamiltonian T(p) + V(q). Other fields as in `RungeKutta`.
    Raises MethodError.

    >>> from driftproof import Facts, Splitting
    >>> Facts(Splitting("mine", "Kick, then drift", 1, "", (("kick", 1), ("drift", 1)))).symplectic
    True
    """

    parts: tuple[tuple[str, Exact], ...]
    quadratic_kinetic: bool = False
    decimal: bool = False
    explicit: ClassVar[bool] = True  # each kick and each drift is a formula in the values before it

    def __post_init__(self) -> None:
        """Promote integers, then raise MethodError for unknown sub-steps, inexact coefficients and several fields."""
        _require_iterable(self.parts, f"{self.key}: parts")
        parts = tuple(self.parts)
        if not parts:
            raise MethodError(f"{self.key}: parts is empty; a splitting has at least one kick or drift")
        for i, part in enumerate(parts):
            if not isinstance(part, tuple) or len(part) != 2 or part[0] not in SUBSTEPS:
                raise MethodError(f"{self.key}: parts[{i}] is {part!r}; write ('kick', c) or ('drift', c)")
        coefficients = _exact((c for _, c in parts), f"{self.key}: parts")
        kinds = (kind for kind, _ in parts)
        object.__setattr__(self, "parts", tuple(zip(kinds, coefficients, strict=True)))
        self._require_one_field()

    def coefficients(self) -> Iterable[Exact]:
        """The coefficients of the kicks and drifts, in their order."""
        return (c for _, c in self.parts)

    def inconsistencies(self) -> dict[str, Exact]:
        """The nonzero residuals of Σ kicks = 1 and Σ drifts = 1: facts about the data, not errors."""
        return nonzero_residuals(
            {f"sum({kind}s) - 1": total(c for part, c in self.parts if part == kind) - 1 for kind in SUBSTEPS}
        )


@dataclass(frozen=True)
class Nystrom(Staged):
    """kᵢ = F(q + cᵢhv + h² Σⱼ aᵢⱼ kⱼ), q₁ = q + hv + h² Σ b_positionᵢ kᵢ, v₁ = v + h Σ b_velocityᵢ kᵢ, for q'' = F(q).

    This is a Runge-Kutta-Nyström method; `a` has s rows of s coefficients, `c`, `b_position` and `b_velocity` have s.
    Its order is the smaller of the orders in q and in v. Other fields as in `RungeKutta`. Raises MethodError.
    """

    rows: ClassVar[tuple[str, ...]] = ("c", "b_position", "b_velocity")
    leading_row: ClassVar[str] = "b_velocity"
    c: tuple[Exact, ...]
    a: tuple[tuple[Exact, ...], ...]
    b_position: tuple[Exact, ...]
    b_velocity: tuple[Exact, ...]
    decimal: bool = False

    def inconsistencies(self) -> dict[str, Exact]:
        """The nonzero residuals of Σ b_velocity = 1, Σ b_position = 1/2, and of Σⱼ aᵢⱼ = cᵢ²/2 where it is tiny.

        The first two are the conditions of order 1 in v and order 2 in q. The last makes stage i accurate to order 2;
        many right methods, all explicit symplectic ones among them, do not have it: only a rounding of it is one.
        """
        residuals = {
            "sum(b_velocity) - 1": total(self.b_velocity) - 1,
            "sum(b_position) - 1/2": total(self.b_position) - Fraction(1, 2),
        }
        stages = {
            f"sum(a[{i}]) - c[{i}]**2/2": total(a) - c * c / 2
            for i, (a, c) in enumerate(zip(self.a, self.c, strict=True))
        }
        return nonzero_residuals(residuals | {name: x for name, x in stages.items() if -TINY < x < TINY})


@dataclass(frozen=True)
class Collocation(Definition):
    """The s-stage Runge-Kutta method whose nodes c₁ < ... < cₛ are the roots of `node_polynomial`, constant term first.

    z₁ = u(h), where u is the polynomial of degree s with u(0) = z and u'(cᵢh) = F(u(cᵢh)) (hairer-lubich-wanner-2006,
    II.1.2). The polynomial is given because R(z), order and stability need none of its roots. It is made monic. Raises
    MethodError unless its coefficients are rational and its roots real and distinct. Other fields as in `RungeKutta`.
    A method with these nodes but another A, such as Radau IA, is no collocation method.
    """

    node_polynomial: tuple[Fraction, ...]
    decimal: ClassVar[bool] = False
    # The collocation conditions are equations, although they are trivial for the single node 0.
    explicit: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Make the polynomial monic, or raise MethodError if it is constant, inexact, or has unsuitable roots."""
        given = rational_row(self.node_polynomial, f"{self.key}: node_polynomial")
        while given and given[-1] == 0:
            given = given[:-1]
        if len(given) < 2:
            raise MethodError(f"{self.key}: node_polynomial is constant; a method has at least one node")
        object.__setattr__(self, "node_polynomial", tuple(x / given[-1] for x in given))
        if len(self.node_balls(64)) != self.stages:
            raise MethodError(f"{self.key}: node_polynomial has a complex or a multiple root")

    @property
    def stages(self) -> int:
        """The number s of nodes."""
        return len(self.node_polynomial) - 1

    @property
    def field(self) -> NumberField | None:
        """None, because the node polynomial is rational."""
        return None

    def tableau(self, bits: int) -> tuple[list[list[Fraction]], list[Fraction], list[Fraction]]:
        """The tableau (A, b, c) with nodes to this many bits; 0, 1 and other short binary fractions are exact.

        aᵢⱼ is the integral of Lagrange's j-th polynomial from 0 to cᵢ, bⱼ that from 0 to 1.
        """
        from flint import fmpq_poly

        nodes = [as_fmpq(dyadic(ball.mid())) for ball in self.node_balls(bits)]
        integrals = lagrange_integrals(nodes, fmpq_poly)
        rows = [[as_fraction(integral(node)) for integral in integrals] for node in nodes]
        return rows, [as_fraction(integral(as_fmpq(1))) for integral in integrals], [as_fraction(x) for x in nodes]

    def node_balls(self, bits: int) -> tuple[arb, ...]:
        """Balls of at least this many bits around the nodes, ascending."""
        common = lcm(*(x.denominator for x in self.node_polynomial))
        return real_root_balls(tuple(int(x * common) for x in self.node_polynomial), bits)

    def inconsistencies(self) -> dict[str, Exact]:
        """Always {}: the weights and the rows of A integrate constants exactly by construction."""
        return {}


def lagrange_integrals(nodes: Sequence[Any], polynomial: Callable[[Sequence[Any]], Any]) -> list[Any]:
    """The integrals from 0 of the Lagrange polynomials for these nodes, as FLINT polynomials of type `polynomial`."""
    found = []
    for i, node in enumerate(nodes):
        others = [x for j, x in enumerate(nodes) if j != i]
        factors = (polynomial([-x, 1]) * polynomial([1 / (node - x)]) for x in others)
        found.append(prod(factors, start=polynomial([1])).integral())
    return found


Method: TypeAlias = RungeKutta | Splitting | Nystrom | Collocation


def is_strictly_lower(a: Sequence[Sequence[object]]) -> bool:
    """True if A has only zeros on and above its diagonal, so that stages can be computed one after the other."""
    return all(x == 0 for i, row in enumerate(a) for x in row[i:])


def rational_row(values: Iterable[object], where: str) -> tuple[Fraction, ...]:
    """The values as fractions. Raises MethodError for an inexact or an irrational value."""
    exact = _exact(values, where)
    rational = tuple(x for x in exact if isinstance(x, Fraction))
    if len(rational) != len(exact):
        raise MethodError(f"{where} has irrational coefficients; rational ones are needed")
    return rational


def _exact(values: Iterable[object], where: str) -> tuple[Exact, ...]:
    _require_iterable(values, where)
    return tuple(_exact_coefficient(value, f"{where}[{i}]") for i, value in enumerate(values))


def _require_iterable(values: object, where: str) -> None:
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise MethodError(f"{where} is {values!r}; write a tuple of exact coefficients")


def _exact_coefficient(value: object, where: str) -> Exact:
    if isinstance(value, Fraction):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        return Fraction(value)
    if isinstance(value, Algebraic):
        return value.as_fraction() if value.is_rational else value
    raise MethodError(
        f"{where} is {value!r} ({type(value).__name__}); coefficients are exact: write an int or a Fraction"
    )


def nonzero_residuals(residuals: dict[str, Exact]) -> dict[str, Exact]:
    """The residuals that are not zero; a rational element of a number field becomes a Fraction."""
    exact = {condition: _exact_coefficient(residual, condition) for condition, residual in residuals.items()}
    return {condition: residual for condition, residual in exact.items() if residual}
