"""What a file is called says which kind of text it holds; words and code are written in that kind."""

from pathlib import Path

import pytest

from driftproof.texts.templates.text_kinds import HTML, LATEX, MARKDOWN, is_code, kind_of


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
