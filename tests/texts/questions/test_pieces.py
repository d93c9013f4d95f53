"""Numbers, lists, names of methods and readouts in a question, and what is said where they are none."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS, keys_of_name
from driftproof.methods.names import also_known_as
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.questions.parser import parse_question
from tests.looping import some
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
    ("run rk4 y'=-y y(0)=e h=1 t=1 : y", 20, "start: expected a number such as 1/4 or 0.25, found 'e'"),
    ("run rk4 y'=-y y(0)=sqrt(-3) h=1 t=1 : y", 1, "start sqrt(-3): a root of a negative number"),
    ("run rk4 h=1 t=1 from pi,0 : q", 1, "pi: the oscillator starts from rationals; with equations you may say pi"),
    ("run rk4 h=pi/50 N=100 : q", 11, f"expected a number such as 1/4 or 0.25, found 'pi'; {_ROUNDED}"),
    ("run rk4 N=100 t=2*pi : q", 18, f"unexpected '*' in a number; {_ROUNDED}"),
    ("run rk4 N=100 t=2π : q", 18, f"unexpected 'π' in a number; {_ROUNDED}"),
    ("run rk4 rates=-y0 from 1 h=1 t=1 : y0", 15, "rates are written in brackets, separated by commas"),
]


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_what_is_no_piece_of_a_question_is_refused_at_its_column(question: str, column: int, reason: str) -> None:
    require_refusal(question, column, reason)


def test_every_title_and_common_name_is_understood_in_a_question() -> None:
    """Also those with signs in them, such as "Euler-Cromer" or "Gauss, two stages (Hammer-Hollingsworth)"."""
    for key, method in some(METHODS.items(), 100):
        for name in {method.title, *also_known_as(key)}:
            if "[" in name:  # refused in any question
                continue
            query = parse_question(f"1 + step {name}, h=1/2 : q").rest[0][1]
            assert (keys_of_name(query.subject.text), query.settings["h"].value) == ((key,), Q(1, 2))


def test_numbers_are_ascii_and_exact() -> None:
    assert value("0.1 * 10").exact == 1
    for foreign in ("٣", "1²", "½", "１"):
        with pytest.raises(QuestionError, match="is not allowed"):
            value(foreign)
