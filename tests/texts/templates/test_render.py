"""Templates with values in them: what they become in each kind of text, and how numbers are written in it."""

from __future__ import annotations

from pathlib import Path

import pytest

from driftproof.texts.templates.kinds import HTML, KINDS, MARKDOWN, TEX, Kind, is_code, kind_of
from driftproof.texts.templates.problems import TemplateProblem
from tests.texts.templates.templating import Become, become_in

Q, V = 'value("rk4.first_step.q")', 'value("rk4.first_step.v")'
LIMIT = 'value("imaginary_limit rk4")'
FIRST = MARKDOWN, HTML, TEX


@pytest.fixture
def become(tmp_path: Path) -> Become:
    return become_in(tmp_path)


@pytest.mark.parametrize(
    ("expression", "texts"),
    [
        (f"{{{{ {Q} }}}}", "337/384"),
        (f"{{{{ {V} }}}}", ("-23/48", "-23/48", r"\ensuremath{-}23/48")),
        (f"{{{{ {Q} | digits(6) }}}}", "0.877604"),
        (f"{{{{ {V} | places(3) }}}}", ("-0.479", "-0.479", r"\ensuremath{-0.479}")),
        (f'{{{{ {V} | places(3, style="printed") }}}}', ("−0.479", "−0.479", r"\ensuremath{-0.479}")),
        (f'{{{{ {V} | places(3, style="plain") }}}}', "-0.479"),
        ('{{ value("1/40000000") | digits(2) }}', ("2.5e-8", "2.5e-8", r"\ensuremath{2.5 \cdot 10^{-8}}")),
        (
            '{{ value("1/40000000") | digits(2, style="printed") }}',
            ("2.5×10⁻⁸", "2.5×10⁻⁸", r"\ensuremath{2.5 \cdot 10^{-8}}"),
        ),
        (f"{{{{ {LIMIT} | exact }}}}", (r"2\*sqrt(2)", "2*sqrt(2)", "2*sqrt(2)")),
        (f"{{{{ {LIMIT} | tex }}}}", r"2 \sqrt{2}"),
        (f"`{{{{ {LIMIT} | exact }}}}`", "`2*sqrt(2)`"),
        (f"```\n{{{{ {LIMIT} | exact }}}}\n```", "```\n2*sqrt(2)\n```"),
        ('{{ value("a_stable rk4") }} {{ value("order rk4") }}', "no 4"),
        ('{{ value("run rk4 h=1/4 t=10 : phase_error").unit }}', "degrees"),
        ('{{ "q = " ~ value("1/2") ~ (1 + 1) }} {{ "<i>" }}', ("q = 1/22 <i>", "q = 1/22 &lt;i&gt;", "q = 1/22 <i>")),
        ("{% for i in range(3) %}{{ loop.index }}{% endfor %}", "123"),
        ('{% macro m(x) %}[{{ x | digits(2) }}]{% endmacro %}{{ m(value("1/3")) }}', "[0.33]"),
        ("{# nothing #}{% raw %}{{ x }}{% endraw %}\n", "{{ x }}\n"),
    ],
)
def test_template_becomes_text_in_every_kind(expression: str, texts: str | tuple[str, ...], become: Become) -> None:
    assert [become(expression, kind) for kind in FIRST] == list([texts] * 3 if isinstance(texts, str) else texts)


def test_mathml_is_markup_in_html_and_in_markdown_and_refused_in_tex(become: Become) -> None:
    asked = '{{ value("1/3") | mathml }}'
    formula = "<math><mfrac><mn>1</mn><mn>3</mn></mfrac></math>"
    assert become(asked, HTML) == become(asked, MARKDOWN) == formula
    with pytest.raises(TemplateProblem, match=r"line 1, column 19: MathML has no place in TeX; write \| tex"):
        become(asked, TEX)


TABLE = (
    '{{ methods_table(["forward_euler", "rk4"], {"A_1": "energy_change digits 2", "Limit": "imaginary_limit exact"},'
    ' h="1/4", t="10") }}'
)
TABLES = {
    MARKDOWN.name: "| Method | A\\_1 | Limit |\n| --- | ---: | ---: |\n| Forward Euler | 5.2 | 0 |\n"
    "| Classical RK4 | -0.000067 | 2\\*sqrt(2) |",
    HTML.name: "<table>\n<thead><tr><th>Method</th><th>A_1</th><th>Limit</th></tr></thead>\n<tbody>\n"
    "<tr><td>Forward Euler</td><td>5.2</td><td>0</td></tr>\n"
    "<tr><td>Classical RK4</td><td>-0.000067</td><td>2*sqrt(2)</td></tr>\n</tbody>\n</table>",
    TEX.name: "\\begin{tabular}{lrr}\nMethod & A\\_1 & Limit \\\\\n\\hline\nForward Euler & 5.2 & 0 \\\\\n"
    "Classical RK4 & \\ensuremath{-0.000067} & 2*sqrt(2) \\\\\n\\end{tabular}",
}


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_table_of_methods_is_written_in_the_kind_of_the_text(kind: Kind, become: Become) -> None:
    assert become(TABLE, kind) == TABLES[kind.name]


def test_headings_of_columns_are_what_is_asked_in_words(become: Become) -> None:
    first = become('{{ methods_table(["rk4"], ["q digits 3", "state_error places 3", "order"], h="1/2", t="1") }}')
    assert first.splitlines()[0] == "| Method | q | State error | Order |"


def test_style_and_rounding_are_set_once_in_a_template_or_by_the_command(become: Become) -> None:
    tie = '{{ value("-5/8") | places(2) }}'
    assert become('{% set style = "printed" %}{% set rounding = "half-away" %}' + tie) == "−0.63"
    assert become('{% set rounding = "half-even" %}' + tie, style="printed") == "−0.62"
    assert become('{% set rounding = "half-even" %}' + tie) == "-0.62"
    macro = '{% macro m() %}{{ value("-1/2") | places(1) }}{% endmacro %}'
    imported = '{% set style = "printed" %}{% import "m.j2" as m with context %}{{ m.m() }}'
    assert become(imported, m_j2=macro) == "−0.5"


def test_arguments_and_comment_signs_of_tex_stay_what_they_are(become: Become) -> None:
    text = "\\newcommand{\\x}[1]{#1}\n\\newcommand{\\y}{%\n  {##1}}{%  \n"
    assert become(text + "{{ value('1/2') }}", TEX) == text + "1/2"
    assert become("{#1#}", HTML) == ""


@pytest.mark.parametrize(
    ("source", "code"),
    [
        ("a `b X` c", True),
        ("a `b` X `c`", False),
        ("a ` X c", False),
        ("```\nX\n```", True),
        ("```\n```\nX", False),
        ("~~~~\n```\nX", True),
        ("```x\n~~~\n```\nX", False),
    ],
)
def test_code_of_markdown_is_told_from_prose(source: str, code: bool) -> None:
    assert is_code(source, source.index("X")) is code


def test_output_is_known_by_its_name() -> None:
    assert [kind_of(Path(f"a.{end}")) for end in ("md", "MYST", "htm", "tex")] == [MARKDOWN, MARKDOWN, HTML, TEX]
    with pytest.raises(ValueError, match=r"a.txt: what is rendered has a name that ends in one of .md, .markdown"):
        kind_of(Path("a.txt"))
