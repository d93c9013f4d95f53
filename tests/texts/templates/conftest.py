"""Templates rendered in this process."""

import pytest

from driftproof.texts.templates.template import Template
from driftproof.texts.templates.text_kinds import MARKDOWN


@pytest.fixture
def become(tmp_path):
    """become(template, kind): the text; further templates beside it as keywords, dots in their names as underscores."""

    def render(template, kind=MARKDOWN, style=None, **beside):
        (tmp_path / "t.j2").write_text(template, encoding="utf-8", newline="")
        for name, text in beside.items():
            (tmp_path / name.replace("_", ".")).write_text(text, encoding="utf-8")
        return Template(tmp_path / "t.j2", kind, style, None).text()

    return render
