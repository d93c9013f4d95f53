"""Steps of Rosenbrock methods are those of the definition in fractions, up to rounding, full and banded, with time."""

from fractions import Fraction as Q

import pytest

from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.tables.rosenbrock import ENTRIES
from driftproof.numeric.advance import advance, evaluations_of
from driftproof.numeric.steps.implicit import StageEquationsUnsolved
from driftproof.numeric.steps.tableaux import solved
from driftproof.numeric.work_precision.integrators import has_numba
from tests.numeric.implicit_runs import made_problem

U = Q(1, 2**53)


def coupled(t, y):
    """f, its Jacobian and ∂f/∂t, by hand."""
    a, b = y
    return [t * b * b - 2 * a, a * b - t], [[-2, 2 * t * b], [b, a]], [b * b, -1]


COUPLED = ("t * y1 * y1 - 2 * y0", "y0 * y1 - t")
CELLS = 9  # a band, of eight or more
HEAT = tuple(
    " + ".join([f"-2 * y{i} - y{i} * y{i}", *(f"y{j}" for j in (i - 1, i + 1) if 0 <= j < CELLS)])
    for i in range(CELLS)
)  # fmt: skip


def heat(t, y):
    near = lambda i: sum(y[j] for j in (i - 1, i + 1) if 0 <= j < CELLS)
    slope = lambda i, j: -2 - 2 * y[i] if i == j else abs(i - j) == 1
    matrix = [[slope(i, j) for j in range(CELLS)] for i in range(CELLS)]
    return [near(i) - 2 * y[i] - y[i] * y[i] for i in range(CELLS)], matrix, [0] * CELLS


def step_by_definition(method, f, t, y, h):
    """kᵢ = f(t + αᵢh, y + h Σ αᵢⱼ kⱼ) + hJ Σ γᵢⱼ kⱼ + hγᵢ ∂f/∂t, then y + h Σ bᵢ kᵢ."""
    _, jacobian, of_time = f(t, y)
    n, k = range(len(y)), list[list[Q]]()
    for alpha, gamma in zip(method.alpha, method.gamma, strict=True):
        place = [y[c] + h * sum(a * x[c] for a, x in zip(alpha, k, strict=False)) for c in n]
        mixed = [sum((g * x[c] for g, x in zip(gamma, k, strict=False)), Q(0)) for c in n]
        slope, _, _ = f(t + h * sum(alpha), place)
        right = [slope[c] + h * sum(jacobian[c][d] * mixed[d] for d in n) + h * sum(gamma) * of_time[c] for c in n]
        matrix = [[(c == d) - h * gamma[len(k)] * jacobian[c][d] for d in n] for c in n]
        k.append(solved(matrix, right))
    return [y[c] + h * sum(b * x[c] for b, x in zip(method.b, k, strict=True)) for c in n]


def rational(method):
    """The method with its coefficients as the doubles that steps are run with."""
    rows = lambda matrix: tuple(tuple(Q(float(x)) for x in row) for row in matrix)
    return Rosenbrock("r", "", 0, "", rows(method.alpha), rows(method.gamma), rows([method.b])[0])


# Diagonals of Γ that differ, one of them 0: an explicit stage.
MIXED = Rosenbrock(
    *("mixed", "Mixed", 0, ""),
    alpha=((0, 0, 0), (1, 0, 0), (Q(1, 2), 0, 0)),
    gamma=((Q(1, 2), 0, 0), (Q(1, 4), 0, 0), (0, -1, Q(1, 4))),
    b=(Q(1, 2), Q(1, 4), Q(1, 4)),
)


@pytest.mark.parametrize(("field", "f", "n"), [(COUPLED, coupled, 2), (HEAT, heat, CELLS)], ids=["time", "band"])
@pytest.mark.parametrize("method", [*ENTRIES, MIXED], ids=lambda m: m.key)
def test_a_step_is_that_of_the_definition_up_to_rounding(method, field, f, n):
    """A stage takes at most 40 roundings in a row, of numbers below 16 with these coefficients; a matrix I - hγJ with
    |hγJ| <= 1/4 doubles what it gets. So s stages are off by 2 · 40 · 16 s u; a coefficient off by 1e-9 is seen.
    """
    start, h, twin = tuple((-1) ** i / (i + 2) for i in range(n)), 2.0**-4, rational(method)
    run = advance(method, made_problem(field, start))
    (first, later), exact = (run(start, h, i, i + 1) for i in (0, 3)), [Q(x) for x in start]
    allowed = 2 * 40 * 16 * len(method.b) * U
    for found, t in ((first, Q(0)), (later, 3 * Q(h))):
        expected = step_by_definition(twin, f, t, exact, Q(h))
        assert max(abs(Q(x) - y) for x, y in zip(found, expected, strict=True)) <= allowed
        off = Rosenbrock("r", "", 0, "", twin.alpha, twin.gamma, (*twin.b[:-1], twin.b[-1] + Q(1, 10**9)))
        wrong = step_by_definition(off, f, t, exact, Q(h))
        assert max(abs(Q(x) - y) for x, y in zip(found, wrong, strict=True)) > allowed


def test_evaluations_leave_out_stages_at_the_same_place_and_those_for_the_estimate():
    problem = made_problem(COUPLED, (0.5, 0.25))
    counts = {"ros2": 2, "ode23s": 2, "ros3p": 2, "grk4t": 3, "rodas3": 3, "rodas4": 6}
    for method in ENTRIES:
        run = advance(method, problem)
        run((0.5, 0.25), 0.125, 0, 5)
        assert evaluations_of(run, method, 5) == 5 * counts[method.key], method.key
    assert {method.key for method in ENTRIES} == {*counts}


def test_a_singular_matrix_and_an_overflow_are_said_in_a_line():
    euler = Rosenbrock("linear_euler", "", 1, "", alpha=((0,),), gamma=((1,),), b=(1,))
    run = advance(euler, made_problem(("2 * y0",), (1.0,)))
    with pytest.raises(StageEquationsUnsolved, match=r"linear_euler: the step from t = 0 by h = 0\.5 has a singular"):
        run((1.0,), 0.5, 0, 1)
    both = advance(euler, made_problem(("2 * y0", "0 * y0"), (1.0, 0.0)))
    with pytest.raises(StageEquationsUnsolved, match=r"the step from t = 0\.5 by h = 0\.25 overflows binary64"):
        both((3e307, 0.0), 0.25, 1, 9)
    assert run((1.0,), 0.25, 0, 1) == (2.0,)


@pytest.mark.slow(keep=0)
@pytest.mark.skipif(not has_numba(), reason="numba is not installed")
@pytest.mark.parametrize(("field", "n"), [(COUPLED, 2), (HEAT, CELLS)], ids=["time", "band"])
def test_compiled_steps_have_the_same_bits(field, n):
    method, start = next(m for m in ENTRIES if m.key == "rodas4"), tuple(1 / (i + 2) for i in range(n))
    problem = made_problem(field, start)
    assert advance(method, problem)(start, 0.0625, 0, 9) == advance(method, problem, compiled=True)(start, 0.0625, 0, 9)
