"""What identify reports: in text, Markdown and JSON, with what to do first."""

import json
import re

from driftproof.blackbox.identify import identify
from tests.blackbox import broken_steppers
from tests.blackbox.handwritten_steppers import rk38


def test_an_end_from_outside_asks_for_no_more_time():
    lines = identify(broken_steppers.is_killed).section("What to do").lines
    assert lines == ("try again where nothing kills its process; running out of memory also kills processes",)


def test_the_report_is_json_markdown_and_text():
    report = identify(rk38)
    data = json.loads(report.json())
    assert (data["method"], data["order"], data["calls"]) == ("rk38", 4, "field")
    assert report.markdown().startswith("### `")
    assert str(report) == report.text()
    assert [section.title for section in report.sections[:2]] == ["What to do", "Coefficients"]
    assert "driftproof verify" in report.section("What to do").lines[0]
    brief = r"^  \d\d passed, \d on traits such as areas; --all \(in Python, \.text\(True\)\) shows each$"
    assert re.search(brief, report.text(), re.MULTILINE)
    assert "h = 0 returns the state unchanged" in report.text(everything=True)


def test_what_to_do_with_a_lambda_is_no_command_that_cannot_work():
    (first, *_) = identify(lambda q, v, h: (q + h * v, v - h * (q + h * v))).section("What to do").lines
    assert f"give it a NAME in its module, then driftproof verify {__name__}:NAME --method" in first
