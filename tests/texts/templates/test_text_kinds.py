"""What a file is called says which kind of text it holds; words, tables and code are written in that kind."""

from pathlib import Path

import pytest

from driftproof.texts.templates.text_kinds import HTML, LATEX, MARKDOWN, TEXT_KINDS, is_code, kind_of

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
    LATEX.name: "\\begin{tabular}{lrr}\nMethod & A\\_1 & Limit \\\\\n\\hline\nForward Euler & 5.2 & 0 \\\\\n"
    "Classical RK4 & \\ensuremath{-0.000067} & 2*sqrt(2) \\\\\n\\end{tabular}",
}


@pytest.mark.parametrize("kind", TEXT_KINDS, ids=lambda kind: kind.name)
def test_table_of_methods_is_written_in_the_kind_of_the_text(kind, become):
    assert become(TABLE, kind) == TABLES[kind.name]


@pytest.mark.parametrize(
    ("source", "code"),
    [
        ("a `b X` c", True), ("a `b` X `c`", False), ("a ` X c", False), ("```\nX\n```", True),
        ("```\n```\nX", False), ("~~~~\n```\nX", True), ("  ```\n  ```\nX", False), ("```x\n~~~\n```\nX", False),
    ],
)  # fmt: skip
def test_code_of_markdown_is_told_from_prose(source, code):
    assert is_code(source, source.index("X")) is code


def test_output_is_known_by_its_name():
    assert [kind_of(Path(f"a.{end}")) for end in ("md", "MYST", "htm", "tex")] == [MARKDOWN, MARKDOWN, HTML, LATEX]
    with pytest.raises(ValueError, match=r"a.txt: the name of the rendered file must end in one of .md, .markdown"):
        kind_of(Path("a.txt"))
