"""Multistep methods as data: what is refused and in which words, TOML files, names, and who cannot take one."""

import re
from fractions import Fraction as Q

import pytest

from driftproof import METHODS, facts, read_method, value
from driftproof.methods.catalogue import FURTHER_METHODS, entry_named
from driftproof.methods.given_methods import method_of, subject_of
from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.schemes import MethodError
from tests.looping import exactly

SQRT2 = square_root(2)
BDF2 = 'family = "multistep"\nrho = ["1/2", -2, "3/2"]\nsigma = [0, 0, 1]\n'


@pytest.mark.parametrize(
    ("rho", "sigma", "words"),
    [
        ((1,), (1,), "m: rho has 1 entries, sigma 1; both need k + 1 entries for k >= 1 steps, zeros included"),
        ((-1, 1), (1, 0, 0), "m: rho has 2 entries, sigma 3"),
        ((-1, 1, 0), (0, 0, 1), "a new value from F; rho and sigma go from the oldest value to the new one"),
        ((-1, 1), (0, 0), "m: sigma is 0"),
        ((0, -1, 1), (0, 1, 0), "m: rho and sigma both begin with 0; leave these entries out"),
        ((-1, 1.0), (1, 0), "m: rho[1] is 1.0 (float); coefficients are exact: write an int or a Fraction"),
        ("-1 1", (1, 0), "m: rho is '-1 1'; write a tuple of exact coefficients"),
        ((-SQRT2, SQRT2), (1, 0), "m: rho has irrational coefficients; rational ones are needed"),
    ],
)
def test_what_is_no_multistep_method_is_refused(rho, sigma, words):
    with pytest.raises(MethodError, match=re.escape(words)):
        Multistep("m", "m", 0, "", rho, sigma)
    with pytest.raises(MethodError, match="derivative is 3; write 1 for y' = F"):
        Multistep("m", "m", 0, "", (-1, 1), (1, 0), 3)


def test_a_file_of_your_own_is_read_and_refused_in_one_line(write, refusal):
    mine = read_method(write(BDF2))
    assert isinstance(mine, Multistep)
    assert (mine.rho, mine.sigma) == (FURTHER_METHODS["bdf2"].rho, FURTHER_METHODS["bdf2"].sigma)
    assert facts(mine).data["order"] == 2
    assert [FURTHER_METHODS[key].explicit for key in ("adams_bashforth2", "bdf2")] == [True, False]
    for old, new, words in exactly(4, [
        ("[0, 0, 1]", "[0, 1]", "sigma 2; both need k + 1 entries"),
        ('"3/2"', '"sqrt(3)"', "a rational number is needed"),
        ("sigma", "sigmas", "a multistep has no key 'sigmas'"),
        ("rho", "derivative = 3\nrho", "derivative is 3; write a whole number from 1 to 2"),
    ]):  # fmt: skip
        assert words in refusal(BDF2.replace(old, new))


def test_names_lead_to_multistep_methods_and_say_which_are_meant():
    for name, key in exactly(6, {
        "BDF2": "bdf2", "BDF-3": "bdf3", "AB2": "adams_bashforth2", "Numerov": "cowell2", "Adams-Moulton, 3 steps":
        "adams_moulton3", "two-step leapfrog": "two_step_leapfrog",
    }.items()):  # fmt: skip
        assert entry_named(name).key == key
    for name, meant in exactly(3, {"leapfrog": "two_step_leapfrog", "AM2": "trapezoid", "BDF": "bdf6"}.items()):
        with pytest.raises(ValueError, match=rf"may mean .*{meant} \("):
            entry_named(name)
    assert not set(FURTHER_METHODS) & set(METHODS)
    assert [entry_named(name).key for name in ("BDF1", "AB1")] == ["backward_euler", "forward_euler"]
    with pytest.raises(ValueError, match="did you mean bdf6"):
        entry_named("bdf66")


def test_who_needs_a_step_from_one_state_says_so():
    words = "bdf2 is a linear multistep method: .* they need a method whose step takes one state and one f"
    assert subject_of("bdf2") is FURTHER_METHODS["bdf2"]
    with pytest.raises(ValueError, match=words):
        method_of("bdf2")


def test_a_refused_multistep_method_is_shown_how_it_runs(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('family = "multistep"\nrho = [0, -1, 1]\nsigma = ["-1/2", "3/2", 0]\n')
    for name in exactly(2, ("bdf2", str(path))):
        with pytest.raises(
            ValueError, match=r"what gives its first values is named by `driftproof value 'run "
        ) as found:
            method_of(name)
        question = re.search("value '(.*)'`", str(found.value))[1]
        assert name in question
        assert value(question)
    with pytest.raises(ValueError, match=r"one state and one f$"):
        method_of("stormer2")


def test_residuals_of_first_and_second_order_methods_are_named():
    assert Multistep("m", "m", 0, "", (-1, 2), (1, 0)).inconsistencies() == {"rho(1)": Q(1), "rho'(1) - sigma(1)": Q(1)}
    second = Multistep("m", "m", 0, "", (1, -1, 1), (0, 1, 0), 2).inconsistencies()
    assert second == {"rho(1)": Q(1), "rho'(1)": Q(1)}
