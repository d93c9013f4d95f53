"""Names of methods are found in sentences, alone and in lists, and told from words that are none."""

import pytest

from driftproof.texts.words.method_names import (
    begins_with_method,
    last_methods_named,
    methods_asked,
    methods_named,
    name_before,
    names_before,
    starters_said,
    starts_said,
    with_names_settled,
    without_starters,
)


def test_methods_are_named_in_every_way_but_by_the_names_of_people():
    assert methods_named("a verlet method") == {"velocity_verlet", "position_verlet"}
    assert methods_named("velocity\nverlet, and verlet again") == {"velocity_verlet"}
    assert methods_named("by gauss and yoshida") == set()
    assert last_methods_named("", "rk4, then velocity-verlet", "heun") == {"velocity_verlet"}


def test_the_midpoint_of_a_step_and_a_fraction_are_no_methods():
    assert methods_named("whose slope at the midpoint of the step is 3/8") == set()
    assert methods_named("the 3/8 rule") == {"rk38"}
    assert methods_named("explicit midpoint of order 2") == {"midpoint2"}


@pytest.mark.parametrize(
    ("said", "words", "names"),
    [
        ("so euler, heun and rk4 are ", " are ", ["euler", "heun", "rk4"]),
        ("so heun's method is ", " is ", ["heun"]),
        ("heun is good, and rk4 is ", " is ", ["rk4"]),
        ("heun, which is good, is ", " is ", []),
        ("nothing is ", " is ", []),
    ],
)
def test_names_of_a_list_stand_before_what_is_said_of_them(said, words, names):
    assert names_before(said, words) == names
    assert name_before(said, words) == (names[-1] if names else None)


def test_what_starts_a_multistep_method_is_no_method_of_a_run():
    said = "ab2 is started by heun, and rk4 goes on"
    assert methods_named(without_starters(said)) == {"adams_bashforth2", "rk4"}
    assert starters_said("bdf2 starts with the exact solution; the first step of ab3 is one of rk4") == ["rk4", "exact"]
    assert [said[slice(*span)] for span in starts_said(said)] == [said]
    assert methods_asked("run ab2 started=rk4 y'=-y, y(0)=1 : y") == {"adams_bashforth2"}


def test_a_name_that_may_mean_several_is_read_as_the_one_that_is_meant():
    meanings = {frozenset(methods_named("verlet")): frozenset({"velocity_verlet"})}
    assert with_names_settled("verlet and rk4", meanings) == "velocity_verlet and rk4"
    assert begins_with_method("rk4 is")
    assert not begins_with_method("with rk4")
