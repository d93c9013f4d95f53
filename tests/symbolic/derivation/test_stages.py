"""M(h) from stage equations: the matrix that the FLINT engine has, and that of the program where there is one."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.derivation.formulas import POSITION, TURN, VELOCITY, as_matrix
from driftproof.symbolic.derivation.one_step import matrix_at, one_step_matrix
from driftproof.symbolic.derivation.stages import derived_matrix
from driftproof.symbolic.runs import exact_matrix_at
from tests.looping import some

RATIONAL = {key: method for key, method in METHODS.items() if method.field is None}
# Two points more than the degree of a numerator and a denominator would decide; a handful finds any slip.
POINTS = (Q(1, 7), Q(-3, 5), Q(11, 4))
# One of each path: explicit, implicit, collocation, splitting, Nyström; a thorough run asks all.
FEW = "rk4 dormand_prince54 radau_iia2 sdirk4 gauss4 lobatto_iiia5 ruth3 symplectic_euler nystrom4"


@pytest.mark.parametrize("key", FEW.split())
def test_matrix_is_that_of_the_other_engine_and_of_the_program(key: str) -> None:
    method = RATIONAL[key]
    m, steps = derived_matrix(method)
    for h in POINTS:
        assert matrix_at(m, h) == exact_matrix_at(method, h)
    assert steps[-1].chain[-1] == as_matrix(m)
    if method.explicit:
        assert m == one_step_matrix(method)


@pytest.mark.long
def test_every_rational_method_has_the_matrix_of_the_other_engine() -> None:
    """The representatives above take each path; here is everything else in the catalogue."""
    for key, method in some(RATIONAL.items(), 90):
        m = derived_matrix(method)[0]
        assert matrix_at(m, POINTS[0]) == exact_matrix_at(method, POINTS[0]), key


QUARTERS = st.integers(-4, 4).map(lambda n: Q(n, 4))


@pytest.mark.slow
@given(st.tuples(*6 * [QUARTERS]))
def test_any_implicit_table_has_the_matrix_of_the_other_engine(entries: tuple[Q, ...]) -> None:
    a, b = (entries[:2], entries[2:4]), entries[4:]
    method = RungeKutta("drawn", "Drawn", 0, "test", a, b, tuple(map(sum, a)))
    m = derived_matrix(method)[0]
    try:
        wanted = exact_matrix_at(method, Q(1, 7))
    except ValueError:
        assume(False)  # a pole just there
    assert matrix_at(m, Q(1, 7)) == wanted


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", ["rk4", "implicit_midpoint", "radau_iia2"])
def test_stages_satisfy_their_equations(key: str) -> None:
    """The slope that is called k_i is put into the equations again, as z -> (q, v) and J -> its matrix."""
    steps = [step for step in derived_matrix(METHODS[key])[1] if str(step.chain[0]).startswith("k_")]
    found = {step.chain[0]: step.chain[-1] for step in steps}
    equations = {step.chain[0]: step.chain[1] for step in reversed(steps) if step.chain[1].has(TURN)}
    assert found.keys() == equations.keys()
    for name, equation in equations.items():
        inside = sympy.expand((equation / TURN).subs(TURN, 1)) if not equation.is_Mul else equation.args[-1].expand()
        terms = sum((inside.coeff(k) * slope for k, slope in found.items()), sympy.Matrix([POSITION, VELOCITY]))
        turned = sympy.Matrix([[0, 1], [-1, 0]]) * terms
        assert (turned - found[name]).applyfunc(sympy.cancel) == sympy.zeros(2, 1)
    _, new, after = derived_matrix(METHODS[key])[1][-2].chain
    moved = sum((sympy.expand(new).coeff(k) * x for k, x in found.items()), sympy.Matrix([POSITION, VELOCITY]))
    assert (moved - after).applyfunc(sympy.cancel) == sympy.zeros(2, 1)


def test_products_and_sums_are_written_in_the_order_in_which_they_act() -> None:
    verlet, nystrom, gauss = (derived_matrix(METHODS[key])[1] for key in ("velocity_verlet", "nystrom4", "gauss4"))
    assert [str(step.chain[0]) for step in verlet] == ["S_1", "S_2", "S_3", "M"]
    assert str(verlet[-1].chain[1]) == "S_3*S_2*S_1"
    assert str(nystrom[1].chain[1]) == "-(h**2*k_1/8 + h*v/2 + q)"
    assert str(gauss[2].chain) == "(M, R(h*J))"


@pytest.mark.parametrize("key", ["nystrom4", "nystrom5"])
def test_forces_of_a_nystrom_method_make_each_chain_equal(key: str) -> None:
    steps = derived_matrix(METHODS[key])[1][:-1]
    forces = {step.chain[0]: step.chain[-1] for step in steps if str(step.chain[0]).startswith("k_")}
    for step in some(steps, METHODS[key].stages + 2):
        assert len({sympy.expand(x.subs(forces)) for x in step.chain[1:]}) == 1


def test_irrational_coefficients_are_refused_in_one_line() -> None:
    with pytest.raises(
        ValueError, match=r"gauss2 has coefficients in Q\(sqrt\(3\)\); derivations take only rational ones"
    ):
        derived_matrix(METHODS["gauss2"])
