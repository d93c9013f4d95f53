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
        ("classical RK4 is symmetric", "symmetric rk4", "yes", False),
    ],
)
def test_a_property_is_a_fact_that_holds_or_not(text, question, answer, holds):
    (found,) = properties_in(text)
    assert (found.question, found.answer, found.holds) == (question, answer, holds)
    assert text.replace("\n", " ")[found.start :].startswith(found.phrase)


@pytest.mark.parametrize(
    "text", ["It is A-stable", "RK4 is fast", "RK4 is A-stable-ish?", "Verner is symplectically", "Rosenbrock is A"]
)
def test_nothing_is_read_into_other_words(text):
    assert [one.question for one in properties_in(text)] in ([], ["a_stable rk4"])
