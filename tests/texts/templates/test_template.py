"""What is wrong with a template is one line with file, line and column."""

import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.questions.answer import Answer
from driftproof.texts.templates import template as module
from driftproof.texts.templates.sandbox import TemplateProblem
from driftproof.texts.templates.template import Template
from driftproof.texts.templates.text_kinds import TEXT_KINDS

# Template, line, column, reason.
PROBLEMS = [
    ("a\n  {{ nope }}", 2, 6, "'nope' is undefined"), ("{{ value(nope) }}", 1, 10, "'nope' is undefined"),
    ("{{ 'a' ~\n nope | upper }}", 2, 2, "'nope' is undefined"),
    ('{{ 1 }}{{ value("rk4.first.step.q") }}', 1, 18,
     "is not the id of a published value; did you mean rk4.first_step.q"),
    ('{{ value("run rk4 h=1/4 : q") }}', 1, 11, "run needs exactly two of h, t and N"),
    ('{{ value("step rk4 h=1/2 : r") }}', 1, 28, "'r' is not a readout of step"),
    ('{{ value("order " ~ "nope") }}', 1, 4, "'order nope', column 7: unknown method 'nope'"),
    ("{{ value(3) }}", 1, 11, "a question is a string"), ("{{ value('pi', 2) }}", 1, 11, "value: too many positional"),
    ("{{ value('pi') | digits }}", 1, 18, "digits: missing a required argument: 'count'"),
    ('{{ value("5/8") | digits(2) }}', 1, 19,
     "half-even gives 0.62, half-away 0.63; choose a rounding, as in digits(2"),
    ('{{ value("rk4.default.energy_change") }}', 1, 4, "needs a format: write | digits(6)"),
    ('{{ value("run rk4 h=1/4 t=10 : state_error") | exact }}', 1, 48, "has no exact form; write | digits(6)"),
    ('{{ value("energy_multiplier rk4") | digits(3) }}', 1, 37, "is not a number and has no decimals"),
    ('{{ value("1/2") | digits(0) }}', 1, 19, "'0' is not a number of digits; write a whole number from 1 to 10000"),
    ('{{ value("1/2") | digits(1000000000) }}', 1, 19, "is not a number of digits"),
    ('{{ value("1/2") | places(true) }}', 1, 19, "'True' is not a number of digits"),
    ('{{ value("1/2") | digits(2, style="fancy") }}', 1, 19, "the style 'fancy' is unknown; choose one of plain"),
    ('{{ value("1/2") | digits(2, rounding="up") }}', 1, 19, "rounding: 'up' is unknown"),
    ("{{ 'x' | digits(2) }}", 1, 10, "a str is not a value; apply filters to value(...)"),
    ('{{ value("1/2").unit }}', 1, 4, "'1/2' has no unit"),
    ('{% if value("1/2") %}x{% endif %}', 1, 4, "'1/2' is not a condition and cannot be compared"),
    ('{{ value("1/2") == value("1/2") }}', 1, 4, "'1/2' is not a condition"),
    ("{{ none }}", 1, 4, "a NoneType cannot be printed"),
    ("{{ [1] }}", 1, 4, "a list cannot be printed"), ("{{ 0.5 }}", 1, 4, "a float cannot be printed"),
    ('{% set ask = value %}x{{ ask("speed rk4") }}', 1, 26, "'speed' is not a known fact"),
    ("{{ value }}", 1, 4, "a function cannot be printed"),
    ('{{ value("1/2" }}', 1, 16, "unexpected '}', expected ')'"),
    ("x {% endfor %}", 1, 6, "Encountered unknown tag 'endfor'."),
    ("x\n{# never closed", 2, 1, "Missing end of comment tag"),
    ("{{ 1 | center(10) }}", 1, 8, "'center' is not a filter; the filters are capitalize, join"),
    ("x\n\ufdd0", 2, 1, "the noncharacter U+FDD0 is not allowed in a text"),
]  # fmt: skip


@pytest.mark.parametrize(("template", "line", "column", "reason"), PROBLEMS, ids=range(len(PROBLEMS)))
def test_problem_is_one_line_with_file_line_and_column(template, line, column, reason, become):
    with pytest.raises(TemplateProblem, match=r"\A[^\n]*\Z") as raised:
        become(template)
    assert str(raised.value).startswith(f"t.j2, line {line}, column {column}: ")
    assert reason in str(raised.value)


def test_problem_of_an_included_template_names_that_one(become):
    with pytest.raises(TemplateProblem, match=r"^b\.md, line 2, column 4: 'nope' is undefined$"):
        become("{% include 'b.md' %}", b_md="x\n{{ nope }}")
    assert become("{% include 'b.md' %}", b_md="[{{ value('1/2') }}]") == "[1/2]"
    assert become("a `{{ value('sqrt(8)*1') | exact }}` {{ value('sqrt(8)') | exact }}") == r"a `2*sqrt(2)` 2\*sqrt(2)"


def test_value_that_is_not_proved_is_refused(become, monkeypatch):
    monkeypatch.setattr(module, "value", lambda _: Answer("x", Fraction(1), "FUZZED"))
    with pytest.raises(TemplateProblem, match=r"line 1, column 11: 'x' is only FUZZED; templates print only what is"):
        become('{{ value("x") | digits(2) }}')


def test_template_nested_too_deeply_is_refused(become):
    with pytest.raises(TemplateProblem, match=r"^t\.j2: nested too deeply"):
        become(f"{{{{ {'(' * 5000}1{')' * 5000} }}}}")


TAGS = [
    *("{{", "}}", "{%", "%}", "{%-", "-}}", "{#", "#}", "{#1}", "{%\n", "\n", "\r\n", " ", "é", "\ufdd0", "\f"),
    *("```\n", "`"),
]
WORDS = re.findall(
    r"\S+",
    """
    ( ) [ ] { } | ~ * ** + - / // % , . : == = ' " 1 x true 0.5 'a' value value('1/3') digits digits(3)
    places(2) exact tex mathml if else endif for i in endfor range(3) set macro m() endmacro raw endraw include 't.j2'
    namespace() loop not is defined block b endblock self super() caller() filter upper endfilter
""",
)
INSIDE = st.lists(st.sampled_from(WORDS), max_size=6).map(" ".join)
PARTS = st.sampled_from(TAGS) | INSIDE | INSIDE.map("{{{{ {} }}}}".format) | INSIDE.map("{{% {} %}}".format)


@given(text=st.lists(PARTS, max_size=8).map("".join), kind=st.sampled_from(TEXT_KINDS))
def test_any_template_is_rendered_or_refused_in_one_line(text, kind, tmp_path_factory):
    template = tmp_path_factory.mktemp("any") / "t.j2"
    template.write_text(text, encoding="utf-8", newline="")
    said = ""
    try:
        assert isinstance(Template(template, kind, None, None).text(), str)
    except TemplateProblem as problem:
        said = str(problem)
    assert said == "" or re.fullmatch(r"t\.j2, line \d+, column \d+: .+", said)
