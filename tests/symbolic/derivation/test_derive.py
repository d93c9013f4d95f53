"""What is derived of a method: against the FLINT engine's facts, against numbers put in, and in its three formats."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import sympy

import driftproof
from driftproof.cli import main
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.derivation.derive import DERIVED, derive
from driftproof.symbolic.derivation.formulas import (
    AREA_FORM,
    CHARACTERISTIC,
    COSINE,
    DET,
    DISCRIMINANT,
    ENERGY_RATIO,
    GRAM,
    MATRIX,
    ROOTS,
    TANGENT,
    TRACE,
)
from driftproof.symbolic.derivation.stability import LAMBDA
from driftproof.symbolic.facts import Facts
from tests.looping import exactly

h, q, v = sympy.symbols("h q v")
FEW = ("forward_euler", "symplectic_euler", "velocity_verlet", "rk4", "bogacki_shampine32", "backward_euler", "gauss4",
       "implicit_midpoint", "lobatto_iiib3", "nystrom4")  # fmt: skip
AT = {h: sympy.Rational(3, 7)}
AFTER = sympy.Symbol("E_1")
LESSON = {  # multiplier, invariant, leading phase error, stability limit: as the lesson prints them
    "forward_euler": (1 + h**2, None, -(h**3) / 3, 0),
    "symplectic_euler": (None, (q**2 - h * q * v + v**2) / 2, h**3 / 24, 2),
    "rk4": (1 - h**6 / 72 + h**8 / 576, None, -(h**5) / 120, 2 * sympy.sqrt(2)),
}


# Every formula of symplectic Euler, in the order of the steps.
FORMULAS = """
S_1 = [1, 0; -h, 1]
S_2 = [1, h; 0, 1]
M = S_2*S_1 = [1 - h**2, h; -h, 1]
det M = M_qq*M_vv - M_qv*M_vq = 1
M^T M = [1 - h**2 + h**4, -h**3; -h**3, 1 + h**2]
E_1 = q**2*(1/2 + h**4/2 - h**2/2) + v**2*(1/2 + h**2/2) - q*v*h**3
det(z, M z) = -h*q**2 - h*v**2 + q*v*h**2
det M = 1
I = q**2/2 + v**2/2 - h*q*v/2
tr M = 2 - h**2
det(lambda I - M) = lambda**2 - lambda*tr M + det M = lambda**2 - lambda*(2 - h**2) + 1
Delta = tr M**2 - 4*det M = -4*h**2 + h**4 = h**2*(-2 + h)*(2 + h)
lambda_1 = 1 + h*sqrt(-4 + h**2)/2 - h**2/2
lambda_2 = 1 - h*sqrt(-4 + h**2)/2 - h**2/2
cos(theta) = tr M/(2*sqrt(det M)) = 1 - h**2/2
theta = acos(1 - h**2/2)
tan(theta) = h*sqrt(4 - h**2)/(2*(1 - h**2/2))
theta - h = h**3/24 + 3*h**5/640 + 5*h**7/7168 + O(h**8)
h**3/24
1 - det M = 0
1 + det M + tr M = -(-2 + h)*(2 + h)
1 + det M - tr M = h**2
H = 2
M = [-3, 2; -2, 1]
"""


def in_sympy(function: object) -> sympy.Expr:
    """A rational function of the FLINT engine in h."""
    both = (function.num.coeffs(), function.den.coeffs())  # type: ignore[attr-defined]
    top, bottom = (sum((sympy.Rational(str(c)) * h**k for k, c in enumerate(p)), sympy.Integer(0)) for p in both)
    return top / bottom


@pytest.mark.parametrize("key", LESSON)
def test_lesson_methods_have_the_lesson_s_formulas(key: str) -> None:
    found = derive(key)
    multiplier, invariant, leading, limit = LESSON[key]
    for derived, wanted in ((found.energy_multiplier, multiplier), (found.invariant, invariant)):
        assert (derived.value is None) == (wanted is None) == (derived.missing is not None)
        assert wanted is None or sympy.expand(derived.value - wanted) == 0
    assert found.phase_error.steps[-1].chain == (leading,)
    assert found.stability_limit.value == limit
    assert found.stability_limit.steps[-1].because.startswith("For small $h > 0$" if limit == 0 else "At $H$")


def test_formulas_stand_in_the_order_in_which_they_are_read() -> None:
    lines = derive("symplectic_euler").written("text").splitlines()
    assert [line.strip() for line in lines if line.startswith(6 * " ")] == FORMULAS.split("\n")[1:-1]


@pytest.mark.parametrize("key", FEW)
def test_what_is_derived_agrees_with_the_facts_of_the_other_engine(key: str) -> None:
    found, facts = derive(key), Facts(METHODS[key])
    for derived, wanted in zip(
        found.one_step_matrix.value, [x for row in facts.one_step_matrix for x in row], strict=True
    ):
        assert sympy.cancel(derived - in_sympy(wanted)) == 0
    assert sympy.cancel(found.determinant.value - in_sympy(facts.determinant.f)) == 0
    multiplier = facts.energy_multiplier
    assert (found.energy_multiplier.value is None) == (multiplier is None)
    if multiplier is not None:
        assert sympy.cancel(found.energy_multiplier.value - in_sympy(multiplier.f).subs(h, h**2)) == 0
    assert (found.invariant.value is None) == (facts.invariant is None)


@pytest.mark.parametrize("key", FEW)
def test_numbers_put_into_the_formulas_satisfy_what_they_say(key: str) -> None:
    """At h = 3/7: both roots solve the characteristic equation, the invariant is conserved, the angle is a root's."""
    found = derive(key)
    m = found.one_step_matrix.value.subs(AT)
    assert found.characteristic_polynomial.value.subs(AT) == sympy.expand((LAMBDA * sympy.eye(2) - m).det())
    for root in found.roots.value:
        assert sympy.simplify((m - root.subs(AT) * sympy.eye(2)).det()) == 0
    assert sympy.simplify(sympy.cos(found.phase.value.subs(AT)) * 2 * sympy.sqrt(m.det()) - m.trace()) == 0
    if (invariant := found.invariant.value) is not None:
        after = m * sympy.Matrix([q, v])
        moved = invariant.subs(AT).subs({q: after[0], v: after[1]}, simultaneous=True)
        assert sympy.expand(moved - invariant.subs(AT)) == 0


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", FEW)
def test_every_result_has_steps_and_the_last_of_a_value_ends_in_it(key: str) -> None:
    """What stands in one chain is equal, at h = 3/7, where trace, determinant and angle are those of the matrix."""
    m = derive(key).one_step_matrix.value.subs(AT)
    known = {
        **AT, q: sympy.Rational(2, 5), v: sympy.Rational(7, 11), TRACE: m.trace(), DET: m.det(),
        DISCRIMINANT: m.trace() ** 2 - 4 * m.det(),
    }  # fmt: skip
    z, half_root = sympy.Matrix([q, v]), sympy.sqrt(known[DISCRIMINANT]) / 2
    known |= {LAMBDA: sympy.Rational(2, 3), ENERGY_RATIO: (m.T * m)[0, 0]}
    known[CHARACTERISTIC] = (known[LAMBDA] * sympy.eye(2) - m).det()
    known[AREA_FORM], known[AFTER] = z.row_join(m * z).det().subs(known), ((m * z).dot(m * z) / 2).subs(known)
    known |= {COSINE: m.trace() / 2 / sympy.sqrt(m.det()), TANGENT: sympy.sqrt(-known[DISCRIMINANT]) / m.trace()}
    known |= dict(zip(ROOTS, (m.trace() / 2 + half_root, m.trace() / 2 - half_root), strict=True))
    matrices = {GRAM: m.T * m, MATRIX: m}
    for derived in exactly(9, derive(key).chosen()):
        assert derived.steps or derived.missing
        assert (derived.value is None) == bool(derived.missing)
        for step in derived.steps:
            assert step.because.count("$") % 2 == 0
            scalars = [x for x in step.chain if not isinstance(x, sympy.MatrixBase)]
            numbers = [x for x in scalars if set() < x.free_symbols <= {*known}]
            for other in numbers[1:]:
                assert sympy.simplify((numbers[0] - other).subs(known)) == 0
            wanted, last = matrices.get(step.chain[0]), step.chain[-1]
            if wanted and isinstance(last, sympy.MatrixBase) and derived.name != "stability_limit":  # M at the limit
                assert sympy.simplify(last.subs(AT) - wanted) == sympy.zeros(2)


def test_a_plane_that_only_drifts_has_no_phase_error_and_says_why() -> None:
    from driftproof.methods.schemes import Splitting

    found = derive(Splitting("drift", "Drift", 0, "test", (("drift", 1),)))
    assert found.phase_error.missing == "the step does not turn by an angle h + O(h**2), as a consistent method does"
    assert "does not tend to the energy" in (found.invariant.missing or "")
    assert found.stability_limit.value == 0


def test_formats_of_the_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["derive", "symplectic_euler", "--format", "json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert list(answer["derived"]) == sorted(DERIVED)
    assert answer["derived"]["invariant"]["value"] == "-h*q*v/2 + q**2/2 + v**2/2"
    assert answer["derived"]["energy_multiplier"]["value"] is None
    assert main(["derive", "rk4", "--only", "energy_multiplier", "--format", "tex"]) == 0
    assert r"\[ \mu = 1 - \frac{h^{6}}{72} + \frac{h^{8}}{576} \]" in capsys.readouterr().out
    table = tmp_path / "ralston.toml"
    table.write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n')
    assert main(["derive", str(table), "--only", "determinant"]) == 0
    assert "det M = M_qq*M_vv - M_qv*M_vq = 1 + h**4/4" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["rk5"], "rk5"),
        (["rk4", "--only", "phas"], "unknown derivation 'phas'; did you mean phase? choose from one_step_matrix"),
        (["gauss2"], "derivations take only rational ones"),
        (["sdirk_order_2"], "is a family of methods"),
        (["missing.toml"], "missing.toml"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["derive", *arguments]) == 2
    complaint = capsys.readouterr().err
    assert words in complaint
    assert complaint.count("\n") == 1


def test_front_door_takes_a_key_and_shows_itself_in_a_notebook() -> None:
    shown = driftproof.derive("symplectic_euler")
    assert shown.determinant._repr_latex_() == r"$\displaystyle \det M = 1$"
    whole = shown._repr_latex_()
    assert whole.startswith("$$")
    assert all(each.tex in whole for each in shown.chosen())
    roots = driftproof.derive("symplectic_euler", only="roots")
    assert roots._repr_latex_() == rf"$$\begin{{gathered}} {shown.roots.tex} \end{{gathered}}$$"
