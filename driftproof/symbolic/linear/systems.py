"""A method on a linear system z' = Az over Q: its one-step matrix M(h), and the h for which the powers stay bounded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import cached_property, partial, reduce
from typing import Any, NamedTuple

from flint import acb, arb, fmpq, fmpq_poly

from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import (
    CertifiableReal,
    EnclosedReal,
    Uncertified,
    enclose,
    settled,
    sign_of_ball,
)
from driftproof.symbolic.algebra.matrices import StepMatrix, matrix_determinant
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    at_complex_ball,
    deflate,
    descend,
    evaluate,
    exact,
    quotient,
    scalar,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, Minimal, RealRoot, rational_root, root_ratio, sign_at
from driftproof.symbolic.linear.eigenvalues import Complex, Eigenvalue, Imaginary, RootPlace, eigenvalues
from driftproof.symbolic.linear.facts import require_known
from driftproof.symbolic.linear.oscillator import (
    area_factor,
    linear_step_matrix,
    oscillator_matrix,
    stability_function_of,
)
from driftproof.symbolic.linear.ray_bounds import (
    UndecidedLimitError,
    at_rest,
    margin_sign,
    modulus_squared_along,
    pair_bound,
    ray_bound,
    ray_conditions,
)
from driftproof.symbolic.linear.stability_limits import (
    ALWAYS,
    INFINITY,
    NEVER,
    Bound,
    Infinity,
    Limit,
    boundary_of,
    bounded_powers,
    common_denominator,
    is_bounded,
    nonnegative_root,
    smallest,
    spectral_radius,
)

# Factors that agree so far count as equal: no more digits than these are printed of either.
TIE_BITS = 1 << 11


class EigenvalueLimit(NamedTuple):
    """An eigenvalue of A with the bound for its part of M(h), or the reason why the bound is not decided."""

    eigenvalue: Eigenvalue
    bound: Bound | UndecidedLimitError


class LinearSystem:
    """What is exact about a method on z' = Az, A square with rational entries, given by its `bounds`."""

    rows: Sequence[Sequence[Fraction]]

    @property
    def bounds(self) -> list[EigenvalueLimit]:
        """The eigenvalues of A, each with its bound."""
        raise NotImplementedError

    def part_is_bounded(self, eigenvalue: Eigenvalue, h: Fraction) -> bool:
        """True if the part of numerical solutions that belongs to one eigenvalue or pair is bounded for this h > 0."""
        raise NotImplementedError

    def factor_at(self, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
        """The largest factor by which a step multiplies a solution that belongs to one eigenvalue."""
        raise NotImplementedError

    def at_infinity(self) -> Exact | Infinity | EnclosedReal | None:
        """The limit of the factor for infinite hλ, with the sign of R(oo); None if it is no function of hλ."""
        raise NotImplementedError

    @cached_property
    def step_limit(self) -> Bound:
        """The largest H with bounded solutions for every h in (0, H). May raise UndecidedLimitError."""
        decided = [bound for _, bound in self.bounds if isinstance(bound, Bound)]
        undecided = next((bound for _, bound in self.bounds if isinstance(bound, UndecidedLimitError)), None)
        if NEVER in decided:
            return NEVER
        if undecided:
            raise undecided
        limit = smallest([bound.limit for bound in decided])
        at_limit = [b.attained for b in decided if b.limit == limit]
        attained = False if False in at_limit else None if None in at_limit else True
        return ALWAYS if isinstance(limit, Infinity) else Bound(limit, attained)

    def bounded_at(self, h: Fraction) -> bool:
        """True if all numerical solutions are bounded, h > 0. May raise UndecidedLimitError."""
        return all(self.part_is_bounded(eigenvalue, h) for eigenvalue, _ in self.bounds)

    def stiffest_factor(self, h: Fraction) -> CertifiableReal:
        """The largest `factor_at` of the eigenvalues of largest modulus."""
        return reduce(_larger, (self.factor_at(e, h) for e in of_largest_modulus(e for e, _ in self.bounds)))


def of_largest_modulus(found: Iterable[Eigenvalue]) -> list[Eigenvalue]:
    """The eigenvalues of which no other one is known to be larger in modulus."""
    sizes = [(e, abs(ball_of(e))) for e in found]
    return [e for e, size in sizes if not any(other > size for _, other in sizes)]


def _larger(x: CertifiableReal, y: CertifiableReal) -> CertifiableReal:
    """The larger number; either of two that agree in their first `TIE_BITS` bits, as those of equal modulus do."""
    if isinstance(x, Fraction) and isinstance(y, Fraction):
        return max(x, y)
    try:
        sign = settled(lambda: sign_of_ball(enclose(x) - enclose(y)), last=TIE_BITS)
    except Uncertified:
        sign = 1
    return x if sign > 0 else y


class SystemFacts(LinearSystem):
    """The exact facts about `method` on z' = Az, A square with rational entries; each is computed at its first use.

    Raises ValueError for a splitting or a Nyström method on a system that is not of the form q' = v, v' = Kq.
    """

    def __init__(self, method: Method, rows: Sequence[Sequence[Fraction]]) -> None:
        """Keep method and matrix; for a splitting or a Nyström method compute M(h), which not every system has."""
        self.method = method
        self.rows = rows
        if stability_function_of(method) is None:
            self.__dict__["matrix"] = linear_step_matrix(method, rows)

    @cached_property
    def matrix(self) -> StepMatrix:
        """The one-step matrix M(h), with z₁ = M(h) z₀."""
        return linear_step_matrix(self.method, self.rows)

    @cached_property
    def determinant(self) -> RationalFunction:
        """det M(h), the factor by which one step scales volume."""
        den = common_denominator(self.matrix)
        rows = [[descend(x.num * quotient(den, x.den)) for x in row] for row in self.matrix]
        return fraction(descend(matrix_determinant(rows)), den ** len(rows))

    @cached_property
    def bounds(self) -> list[EigenvalueLimit]:
        """The eigenvalues of A, each with its bound."""
        return [EigenvalueLimit(eigenvalue, self._bound(eigenvalue)) for eigenvalue in eigenvalues(self.rows)]

    def _bound(self, eigenvalue: Eigenvalue) -> Bound | UndecidedLimitError:
        r = stability_function_of(self.method)
        try:
            if r is None:
                return partitioned_bound(self.method, eigenvalue.place, eigenvalue.block)
            return runge_kutta_bound(r, eigenvalue.place, eigenvalue.block)
        except UndecidedLimitError as reason:
            return reason

    def part_is_bounded(self, eigenvalue: Eigenvalue, h: Fraction) -> bool:
        """True if powers of the part of M(h) for the eigenvalue or pair are bounded. May raise UndecidedLimitError."""
        r = stability_function_of(self.method)
        if r is None:
            return _partitioned(self.method, eigenvalue, h)
        place, block = eigenvalue.place, eigenvalue.block
        if place == ZERO_ROOT:
            return at_rest(r, block) == ALWAYS
        if isinstance(place, Complex) and place.degree > 2:
            _require_simple(block)
            return margin_sign(r, place, as_fmpq(h)) == 1
        total, product, size = _ray(place)
        margin, obstacles = ray_conditions(r, total, product, block)
        x = _times(size, h)
        inside = sign_at(margin, x)
        return inside == 1 or (not inside and not any(sign_at(p, x) for p in obstacles))

    def factor_at(self, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
        """The largest modulus of the eigenvalues of M(h) that belong to this one of A: |R(hλ)|, or from a 2x2 matrix.

        It is a Fraction if found to be rational, as no ball could tell that the modulus is exactly 1 or 0.
        """
        r = stability_function_of(self.method)
        if r is None:
            return _radius(_block(self.method, eigenvalue.place), eigenvalue, h)
        return _size_of_function(r, eigenvalue, h)

    def at_infinity(self) -> Exact | Infinity | None:
        """R(oo)."""
        r = stability_function_of(self.method)
        return None if r is None else INFINITY if (found := r.at_infinity()) is None else found


def runge_kutta_bound(r: RationalFunction, place: RootPlace, block: int) -> Bound:
    """The bound for powers of R(hJ), J a Jordan block of the eigenvalue or pair. May raise UndecidedLimitError."""
    if place == ZERO_ROOT:
        return at_rest(r, block)
    if isinstance(place, Complex) and place.degree > 2:
        _require_simple(block)
        return pair_bound(r, place)
    total, product, size = _ray(place)
    return _bound_of_step(ray_bound(r, total, product, block), size)


def _require_simple(block: int) -> None:
    if block > 1:
        raise UndecidedLimitError("no procedure decides a complex eigenvalue of degree 3 or more with a Jordan block")


def _ray(place: RootPlace) -> tuple[fmpq, fmpq, RealRoot]:
    """(e + ē, eē, x) for a nonzero eigenvalue xe, x > 0: e is ±1 if real, i if imaginary, else xe itself with x = 1."""
    if isinstance(place, Complex):
        return *place.sum_and_product(), rational_root(Fraction(1))
    if isinstance(place, Imaginary):
        return fmpq(0), fmpq(1), place.size
    return fmpq(2 if sign_of_ball(place.ball()) == 1 else -2), fmpq(1), _size(place)


def _size(place: RealRoot | Imaginary) -> RealRoot:
    """|λ|."""
    if isinstance(place, Imaginary):
        return place.size
    return place if sign_of_ball(place.ball()) == 1 else place.negated()


def partitioned_bound(method: Method, place: RootPlace, block: int) -> Bound:
    """The bound for powers of M(h) of a splitting or Nyström method on q' = v, v' = Kq, λ² being an eigenvalue of K.

    For λ = iω it is that of the oscillator divided by ω, for real λ that of q' = v, v' = q divided by |λ|. Raises
    UndecidedLimitError for a Jordan block, or a step without kicks or drifts, that these do not decide.
    """
    m = oscillator_matrix(method)
    into_position, into_velocity = m[0][1].num[1], m[1][0].num[1]
    if isinstance(place, Complex) and into_position and into_velocity:
        # M = I + h[[0, β], [λ²γ, 0]] + O(h²) has the eigenvalues 1 ± hλ sqrt(βγ) + O(h²). One of them is above 1 in
        # modulus, as sqrt(βγ) is real or imaginary and λ is neither.
        return NEVER
    if place == ZERO_ROOT and into_position:
        return NEVER
    if isinstance(place, Imaginary) and block == 1:
        return _bound_of_step(bounded_powers(m), place.size)
    if isinstance(place, Imaginary) and area_factor(m) == fraction(ONE) and into_position:
        # The eigenvalues lie on the unit circle and turn with ω: dθ/dω is 0 for isolated h only.
        return NEVER
    if isinstance(place, RealRoot) and place != ZERO_ROOT:
        bound = bounded_powers(_block(method, place))
        if block == 1 or bound == NEVER:
            return _bound_of_step(bound, _size(place))
    raise UndecidedLimitError("no procedure decides this: a Jordan block, or a step without kicks or drifts")


def _bound_of_step(bound: Bound, size: RealRoot) -> Bound:
    """The bound for h that follows from a bound for y = h size, size > 0."""
    limit = bound.limit
    if not isinstance(limit, Infinity) and limit != ZERO_ROOT:
        limit = root_ratio(limit, size)
    return Bound(limit, bound.attained)


def limit_of(facts: LinearSystem) -> tuple[Limit | UndecidedLimitError, bool | None]:
    """The step limit and whether it is attained; the reason in place of one that is not decided."""
    try:
        return facts.step_limit
    except UndecidedLimitError as reason:
        return reason, None


# Every fact by name, in the order in which they are printed; an UndecidedLimitError is returned as a fact.
SYSTEM_FACTS: dict[str, Callable[[SystemFacts], Any]] = {
    "method": lambda facts: facts.method,
    "system": lambda facts: facts.rows,
    "one_step_matrix": lambda facts: facts.matrix,
    "determinant": lambda facts: facts.determinant,
    "eigenvalues": lambda facts: facts.bounds,
    "step_limit": lambda facts: limit_of(facts)[0],
    "step_limit_attained": lambda facts: limit_of(facts)[1],
}


def facts_on_system(
    method: Method, rows: Sequence[Sequence[Fraction]], names: Sequence[str] | None = None
) -> dict[str, Any]:
    """The facts with these names, by default all, about the method on z' = Az, A given by its rows.

    Raises ValueError for an unknown name, a matrix that is not square, or a system to which the method does not apply.
    """
    require_known(names or (), SYSTEM_FACTS)
    facts = SystemFacts(method, rows)
    return {name: SYSTEM_FACTS[name](facts) for name in names or SYSTEM_FACTS}


def _partitioned(method: Method, eigenvalue: Eigenvalue, h: Fraction) -> bool:
    """Decide boundedness on q' = v, v' = Kq by exact signs of the 2x2 matrix at h|λ|, see `_block`."""
    place = eigenvalue.place
    if eigenvalue.block > 1 or isinstance(place, Complex) or place == ZERO_ROOT:
        raise UndecidedLimitError("for splittings and the like, only simple real or imaginary eigenvalues are decided")
    return is_bounded(boundary_of(_block(method, place)), partial(sign_at, root=_times(_size(place), h)))


def _times(size: RealRoot, h: Fraction) -> RealRoot:
    """The product of a positive number and h > 0."""
    return root_ratio(size, rational_root(1 / h))


def _size_of_function(r: RationalFunction, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
    place, over_q = eigenvalue.place, isinstance(r.num, fmpq_poly) and isinstance(r.den, fmpq_poly)
    if isinstance(place, RealRoot) and place.rational is not None:
        value = exact(r(scalar(h * place.rational)))
        if isinstance(value, Fraction):
            return abs(value)
    elif not isinstance(place, RealRoot) and len(place.minimal) == 3:
        return nonnegative_root(_squared_size(r, place.minimal, h))
    elif over_q and (rational := _rational_value(r, fmpq_poly(list(place.minimal)), as_fmpq(h))) is not None:
        return abs(rational)

    def ball() -> arb:
        z = ball_of(eigenvalue) * as_fmpq(h)
        return abs(at_complex_ball(r.num, z) / at_complex_ball(r.den, z))

    return ball


def _squared_size(r: RationalFunction, minimal: Minimal, h: Fraction) -> Exact:
    """|R(hλ)|² for a conjugate pair of degree 2, whose sum and product are rational."""
    c, b, a = minimal
    num, den = (evaluate(modulus_squared_along(p, fmpq(-b, a), fmpq(c, a)), scalar(h)) for p in (r.num, r.den))
    return exact(num / den)


def _rational_value(r: RationalFunction, minimal: Polynomial, h: fmpq) -> Fraction | None:
    """R(hλ) if it is rational, else None, from num/den modulo the minimal polynomial of λ; R over Q."""
    num, den = (p(fmpq_poly([0, h])) % minimal for p in (r.num, r.den))
    common, inverse, _ = den.xgcd(minimal)
    value = num * inverse % minimal
    return as_fraction(value[0]) if common == 1 and value.degree() < 1 else None


def _block(method: Method, place: RootPlace) -> StepMatrix:
    """M(h) on q' = v, v' = q for a real λ, else on the oscillator."""
    return linear_step_matrix(method, [[0, 1], [1, 0]]) if isinstance(place, RealRoot) else oscillator_matrix(method)


def _radius(matrix: StepMatrix, eigenvalue: Eigenvalue, h: Fraction) -> CertifiableReal:
    """The spectral radius of the matrix of `_block`, at h|λ| for a real or imaginary λ, else at hλ/i."""
    place = eigenvalue.place
    size = place.size if isinstance(place, Imaginary) else place
    if isinstance(size, RealRoot) and size.rational is not None:
        x = scalar(abs(h * size.rational))
        return spectral_radius([exact(entry(x)) for row in matrix for entry in row])
    if isinstance(place, Imaginary) and len(place.minimal) == 3:
        return spectral_radius(_similar(matrix, h * h * Fraction(place.minimal[0], place.minimal[2])))

    def ball() -> arb:
        z = ball_of(eigenvalue) * as_fmpq(h)
        y = z / acb(0, 1) if isinstance(place, Complex) else acb(abs(z))
        (a, b), (c, d) = ([at_complex_ball(e.num, y) / at_complex_ball(e.den, y) for e in row] for row in matrix)
        half, square = (a + d) / 2, (a - d) * (a - d) + 4 * b * c
        root = (square.sqrt() if square.real > 0 else (-square).sqrt() * acb(0, 1)) / 2  # off the branch cut
        return abs(half + root).max(abs(half - root))

    return ball


def _similar(matrix: StepMatrix, square: Fraction) -> list[Exact]:
    """The entries of diag(1, y) M(y) diag(1, 1/y) for y² = `square`: those of M off the diagonal are odd in y."""
    x, found = scalar(square), []
    for entry, odd in zip([*matrix[0], *matrix[1]], (0, 1, 1, 0), strict=True):
        found.append(evaluate(deflate(entry.num.left_shift(odd)), x) / evaluate(deflate(entry.den), x))
    return [exact(value) for value in (found[0], found[1] / x, *found[2:])]


def ball_of(eigenvalue: Eigenvalue) -> acb:
    """A ball around the eigenvalue, or around that of its pair above the real axis."""
    place = eigenvalue.place
    return acb(0, place.size.ball()) if isinstance(place, Imaginary) else acb(place.ball())
