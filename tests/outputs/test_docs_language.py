"""The page of the language is true: its answers are as they stand there, its grammar is the parser's."""

import re
from pathlib import Path

from docs.language_tables import TABLES, questions_of
from docs.pages import refreshed
from driftproof.methods.formulas import expression_tree
from driftproof.texts.questions import parser
from driftproof.texts.questions.arithmetic import NUMBER_FUNCTIONS
from driftproof.texts.questions.decimals import ROUNDING_POLICIES
from driftproof.texts.questions.runs import RUN_READOUTS, UNITS

PAGE = (Path(__file__).parents[2] / "docs" / "language.md").read_text(encoding="utf-8")


def test_page_is_what_its_generator_writes_and_wrong_answers_are_put_right():
    wrong = PAGE
    for shown in ("exactly 337/384", "−0.053697", "3.99999832274553"):
        assert shown in PAGE
        wrong = wrong.replace(shown, f"{shown}1")
    assert refreshed(wrong, TABLES) == PAGE, "run `make docs`"


def test_page_names_every_function_readout_unit_and_policy():
    for name in (*NUMBER_FUNCTIONS, *RUN_READOUTS, *ROUNDING_POLICIES, *UNITS):
        assert re.search(rf"\b{re.escape(name)}\b", PAGE), name


RULE = re.compile(r"^ *(\w+) += (.*)$", re.MULTILINE)


def test_page_shows_the_grammar_of_expressions_with_the_queries_that_extend_it():
    on_page = dict(RULE.findall(PAGE.partition("## Grammar")[2]))
    expressions, queries = (dict(RULE.findall(str(module.__doc__))) for module in (expression_tree, parser))
    assert set(queries) == {"query", "part", "start", "entry", "rates", "equation", "literal", "value"}
    extended = expressions["atom"].replace(' | "(" sum', ' | query | "(" sum')
    assert on_page == {**expressions, **queries, "atom": extended, "value": on_page["value"]}
    assert len(on_page) == 14


def test_every_kind_of_question_has_examples():
    assert set(re.findall(r"<!-- table: (\w+) -->", PAGE)) == set(TABLES)
    assert all(len(questions_of(name)) >= 4 for name in TABLES)


def test_a_question_that_is_answered_after_all_is_no_refusal():
    assert TABLES["refusals"]([["`1/3`", ""]])[1][1].startswith("not refused")
