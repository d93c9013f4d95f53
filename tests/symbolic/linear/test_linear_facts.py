"""Facts of single methods as printed, two formulas for R, and the shape of the JSON."""

from __future__ import annotations

from typing import Any

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta, Splitting
from driftproof.symbolic.linear.facts import LinearFacts
from driftproof.symbolic.linear.oscillator import one_step_matrix
from driftproof.symbolic.linear.stability_function import (
    stability_function_by_determinants,
    stability_function_by_moments,
)
from driftproof.symbolic.linear.tableaux import tableau
from tests.symbolic.linear.linear_examples import record_text

WITH_R = [key for key, method in METHODS.items() if isinstance(method, RungeKutta | Collocation)]


def test_only_what_is_asked_for_is_computed() -> None:
    facts = LinearFacts(METHODS["rk4"])
    assert facts.value("stability_function") == {"num": ["1", "1", "1/2", "1/6", "1/24"], "den": ["1"]}
    assert set(vars(facts)) == {"method", "terms", "stability_function"}
    with pytest.raises(KeyError):
        facts.value("colour")


@pytest.mark.parametrize("key", WITH_R)
def test_two_formulas_for_r(key: str) -> None:
    data = tableau(METHODS[key])
    found = LinearFacts(METHODS[key]).stability_function
    assert stability_function_by_moments(data) == found
    if not isinstance(METHODS[key], RungeKutta) or METHODS[key].stages < 20:
        assert stability_function_by_determinants(data) == found


# (key, fact): value, as printed in the sources, or derived in them.
PUBLISHED: dict[tuple[str, str], str] = {
    ("rk4", "imaginary_limit"): "2*sqrt(2)",
    ("kutta3", "imaginary_limit"): "sqrt(3)",
    ("ssprk33", "imaginary_limit"): "sqrt(3)",
    ("chebyshev10_1", "real_limit"): "200",
    ("ssprk40_2", "real_limit"): "78",
    ("heun2", "imaginary_limit"): "0",
    ("ssprk22", "ssp_coefficient"): "1",
    ("ssprk33", "ssp_coefficient"): "1",
    ("ssprk43", "ssp_coefficient"): "2",
    ("ssprk104", "ssp_coefficient"): "6",
    ("ssprk40_2", "ssp_coefficient"): "39",
    ("rk4", "ssp_coefficient"): "0",
    ("velocity_verlet", "imaginary_limit"): "2",
    ("symplectic_euler", "imaginary_limit"): "2",
    ("backward_euler", "real_limit"): "oo",
    ("backward_euler", "imaginary_limit"): "oo",
    ("gauss2", "imaginary_limit"): "oo",
    ("bogacki_shampine32", "imaginary_limit"): "sqrt(3)",
    ("merson45", "imaginary_limit"): "2*sqrt(3)",
}
# Two to five digits as papers print them.
PRINTED: dict[tuple[str, str], str] = {
    ("rk4", "real_limit"): "2.785",
    ("kutta3", "real_limit"): "2.512",
    ("dormand_prince54", "real_limit"): "3.306",
    ("fehlberg45", "real_limit"): "3.02",
    ("ssprk104", "real_limit"): "13.91",
    ("forest_ruth", "imaginary_limit"): "1.573",
    ("pefrl", "imaginary_limit"): "2.98",
}


@pytest.mark.parametrize("where", PUBLISHED)
def test_published_exact_value(where: tuple[str, str]) -> None:
    key, fact = where
    assert record_text(LinearFacts(METHODS[key]).value(fact)) == PUBLISHED[where]


@pytest.mark.parametrize("where", PRINTED)
def test_printed_digits(where: tuple[str, str]) -> None:
    key, fact = where
    assert LinearFacts(METHODS[key]).value(fact)["decimal"].startswith(PRINTED[where])


A_AND_L = {
    "gauss": (True, False),
    "radau_ia": (True, True),
    "radau_iia": (True, True),
    "lobatto_iiia": (True, False),
    "lobatto_iiib": (True, False),
    "lobatto_iiic": (True, True),
    "sdirk2": (True, True),
    "sdirk4": (True, True),
    "alexander3": (True, True),
    "crouzeix": (True, False),
    "tr_bdf2": (True, True),
    "trapezoid": (True, False),
    "backward_euler": (True, True),
}


@pytest.mark.parametrize("key", WITH_R)
def test_stability_of_the_classical_families(key: str) -> None:
    facts = LinearFacts(METHODS[key])
    found = (facts.value("a_stable"), facts.value("l_stable"))
    family = next((name for name in A_AND_L if key.startswith(name)), None)
    if family:
        assert found == A_AND_L[family]
        assert facts.value("sector")["degrees"] == "90"
    elif facts.stability_function is not None and facts.stability_function.den.degree() < 1:
        assert found == (False, False)


# ---- the shape of the JSON


def test_facts_of_rk4_are_those_of_the_design() -> None:
    facts = LinearFacts(METHODS["rk4"])
    wanted: dict[str, Any] = {
        "energy_multiplier": {"num": ["1", "0", "0", "-1/72", "1/576"], "den": ["1"]},
        "a_stable": False,
        "l_stable": False,
        "symplectic": False,
        "error_constant": {"power": 5, "coefficient": "-1/120"},
        "dispersion": {"power": 5, "coefficient": "-1/120"},
        "dissipation": {"power": 6, "coefficient": "-1/144"},
        "invariant": None,
        "linear_order": 4,
        "limit_at_infinity": "oo",
    }
    assert {name: facts.value(name) for name in wanted} == wanted


def test_facts_of_symplectic_euler_are_those_of_the_design() -> None:
    facts = LinearFacts(METHODS["symplectic_euler"])
    wanted: dict[str, Any] = {
        "stability_function": None,
        "real_limit": None,
        "a_stable": None,
        "a_stability": None,
        "sector": None,
        "limit_at_infinity": None,
        "modified_rate": None,
        "ssp_coefficient": None,
        "error_constant": None,
        "energy_multiplier": None,
        "invariant": {"q2": "1/2", "qv": "-h/2", "v2": "1/2"},
        "determinant": {"num": ["1"], "den": ["1"]},
        "dissipation": None,
        "dispersion": {"power": 3, "coefficient": "1/24"},
        "symplectic": True,
        "symmetric": False,
        "linearly_symmetric": False,
    }
    assert {name: facts.value(name) for name in wanted} == wanted


def test_a_refusal_names_a_witness() -> None:
    found = LinearFacts(METHODS["rk4"]).value("a_stability")
    assert found["margin"] == ["0", "0", "0", "1/72", "-1/576"]
    assert found["witness"] == "9"
    assert not found["holds"]


def test_modified_hamiltonian_of_symplectic_euler_as_text() -> None:
    found = LinearFacts(METHODS["symplectic_euler"], terms=5).value("modified_hamiltonian")
    assert found["factor"] == "acos(1 - h**2/2)/sqrt(1 - (1 - h**2/2)**2)"
    assert found["quadratic"] == {"q2": "1/2", "qv": "-h/2", "v2": "1/2"}
    assert found["factor_series"] == ["1", "0", "1/6", "0", "1/30"]
    assert found["valid_limit"]["exact"] == "2"


def test_splittings_without_r_have_the_same_keys() -> None:
    assert isinstance(METHODS["velocity_verlet"], Splitting)
    assert len(one_step_matrix(METHODS["velocity_verlet"])) == 2
