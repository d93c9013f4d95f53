"""A table is read as it is written; what does not fit is refused in one line with its place and what is allowed."""

import pytest

from driftproof.support import toml_tables as toml


class Refused(ValueError):
    """What a caller of its own calls a refusal."""


def test_decimals_stay_as_they_are_written():
    assert toml.parse_toml("x = 0.1\ny = [1, 2e-3]") == {"x": "0.1", "y": [1, "2e-3"]}
    assert toml.parse_toml("x = [" + "0.125, " * 600 + "]")["x"] == ["0.125"] * 600
    assert toml.parse_toml("a" + ".a" * 300 + " = 1")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"x = ", "not TOML: Invalid value"),
        (b"x = 1\nx = 2\n", "not TOML: a key is given twice (at line 2"),
        (b"x = " + b"[" * 9000, "nested too deeply"),
        (b"a" + b".a" * 301 + b" = 1", "more than 300 dots in one line"),
        (b"'1.1'" + b".'1.1'" * 301 + b" = 1", "more than 300 dots in one line"),
        ("'\u2028'".encode() + ".'\u2028'".encode() * 301 + b" = 1", "more than 300 dots in one line"),
        (b"x = " + b"9" * 5000, "not TOML: Exceeds the limit"),
    ],
)
def test_what_is_not_toml_or_too_much_is_refused(content, reason, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_bytes(content)
    with pytest.raises(Refused, match=r"\A[^\n]*\Z") as caught:
        toml.read_toml(path, 10_000, dict, Refused)
    assert str(caught.value).startswith(f"{path}: ")
    assert reason in str(caught.value)


def test_a_reason_of_the_caller_and_one_of_the_system_name_the_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("x = 1", encoding="utf-8")
    assert toml.read_toml(path, 10, lambda table: toml.as_whole(table["x"], "x", 0, 9)) == 1
    with pytest.raises(ValueError, match=r"mine\.toml: x is 1; write text in quotes\Z"):
        toml.read_toml(str(path), 10, lambda table: toml.as_text(table["x"], "x"))
    for missing, reason in ((tmp_path / "two\nlines.toml", "two lines.toml: No such file"), (tmp_path, "a directory")):
        with pytest.raises(Refused, match=reason):
            toml.read_toml(missing, 10, dict, Refused)


FITS = [
    (toml.as_text("", "x"), ""), (toml.as_line("  a  b   ", "x", 9), "a  b"),
    (toml.as_texts(["a", "b"], "x"), ("a", "b")), (toml.as_flag(False, "x"), False),
    (toml.as_whole(9, "x", 0, 9) - toml.as_whole(0, "x", 0, 9), 9),
    (toml.as_choice("a", "x", ("a", "b")), "a"), (toml.as_table({}, "x"), {}),
    (toml.as_list([1, 2], "x", 2, 2), [1, 2]),
]  # fmt: skip
REFUSALS = [
    (lambda: toml.as_text(1, "x"), "x is 1; write text in quotes"),
    (lambda: toml.as_text(None, "x"), "x is missing; write text in quotes"),
    (
        lambda: toml.as_line("  ", "x", 9),
        "x is '  '; write a line of text of 1 to 9 characters, all printable, in quotes",
    ),
    (lambda: toml.as_line("a\nb", "x", 9), "x is 'a\\nb'; write a line of text"),
    (lambda: toml.as_line("0123456789", "x", 9), "x is '0123456789'; write a line of text of 1 to 9"),
    (lambda: toml.as_texts(["a", 2], "x"), "x[1] is 2; write text in quotes"),
    (lambda: toml.as_flag(1, "x"), "x is 1; write true or false"),
    (lambda: toml.as_whole(True, "x", 0, 9), "x is True; write a whole number from 0 to 9"),
    (lambda: toml.as_whole(10, "x", 0, 9), "x is 10; write a whole number from 0 to 9"),
    (lambda: toml.as_choice("c", "x", ("a", "b")), "x is 'c'; write 'a' or 'b'"),
    (lambda: toml.as_choice(["a"], "x", ("a", "b")), "x is ['a']; write 'a' or 'b'"),
    (lambda: toml.as_table([], "x"), "x is []; write a table [x]"),
    (lambda: toml.as_list("ab", "x"), "x is 'ab'; write a list"),
    (lambda: toml.as_list([1, 2, 3], "x", 2, 2), "x has 3 entries; at most 2 are allowed"),
    (lambda: toml.as_list([1], "x", 2), "x has 1 entries, 2 are needed"),
    (lambda: toml.require_keys({"a": 1, "c": 2}, ("a", "b"), "a table"), "a table has no key 'c'; its keys are a, b"),
]


def test_a_value_that_fits_is_returned():
    toml.require_keys({"a": 1}, ("a", "b"), "a table")
    assert [found for found, _ in FITS] == [expected for _, expected in FITS]


@pytest.mark.parametrize(("demand", "line"), REFUSALS, ids=[line for _, line in REFUSALS])
def test_a_value_that_does_not_fit_is_refused_with_what_is_allowed(demand, line):
    with pytest.raises(ValueError, match=r"\A[^\n]*\Z") as caught:
        demand()
    assert str(caught.value).startswith(line)


def test_what_is_quoted_is_cut_and_a_huge_number_is_not_written_out():
    assert toml.quoted("x" * 99) == "'" + "x" * 56 + "..."
    assert toml.quoted(10**5000) == "a huge number"
