"""Answers that are facts, against Fractions by hand and against what is in print; why a method has none."""

import re
from fractions import Fraction as Q

import pytest

from driftproof.texts.questions.evaluate import value
from tests.texts.questions.steps_by_hand import BY_HAND, energy, reached


def test_energy_multiplier_is_what_a_step_does_to_the_energy():
    for h in (Q(1, 4), Q(-2), Q(17, 5)):
        for key in ("forward_euler", "rk4"):
            expected = energy(reached(key, h, 1)) / energy((Q(1), Q(0)))
            assert value(f"energy_multiplier {key} h={h}").exact == expected
    assert value("energy_multiplier rk4").exact_text == "1 - h**6/72 + h**8/576"
    assert not value("energy_multiplier rk4").is_number


def test_an_order_of_rounded_coefficients_is_said_to_be_that():
    for method, rounded in (("tsitouras54", True), ("KenCarp4", True), ("rk4", False), ("bdf2", False)):
        assert ("with the coefficients as rounded" in str(value(f"order of {method}"))) is rounded


ALEXANDER = """family = "runge_kutta"
A = [[0.4358665215, 0, 0], [0.28206673925, 0.4358665215, 0], [1.208496649, -0.644363171, 0.4358665215]]
b = [1.208496649, -0.644363171, 0.4358665215]
"""


def test_stability_of_rounded_coefficients_is_said_to_be_that(tmp_path, monkeypatch):
    """Alexander's L-stable method, in ten digits; a table that needs no rounding, without the remark."""
    monkeypatch.chdir(tmp_path)
    for name, more in (("said", "decimal = true\n"), ("unsaid", "")):
        (tmp_path / f"{name}.toml").write_text(more + ALEXANDER)
        for asked in (f"is {name}.toml L-stable", f"a_stable {name}.toml"):
            assert str(value(asked)).endswith("as rounded; stability_within_digits ignores the rounding)")
    for exact in ("a_stable gauss2", "l_stable sdirk2"):
        assert str(value(exact)) == "yes  (DERIVED)"
    assert str(value("symplectic said.toml")) == "no  (DERIVED; with the coefficients as rounded)"


def test_leading_term_with_a_root_is_exact():
    """C = 1/6 - gamma + gamma**2/2 times -1 for two stages (hairer-wanner-1996, IV.6), gamma = 1 - sqrt(1/2)."""
    found = value("error_constant sdirk2")
    assert (found.exact_text, found.evidence) == ("-2/3 + 1/2*sqrt(2)", "DERIVED")


def test_one_step_matrix_has_the_images_of_the_axes_for_columns():
    h = Q(3, 7)
    for key in BY_HAND:
        columns = [reached(key, h, 1, axis) for axis in ((Q(1), Q(0)), (Q(0), Q(1)))]
        found = [[value(f"one_step_matrix {key} h={h} : M_{row}{column}").exact for column in "qv"] for row in "qv"]
        assert found == [[columns[j][i] for j in (0, 1)] for i in (0, 1)]
        (a, b), (c, d) = found
        assert value(f"determinant {key} h={h}").exact == a * d - b * c


def test_invariant_keeps_its_value_over_a_step():
    h, z = Q(2, 3), (Q(1, 5), Q(-4))
    q, v = BY_HAND["symplectic_euler"](z, h)
    before, after = (value(f"invariant symplectic_euler h={h} from {a},{b}").exact for a, b in (z, (q, v)))
    assert before == after == (z[0] ** 2 - h * z[0] * z[1] + z[1] ** 2) / 2
    assert value("invariant symplectic_euler").exact_text == "q**2/2 - h*q*v/2 + v**2/2"
    assert value("invariant symplectic_euler h=1/2 : qv").exact == Q(-1, 4)
    assert not value("invariant symplectic_euler").is_number
    assert value("determinant symplectic_euler").exact == 1


def taylor(x):
    return 1 - x + x**2 / 2 - x**3 / 6 + x**4 / 24


def test_stability_limits_of_rk4_are_where_its_polynomial_leaves_the_disc():
    limit = Q(value("real_limit rk4").digits(40))
    unit = Q(1, 10**38)
    assert taylor(limit - unit) < 1 < taylor(limit + unit)
    assert value("stability_function rk4 z=-3/2").exact == taylor(Q(3, 2))
    imaginary = value("imaginary_limit rk4")
    assert (imaginary.exact_text, value("(imaginary_limit rk4)**2").exact) == ("2*sqrt(2)", 8)
    assert value("real_limit backward_euler").exact_text == "oo"


FACTS = {
    "order rk4": ("4", "DERIVED"), "stages rk4": ("4", "COUNTED"), "a_stable radau_iia2": ("yes", "DERIVED"),
    "a_stable rk4": ("no", "DERIVED"), "error_constant rk4": ("-1/120", "DERIVED"),
    "error_constant rk4 : power": ("5", "DERIVED"), "order_fails rk4 : residual": ("1/120", "DERIVED"),
    "dispersion rk4": ("-h**5/120", "DERIVED"), "dispersion rk4 h=1/10": ("-1/12000000", "DERIVED"),
    "dissipation rk4 : coefficient": ("-1/144", "DERIVED"),
    "dispersion_series rk4": ("-h**5/120 + h**7/336 - h**9/5184 - h**11/19008", "DERIVED"),
    "stability_function radau_iia2": ("(1 + z/3)/(1 - 2*z/3 + z**2/6)", "DERIVED"),
    "limit_at_infinity radau_iia2": ("0", "DERIVED"), "limit_at_infinity rk4": ("oo", "DERIVED"),
    "ssp_coefficient ssprk33": ("1", "DERIVED"), "sector radau_iia2 : degrees": ("90", "DERIVED"),
    "sector radau_iia2 : tan": ("oo", "DERIVED"), "sector rk4 : degrees": ("0", "DERIVED"),
    "simplifying_assumptions gauss2 : B": ("4", "DERIVED"),
    "principal_error rk4 : squared_norm": ("349/1658880", "DERIVED"),
    "modified_hamiltonian symplectic_euler : quadratic.qv": ("-h/2", "DERIVED"),
    "order sdirk_order_2": ("2", "DERIVED"),
    "order sdirk_order_2 at (1/2 + sqrt(3)/6)": ("3", "DERIVED"),
    "order sdirk_order_2 at = 1/4": ("2", "DERIVED"), "a_stable sdirk_order_2": ("[1/4, oo)", "DERIVED"),
    "a_stable sdirk_order_2 at 1/5": ("no", "DERIVED"), "title rk4": ("Classical RK4", "STATED"),
}  # fmt: skip


@pytest.mark.parametrize("question", FACTS)
def test_facts_are_answered_by_name(question):
    found = value(question)
    assert (found.exact_text, found.evidence) == FACTS[question]
    assert found.is_number is (not re.search("[a-zA-Z]", found.exact_text or ""))
