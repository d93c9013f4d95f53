"""`driftproof diff`: a changed value is told from more digits and from other words, in any file of values."""

import json
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.commands.arguments import BAD_INPUT, REFUTED
from driftproof.symbolic.algebra.certified import fixed
from driftproof.texts.values import changes as module
from driftproof.texts.values.changes import CHANGES, changes, read_values
from driftproof.texts.values.published import VALUES_FILE

NUMBER = {"exact": "337/384", "decimal": "0.877604", "evidence": "PROVED", "printed": {"L080": "337/384"}}


def of_number(**change):
    old, new = ({"values": {"a.q": number}} for number in (NUMBER, {**NUMBER, **change}))
    return [(found.kind, found.part) for found in changes(old, new)]


@pytest.mark.parametrize(
    ("change", "kinds"),
    [
        ({}, []), ({"exact": "337/385"}, [("value", "")]),
        ({"exact": "-337/384", "decimal": "-0.877604"}, [("value", "")]),
        ({"decimal": "0.877605"}, [("value", "")]), ({"decimal": "0.8776041667"}, [("digits", "")]),
        ({"decimal": "0.878"}, [("digits", "")]), ({"decimal": "0.87"}, [("value", "")]),
        ({"decimal": "8.776e-1"}, [("digits", "")]), ({"decimal": "8.776e-2"}, [("value", "")]),
        ({"decimal": "8.77604e-1"}, [("digits", "")]), ({"exact": "sqrt(3)/2"}, [("value", "")]),
        ({"decimal": "nan"}, [("value", "")]), ({"exact": "674/768"}, [("wording", "")]),
        ({"exact": None}, [("wording", "")]),
        ({"evidence": "CERTIFIED"}, [("wording", "evidence")]),
        ({"unit": "degrees"}, [("value", "unit")]),
        ({"printed": {"L080": "0.8776"}}, [("digits", "printed L080")]),
        ({"printed": {"L080": "0.8777"}}, [("value", "printed L080")]),
        ({"printed": {"L080": "√2"}}, [("value", "printed L080")]),
        ({"printed": {}}, [("wording", "printed L080")]),
        ({"exact": "1/3", "decimal": "0.333333", "evidence": "?"}, [("value", ""), ("wording", "evidence")]),
    ],
)  # fmt: skip
def test_change_of_a_number_is_named(change, kinds):
    assert of_number(**change) == kinds


@pytest.mark.parametrize(
    ("old", "new", "kind"),
    [
        ({"order": 4}, {"order": 5}, "value"), ({"a_stable": True}, {"a_stable": False}, "value"),
        ({"limit": None}, {"limit": "oo"}, "value"), ({"c": ["1", "1/2"]}, {"c": ["1", "2/4"]}, "wording"),
        ({"c": ["1", "1/2"]}, {"c": ["1", "1/3"]}, "value"), ({"c": ["1"]}, {"c": ["1", "1/3"]}, "added"),
        ({"rk4": {"title": "RK4"}}, {"rk4": {"title": "Classical RK4"}}, "wording"),
        ({"digits": 15}, {"digits": 30}, "digits"), ({"x": 0.25}, {"x": 0.5}, "value"),
        ({"limit": {"decimal": "2.83", "exact": "2*sqrt(2)"}}, {"limit": "0"}, "value"),
        ({"x": {"decimal": "1.4", "exact": "sqrt(2)"}}, {"x": {"decimal": "1.4", "exact": "sqrt(3)"}}, "value"),
        ({"x": {"decimal": "1.4", "exact": "sqrt(2)"}}, {"x": {"decimal": "1.4", "exact": None}}, "wording"),
        ({"x": {"decimal": "1.4", "exact": "sqrt(2)"}}, {"x": {"decimal": "1.41", "exact": "sqrt(2)"}}, "digits"),
        ({"limit": {"decimal": "2.83"}}, {}, "removed"), ({"values": 3}, {"values": 4}, "value"),
        ({"values": {}}, {"values": {"a": NUMBER}}, "added"),
    ],
)  # fmt: skip
def test_leaves_of_any_document_are_compared(old, new, kind, tmp_path):
    read = []
    for name, document in (("old", old), ("new", new)):
        (tmp_path / name).write_text(json.dumps(document), encoding="utf-8")
        read.append(read_values(tmp_path / name))
    assert kind in [found.kind for found in changes(*read) if found.id]


def test_numbers_of_json_are_read_to_the_last_digit(tmp_path):
    for name, text in (("old", '{"x": 0.1}'), ("new", '{"x": 0.10000000000000001}')):
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert [found.kind for found in changes(read_values(tmp_path / "old"), read_values(tmp_path / "new"))] == ["value"]


@given(st.fractions(-10, 10), st.integers(0, 12), st.integers(0, 12))
def test_roundings_of_one_number_never_count_as_a_change_of_value(x, few, many):
    old, new = ({"values": {"x": {"exact": None, "decimal": fixed(x, places)}}} for places in (few, many))
    assert [found.kind for found in changes(old, new)] in ([], ["digits"])


@given(st.fractions(-10, 10), st.integers(0, 12), st.integers(0, 12))
def test_unit_in_the_last_place_of_the_shorter_is_a_change_of_value(x, few, more):
    """Rounding moves each decimal by half a unit of its own at most, so two units apart cannot be one number."""
    other = x + 2 * Fraction(1, 10**few)
    old = {"values": {"x": {"exact": None, "decimal": fixed(x, few)}}}
    new = {"values": {"x": {"exact": None, "decimal": fixed(other, few + more)}}}
    assert [found.kind for found in changes(old, new)] == ["value"]


@pytest.fixture
def files(tmp_path, monkeypatch):
    """files(**change): old.json as published and new.json with rk4.first_step.q changed, in the current folder."""

    def write(**change):
        monkeypatch.chdir(tmp_path)
        document = json.loads(VALUES_FILE.read_text(encoding="utf-8"))
        Path("old.json").write_text(json.dumps(document, indent=1), encoding="utf-8")
        document["values"]["rk4.first_step.q"].update(change)
        Path("new.json").write_text(json.dumps(document, indent=1), encoding="utf-8")

    return write


def test_same_values_are_status_0_and_a_changed_one_status_1(files, run):
    files()
    assert run("diff", "old.json", "new.json") == (0, "old.json and new.json say the same\n", "")
    files(decimal="0.8776")
    status, out, _ = run("diff", "old.json", "new.json")
    assert (status, out.splitlines()) == (0, [
        "digits  rk4.first_step.q  337/384 = 0.877604166666666666666666666667 became 337/384 = 0.8776", "",
        "0 values changed, 1 only in digits, 0 only in wording, 0 added, 0 removed",
    ])  # fmt: skip
    files(exact="337/385")
    status, out, err = run("diff", "old.json", "new.json")
    assert (status, err) == (REFUTED, "")
    assert out.startswith("value  rk4.first_step.q  337/384 = 0.877604166666666666666666666667 became 337/385 = ")


def test_json_says_every_change_in_full_and_counts_kinds(files, run):
    files(exact="1" * 50 + "/7", evidence="GUESSED")
    status, out, _ = run("diff", "old.json", "new.json", "--format", "json")
    said = json.loads(out)
    assert status == REFUTED
    assert [change["part"] for change in said["changes"]] == ["", "evidence"]
    assert said["changes"][0]["new"] == f"{'1' * 50}/7 = {'0.877604166666666666666666666667'}"
    assert said["counts"] == {**dict.fromkeys(CHANGES, 0), "value": 1, "wording": 1}


def test_answers_to_one_question_are_compared(tmp_path, run):
    for name, question in (("old", "order rk4"), ("new", "order rk4 + 1"), ("stable", "a_stable rk4")):
        (tmp_path / name).write_text(run("value", question, "--format", "json")[1], encoding="utf-8")
    old, new, stable = (str(tmp_path / name) for name in ("old", "new", "stable"))
    for path in (old, stable):
        assert run("diff", path, path) == (0, f"{path} and {path} say the same\n", "")
    assert "added    order rk4 + 1  5" in run("diff", old, new)[1]
    document = json.loads(Path(old).read_text(encoding="utf-8"))
    Path(new).write_text(json.dumps({**document, "exact": "5", "decimal": "5"}), encoding="utf-8")
    status, out, _ = run("diff", old, new)
    assert (status, out.splitlines()[0]) == (REFUTED, "value  order rk4  4 = 4.00000000000000 became 5")


BAD = {
    "truncated": (b'{"values": ', "not JSON: Expecting value"),
    "list": (b"[]", "not a JSON object"),
    "bytes": (b"\xff\xfe", "not UTF-8 at byte 0"),
    "deep": (b"[" * 10**6, "nested too deeply"),
    "twice": (b'{"values": {"b": 0, "a": 1, "a": 2}}', "the key 'a' occurs twice"),
    "empty": (b"", "not JSON"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_json_is_one_line_and_status_2(name, tmp_path, run):
    content, message = BAD[name]
    (tmp_path / "bad.json").write_bytes(content)
    status, out, err = run("diff", str(VALUES_FILE), str(tmp_path / "bad.json"))
    assert (status, out, err.count("\n")) == (BAD_INPUT, "", 1)
    assert message in err
    assert "bad.json" in err


@pytest.mark.parametrize(("old", "new"), [("1e99999999", "1e99999998"), ("9" * 9999, "9" * 9998)])
def test_numbers_of_any_length_are_compared_or_bounded(old, new):
    documents = ({"values": {"x": {"exact": None, "decimal": text}}} for text in (old, new))
    assert [found.kind for found in changes(*documents)] == ["value"]


NO_DECIMAL = ["1/0", "NaN", "inf", "", "0.5.", "1e9999999"]


@pytest.mark.parametrize("text", NO_DECIMAL)
def test_what_is_no_number_is_refused_by_file_and_id(text, tmp_path):
    path, number = tmp_path / "new.json", {"exact": "1/2", "decimal": text}
    for document, name in (({"values": {"a.b": number}}, r"a\.b"), ({"a": [number]}, r"a\[0\]")):
        path.write_text(json.dumps(document), encoding="utf-8")
        with pytest.raises(ValueError, match=rf"new\.json: {name}: decimal is .*, not a number$"):
            read_values(path)


def test_quotient_by_zero_is_a_changed_value(tmp_path, run):
    paths = [tmp_path / f"{name}.json" for name in ("before", "after", "later")]
    for path, exact in zip(paths, ("1/2", "1/0", "2/0"), strict=True):
        path.write_text(json.dumps({"values": {"a.b": {"exact": exact, "decimal": "0.5"}}}), encoding="utf-8")
    for old, new, line in ((0, 1, "1/2 = 0.5 became 1/0 = 0.5"), (1, 2, "1/0 = 0.5 became 2/0 = 0.5")):
        status, out, err = run("diff", str(paths[old]), str(paths[new]))
        assert (status, err) == (REFUTED, "")
        assert f"a.b  {line}" in out
    assert run("diff", str(paths[1]), str(paths[1]))[0] == 0


def test_limits_of_exponents_texts_and_files(tmp_path, monkeypatch):
    value = lambda decimal: {"values": {"a": {"decimal": decimal}}}
    assert changes(value("1e100000"), value("10e99999"))[0].kind == "digits"
    assert [changes(x, {})[0].old for x in (value("1.4"), {"a": {"exact": "2", "decimal": "2"}})] == ["1.4", "2"]
    path = tmp_path / "values.json"
    for exponent, wrong in ((100000, False), (100001, True), (-100001, True)):
        path.write_text(json.dumps(value(f"1e{exponent}")), encoding="utf-8")
        if wrong:
            with pytest.raises(ValueError, match="not a number"):
                read_values(path)
        else:
            assert read_values(path)
    for length, shown in ((40, "x" * 40), (41, "x" * 18 + "..." + "x" * 18)):
        assert str(module.Change("added", "a", "", None, "x" * length)) == shown
    limits = []
    monkeypatch.setattr(module, "read_utf8", lambda path, most: limits.append(most) or "{}")
    assert (read_values(path), limits) == ({}, [64_000_000])
