"""What a text says of a method in words is read where it names one, and is compared with the facts."""

import pytest

from driftproof.texts.claims.properties import properties_in, properties_in_items, properties_in_tables


@pytest.mark.parametrize(
    ("text", "question", "answer", "holds"),
    [
        ("So BDF2 is A-stable.", "a_stable bdf2", "yes", True),
        ("BDF3 is A-stable", "a_stable bdf3", "yes", False),
        ("the Crank-Nicolson\nmethod is not\nL-stable", "l_stable trapezoid", "no", True),
        ("Leapfrog is symplectic", "symplectic position_verlet", "yes", True),
        ("Euler's method is A-stable", "a_stable forward_euler", "yes", False),
        ("Heun's is not A-stable", "a_stable heun2", "no", True),
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


def test_a_table_says_yes_or_no_under_the_name_of_a_property():
    text = "| Method | Order | A-stable |\n| RK4 | 4 | yes |\n| BDF2 | 2 | yes |\n| BDF3 | 3 | no |\n| Adams | 3 | - |"
    found = [*properties_in_tables(text)]
    assert [(one.question, one.answer, one.holds) for one in found] == [
        ("a_stable rk4", "yes", False),
        ("a_stable bdf2", "yes", True),
        ("a_stable bdf3", "no", True),
    ]
    assert [one.phrase for one in found][::2] == ["rk4 is a-stable", "bdf3 is not a-stable"]


@pytest.mark.parametrize(
    "text",
    [
        *("It is A-stable", "RK4 is fast", "RK4 is symplectically ill", "RK4 is L", "So RK4 is A-stable?"),
        *("True or false: RK4 is A-stable.", "It is a myth that RK4 is A-stable", "Nobody says that RK4 is A-stable"),
    ],
)
def test_nothing_is_read_into_other_words_questions_and_denials(text):
    assert not [*properties_in(text)]


@pytest.mark.parametrize(
    ("said", "holds"),
    [
        ("Trapezoidal rule: order 2, A-stable but not L-stable.", [True, True]),
        ("Trapezoidal rule: order 2, A-stable and L-stable.", [True, False]),
        ("Trapezoidal rule: L-stable for no step.", []),
        ("Gauss with two stages: symplectic?", []),
    ],
)
def test_an_item_says_the_properties_of_the_method_before_its_colon(said, holds):
    assert [one.holds for one in properties_in_items(f"Methods:\n{said}\nEnd")] == holds
