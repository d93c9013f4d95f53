"""A claims file is read, and whatever is wrong with it is told in one line."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.claims.claims import parse_claims

CLAIM = '[[claim]]\nid = "a"\nphrase = "is {value}"\nvalue = "rk4.first_step.q"\n'


def test_claims_file_says_phrases_values_forms_and_labels():
    claims = parse_claims(
        """
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
        [[label]]
        phrase = "{n} min"
        why = "time"
        """
    )
    (claim,) = claims.claims
    assert (claims.form, claims.coverage, claim.count, claim.given) == ("tex", Fraction(39, 40), 2, "why")
    assert claim.spellings() == {"t": ["10"], "q": ["0.878"], "v": ["-23/48"]}
    assert claim.phrase.written(claim.spellings()) == "at 10: (0.878, -23/48) of 5"
    assert claims.labels[0].why == "time"


def test_reason_of_what_is_given_has_200_characters_at_most():
    with_reason = "{}given = '{}'".format
    assert parse_claims(with_reason(CLAIM, "x" * 200)).claims[0].given == "x" * 200
    assert parse_claims(f"{CLAIM}given = true").claims[0].given == "given"
    with pytest.raises(ValueError, match="given is true, or a short reason why"):
        parse_claims(with_reason(CLAIM, "x" * 201))


def test_limits_are_within_what_is_read():
    text = CLAIM.replace('"rk4.first_step.q"', f"{{given = '{'1' * 200}'}}")
    (given,) = parse_claims(f"{text}\ncount = 10000\n[text]\ncoverage = '100%'").claims
    assert (given.spellings(), given.count) == ({"value": ["1" * 200]}, 10_000)
    names = "".join(f"{{n{i}}}" for i in range(20))
    label = parse_claims(f"[[label]]\nphrase = '{names}'\nwhy = '{'x' * 200}'")
    assert (len(label.labels[0].why), label.coverage) == (200, 0)


BAD = [
    ("x = 1", "the file has no key 'x'; its keys are text, claim, label"),
    ("claim = 1", "claim is 1; write a list"),
    ("[claim]\nid = 'a'", "claim is {'id': 'a'}; write a list"),
    ("[[claim]]\nphrase = 'a'", "id of claim 1 is missing; write a line of text of 1 to 200 characters"),
    ("text.x = 1", "text has no key 'x'"), ("[[label]]\nphrase = '{n}'\nwhy = 'a'\nx = 1", "a label has no key 'x'"),
    (CLAIM.replace('"rk4.first_step.q"', "{ask = '1', x = 1}"), "a value has no key 'x'; its keys are ask, given"),
    (CLAIM + CLAIM, "two claims have the id 'a'"), (CLAIM + "plases = 3", "a claim has no key 'plases'"),
    (CLAIM + "places = 3\ndigits = 4", "it has places and digits; give only one of them"),
    (CLAIM + "places = 1000000000", "places is 1000000000; write a whole number from 0 to 1000"),
    (CLAIM + "digits = 0", "digits is 0; write a whole number from 1 to 1000"),
    (CLAIM + "places = true", "places is True; write a whole number"),
    (CLAIM + "places = 2.5", "places is '2.5'; write a whole number"),
    (CLAIM + "count = -1", "count is -1; write a whole number from 0"),
    (CLAIM + "count = 10001", "count is 10001; write a whole number from 0 to 10000"),
    (CLAIM + "given = ''", "given is true, or a short reason why"),
    (CLAIM.replace('"rk4.first_step.q"', "{ask = 3}"), "a question is a string"),
    (CLAIM.replace('"rk4.first_step.q"', f"{{given = '{'1' * 201}'}}"), "given is one number"),
    (f"[[claim]]\nid = 'a'\nphrase = 'is 5'\nvalues.{'v' * 41} = '1'", f"values defines '{'v' * 40}', which"),
    ("claim = [1]", "claim is a list of tables; begin each with [[claim]]"),
    ("[[label]]\nphrase = '{n}'\nwhy = ''", "label 1: why is a short text"),
    (f"[[label]]\nphrase = '{{n}}'\nwhy = '{'x' * 201}'", "label 1: why is a short text"),
    ("[text]\ncoverage = '100.001%'", "coverage of text is a percentage"),
    (CLAIM + "rounding = 'up'", "rounding is 'up'; write 'half-even' or"),
    (CLAIM + "exact = 1", "exact is 1; write true or false"),
    (CLAIM + "values = {}", "both value and values"),
    (CLAIM.replace("is {value}", "is {value} of 5"), "the number 5 of its phrase is not a placeholder"),
    (CLAIM.replace("is {value}", "is {value"), "unpaired '{'"),
    (CLAIM.replace("is {value}", "{value} {value}"), "the placeholder {value} occurs twice"),
    (CLAIM.replace("is {value}", "is").replace("value =", "values.value ="), "values defines 'value', which is not a"),
    (CLAIM + "answer = 'no'", "answer is for a phrase without a placeholder, with a question as its value"),
    (CLAIM + "method = 'Euler'", "method is the key of a method that the text names where the value stands, or one"),
    (CLAIM + "row = ''", "row"), (CLAIM + "column = 1", "column"),
    (CLAIM + "column = ['h', 'k']", "column is the head of a column of a table, or a"),
    (CLAIM + "column = [1]", "column"),
    (CLAIM + "method = 1", "method is the key of a"), (CLAIM + "method = ['rk4', 'rk4']", "method is the key of a"),
    ("[[claim]]\nid = 'a'\nphrase = 'of RK4'\ngiven = true\nmethod = 'rk4'", "method is the key of a method"),
    (CLAIM.replace("is {value}", "is {other}"), "has the placeholder {other}, which neither value nor values defines"),
    (CLAIM.replace("is {value}", "x" * 401), "it has 401 characters; at most 400"),
    (CLAIM.replace("is {value}", "".join(f"{{a{i}}} " for i in range(21))), "more than 20 values"),
    (CLAIM.replace("is {value}", " "), "phrase: it is empty"),
    (CLAIM.replace('"rk4.first_step.q"', "3"), "a value is a question"),
    (CLAIM.replace('"rk4.first_step.q"', "{given = 'x'}"), "given is one number"),
    (
        CLAIM.replace('"rk4.first_step.q"', "{given = '1', places = 2}"),
        "given is one number in quotes, as the text writes it, without places, digits or exact",
    ),
    ("[[claim]]\nid = 'a'\nphrase = 'no number'", "its phrase contains no number"),
    ("[[label]]\nphrase = '{n}'", "label 1: why is a short text"),
    ("[text]\nformat = 'word'", "format of text is 'word'; write 'plain' or 'markdown'"),
    ("[text]\ncoverage = '101%'", "coverage of text is a percentage"),
    ("[text]\ncoverage = 0.5", "coverage of text is a percentage"),
    ("a = " + "[" * 100_000, "nested too deep"), ("a = " + "{a=" * 100_000, "nested too deep"),
    ("a" + ".a" * 500_000 + " = 1", "dots in one line"),
    ("x = ", "Invalid value"),
    ("[[claim]]\n" * 5001, "claim has 5001 entries; at most 5000 are allowed"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), BAD, ids=range(len(BAD)))
def test_bad_claims_file_is_refused_in_one_line(text, message):
    with pytest.raises(ValueError, match=r"\A[^\n]*\Z") as error:
        parse_claims(text)
    assert message in str(error.value)
    assert len(str(error.value)) < 300


KEYS = [
    "id",
    "phrase",
    "value",
    "values",
    "places",
    "digits",
    "exact",
    "count",
    "given",
    "rounding",
    "answer",
    "method",
]
ENTRIES = ['"a {value}"', '"{"', "1", "-1", "true", "{}", "[]", "0.5", "{value = 'x'}", "[[1]]", '""']
ENTRY = st.builds("{} = {}".format, st.sampled_from(KEYS), st.sampled_from(ENTRIES))


@given(
    st.text(alphabet="[]{}=\"'\n.,#claimphrase id value 0123456789", max_size=80)
    | st.lists(ENTRY).map(lambda entries: "\n".join(["[[claim]]", *entries]))
)
def test_no_text_and_no_claim_crashes_the_reader_of_claims(text):
    try:
        parse_claims(text)
    except ValueError as error:
        complaint = str(error)
    else:
        return
    assert complaint
    assert "\n" not in complaint
