"""What a text says of a method in words is read where it names one, and is compared with the facts."""

import pytest

from driftproof.texts.claims.properties import properties_in


@pytest.mark.parametrize(
    ("text", "question", "answer", "holds"),
    [
        ("So BDF2 is A-stable.", "a_stable bdf2", "yes", True),
        ("BDF3 is A-stable", "a_stable bdf3", "yes", False),
        ("the Crank-Nicolson\nmethod is not\nL-stable", "l_stable trapezoid", "no", True),
        ("Leapfrog is symplectic", "symplectic position_verlet", "yes", True),
        ("Euler's method is A-stable", "a_stable forward_euler", "yes", False),
        ("Heun's is not A-stable", "a_stable heun2", "no", True),
        ("It is so if R(∞) = 0. Backward Euler is L-stable", "l_stable backward_euler", "yes", True),
        ("classical RK4 is symmetric", "symmetric rk4", "yes", False),
    ],
)
def test_a_property_is_a_fact_that_holds_or_not(text, question, answer, holds):
    (found,) = properties_in(text)
    assert (found.question, found.answer, found.holds) == (question, answer, holds)
    assert text.replace("\n", " ")[found.start :].startswith(found.phrase)


def test_two_properties_of_one_sentence_are_two_facts_and_what_stands_between_commas_none():
    found = [*properties_in("The trapezoidal rule is A-stable but not L-stable. RK4, of order 4, is symplectic.")]
    assert [(one.question, one.answer, one.holds) for one in found] == [
        ("a_stable trapezoid", "yes", True),
        ("l_stable trapezoid", "no", True),
        ("symplectic rk4", "yes", False),
    ]
    assert found[0].phrase == found[1].phrase == "trapezoidal rule is A-stable but not L-stable"


@pytest.mark.parametrize(
    "text",
    [
        *("It is A-stable", "RK4 is fast", "RK4 is symplectically ill", "RK4 is L", "So RK4 is A-stable?"),
        *("True or false: RK4 is A-stable.", "It is a myth that RK4 is A-stable", "Nobody says that RK4 is A-stable"),
    ],
)
def test_nothing_is_read_into_other_words_questions_and_denials(text):
    assert not [*properties_in(text)]
