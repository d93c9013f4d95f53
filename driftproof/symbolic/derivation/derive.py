"""Properties of a method on the oscillator as SymPy objects, each with the steps of its derivation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import sympy
from sympy.polys.matrices import DomainMatrix

from driftproof.methods.given_methods import method_of
from driftproof.methods.schemes import Method
from driftproof.support.plain_text import as_json, unknown
from driftproof.support.results import Printable
from driftproof.symbolic.derivation.energy import (
    StateDependentEnergy,
    energy_after,
    energy_multiplier,
    invariant_quadratic,
)
from driftproof.symbolic.derivation.formulas import (
    AREA_FORM,
    CHARACTERISTIC,
    COSINE,
    DET,
    DISCRIMINANT,
    ENERGY_RATIO,
    GRAM,
    INVARIANT,
    LIMIT,
    MATRIX,
    POSITION,
    ROOTS,
    STEP_SIZE,
    TANGENT,
    THETA,
    TRACE,
    VELOCITY,
    Derived,
    ProofStep,
    as_matrix,
)
from driftproof.symbolic.derivation.one_step import determinant, entries, expression, trace
from driftproof.symbolic.derivation.phase import leading_term, phase_error_series, phase_per_step
from driftproof.symbolic.derivation.stability import (
    LAMBDA,
    AtStep,
    characteristic_polynomial,
    conditions,
    discriminant,
    minimal_polynomial_of,
    multipliers,
    square_root_of_discriminant,
    stability_limit,
)
from driftproof.symbolic.derivation.stages import derived_matrix
from driftproof.symbolic.linear.facts import fact_names

# Terms of the phase error; chosen, and doubled while all are zero, which ends: cos θ is algebraic in h, cos h is not.
FIRST_TERMS = 8
MONOMIALS = (POSITION**2, POSITION * VELOCITY, VELOCITY**2)


@dataclass(frozen=True, repr=False)
class Derivation(Printable):
    """The derived properties of `method` on q' = v, v' = -q in the symbol h, each computed at its first use.

    `only` names those that are printed, by default all.
    """

    method: Method
    only: Sequence[str] = ()

    @cached_property
    def _matrix_and_steps(self) -> tuple[DomainMatrix, list[ProofStep]]:
        return derived_matrix(self.method)

    @property
    def _m(self) -> DomainMatrix:
        return self._matrix_and_steps[0]

    @cached_property
    def one_step_matrix(self) -> Derived:
        """M(h) with (q₁, v₁) = M(h) (q, v)."""
        return Derived("one_step_matrix", MATRIX, as_matrix(self._m), tuple(self._matrix_and_steps[1]))

    @cached_property
    def determinant(self) -> Derived:
        """det M, the factor by which a step scales area."""
        value = expression(determinant(self._m))
        qq, qv, vq, vv = sympy.symbols("M_qq M_qv M_vq M_vv")
        step = ProofStep("The factor by which a step scales areas:", (DET, qq * vv - qv * vq, value))
        return Derived("determinant", DET, value, (step,))

    @cached_property
    def energy_multiplier(self) -> Derived:
        """The factor μ(h) with E(Mz) = μ E(z) for every z, if there is one."""
        after, gram = energy_after(self._m), as_matrix(self._m.transpose() * self._m)
        square = ProofStep("A step multiplies by $M$, and $E = |z|^2/2$.", (GRAM, gram))
        try:
            value = expression(energy_multiplier(self._m))
        except StateDependentEnergy:
            form = sum(expression(c) * x for c, x in zip(after, MONOMIALS, strict=True))
            change = ProofStep("So the energy after one step is:", (sympy.Symbol("E_1"), form))
            reason = "$M^T M$ is not a multiple of $I$, so the energy change of a step depends on the state"
            return Derived("energy_multiplier", ENERGY_RATIO, None, (square, change), reason)
        ratio = ProofStep("It is a multiple of $I$; the factor is the energy multiplier.", (ENERGY_RATIO, value))
        gain = ProofStep("A step changes the energy by this fraction.", (ENERGY_RATIO - 1, sympy.factor(value - 1)))
        return Derived("energy_multiplier", ENERGY_RATIO, value, (square, ratio, gain))

    @cached_property
    def invariant(self) -> Derived:
        """The quadratic form that every step conserves and that becomes the energy as h goes to 0, if there is one."""
        qq, qv, vq, vv = (expression(x) for x in entries(self._m))
        area_form = vq * POSITION**2 + sympy.factor(vv - qq) * POSITION * VELOCITY - qv * VELOCITY**2
        steps = [
            ProofStep("The area spanned by $z$ and its image is a quadratic form in $z$.", (AREA_FORM, area_form)),
            ProofStep(r"A step multiplies it, like every area, by $\det M$.", (DET, expression(determinant(self._m)))),
        ]
        try:
            found = invariant_quadratic(self._m)
        except ValueError as error:
            return Derived("invariant", INVARIANT, None, tuple(steps), str(error))
        value = sympy.Add(*(expression(c) * x for c, x in zip(found, MONOMIALS, strict=True)))
        steps.append(
            ProofStep(r"As $\det M = 1$, it is conserved; scaled to equal the energy at $h = 0$:", (INVARIANT, value))
        )
        return Derived("invariant", INVARIANT, value, tuple(steps))

    @cached_property
    def characteristic_polynomial(self) -> Derived:
        """The characteristic polynomial λ² - tr M λ + det M."""
        value, sum_of_roots = characteristic_polynomial(self._m).as_expr(), expression(trace(self._m))
        forms = ((TRACE, DET), (sum_of_roots, expression(determinant(self._m))))
        chain = (sympy.Add(LAMBDA**2, -LAMBDA * t, d, evaluate=False) for t, d in forms)
        steps = (
            ProofStep("The trace is the sum of the diagonal.", (TRACE, sum_of_roots)),
            ProofStep("With the trace and the determinant it is:", (CHARACTERISTIC, *chain)),
        )
        return Derived("characteristic_polynomial", CHARACTERISTIC, value, steps)

    @cached_property
    def roots(self) -> Derived:
        """The two roots of the characteristic polynomial."""
        inside = expression(discriminant(self._m))
        value = sympy.Tuple(*multipliers(self._m))
        halves = ("Half the trace plus half the square root of the discriminant:", "The same with a minus sign:")
        steps = [
            ProofStep(
                "The discriminant; where it is negative, the roots are complex conjugates.",
                _chain(DISCRIMINANT, TRACE**2 - 4 * DET, inside, sympy.factor(inside)),
            ),
            *map(ProofStep, halves, zip(ROOTS, value, strict=True)),
        ]
        return Derived("roots", sympy.Tuple(*ROOTS), value, tuple(steps))

    @cached_property
    def phase(self) -> Derived:
        """θ(h), the angle by which a step turns; the exact flow turns by h."""
        half_trace, area = expression(trace(self._m)) / 2, expression(determinant(self._m))
        cosine = ProofStep(
            r"Complex roots have the modulus $(\det M)^{1/2}$, the arguments $\pm\theta$, and their sum is the trace.",
            _chain(COSINE, TRACE / (2 * sympy.sqrt(DET)), half_trace / sympy.sqrt(area)),
        )
        value = phase_per_step(self._m)
        return Derived("phase", THETA, value, (cosine, ProofStep("So the angle is:", (THETA, value))))

    @cached_property
    def phase_error(self) -> Derived:
        """The first terms of θ(h) - h; a negative leading coefficient means that the method lags."""
        symbol, half_trace = THETA - STEP_SIZE, expression(trace(self._m)) / 2
        factor, rest = square_root_of_discriminant(self._m)
        because = "The tangent is a power series in $h$, and so is its arctangent."
        tangent = ProofStep(because, (TANGENT, factor * sympy.sqrt(-rest) / 2 / half_trace))
        terms = FIRST_TERMS
        try:
            while (leading := leading_term(series := phase_error_series(self._m, terms))) is None:
                terms *= 2
        except ValueError as error:
            return Derived("phase_error", symbol, None, (), str(error))
        value = expression(series) + sympy.Order(STEP_SIZE**terms)
        first = ProofStep("For small $h$ the first term dominates.", (leading[1] * STEP_SIZE ** leading[0],))
        return Derived("phase_error", symbol, value, (tangent, ProofStep("The first terms:", (symbol, value)), first))

    @cached_property
    def stability_limit(self) -> Derived:
        """The largest H such that the powers of M(h) are bounded for every h in (0, H)."""
        found = conditions(self._m)
        named = (
            ("The product of the roots is at most $1$ if this is nonnegative.", 1 - DET, found.area),
            (
                "The characteristic polynomial at $-1$, nonnegative as long as no root is below $-1$.",
                1 + TRACE + DET,
                found.plus,
            ),
            (
                "The characteristic polynomial at $1$, nonnegative as long as no root is above $1$.",
                1 - TRACE + DET,
                found.minus,
            ),
        )
        square = expression(found.pole) ** 2
        steps = [ProofStep(why, _chain(symbol, sympy.factor(expression(p) / square))) for why, symbol, p in named]
        value = stability_limit(self._m)
        return Derived("stability_limit", LIMIT, value, (*steps, *_verdict(self._m, value)))

    def chosen(self, names: Sequence[str] = ()) -> tuple[Derived, ...]:
        """The derivations with these names, by default all. Raises ValueError for an unknown name."""
        for name in names:
            if name not in DERIVED:
                raise ValueError(unknown("derivation", name, DERIVED))
        return tuple(getattr(self, name) for name in names or DERIVED)

    def written(self, form: str) -> str:
        """The chosen derivations with their steps, as "text", "tex" or "json". Raises ValueError for unknown names."""
        derived = self.chosen(self.only)
        if form == "json":
            return as_json({"method": self.method.key, "derived": {each.name: each.data() for each in derived}})
        return "\n\n".join(each.derivation_tex if form == "tex" else each.text for each in derived)

    def _repr_html_(self) -> None:
        """Return None, so that a notebook shows the TeX."""

    def _repr_latex_(self) -> str:
        lines = r" \\ ".join(derived.tex for derived in self.chosen(self.only))
        return rf"$$\begin{{gathered}} {lines} \end{{gathered}}$$"


# The names of all derivations, in the order in which they are printed.
DERIVED = fact_names(Derivation)


def derive(method: str | Path | Method, *, only: Sequence[str] = ()) -> Derivation:
    """Derive the properties of a method, also given by name or TOML file, on the oscillator q' = v, v' = -q.

    Raises ValueError for an unknown name; for irrational coefficients the properties of the result raise it.

    >>> from driftproof import derive
    >>> derive("forward_euler").energy_multiplier.value
    h**2 + 1
    """
    return Derivation(method_of(method), tuple(map(str.strip, only.split(",")) if isinstance(only, str) else only))


def _verdict(m: DomainMatrix, limit: sympy.Expr) -> list[ProofStep]:
    """The steps from the boundedness conditions to the limit, and whether the powers are bounded at the limit."""
    if limit in (0, sympy.oo):
        because = "For small $h > 0$ one of them is negative, or the roots coincide and the powers grow."
        return [ProofStep(because if limit == 0 else "None of them is negative for any $h > 0$.", (LIMIT, limit))]
    steps = [ProofStep("This is the largest $H$ with bounded powers for every $h < H$.", (LIMIT, limit))]
    if limit.atoms(sympy.CRootOf):
        polynomial = minimal_polynomial_of(m, limit).as_expr()
        return [*steps, ProofStep("It is a root of this irreducible polynomial.", (polynomial, sympy.Integer(0)))]
    at = AtStep(m, limit)
    grows = "At $H$ the roots coincide and the powers grow." if at.jordan_block else "At $H$ the powers grow."
    return [*steps, ProofStep("At $H$ they are still bounded." if at.bounded else grows, (MATRIX, at.matrix))]


def _chain(*members: sympy.Basic) -> tuple[sympy.Basic, ...]:
    """The members without repetitions."""
    return tuple(dict.fromkeys(members))
