"""Drafted claims hold of the text they are drafted from, and cover what they say."""

import re
import tomllib
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from driftproof.texts.claims.checking import GIVEN, UNCOVERED, WORKED_OUT, check_claims
from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.drafts import drafting
from driftproof.texts.drafts.drafting import draft
from driftproof.texts.readers.document import document_of, read_document
from tests.texts.sample import SPRING, held

TODO = re.compile(r"(?m)^# (?:TODO\n)?(?=\[\[claim|id =|phrase =|count =|given =)|^# TODO\n")


def test_drafted_claims_hold_and_cover_all_once_the_rest_is_given():
    document = read_document(SPRING)
    text = draft(document, "spring.md")
    counts = held(document, text)
    assert counts[WORKED_OUT] > 5
    assert counts[GIVEN] == text.count("the text chooses it")
    assert held(document, TODO.sub("", text))[UNCOVERED] == 0


def test_drafted_claims_notice_a_changed_digit():
    claims = parse_claims(draft(read_document(SPRING), "spring.md"))
    wrong = document_of(SPRING.read_text(encoding="utf-8").replace("5.151", "5.152"), "markdown")
    findings = [finding for outcome in check_claims(wrong, claims.claims) for finding in outcome.findings]
    assert [(finding.expected, finding.found) for finding in findings] == [("5.151", "5.152")]


@pytest.mark.parametrize("method", ["forward Euler", "velocity Verlet"])
def test_a_digit_beside_the_name_of_a_method_is_no_state_of_it(method):
    """No word but the method's names q = 1, which forward Euler has after a step from (1, 0)."""
    for said, times in (("y(0) = 1", 1), ("a ratio of 1", 0)):
        drafted = draft(document_of(f"We run {method} with h = 0.1 and {said}, often.", "markdown"), "a")
        assert 'value = "' not in drafted
        assert drafted.count("the text chooses it") == 1 + times


def test_draft_says_what_was_asked_for_and_is_nowhere_and_its_ids_are_short():
    asked = "run forward_euler rates=(t+y0+0*(t+y0+t+y0+t+y0)) from 0 h=0.2 t={0.4,0.6,1.0} : {y0,state_error}"
    document = document_of("| 0.4 | 0.04 | 0.052 |\n| 0.6 | 0.128 | 0.094 |\n| 1.0 | 0.489 | 0.229 |\n")
    text = draft(document, "a", [asked])
    assert held(document, text)[WORKED_OUT] == 3
    assert 'id = "| {a} | {b}"' in text, "two such questions are too long for an id"
    assert text.rpartition("# Asked for with --ask, but not found in the text:\n")[2].count("t=1.0 : ") == 2
    assert "Asked for" not in draft(document, "a")
    drafted = draft(document, "a", ["run rk4 h={1/4,1/2} t={1,3/4} : q"])
    assert drafted.endswith("\n# Not asked, because h does not divide t: 1, such as run rk4 h=1/2 t=3/4 : q")
    assert drafted.count("#   run rk4 h=") == 3
    drafted = draft(document_of("RK4: 30 steps of 0.2."), "a", ["run rk4 h=0.2 N=30 : {steps,h,evaluations}"])
    assert "the question itself says the value: 2, such as run rk4 h=0.2 N=30 : steps" in drafted
    assert "value =" not in drafted


def test_what_was_asked_for_is_listed_with_the_slips_and_the_guesses_that_may_mean_it():
    asked = ["1.35914", "5/8 + 0.0000000005", "2.5", "64.5 - 1/2", "stability_function rk4", "order rk4", "exp(-9)"]
    drafted = draft(document_of("It is 1.35941 here, 2.5 there\nand 3 elsewhere: 2.5."), "a", asked)
    _, nowhere, guessed = drafted.split("# Asked for with --ask")
    assert "# line 1: 1.35941 is perhaps a slip: 1.35914 is 1.35914\n" in drafted
    listed = ["1.35914; a slip? 1.35941 in line 1", "0.625", "64", "1 + z + z**2/2 + z**3/6 + z**4/24", "4"]
    missing = zip([question for question in asked if question != "2.5"], [*listed, "0.0001234098"], strict=True)
    assert nowhere.splitlines()[1:-1] == [f"#   {question}, {text}" for question, text in missing]
    assert guessed.endswith("\n#   2.5, 2.5; perhaps 2.5 in line 1, 2.5 in line 2")
    assert "#   0.625000005, 0.625\n" in draft(document_of(""), "a", ["0.625000005"]) + "\n", "a tie"


def test_an_asked_value_of_which_no_digit_is_certain_is_listed():
    """The logarithm of the ratio of two equal errors, which are known by enclosures."""
    error = "run heun2 y'=-y, y(0)=1, h=1/4, t=1 : error"
    listed = f"log2(ratio({error}, {error})), whose digits take more bits than a draft does"
    assert draft(document_of("is 7.25"), "a", [f"log2(ratio({error}, {error}))"]).endswith(listed)


def test_an_id_has_80_characters_at_most_and_what_is_nowhere_8_digits():
    for length, shown in ((80, True), (81, False)):
        question = f"0.123457 +{' ' * (length - 11)}0"
        text = draft(document_of("is 0.123457"), "a", [question])
        assert (f'id = "{question}"' in text) is shown
        assert ('id = "is {value}"' in text) is not shown
    assert draft(document_of("7"), "a", ["1/3"]).endswith("#   1/3, 0.33333333")


def test_numbers_of_programs_are_left_out_and_counted_but_for_those_that_are_values():
    program = "```python\nx = 3.75\nq = rk4(1, h=0.5)\nassert q == 337/384  # rk4, one step, or 4.5\n```\n"
    document = document_of(f"{program}\nis 3.75\n", "markdown")
    text = draft(document, "a")
    assert text.endswith("# Left out: numbers in program code, 3 in all; they are inputs, not claims.")
    assert [claim["value"] for claim in tomllib.loads(text)["claim"]] == ["rk4.first_step.q"]
    left = [line for line in text.splitlines() if line.startswith("# phrase")]
    assert left == ['# phrase = "one step, or 4.5"', '# phrase = "is 3.75"']
    assert held(document, text) == {"value": 1, "given": 0, "run": 0, "label": 5, "uncovered": 2}


def test_single_digits_of_programs_are_no_values_though_their_words_stand_around():
    said = "Heun has two stages per step. RK4 uses 16 evaluations in all. The energy of forward Euler grows.\n\n"
    code = "```python\ny = 1.0\nfor n in range(2): y = y * (1 - 0.5 + 0.125)\n```\n"
    drafted = draft(document_of(said + code, "markdown"), "a")
    assert re.findall('value = "(.*)"', drafted) == ["stages heun2"]
    assert drafted.endswith("# Left out: numbers in program code, 5 in all; they are inputs, not claims.")


def test_name_of_the_text_cannot_break_the_draft():
    assert tomllib.loads(draft(document_of("7"), 'a\nb = 1\n"')) == {}


@pytest.mark.parametrize(
    ("energy", "kept"), [("p^2/2 - cos(x)", True), ("p^2/2 + cos(x)", False), ("p^2 - cos(x)", False)]
)
def test_an_energy_that_the_equations_of_its_text_change_is_told(energy, kept):
    problem = "The pendulum is x' = p, p' = -sin(x), x(0) = 1, p(0) = 0, with the energy"
    text = draft(document_of(f"{problem} E = {energy}. With RK4, h = 0.1, until t = 1 it changes by 2.5e-7.\n"), "a")
    told = re.findall(r"# energy=(.+): f does not conserve this energy, which .+ changes by .+; if", text)
    assert told == [energy] * (not kept)


PIECES = ("0.877604", "337/384", "0.5", "40", "2.390", "RK4 ", "energy ", "is ", ". ", *'{}"\\\n(%\x7f√')


@pytest.mark.slow
@given(st.lists(st.sampled_from(PIECES), max_size=15))
@example(pieces=["0.5", "0.5", ". "])
def test_draft_of_any_text_holds_of_it(pieces):
    document = document_of("".join(pieces))
    text = draft(document, "a.txt")
    held(document, text)
    held(document, TODO.sub("", text))


def test_more_claims_than_a_file_may_have_are_not_drafted(monkeypatch):
    monkeypatch.setattr(drafting, "MOST_CLAIMS", 3)
    assert draft(document_of("a 1.5\nb 2.5\nc 3.5"), "a").count("[[claim]]") == 3
    assert draft(document_of("a 1.5\n" * 9), "a").count("[[claim]]") == 1
    with pytest.raises(ValueError, match="claims for more than 3 groups of numbers are not drafted"):
        draft(document_of("a 1.5\nb 2.5\nc 3.5\nd 4.5"), "a")


def test_command_drafts_in_the_format_of_the_text(answer, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.html").write_text("<table><tr><td>RK4<td>0.877604<td>337/384</table>", encoding="utf-8")
    Path("c.toml").write_text(answer("check", "a.html", "--init"), encoding="utf-8")
    assert "100% of 2 numbers covered: 2 by values" in answer("check", "a.html", "--claims", "c.toml")
    asked = "step rk4 lambda=1 h=1/{2..3} : y"
    assert "lambda=1 h=1/3 : y, 1.3955" in answer("check", "a.html", "--init", "--ask", asked)


METHODS_NAMED = """\
θ'' = -sin(θ) with θ(0) = 1.5 and θ'(0) = 0 up to t = 10.
Classical RK4 has an error of 4.52e-6 for h = 0.1, and 3.05e-7 for h = 0.05.
BDF2 is A-stable, and classical RK4 is not symplectic.

| Name | Class | Order | Real limit |
| Classical RK4 | RK4 | 4 | 2.785 |
| Kutta's third-order method | K3 | 3 | 2.513 |
"""


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ("Classical RK4 has", "The 3/8 rule has", "the text names rk38 here, not rk4"),
        ("| Classical RK4 |", "| The 3/8 rule |", "'| Classical RK4 | RK4 | 4 | 2.785' occurs nowhere"),
        (
            "| Kutta's third-order method |",
            "| Ralston's third-order method |",
            'third-order method | K3 | 3 | 2.513" occurs',
        ),
        ("= -sin(θ)", "= -2sin(θ)", "\"θ'' = -sin(θ)\" occurs nowhere"),
        ("BDF2 is A", "BDF3 is A", "expected 2, found 3"),
        ("is not symplectic", "is symplectic", "occurs nowhere in the text"),
    ],
)
def test_a_drafted_claim_holds_the_method_the_equation_and_the_property_that_the_text_names(right, wrong, said):
    document = document_of(METHODS_NAMED, "plain")
    drafted = draft(document, "a")
    held(document, drafted)
    changed = document_of(METHODS_NAMED.replace(right, wrong), "plain")
    found = [finding.message for one in check_claims(changed, parse_claims(drafted).claims) for finding in one.findings]
    assert len(found) >= 1
    assert all(said in message for message in found), found


@pytest.mark.parametrize(
    ("name", "v", "method"),
    [
        ("Verlet", "0.075179", "velocity_verlet"),
        ("Störmer-Verlet (velocity form)", "0.075179", "velocity_verlet"),
        ("Störmer-Verlet in position form", "0.075000", "position_verlet"),
    ],
)
def test_neighbours_are_values_of_one_method_though_its_name_may_mean_two(name, v, method):
    text = f"For x'' = x - x^3, x(0) = 0.5, x'(0) = 0, h = 0.2 one step of {name} gives x = 0.507500 and v = {v}."
    drafted = draft(document_of(text, "plain"), "a")
    assert re.findall(r"ask = \"run (\w+) ", drafted) == [method] * 2


def test_a_property_with_a_number_beside_it_is_a_claim_that_can_be_checked():
    document = document_of("RK4, of order 4, is not symplectic.", "plain")
    assert held(document, drafted := draft(document, "a"))["value"] == 1
    assert 'value = "symplectic rk4"' in drafted


DECAY = """\
For $w' = -2w + 1$, $w(0) = 3$ Heun's method with $h = 0.2$ and then $h = 0.1$ goes to $t = 1$. Take h = {}.

```python
w = 3.0
for n in range(round(1/{})):
    w = heun(w, {})
print(w)
```

```
{}
```
"""


@pytest.mark.parametrize(
    ("said", "in_code", "printed", "slip"),
    [
        ("0.2", "0.1", "0.843620", None),
        ("0.1", "0.2", "0.863483", None),
        ("0.2", "0.2", "0.843620", "0.863483"),
        ("0.1", "0.1", "0.843602", "0.843620"),
    ],
)
def test_what_a_listing_prints_is_of_its_own_step_size(said, in_code, printed, slip):
    drafted = draft(document_of(DECAY.format(said, in_code, in_code, printed), "markdown"), "a")
    assert re.findall(rf"{printed} is perhaps a slip: .* is ([0-9.]+)", drafted) == [slip] * bool(slip)
    assert (f'h={in_code}, t=1 : w"\nplaces = 6' in drafted) is (slip is None)
