"""Values in a template: how a number is written in each kind of text, and what is no value."""

import pytest

from driftproof.texts.templates.sandbox import TemplateProblem
from driftproof.texts.templates.text_kinds import HTML, LATEX, MARKDOWN

Q, V = 'value("rk4.first_step.q")', 'value("rk4.first_step.v")'
LIMIT = 'value("imaginary_limit rk4")'
FIRST = MARKDOWN, HTML, LATEX


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
        ('{{ value("1/4e7") | digits(2, style="printed") }}', (*["2.5×10⁻⁸"] * 2, r"\ensuremath{2.5 \cdot 10^{-8}}")),
        (f"{{{{ {LIMIT} | exact }}}}", (r"2\*sqrt(2)", "2*sqrt(2)", "2*sqrt(2)")),
        (f"{{{{ {LIMIT} | tex }}}}", r"2 \sqrt{2}"),
        (f"`{{{{ {LIMIT} | exact }}}}`", "`2*sqrt(2)`"),
        (f"```\n{{{{ {LIMIT} | exact }}}}\n```", "```\n2*sqrt(2)\n```"),
        ('{{ value("a_stable rk4") }} {{ value("order rk4") }}', "no 4"),
        ('{{ value("run rk4 h=1/4 t=10 : phase_error").unit }}', "degrees"),
        ('{{ "q = " ~ value("1/2") ~ (1 + 1) }} {{ "<i>" }}', ("q = 1/22 <i>", "q = 1/22 &lt;i&gt;", "q = 1/22 <i>")),
        ("{% for i in range(3) %}{{ loop.index }}{{ loop.cycle('a', 'b') }}{% endfor %}", "1a2b3a"),
        ('{% macro m(x) %}[{{ x | digits(2) }}]{% endmacro %}{{ m(value("1/3")) }}', "[0.33]"),
        ("{{ 'a' + 'b' }}{{ 7 // 2 + 7 % 4 }}", "ab6"),
        (
            "| a |\n|---|\n{% for i in range(2) %}\n| {{ i }} |\n{% endfor %}\nEnd\n",
            "| a |\n|---|\n| 0 |\n| 1 |\nEnd\n",
        ),
        ("- a\n  {% if 1 %}\n  {# why #} {% set x = 'b' %}\n  - {{ x }}\n  {% endif %}\n- c", "- a\n  - b\n- c"),
        ("x{% if 1 %}y{% endif %}\nz\n{%+ if 1 %}\n{% endif %}\n", "xy\nz\n\n"),
        ("{% raw %}\n  {% if x %}\n{% endraw %}\n", "\n  {% if x %}\n\n"),
        ("{# nothing #}{% raw %}{{ x }}{% endraw %}\n", "{{ x }}\n"),
    ],
)
def test_template_becomes_text_in_every_kind(expression, texts, become):
    assert [become(expression, kind) for kind in FIRST] == list([texts] * 3 if isinstance(texts, str) else texts)


def test_mathml_is_markup_in_html_and_in_markdown_and_refused_in_tex(become):
    asked = '{{ value("1/3") | mathml }}'
    formula = "<math><mfrac><mn>1</mn><mn>3</mn></mfrac></math>"
    assert become(asked, HTML) == become(asked, MARKDOWN) == formula
    with pytest.raises(TemplateProblem, match=r"line 1, column 19: MathML is not allowed in TeX; write \| tex"):
        become(asked, LATEX)


def test_style_and_rounding_are_set_once_in_a_template_or_by_the_command(become):
    tie = '{{ value("-5/8") | places(2) }}'
    assert become('{% set style = "printed" %}{% set rounding = "half-away" %}' + tie) == "−0.63"
    assert become('{% set rounding = "half-even" %}' + tie, style="printed") == "−0.62"
    assert become('{% set rounding = "half-even" %}' + tie) == "-0.62"
    macro = '{% macro m() %}{{ value("-1/2") | places(1) }}{% endmacro %}'
    imported = '{% set style = "printed" %}{% import "m.j2" as m with context %}{{ m.m() }}'
    assert become(imported, m_j2=macro) == "−0.5"
