"""What people call the methods: every name leads to its method, an ambiguous one to the choice."""

import pytest

from driftproof import FAMILIES, METHODS
from driftproof.methods.catalogue import FURTHER_METHODS, entry_named, names_listed
from driftproof.methods.given_methods import methods_of, subject_of
from driftproof.methods.names import EASILY_CONFUSED, also_known_as, keys_called, plain_name
from tests.looping import some

# As in textbooks, libraries and encyclopedias, spelled as there.
SAID = {
    "Euler": "forward_euler", "explicit Euler": "forward_euler", "Euler's method": "forward_euler",
    "Semi-implicit Euler method": "symplectic_euler", "Euler–Cromer": "symplectic_euler",
    "RK4": "rk4", "the classical Runge-Kutta method": "rk4", "Heun's method": "heun2", "Improved Euler": "heun2",
    "RK45": "dormand_prince54", "DOPRI5": "dormand_prince54", "dormand-prince": "dormand_prince54",
    "ode45": "dormand_prince54", "RKF45": "fehlberg45", "Cash–Karp": "cash_karp54", "Crank–Nicolson": "trapezoid",
    "Tsit5": "tsitouras54", "BS3": "bogacki_shampine32", "RK23": "bogacki_shampine32", "Radau": "radau_iia3",
    "implicit Euler": "backward_euler", "explicit midpoint": "midpoint2", "TR-BDF2": "tr_bdf2",
    "Kutta's 3/8 rule": "rk38", "Velocity Verlet": "velocity_verlet", "velocity-verlet": "velocity_verlet",
    "two-stage Gauss-Legendre": "gauss2", "SSPRK(3,3), Shu-Osher": "ssprk33", "DOP853": "dop853",
    "Gauss with two stages": "gauss2", "two-stage Radau IIA": "radau_iia2", "Radau IIA with 3 stages": "radau_iia3",
    "4th-order Runge-Kutta": "rk4", "Heun's 2nd-order method": "heun2",
    "yoshida4_position_first": "forest_ruth",
}  # fmt: skip


@pytest.mark.parametrize(("name", "key"), SAID.items())
def test_a_name_leads_to_its_method(name, key):
    assert entry_named(name).key == key


@pytest.mark.parametrize(
    "name",
    [
        "Verlet",
        "leapfrog",
        "Störmer–Verlet",
        "midpoint",
        "Yoshida",
        "RK2",
        "modified Euler",
        "RadauIIA5",
        "Störmer",
        "Yoshida 4",
    ],
)
def test_an_ambiguous_name_lists_what_it_may_mean(name):
    with pytest.raises(ValueError, match=r"may mean .* or ") as caught:
        entry_named(name)
    assert all(f"{key} (" in str(caught.value) for key in some(keys_called(name)))


def test_every_title_and_every_key_leads_to_its_method():
    for key, method in some(METHODS.items()):
        assert entry_named(method.title) is entry_named(key) is method
        assert entry_named(key.replace("_", "-").upper()) is method  # though RadauIIA5 is ambiguous


def test_titles_may_stand_in_a_list_with_their_commas():
    for method in some((*METHODS.values(), *FURTHER_METHODS.values())):
        assert names_listed(f"rk4,{method.title}, Heun,pefrl") == ["rk4", method.title, "Heun", "pefrl"]
    assert names_listed("PEFRL, rk4") == ["PEFRL", "rk4"]
    assert names_listed("rk4,,a b.toml") == ["rk4", "", "a b.toml"]
    assert [each.key for each in methods_of("Radau IIA, two stages,Heun")] == ["radau_iia2", "heun2"]


@pytest.mark.parametrize("key", FAMILIES)
def test_the_title_of_a_family_leads_to_it(key):
    assert subject_of(FAMILIES[key].title.lower()) is subject_of(key.upper()) is FAMILIES[key]


def test_names_are_unique_and_of_methods_that_exist():
    for key in some((*METHODS, *FURTHER_METHODS)):
        assert all(keys_called(name) == (key,) for name in also_known_as(key))
        assert all(other in (*METHODS, *FURTHER_METHODS) and other != key for other in EASILY_CONFUSED.get(key, ()))
    titles = [plain_name(method.title) for method in (*METHODS.values(), *FURTHER_METHODS.values())]
    assert len(set(titles)) == len(titles)


@pytest.mark.parametrize("name", ["", "Laplace", "!!", "rk", "verlet2000"])
def test_a_name_that_nobody_uses_is_refused(name):
    with pytest.raises(ValueError, match="unknown method"):
        entry_named(name)
