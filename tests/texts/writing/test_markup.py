"""TeX and MathML of exact forms: to the letter, and evaluated back to the number that they are about."""

from contextlib import suppress
from fractions import Fraction as Q
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.decimals import Style
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.writing.markup import MATHML, TEX, decimal_markup, formula, in_any_mode

IN_TEX = {
    "337/384": r"\frac{337}{384}", "-23/48": r"-\frac{23}{48}", "-h/2": r"-\frac{h}{2}", "1 - (-2*h)": "1-(-2 h)",
    "1 - h**6/72 + h**8/576": r"1-\frac{h^{6}}{72}+\frac{h^{8}}{576}",
    "(1 + z/3)/(1 - 2*z/3 + z**2/6)": r"\frac{1+\frac{z}{3}}{1-\frac{2 z}{3}+\frac{z^{2}}{6}}",
    "2*sqrt(2)": r"2 \sqrt{2}", "-2*sqrt(6)/3": r"-\frac{2 \sqrt{6}}{3}",
    "sqrt(3 + 2*sqrt(3))": r"\sqrt{3+2 \sqrt{3}}", "2*3**(1/3)": r"2 \sqrt[3]{3}", "2*3": r"2 \cdot 3",
    "2*3**2": r"2 \cdot 3^{2}", "2*(3*h)": r"2 \cdot 3 h", "2*(3/h)": r"2 \frac{3}{h}", "-sin(10)": r"-\sin(10)",
    "3*cos(1/2)/5": r"\frac{3 \cos\left(\frac{1}{2}\right)}{5}",
    "acos(1 - h)": r"\arccos(1-h)", "1 - (1 - h)": "1-(1-h)", "1 - (-h)": "1-(-h)", "(-h)**2": "(-h)^{2}",
    "(2 - sqrt(2))*h": r"(2-\sqrt{2}) h", "1/2*gamma": r"\frac{\gamma}{2}", "oo": r"\infty",
    "1*1/h": r"\frac{1}{h}", "3**(2/3)": r"3^{\frac{2}{3}}", "2**(1/2)": r"\sqrt{2}",
}  # fmt: skip


@pytest.mark.parametrize("form", IN_TEX)
def test_tex_is_what_an_author_would_write(form):
    assert formula(form, TEX) == IN_TEX[form]


def test_roots_in_mathml_and_digits_in_any_mode():
    roots = "<mn>2</mn><mo>\u2062</mo><msqrt><mn>2</mn></msqrt><mo>\u2062</mo><mroot><mn>3</mn><mn>5</mn></mroot>"
    assert formula("2*sqrt(2)*3**(1/5)", MATHML) == f"<mrow>{roots}</mrow>"
    assert (in_any_mode("5.2"), in_any_mode("-1")) == ("5.2", r"\ensuremath{-1}")


OPERATORS = {"+": "+", "−": "-", "⁢": "*", "·": "*"}


def evaluated(element, names):
    """The number that presentation MathML without functions shows, read from left to right as one reads it."""
    parts = list(element)
    if element.tag == "mn":
        return Q(element.text or "")
    if element.tag == "mi":
        return names[element.text or ""]
    if element.tag in ("mfrac", "msup"):
        first, second = (evaluated(part, names) for part in parts)
        return first / second if element.tag == "mfrac" else first ** int(second)
    assert element.tag in ("math", "mrow"), element.tag
    terms = [part for part in parts if not (part.tag == "mo" and part.text in "()")]
    total, product, signed = Q(0), Q(1), True
    for part in terms:
        if part.tag != "mo":
            product *= evaluated(part, names)
            continue
        operator = OPERATORS[part.text or ""]
        if operator != "*":
            total += 0 if signed and part is terms[0] else product
            product = Q(-1 if operator == "-" else 1)
        signed = False
    return total + product


POLYNOMIALS = st.lists(st.fractions(max_denominator=99), min_size=1, max_size=6)


def written(coefficients):
    terms = [f"({c})*h**{k}" for k, c in enumerate(coefficients)]
    return " - ".join(terms)


@pytest.mark.slow
@given(POLYNOMIALS, POLYNOMIALS, st.fractions(max_denominator=20))
def test_mathml_of_a_rational_function_has_its_value(top, bottom, h):
    def at(coefficients):
        terms = [c * h**k for k, c in enumerate(coefficients)]
        return terms[0] - sum(terms[1:])

    if at(bottom):
        markup = f"<math>{formula(f'({written(top)})/({written(bottom)})', MATHML)}</math>"
        assert evaluated(ElementTree.fromstring(markup), {"h": h}) == at(top) / at(bottom)


@pytest.mark.parametrize("key", ["rk4", "radau_iia2", "sdirk4", "velocity_verlet", "gauss3", "ssprk33"])
@pytest.mark.parametrize("entry", ["M_qq", "M_qv"])
def test_mathml_of_a_matrix_entry_has_the_value_of_the_answer_at_h(key, entry):
    root = ElementTree.fromstring(value(f"one_step_matrix {key} : {entry}").mathml())
    for h in (Q(1, 3), Q(-2)):
        exact = value(f"one_step_matrix {key} h={h} : {entry}").exact
        if "sqrt" not in str(value(f"one_step_matrix {key} : {entry}").exact_text):
            assert evaluated(root, {"h": h}) == exact
            assert evaluated(root, {"h": h + 1}) != exact


def test_mathml_is_well_formed_and_its_fractions_have_two_parts():
    for question in ("exact t=1/2 from 3/5,-2 : q", "imaginary_limit rk4", "title rk4", "rk4.first_step.v", "2**(1/3)"):
        root = ElementTree.fromstring(value(question).mathml())
        for element in root.iter():
            if element.tag in ("mfrac", "msup", "mroot"):
                assert len(element) == 2
    assert ElementTree.fromstring(value("rk4.first_step.v").mathml(digits=3)).find(".//mn").text == "0.479"


def test_decimals_in_tex_and_mathml_have_powers_of_ten():
    assert decimal_markup("-6.7e-5", TEX) == r"-6.7 \cdot 10^{-5}"
    assert decimal_markup("0.479", MATHML) == "<mn>0.479</mn>"
    assert decimal_markup("1.2e30", MATHML) == "<mrow><mn>1.2</mn><mo>·</mo><msup><mn>10</mn><mn>30</mn></msup></mrow>"
    assert value("rk4.first_step.v").tex(digits=3) == "-0.479"
    assert value("-1/8").tex(places=2, style=Style("half-away")) == "-0.13"
    assert value("run rk4 h=1/1000 t=10 : state_error").tex(digits=2) == r"8.3 \cdot 10^{-14}"


def test_number_without_an_exact_form_has_none_in_tex_either():
    for mark_up in ("tex", "mathml"):
        with pytest.raises(QuestionError, match="has no exact form; add digits or places"):
            getattr(value("run rk4 h=1/4 t=10 : state_error"), mark_up)()
    assert value("1/3").tex() != ""


def test_form_that_says_more_than_its_number_is_what_is_written():
    assert Answer("", Q(1, 2), form="cos(0)/2").tex() == r"\frac{\cos(0)}{2}"
    assert Answer("", Q(1, 2)).tex() == r"\frac{1}{2}"


def test_words_are_text_and_hold_their_own_mathematics():
    assert value("a_stable radau_iia2").tex() == r"\text{yes}"
    assert value("a_stable radau_iia2").mathml() == "<math><mtext>yes</mtext></math>"
    assert value("a_stable sdirk_order_2").tex() == r"\text{$[\frac{1}{4}, \infty)$}"
    assert value("family rk4").tex() == r"\text{runge\_kutta}"


def test_exact_form_of_a_number_is_a_question_with_the_same_answer():
    rational = ("rk4.first_step.q", "exact.default.v", "exact t=1/2 from 3/5,-2 : v")
    for question in (*rational, "imaginary_limit rk4", "sqrt(8) + 1", "2**(1/3)", "imaginary_limit merson45"):
        form = value(question).exact_text
        if form is not None:
            assert value(form).digits(40, Style("half-even")) == value(question).digits(40, Style("half-even"))
            assert value(f"{form} + 1").digits(40, Style("half-even")) != value(question).digits(40, Style("half-even"))


@pytest.mark.slow
def test_every_formula_of_the_catalogue_can_be_written():
    formulas = []
    for key in METHODS:
        for question in (f"energy_multiplier {key}", f"invariant {key}", f"one_step_matrix {key} : M_qq"):
            with suppress(QuestionError):  # a fact that the method has not
                found = value(question)
                formulas.append(found)
    assert len(formulas) > 2 * len(METHODS)
    for found in formulas:
        assert found.tex().count("{") == found.tex().count("}")
        ElementTree.fromstring(found.mathml())
