"""A page from Python: a file or none."""

import json
from dataclasses import replace

import pytest

from driftproof import PRESETS, report


def test_a_page_is_written_where_it_is_asked_for_and_shown_in_a_frame(tmp_path):
    page = report("compare", replace(PRESETS["compare"], name="once_more"))
    assert str(page) == "a page of Compare, Once more; its HTML is in .html"
    assert page.written("html") == page.html
    assert page._repr_html_().startswith('<iframe srcdoc="&lt;!DOCTYPE html&gt;')
    path = tmp_path / "page.html"
    written = report("compare", replace(PRESETS["compare"], name="once_more"), output=path)
    assert str(written) == f"wrote {path}"
    assert path.read_text(encoding="utf-8") == page.html
    for what, given in (("methods", {"methods": "rk4"}), ("errors", {"error": 1e-3})):
        with pytest.raises(ValueError, match=f"{what} are for problems, and none is named"):
            report("compare", **given)
    assert json.loads(written.json()) == {"scenes": ["Compare", "Once more"], "output": str(path)}
