"""A report says the same as text, as Markdown and as JSON, and shows nothing that is not there."""

import json
from dataclasses import replace

from driftproof.blackbox.report import Basis, Report, Section, sections, without_duplicates

REPORT = Report(
    "mylib:step", "is not rk4; it is rk38", False, sections(("Rounding", ["q is a_b*c"]), ("Faults", [])), {"order": 4}
)


def test_a_section_without_lines_is_left_out():
    assert [section.title for section in REPORT.sections] == ["Rounding"]
    assert REPORT.section("Rounding").lines == ("q is a_b*c",)
    assert REPORT.section("Faults") is None


def test_text_has_the_target_the_verdict_and_the_sections():
    assert REPORT.text() == "mylib:step\n  is not rk4; it is rk38\n\nRounding\n  q is a_b*c"
    assert REPORT.written("text") == REPORT.text() == str(REPORT)


def test_line_that_stands_for_others_gives_way_where_everything_is_asked_for():
    long = replace(REPORT, sections=(Section("Checks", ("kept", "kept, too"), "2 kept"),))
    for form in ("text", "markdown"):
        assert ("2 kept" in long.written(form), "too" in long.written(form)) == (True, False)
        assert ("2 kept" in long.written(form, True), "too" in long.written(form, True)) == (False, True)
    assert without_duplicates(["a", "b", "a"]) == ["a (2 times)", "b"]


def test_a_verdict_answers_if_it_names_a_method_exactly_or_nearly():
    assert [basis.answered for basis in Basis] == [*[True] * 4, False, None, False]


def test_markdown_shows_the_verdict_and_the_lines_verbatim():
    said = replace(REPORT, verdict="raises **x** <lambda>\nat `\\*", sections=sections(("Rounding", ["a_b*c\n# d"])))
    assert said.written("markdown") == (
        "### `mylib:step`: raises \\*\\*x\\*\\* \\<lambda> at \\`\\\\\\*\n\n**Rounding**\n\n- a\\_b\\*c # d"
    )


def test_json_holds_the_data_with_sorted_keys():
    data = json.loads(REPORT.written("json"))
    assert data == {"target": "mylib:step", "verdict": "is not rk4; it is rk38", "passed": False, "order": 4}
    assert list(data) == sorted(data)


def test_text_of_a_stepper_has_no_say_over_the_terminal():
    report = Report("mylib:step", "raises \x1b[2Jboo", None, sections(("Faults", ["said \x9b31m\a"])))
    assert report.text() == "mylib:step\n  raises \\u001b[2Jboo\n\nFaults\n  said \\u009b31m\\u0007"
