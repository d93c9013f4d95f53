"""Numbers, lists, names of methods and readouts in a question, and what is said where they are none."""

from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS, keys_of_name
from driftproof.methods.families import FAMILIES
from driftproof.methods.given_methods import subject_of
from driftproof.methods.names import also_known_as
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.questions.parser import parse_question
from tests.looping import exactly, some
from tests.texts.questions.refusals import require_refusal

_ROUNDED = "steps and times are rational, so round pi yourself, as in h=0.01 t=6.28"
REFUSED = [
    ("order sdirk_order_2 at (1", 24, "a bracket is not closed"),
    ("order sdirk_order_2 at sqrt(2)", 24, "expected a number such as 1/4 or 0.25, found 'sqrt'"),
    ("step :", 7, "expected the name of a readout, such as q, after the colon; found the end"),
    ("step rk4 h=1/2/3 : q", 15, "unexpected '/' in a number"),
    ("step rk4 h=1/2x : q", 15, "unexpected 'x' in a number"),
    ("step rk4 h=0,1 : q", 13, "write it with a point: 0.1"),
    ("step rk4 h=-: q", 13, "h: expected a number such as 1/4 or 0.25, found ':'"),
    ("step rk4 h=1/x : q", 13, "unexpected '/' in a number"),
    ("run rk4 y'=-y y(0)=3pi h=1 t=1 : y", 1, "start 3pi: unexpected 'pi'"),
    ("run rk4 y'=-y y(0)=f h=1 t=1 : y", 20, "start: expected a number such as 1/4 or 0.25, found 'f'"),
    ("run rk4 y'=-y y(0)=sqrt(-3) h=1 t=1 : y", 1, "start sqrt(-3): a root of a negative number"),
    ("run rk4 h=1 t=1 from pi,0 : q", 1, "pi: the oscillator starts from rationals; with equations you may say pi"),
    ("run rk4 h=pi/50 N=100 : q", 11, f"expected a number such as 1/4 or 0.25, found 'pi'; {_ROUNDED}"),
    ("run rk4 N=100 t=2*pi : q", 18, f"unexpected '*' in a number; {_ROUNDED}"),
    ("run rk4 N=100 t=2π : q", 18, f"unexpected 'pi' in a number; {_ROUNDED}"),
]


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_what_is_no_piece_of_a_question_is_refused_at_its_column(question, column, reason):
    require_refusal(question, column, reason)


def test_every_title_and_common_name_is_understood_in_a_question():
    """Also with signs in it, as in "Euler-Cromer", with words such as "of order 2", and before what is asked."""
    for key, method in some({**METHODS, **FURTHER_METHODS}.items(), 150):
        for name in {method.title, *also_known_as(key)}:
            query = parse_question(f"1 + step {name}, h=1/2 : q").rest[0][1]
            assert (keys_of_name(query.subject.text), query.settings["h"].value) == ((key,), Q(1, 2))
            assert subject_of(query.subject.text).key == key
            assert keys_of_name(parse_question(f"{name} order").subject.text) == (key,)
    for key, family in exactly(len(FAMILIES), FAMILIES.items()):
        assert subject_of(parse_question(f"order of {family.title} at 1/2").subject.text).key == key


PLAIN_FILES = (
    "m.toml my-m.toml sub/m.toml ./m.toml ../m.toml /tmp/m.toml 2_m.toml a+b.toml 50%.toml m[1].toml méthode.toml"
)
QUOTED_FILES = ("my dir/m.toml", "order of m.toml", "m (1).toml", "a,b.toml", "C:m.toml", "h = 1.toml", "it's.toml")


def test_names_of_files_are_taken_as_they_stand_and_in_quotes_with_any_sign():
    plain = PLAIN_FILES.split()
    for name in exactly(18, (*plain, *QUOTED_FILES)):
        spellings = [f'"{name}"', f"“{name}”", *[f"'{name}'"] * ("'" not in name), *[name] * (name in plain)]
        for spelled in some(spellings, 2):
            query = parse_question(f"2*(run {spelled} problem={spelled}, h=1/2 : v)").rest[0][1]
            assert (query.subject.text, query.problem.text, query.readout.text) == (name, name, "v")
            with_equations = parse_question(f"error of {spelled} with x'=v, v' = -x, x(0)=1, v(0)=0, h=1/2, t=1")
            assert (with_equations.subject.text, with_equations.unknowns) == (name, ("x", "v"))


@pytest.mark.parametrize("name", [name for name in QUOTED_FILES if {*":="}.isdisjoint(name)])
def test_an_unquoted_name_of_a_file_is_refused_with_how_to_quote_it(name):
    for question in (f"order {name}", f"run {name} h=1 t=1 : q", f"run rk4 problem={name} h=1 t=1 : y0"):
        with pytest.raises(
            QuestionError, match=r"a file's name with blanks or signs stands in quotes: 'my method.toml'"
        ):
            value(question)
    with pytest.raises(QuestionError) as other:
        value("run rk4 k=1 problem=m.toml h=1 t=1 : q")
    assert "quotes" not in str(other.value)


def test_numbers_are_ascii_and_exact():
    assert value("0.1 * 10").exact == 1
    for foreign in ("٣", "1²", "½", "１"):
        with pytest.raises(QuestionError, match="is not allowed"):
            value(foreign)


def test_e_is_a_number_in_starts_and_the_base_of_powers_in_equations_unless_it_is_an_unknown():
    run = "run rk4 y'={}, y(0)={}, h=0.1, t=1 : y"
    for said, meant in ((("e^(-t)-y", "e"), ("exp(-t)-y", "exp(1)")), (("y*e**-t", "2*e"), ("y*exp(-t)", "2*exp(1)"))):
        assert value(run.format(*said)).digits(20) == value(run.format(*meant)).digits(20)
    assert value("run forward_euler e'=-e^2, e(0)=1/2, h=1, N=1 : e").exact == Q(1, 4)
