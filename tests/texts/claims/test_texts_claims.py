"""A claims file says what it means or is refused in one line, however it was meant to hurt."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.claims.phrases import NumberForm, Phrase

CLAIM = '[[claim]]\nid = "a"\nphrase = "is {value}"\nvalue = "rk4.first_step.q"\n'


def test_claims_file_says_phrases_values_forms_and_labels() -> None:
    claims = parse_claims(
        b"""
        [text]
        format = "tex"
        coverage = "97.5%"
        [[claim]]
        id = "one"
        phrase = "at {t}: ({q}, {v}) of 5"
        values = { t = { given = "10" }, q = "rk4.first_step.q", v = { ask = "rk4.first_step.v", exact = true } }
        places = 3
        rounding = "half-away"
        count = 2
        given = "why"
        ignore_case = true
        [[label]]
        phrase = "{n} min"
        why = "time"
        """
    )
    (claim,) = claims.claims
    assert (claims.form, claims.coverage, claim.count, claim.given) == ("tex", Fraction(39, 40), 2, "why")
    assert claim.spellings() == {"t": ["10"], "q": ["0.878"], "v": ["-23/48"]}
    assert claim.phrase.written(claim.spellings()) == "at 10: (0.878, -23/48) of 5"
    assert claim.ignore_case
    assert claims.labels[0].why == "time"


BAD = [
    ("x = 1", "the file has no key 'x'; there are text, claim, label"),
    ("claim = 1", "claim is 1; write a list"),
    ("[claim]\nid = 'a'", "claim is {'id': 'a'}; write a list"),
    ("[[claim]]\nphrase = 'a'", "id of claim 1 is missing; write a line of text of 1 to 200 characters"),
    (CLAIM + CLAIM, "claim 'a' stands in it twice"),
    (CLAIM + "plases = 3", "a claim has no key 'plases'"),
    (CLAIM + "places = 3\ndigits = 4", "it says places and digits; one of them is enough"),
    (CLAIM + "places = 1000000000", "places is 1000000000; write a whole number from 0 to 1000"),
    (CLAIM + "digits = 0", "digits is 0; write a whole number from 1 to 1000"),
    (CLAIM + "places = true", "places is True; write a whole number"),
    (CLAIM + "places = 2.5", "places is '2.5'; write a whole number"),
    (CLAIM + "count = -1", "count is -1; write a whole number from 0"),
    (CLAIM + "rounding = 'up'", "rounding is 'up'; write 'half-even' or"),
    (CLAIM + "exact = 1", "exact is 1; write true or false"),
    (CLAIM + "values = {}", "both value and values"),
    (CLAIM.replace("is {value}", "is {value} of 5"), "the number 5 of its phrase is no value"),
    (CLAIM.replace("is {value}", "is {value"), "'{' stands alone"),
    (CLAIM.replace("is {value}", "{value} {value}"), "{value} stands in it twice"),
    (CLAIM.replace("is {value}", "is"), "its values name 'value', which its phrase does not hold"),
    (CLAIM.replace("is {value}", "is {other}"), "holds {other}, and nothing says what that is"),
    (CLAIM.replace("is {value}", "x" * 401), "it has 401 characters; at most 400"),
    (CLAIM.replace("is {value}", "".join(f"{{a{i}}} " for i in range(21))), "more than 20 values"),
    (CLAIM.replace("is {value}", " "), "phrase: it is empty"),
    (CLAIM.replace('"rk4.first_step.q"', "3"), "a value is a question"),
    (CLAIM.replace('"rk4.first_step.q"', "{given = 'x'}"), "given is one number"),
    (CLAIM.replace('"rk4.first_step.q"', "{given = '1', places = 2}"), "has no form"),
    ("[[claim]]\nid = 'a'\nphrase = 'no number'", "its phrase holds no number"),
    ("[[label]]\nphrase = '{n}'", "label 1: why says"),
    ("[text]\nformat = 'word'", "format of text is 'word'; write 'plain' or 'markdown'"),
    ("[text]\ncoverage = '101%'", "coverage of text is a percentage"),
    ("[text]\ncoverage = 0.5", "coverage of text is a percentage"),
    ("a = " + "[" * 100_000, "nested too deep"),
    ("a = " + "{a=" * 100_000, "nested too deep"),
    ("a" + ".a" * 500_000 + " = 1", "dots in one line"),
    ("#" * (2**20 + 1), "too large; at most 1048576 bytes are read"),
    ("x = ", "Invalid value"),
    ("[[claim]]\n" * 5001, "claim has 5001 entries; at most 5000 are read"),
]


@pytest.mark.parametrize(("text", "message"), BAD, ids=range(len(BAD)))
def test_bad_claims_file_is_refused_in_one_line(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=r"\A[^\n]*\Z") as error:
        parse_claims(text.encode())
    assert message in str(error.value)
    assert len(str(error.value)) < 300


@pytest.mark.parametrize(
    ("question", "form", "message"),
    [
        ("rk4.first_step.z", "", "is no id of a published value"),
        ("step rk4 h=1/0 : q", "", "divides by zero"),
        ("imaginary_limit rk4", "", "no decimal that ends; say places, digits or exact"),
        ("rk4.first_step.q", "", "no decimal that ends"),
        ("run rk4 h=1/4 t=10 : state_error", "exact = true", "no exact form"),
        ("run rk4 h=1/4 t=10 : energy", "exact = true", "the exact form has"),
        ("1/2", "places = 0", "name a rounding"),
        ("__import__('os')", "places = 1", "claim 'a'"),
        ("2**2**2**2**9999999", "places = 1", "claim 'a'"),
    ],
)
def test_value_that_cannot_be_written_so_is_refused_in_one_line(question: str, form: str, message: str) -> None:
    (claim,) = parse_claims((CLAIM.replace("rk4.first_step.q", question) + form).encode()).claims
    with pytest.raises(ValueError, match=r"\A[^\n]*\Z") as error:
        claim.spellings()
    assert message in str(error.value)
    assert "claim 'a'" in str(error.value)


@pytest.mark.parametrize(
    ("question", "form", "spellings"),
    [
        ("1/2", NumberForm(), ["0.5"]),
        ("40", NumberForm(), ["40"]),
        ("337/384", NumberForm(exact=True), ["337/384"]),
        ("337/384", NumberForm(places=3), ["0.878"]),
        ("-1/3000", NumberForm(digits=2), ["-0.00033", "-3.3e-4"]),
        ("5651", NumberForm(digits=2), ["5700", "5.7e3"]),
        ("1/8", NumberForm(places=2, rounding="half-away"), ["0.13"]),
        ("1/8", NumberForm(places=2, rounding="half-even"), ["0.12"]),
        ("0", NumberForm(digits=3), ["0"]),
        ("imaginary_limit rk4", NumberForm(exact=True), ["2√2", "2*sqrt(2)"]),
        ("energy_multiplier rk4", NumberForm(places=3), ["1 - h^6/72 + h^8/576", "1 - h**6/72 + h**8/576"]),
    ],
)
def test_value_is_spelled_in_every_way_that_means_the_same(
    question: str, form: NumberForm, spellings: list[str]
) -> None:
    from driftproof.texts.questions.evaluate import value

    assert form.spellings(value(question)) == spellings


@given(st.text(alphabet="[]{}=\"'\n.,#claimphrase id value 0123456789", max_size=80))
def test_no_text_crashes_the_reader_of_claims(text: str) -> None:
    held(text)


@given(
    st.dictionaries(
        st.sampled_from(["id", "phrase", "value", "values", "places", "digits", "exact", "count", "given", "rounding"]),
        st.sampled_from(['"a {value}"', '"{"', "1", "-1", "true", "{}", "[]", "0.5", "{value = 'x'}", "[[1]]", '""']),
    )
)
def test_no_claim_crashes_the_reader_of_claims(claim: dict[str, str]) -> None:
    held("[[claim]]\n" + "\n".join(f"{key} = {value}" for key, value in claim.items()))


@given(st.text(max_size=60))
def test_no_phrase_crashes_its_reader(text: str) -> None:
    try:
        phrase = Phrase.of(text)
    except ValueError:
        return
    spellings = {name: ["0.5"] for name in phrase.names}
    written = phrase.written(spellings)
    assert len(phrase.numbers(spellings)) == phrase.shape(spellings).groups
    assert phrase.exact(spellings).fullmatch(written)


def held(text: str) -> None:
    try:
        parse_claims(text.encode())
    except ValueError as error:
        complaint = str(error)
    else:
        return
    assert complaint
    assert "\n" not in complaint
