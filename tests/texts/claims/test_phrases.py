"""A phrase stands where the text says it with the right numbers, and a value is spelled in every way that it can be."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.claims.claims import parse_claims
from driftproof.texts.claims.phrases import NumberForm, Phrase, decimal_spellings, digits_of, form_of, slips, spelled
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import numbers_in
from tests.texts.sample import claim, stands

# phrase, value, a text that says it, texts that do not
STANDS = [
    ("is {value} off", "0.33", "it is\u00a00.33\n  off.", ["it is 0.34 off", "it is 0.331 off", "this is 10.33 off"]),
    ("error {value}", "0.33", "error 0.33, and", ["error 0.331", "error 0.33e-4", "error 0.33×10⁻⁴", "error 0.33/2"]),
    ("error {value}", "0.33", "an error 0.33", ["error 0.33%", "error 0.33 %", "terror 0.33", "error 0.33.1"]),
    (
        "error {value}",
        "0.33",
        "error 0.33 per step",
        [
            f"error 0.33{x}"
            for x in (
                " percent",
                " per cent",
                "\u00a0\u2030",
                " per mille",
                " ppm",
                " million",
                "-0.5",
                "\u20130.5",
                " x 10^-3",
                "*10**-3",
                "·10",
                " × 10⁻³",
                "\npercent",
            )
        ],
    ),
    ("{value} D", "1", "the 1 D case", [f"{x}1 D" for x in ("2 x ", "2·", "2 × ", "minus ", "0.5-", "negative ")]),
    ("in {value}", "1", "in 1-D", []),
    ("from {value}-0.7", "0.5", "from 0.5-0.7", ["from 0.5-0.8", "from 0.5-0.7 %"]),
    ("{value} of", "0.33", "(0.33 of", ["-0.33 of", "1.0.33 of", "10.33 of", "√0.33 of", "^0.33 of"]),
    ("v = {value}", "-0.5", "v = −0.5", ["v = 0.5", "v = - 0.5", "v = −0.55", "v = −0,5"]),
    ("v = {value}", "-0.5", "v = -0.5", ["v = +0.5"]),
    ("{value} steps", "12345678", "12,345,678 steps", ["1,2345,678 steps", "12,345678 steps", "12,34,5678 steps"]),
    ("{value} steps", "123456", "123'456 steps", ["1234'56 steps", "123,'456 steps"]),
    ("in {value} steps", "5651", "in 5,651 steps", ["in 56,51 steps", "in 5651.0 steps", "in 5 651 steps"]),
    ("in {value} steps", "5651", "in 5\u202f651 steps", ["in 5\u202f652 steps"]),
    ("is {value}", "0.75", "is +0.75.", ["is -0.75.", "is 2+0.75.", "is ++0.75."]),
    ("is {value}", "3.3e-4", "is 3.3×10⁻⁴.", ["is 3.3×10⁻³.", "is 3.3×10⁴.", "is 3.3"]),
    ("is {value}", "3.3e-4", "is 3.3e-04", ["is 3.3e-05", "is 3.3e-40", "is 3.3e4"]),
    ("is {value}", "3.3e-4", "is 3.3E-004", ["is 3.3E-0004", "is 3.3E-005"]),
    ("is {value}", "-0.5", "is -.5", ["is .5", "is -1.5", "is -.55"]),
    ("is {value}", "0.5", "is .5", ["is 1.5", "is 0.0.5", "is .55"]),
    ("O(h^{value})", "4", "O(h⁴)", ["O(h⁵)", "O(h⁴⁴)", "O(h4)"]),
    ("Euler{value}-0.054", "0.090", "Euler0.090-0.054", ["Euler0.090-0.055", "Euler0.091-0.054"]),
    ("f{{x}} is {value}", "0.5", "f{x} is 0.5", ["fx is 0.5", "f{{x}} is 0.5", "f{} is 0.5"]),
    ("after {value}", "2", "after 2.", ["after 2.5", "after 2/3", "after 2h", "after 2√2", "after 2²"]),
]


@pytest.mark.parametrize(("phrase", "spelled", "text", "others"), STANDS)
def test_phrase_stands_in_no_text_with_another_number(phrase, spelled, text, others):
    one = claim(phrase, "given = true", spelled)
    assert stands(text, one) == 1
    assert [other for other in others if stands(other, one)] == []


CLAIM = '[[claim]]\nid = "a"\nphrase = "is {value}"\nvalue = "rk4.first_step.q"\n'


@pytest.mark.parametrize(
    ("question", "form", "message"),
    [
        ("rk4.first_step.z", "", "is not the id of a published value"),
        ("step rk4 h=1/0 : q", "", "divides by zero"),
        ("imaginary_limit rk4", "", "does not terminate; add places, digits or exact"),
        ("rk4.first_step.q", "", "the decimal of the value does not terminate"),
        ("imaginary_limit rk4", "spelled = 'words'", "not rational, so it cannot be written in words"),
        ("rk4.first_step.q", "spelled = 'words'", "this number has no usual form in words"),
        ("run rk4 h=1/4 t=10 : state_error", "exact = true", "no exact form"),
        ("run rk4 h=1/4 t=10 : energy", "exact = true", "the exact form has"),
        ("1/2", "places = 0", "choose a rounding"),
        ("__import__('os')", "places = 1", "claim 'a'"),
        ("2**2**2**2**9999999", "places = 1", "claim 'a'"),
    ],
)
def test_value_that_cannot_be_written_so_is_refused_in_one_line(question, form, message):
    (claim,) = parse_claims(CLAIM.replace("rk4.first_step.q", question) + form).claims
    with pytest.raises(ValueError, match=r"\A[^\n]*\Z") as error:
        claim.spellings()
    assert message in str(error.value)
    assert "claim 'a'" in str(error.value)


@pytest.mark.parametrize(
    ("question", "form", "spellings"),
    [
        ("1/2", NumberForm(), ["0.5"]), ("40", NumberForm(), ["40"]), ("1/3125", NumberForm(), ["0.00032"]),
        ("337/384", NumberForm(exact=True), ["337/384"]), ("337/384", NumberForm(places=3), ["0.878"]),
        ("-1/3000", NumberForm(digits=2), ["-0.00033", "-3.3e-4", "-0.33e-3", "-33e-5"]),
        ("5651", NumberForm(digits=2), ["5700", "5.7e3", "0.57e4", "57e2"]),
        ("123456", NumberForm(digits=6), ["123456", "1.23456e5", "0.123456e6", "12.3456e4", "123.456e3", "1234.56e2"]),
        ("1/8", NumberForm(places=2, rounding="half-away"), ["0.13"]),
        ("1/8", NumberForm(places=2, rounding="half-even"), ["0.12"]),
        ("0", NumberForm(digits=3), ["0"]),
        ("imaginary_limit rk4", NumberForm(exact=True), ["2√2", "2*sqrt(2)"]),
        ("imaginary_limit ssprk43", NumberForm(exact=True), ["√(-8 + 4√10)", "sqrt(-8 + 4*sqrt(10))"]),
        ("energy_multiplier rk4", NumberForm(places=3), ["1 - h^6/72 + h^8/576", "1 - h**6/72 + h**8/576"]),
    ],
)  # fmt: skip
def test_value_is_spelled_in_every_way_that_means_the_same(question, form, spellings):
    assert form.spellings(value(question)) == spellings


def test_full_decimals_have_exponents_of_1000_at_most():
    assert [len(decimal_spellings(f"1e{n}")[0]) for n in (1000, -1000, 1001, -1001)] == [1001, 1002, 6, 7]


def test_exact_form_has_400_characters_at_most():
    form = NumberForm(exact=True)
    assert form.spellings(value("1/" + "3" * 398)) == ["1/" + "3" * 398]
    with pytest.raises(ValueError, match="the exact form has 401 characters; add places or digits"):
        form.spellings(value("1/" + "3" * 399))


@given(st.text(max_size=60))
def test_no_phrase_crashes_its_reader(text):
    try:
        phrase = Phrase.of(text)
    except ValueError:
        return
    spellings = {name: ["0.5"] for name in phrase.names}
    written = phrase.written(spellings)
    shape, numbers = phrase.shape(spellings)
    assert len(numbers) == shape.groups
    assert phrase.exact(spellings).fullmatch(written)
    assert not Phrase.of("Of {x}").exact({"x": ["1"]}).fullmatch("of 1")


def test_any_number_may_stand_for_a_value_and_literal_numbers_stay():
    pattern = Phrase.of("after 40 steps {q} and {v} are left").any_numbers()
    found = [pattern.search(f"after {n} steps 0.5 and -1e-3 are left") for n in (40, 41)]
    assert (found[0].groups(), found[1]) == (("0.5", "-1e-3"), None)


def test_a_table_may_print_all_its_numbers_with_one_exponent():
    one = parse_claims("[[claim]]\nid='a'\nphrase='is {value}'\nvalue='113670/1000000'\ndigits=3").claims[0]
    assert [stands(f"is {text}", one) for text in ("11.4×10⁻²", "114e-3", "11.4×10⁻³", "11.5e-2")] == [1, 1, 0, 0]


@pytest.mark.parametrize(
    ("text", "spelling", "form"),
    [
        ("337/384", "337/384", NumberForm(exact=True)),
        ("3.3×10^{-4}", "3.3e-4", NumberForm(digits=2)),
        ("1.5e-03", "1.5e-3", NumberForm(digits=2)),
        ("1.20", "1.20", NumberForm(places=2)),
        (".5", "0.5", NumberForm(places=1)),
        ("1,000", "1000", NumberForm()),
        ("159 %", "159", NumberForm(digits=3)),
    ],
)
def test_a_number_is_spelled_as_values_are(text, spelling, form):
    (number,) = numbers_in(text)
    assert (spelled(number), form_of(number, text)) == (spelling, form)


def test_telling_digits_are_those_before_the_zeros_of_a_round_value():
    assert [digits_of(text) for text in ("0.0120", "1.000", "2.5e-10", "-40")] == ["120", "1000", "25", "40"]
    assert [digits_of(text, telling=True) for text in ("1.000", "4.0", "0.50", "1000", "1.2300")] == [
        *("1", "4", "50", "1000", "123")
    ]


def test_slips_are_another_sign_first_then_neighbours_exchanged_and_each_other_digit():
    first, *others = slips("1.2")
    assert first == "-1.2"
    assert others[0] == "2.1"
    assert {*others} == {"2.1", *(f"{n}.2" for n in range(10)), *(f"1.{n}" for n in range(10))} - {"1.2"}
    assert next(slips("-1.2")) == "1.2"
