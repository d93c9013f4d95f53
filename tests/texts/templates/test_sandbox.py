"""What is hostile in a template is refused or bounded, at its place; TeX keeps its own signs."""

import pytest
from jinja2 import Environment

from driftproof.texts.templates.sandbox import FILTERS, FolderLoader, TemplateProblem
from driftproof.texts.templates.text_kinds import HTML, LATEX

# Template, column on its only line, reason.
HOSTILE = [
    ("{{ ''.__class__.__mro__ }}", 4, "access to attribute '__class__' of 'str' object is unsafe."),
    ("{{ value.__globals__ }}", 4, "access to attribute '__globals__'"),
    ("{{ value('1/2')._value }}", 4, "access to attribute '_value' of 'TemplateValue' object is unsafe."),
    ("{{ value('1/2')['_value'] }}", 4, "access to attribute '_value'"),
    ("{{ '{0.__class__}'.format(value) }}", 4, "a template may call only value, range, namespace and its own"),
    ("{{ 'a'.center(1000000000) }}", 4, "a template may call only value"),
    ("{{ lipsum(1000) }}", 4, "'lipsum' is undefined"), ("{{ 'a' * 9 }}", 4, "* is not available in templates"),
    ("{{ [0] * 10 }}", 4, "* is not available in templates"),
    ("{{ '%999999999d' % 1 }}", 4, "% is not available in templates"),
    ("{{ '%d' % 'a' }}", 4, "% is not available in templates"),
    ("{{ [1] + [2] }}", 4, "+ is not available in templates"),
    ("{{ 10**10**10 }}", 4, "** is not available in templates"),
    ("{{ 1/3 }}", 4, "/ is not available in templates; value('1/3 + 1/6') computes exactly"),
    ("{{ 1 // 0 }}", 4, "integer division or modulo by zero"),
    ("{% for i in range(1000000) %}{% endfor %}", 4, "Range too big. The sandbox blocks ranges larger than MAX_RANGE"),
    ("{% include '../secret' %}", 4, "'../secret' lies outside the folder of the template"),
    ("{% include '/etc/passwd' %}", 4, "'/etc/passwd' lies outside the folder of the template"),
    ("{% include 'link' %}", 4, "'link' lies outside the folder of the template"),
    ("{% include 'circle' %}", 4, "no template 'circle' is in the folder of this one"),
    ("{% include 'none' %}", 4, "no template 'none' is in the folder of this one"),
    ("{% include 't.j2' %}", 4, "nested too deeply, or a template includes itself"),
]  # fmt: skip


@pytest.mark.parametrize(("template", "column", "reason"), HOSTILE)
def test_template_reaches_nothing_but_what_it_is_given(template, column, reason, become, tmp_path):
    (tmp_path.parent / "secret").write_text("secret", encoding="utf-8")
    (tmp_path / "link").symlink_to(tmp_path.parent / "secret")
    (tmp_path / "circle").symlink_to("circle")
    with pytest.raises(TemplateProblem) as raised:
        become(template)
    assert str(raised.value).startswith(f"t.j2, line 1, column {column}: ")
    assert reason in str(raised.value)


def test_arguments_and_comment_signs_of_tex_stay_what_they_are(become):
    text = "\\newcommand{\\x}[1]{#1}\n\\newcommand{\\y}{%\n  {##1}}{%  \n"
    assert become(text + "{{ value('1/2') }}", LATEX) == text + "1/2"
    assert become("{#1#}", HTML) == ""


def test_no_filter_of_jinja_turns_what_is_missing_into_a_blank():
    assert not {"default", "d", "format", "center", "indent", "attr", "map", "safe", "tojson"} & set(FILTERS)


def test_a_template_has_ten_million_bytes_at_most(tmp_path):
    path = tmp_path / "t.j2"
    for size, read in ((10**7, True), (10**7 + 1, False)):
        path.write_bytes(b" " * size)
        if read:
            assert len(FolderLoader(path).get_source(Environment(), "t.j2")[0]) == size
        else:
            with pytest.raises(ValueError, match="too large; at most 10000000 bytes"):
                FolderLoader(path).get_source(Environment(), "t.j2")
