"""The derivation of M(h), line by line: the stage equations of a method and their solution on the oscillator."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy
from sympy.polys.matrices import DomainMatrix

from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.derivation.formulas import (
    ARGUMENT,
    MATRIX,
    NEW_STATE,
    POSITION,
    STABILITY,
    STATE,
    STEP_SIZE,
    TURN,
    VELOCITY,
    ProofStep,
    as_matrix,
)
from driftproof.symbolic.derivation.one_step import (
    FRACTION_FIELD,
    H,
    expression,
    matrix,
    numerator_and_denominator,
    rational,
)


def derived_matrix(method: Method) -> tuple[DomainMatrix, list[ProofStep]]:
    """M(h) over Q[h] or Q(h), and the steps of its derivation from the definition of the method.

    Raises ValueError for irrational coefficients: SymPy's rational functions are over Q here.
    """
    if method.field is not None:
        raise ValueError(
            f"{method.key} has coefficients in Q({method.field.name}); derivations take only rational ones; "
            "`driftproof facts` lists the properties of the method"
        )
    derive = {RungeKutta: _runge_kutta, Splitting: _splitting, Nystrom: _nystrom, Collocation: _collocation}
    m, steps = derive[type(method)](method)  # type: ignore[operator]
    parts = [[(x, *numerator_and_denominator(x)) for x in row] for row in m.to_list()]
    # a fraction with a constant denominator is a polynomial
    m = matrix([[top.quo_ground(bottom.LC) if bottom.is_ground else x for x, top, bottom in row] for row in parts])
    return m, steps if isinstance(method, Splitting) else [*steps, ProofStep("So $M$ is:", (MATRIX, as_matrix(m)))]


def _runge_kutta(method: RungeKutta) -> tuple[DomainMatrix, list[ProofStep]]:
    """M(h) of a Runge-Kutta method: kᵢ = J(z + h Σ aᵢⱼ kⱼ) = Kᵢ z, where the blocks Kᵢ solve K = 1⊗J + (hA⊗J) K."""
    s = method.stages
    turn, one = [[0, 1], [-1, 0]], [[1, 0], [0, 1]]
    coupling = _matrix([[_times_h(x) * entry for x in row for entry in turned] for row in method.a for turned in turn])
    stages = _solved(coupling, _matrix(turn * s))
    total = _matrix(one) + _matrix([[_times_h(b) * x for b in method.b for x in row] for row in one]) * stages
    names = [sympy.Symbol(f"k_{i + 1}", commutative=False) for i in range(s)]
    equations = [TURN * (STATE + STEP_SIZE * _combined(row, names)) for row in method.a]
    forms = _forms(stages)
    vectors = [sympy.ImmutableMatrix(forms[2 * i : 2 * i + 2]) for i in range(s)]
    setting = ProofStep(
        "On $q' = v$, $v' = -q$ the right-hand side is $J z$.",
        (TURN * STATE, sympy.ImmutableMatrix([VELOCITY, -POSITION])),
    )
    new = STATE + STEP_SIZE * _combined(method.b, names)
    after = ProofStep("The step adds the weighted stages.", (NEW_STATE, new, sympy.ImmutableMatrix(_forms(total))))
    return total, [setting, *_stage_steps(names, equations, vectors, method.explicit), after]


def _nystrom(method: Nystrom) -> tuple[DomainMatrix, list[ProofStep]]:
    """M(h) of a Nyström method: the forces kᵢ = -(q + cᵢhv + h² Σ aᵢⱼ kⱼ) solve k = -(1, hc)(q, v)ᵀ - h²A k."""
    h = _times_h(1)
    coupling = _matrix([[-h * _times_h(x) for x in row] for row in method.a])
    stages = _solved(coupling, _matrix([[-1, -_times_h(c)] for c in method.c]))
    weights = _matrix([[h * _times_h(b) for b in method.b_position], [_times_h(b) for b in method.b_velocity]])
    total = _matrix([[1, h], [0, 1]]) + weights * stages
    names = [sympy.Symbol(f"k_{i + 1}", commutative=False) for i in range(method.stages)]
    equations = [
        -(POSITION + _plain(c) * STEP_SIZE * VELOCITY + STEP_SIZE**2 * _combined(row, names))
        for c, row in zip(method.c, method.a, strict=True)
    ]
    drift = POSITION + STEP_SIZE * VELOCITY + STEP_SIZE**2 * _combined(method.b_position, names)
    kick = VELOCITY + STEP_SIZE * _combined(method.b_velocity, names)
    position, velocity = _forms(total)
    after = [
        ProofStep("The position moves by velocity and weighted forces.", (sympy.Symbol("q_1"), drift, position)),
        ProofStep("The velocity changes by the weighted forces.", (sympy.Symbol("v_1"), kick, velocity)),
    ]
    return total, [*_stage_steps(names, equations, _forms(stages), method.explicit), *after]


def _splitting(method: Splitting) -> tuple[DomainMatrix, list[ProofStep]]:
    """M(h) of a splitting: every kick and every drift is a shear, and M is their product with the last on the left."""
    total, steps = _matrix([[1, 0], [0, 1]]), []
    names: list[sympy.Symbol] = []
    for i, (kind, c) in enumerate(method.parts):
        shear = _matrix([[1, 0], [-_times_h(c), 1]] if kind == "kick" else [[1, _times_h(c)], [0, 1]])
        total = shear * total
        names.insert(0, sympy.Symbol(f"S_{i + 1}", commutative=False))
        moved = "$v$ becomes $v - c h q$" if kind == "kick" else "$q$ becomes $q + c h v$"
        steps.append(ProofStep(f"A {kind} with $c = {c}$: {moved}.", (names[0], as_matrix(shear))))
    product = (sympy.Mul(*names),) if len(names) > 1 else ()
    return total, [
        *steps,
        ProofStep("$M$ is their product, with the first one on the right.", (MATRIX, *product, as_matrix(total))),
    ]


def _collocation(method: Collocation) -> tuple[DomainMatrix, list[ProofStep]]:
    """M(h) = R(hJ) of a collocation method: R(z) = Σ N⁽ˢ⁻ᵏ⁾(1) zᵏ / Σ N⁽ˢ⁻ᵏ⁾(0) zᵏ for its node polynomial N."""
    nodes = sympy.Poly([_plain(c) for c in reversed(method.node_polynomial)], ARGUMENT)
    derivatives = [nodes]
    while len(derivatives) <= method.stages:
        derivatives.append(derivatives[-1].diff())
    parts = [[d.eval(x) for d in reversed(derivatives)] for x in (1, 0)]
    top, bottom = (sympy.Poly(list(reversed(part)), ARGUMENT).as_expr() for part in parts)
    turned = [_polynomial_of(part, _matrix([[0, _times_h(1)], [-_times_h(1), 0]])) for part in parts]
    steps = [
        ProofStep("The nodes of the method are the roots of this polynomial.", (sympy.Symbol("N(z)"), nodes.as_expr())),
        ProofStep(
            "Collocation multiplies by $R(z)$, the sum of $N^{(s-k)}(1) z^k$ over that of $N^{(s-k)}(0) z^k$.",
            (STABILITY, top / bottom),
        ),
        ProofStep("On the oscillator $z$ is $hJ$, and $J^2 = -I$.", (MATRIX, sympy.Function("R")(STEP_SIZE * TURN))),
    ]
    return turned[1].inv() * turned[0], steps


def _stage_steps(
    names: Sequence[sympy.Symbol], equations: Sequence[Any], solved: Sequence[Any], explicit: bool
) -> list[ProofStep]:
    numbered = list(enumerate(zip(names, equations, solved, strict=True), start=1))
    if explicit:
        known = "Stage {} is given by a formula."
        return [
            ProofStep(known.format(i), (k, *dict.fromkeys((equation, form)))) for i, (k, equation, form) in numbered
        ]
    equations_first = [ProofStep(f"Stage {i} solves an equation:", (k, equation)) for i, (k, equation, _) in numbered]
    return [
        *equations_first,
        *(ProofStep("The equations are linear; their solution:", (k, form)) for _, (k, _, form) in numbered),
    ]


def _solved(coupling: DomainMatrix, right: DomainMatrix) -> DomainMatrix:
    """The solution of X = right + coupling·X, which is unique, as the coupling is 0 at h = 0."""
    return (DomainMatrix.eye(coupling.shape[0], FRACTION_FIELD) - coupling).lu_solve(right)


def _polynomial_of(ascending: Sequence[Any], x: DomainMatrix) -> DomainMatrix:
    total = x * FRACTION_FIELD.zero
    for c in reversed(ascending):
        total = total * x + DomainMatrix.eye(2, FRACTION_FIELD) * FRACTION_FIELD.from_sympy(c)
    return total


def _matrix(rows: Sequence[Sequence[Any]]) -> DomainMatrix:
    return DomainMatrix.from_list([[FRACTION_FIELD.convert(x) for x in row] for row in rows], FRACTION_FIELD)


def _times_h(x: Any) -> Any:
    return FRACTION_FIELD.convert(rational(x) * H)


def _plain(x: Any) -> sympy.Rational:
    return sympy.Rational(x.numerator, x.denominator)


def _combined(coefficients: Sequence[Any], names: Sequence[sympy.Symbol]) -> sympy.Expr:
    """The linear combination of the stages with these coefficients, in their order."""
    return sympy.Add(*(_plain(c) * name for c, name in zip(coefficients, names, strict=True) if c), evaluate=False)


def _forms(rows: DomainMatrix) -> list[sympy.Expr]:
    """The expression a q + b v for each row (a, b), written in this order."""
    pairs = [(expression(a) * POSITION, expression(b) * VELOCITY) for a, b in rows.to_list()]
    return [sympy.Add(*pair, evaluate=False) if all(pair) else sum(pair) for pair in pairs]
