"""What the coefficients alone decide: symplecticity, symmetry, stiff accuracy; each on the irreducible method."""

from __future__ import annotations

from itertools import groupby

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Collocation, Method, RungeKutta, Splitting
from driftproof.symbolic.algebra.polynomials import ONE, X, polynomial
from driftproof.symbolic.linear.irreducible import Stages, matchings, reduced, stages_of, total


def is_symplectic(method: Method) -> bool:
    """Symplectic for every Hamiltonian; splittings and Nyström methods: for every one of the form T(p) + V(q).

    Runge-Kutta: bᵢaᵢⱼ + bⱼaⱼᵢ = bᵢbⱼ; Nyström: b̄ᵢ = bᵢ(1 - cᵢ) and bᵢ(b̄ⱼ - aᵢⱼ) = bⱼ(b̄ᵢ - aⱼᵢ). Sufficient, and for
    irreducible methods necessary (hairer-lubich-wanner-2006, VI.4 and VI.7). Collocation: the nodes are Gauss's, since
    the condition says that the quadrature is exact to degree 2s - 1.
    """
    if isinstance(method, Splitting):
        return True
    if isinstance(method, Collocation):
        return bool(polynomial(method.node_polynomial) == _gauss_polynomial(method.stages))
    return not symplectic_residuals(reduced(stages_of(method)))


def symplectic_residuals(stages: Stages) -> dict[str, Exact]:
    """The residuals, where not zero, of the conditions of `is_symplectic` for the coefficients as they stand."""
    a, b = stages.a, stages.b
    pairs = [(i, j) for i in range(len(b)) for j in range(i, len(b))]
    if len(stages.weights) == 1:
        found = {f"{i + 1},{j + 1}": b[i] * a[i][j] + b[j] * a[j][i] - b[i] * b[j] for i, j in pairs}
    else:
        outer = stages.weights[0]
        found = {f"{i + 1}": outer[i] - b[i] + b[i] * c for i, c in enumerate(stages.c)}
        found |= {f"{i + 1},{j + 1}": b[i] * (outer[j] - a[i][j]) - b[j] * (outer[i] - a[j][i]) for i, j in pairs}
    return {place: residual for place, residual in found.items() if residual != 0}


def is_symmetric(method: Method) -> bool:
    """The step of -h undoes the step of h on every problem: the method is its own adjoint.

    Some order of the stages turns the irreducible coefficients into the adjoint's, bⱼ - aᵢⱼ for a Runge-Kutta method
    (hairer-lubich-wanner-2006, V.2); a splitting's reduced word is a palindrome; a collocation method's nodes are
    symmetric about 1/2.
    """
    if isinstance(method, Splitting):
        word = reduced_word(method)
        return word == word[::-1]
    if isinstance(method, Collocation):
        nodes = polynomial(method.node_polynomial)
        return bool(nodes(ONE - X) * (-1) ** method.stages == nodes)
    stages = reduced(stages_of(method))
    return next(matchings(stages, adjoint(stages)), None) is not None


def adjoint(stages: Stages) -> Stages:
    """The coefficients of the adjoint method, stages in the same order: h for -h, start and end exchanged."""
    a, c = stages.a, tuple(1 - x for x in stages.c)
    *outer, b = stages.weights
    size = range(len(b))
    if not outer:
        return Stages(tuple(tuple(b[j] - a[i][j] for j in size) for i in size), (b,), c)
    (position,) = outer
    rows = tuple(tuple(b[j] * c[i] - position[j] + a[i][j] for j in size) for i in size)
    return Stages(rows, (tuple(b[j] - position[j] for j in size), b), c)


def is_stiffly_accurate(method: Method) -> bool:
    """The last stage is the result: aₛⱼ = bⱼ for all j (hairer-wanner-1996, IV.3); False for other families."""
    if isinstance(method, Collocation):
        return bool(polynomial(method.node_polynomial)(1) == 0)
    return isinstance(method, RungeKutta) and method.a[-1] == method.b


def is_first_same_as_last(method: Method) -> bool:
    """The first slope of a step is the last one of the step before: a₁ⱼ = 0 and aₛⱼ = bⱼ for all j."""
    if isinstance(method, Collocation):
        return is_stiffly_accurate(method) and method.node_polynomial[0] == 0
    return isinstance(method, RungeKutta) and is_stiffly_accurate(method) and not any(method.a[0])


def reduced_word(method: Splitting) -> list[tuple[str, Exact]]:
    """The sub-steps without zeros, neighbours of one kind added up, until nothing changes."""
    word = [(kind, c) for kind, c in method.parts if c != 0]
    while True:
        grouped = [(kind, total(c for _, c in run)) for kind, run in groupby(word, key=lambda part: part[0])]
        shorter = [(kind, c) for kind, c in grouped if c != 0]
        if shorter == word:
            return word
        word = shorter


def _gauss_polynomial(degree: int) -> object:
    """The monic Legendre polynomial on [0, 1], as the derivative of order `degree` of (x² - x)**degree."""
    found = (X * X - X) ** degree
    for _ in range(degree):
        found = found.derivative()
    return found / found.leading_coefficient()
