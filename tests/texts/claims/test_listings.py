"""Listings run in a child, within limits, and a line that they do not print is found."""

import json
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.support.processes import Limits
from driftproof.texts.claims import listings
from driftproof.texts.claims.listings import listings_in, run_listings
from driftproof.texts.readers.document import document_of

MARKDOWN = """\
# A listing

```python
x = 3
print(f"x = {x}")
print(x / 4)
```

prints

```text
x = 3
0.75
```

and then

```python
print(x + 1)
```

```
4
```
"""
PLAIN = """\
Some prose, that is no program.

def double(x):
    return 2 * x

for i in range(2):
    print(double(i), double(0.25))

Expected output:

0 0.5
2 0.5

More prose = 5.
"""
NOTEBOOK = {
    "cells": [
        {"cell_type": "code", "source": ["y = 2\n", "y + 1"], "outputs": [{"data": {"text/plain": ["3"]}}]},
        {"cell_type": "code", "source": ["print(y)"], "outputs": [{"text": ["2\n"]}]},
    ]
}
TEX = "\\begin{lstlisting}[language=Python]\nprint(1/4)\n\\end{lstlisting}\n\\begin{verbatim}\n0.25\n\\end{verbatim}"
HTML = '<pre><code class="language-python">print(&quot;0.25&quot;)</code></pre><p>gives</p><pre>0.25</pre>'
TEXTS = {
    "markdown": (MARKDOWN, "0.75", 2, 13), "plain": (PLAIN, "2 0.5", 1, 12),
    "notebook": (json.dumps(NOTEBOOK, indent=1), '"3"', 2, None),
    "tex": (TEX, "0.25\n", 1, 5), "html": (HTML, "<pre>0.25", 1, 1),
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("form", TEXTS)
def test_listing_prints_what_the_text_says_or_the_line_is_found(form):
    source, shown, count, line = TEXTS[form]
    ran = run_listings(document_of(source, form))
    assert (ran.findings, ran.count, len(ran.spans)) == ((), count, count)
    changed = shown.replace(shown.strip('"\n')[-1], "9")
    wrong = run_listings(document_of(source.replace(shown, changed), form))
    (finding,) = wrong.findings
    assert finding.message.startswith("the listing prints ")
    assert line is None or finding.line == line
    assert len(wrong.spans) == count - 1


# What is shown of the output 1, 2, 3 -> the line of the file that differs first; its last one, if a line is missing.
DIFFERENT = {"9\n2\n3": 6, "1\n9\n3": 7, "1\n2\n9": 8, "1\n2\n3\n4": 9, "1\n2": 7, "1": 6, "\n\n1\n\n3\n": 9}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("shown", DIFFERENT)
def test_finding_is_at_the_beginning_of_the_line_that_differs(shown):
    source = f"```python\nprint('1\\n2\\n3')\n```\n\n```\n{shown}\n```\n"
    (finding,) = run_listings(document_of(source, "markdown")).findings
    assert (finding.line, finding.column) == (DIFFERENT[shown], 1)


def test_a_listing_that_ends_with_an_error_is_found_at_its_beginning():
    for output in ("```text\n1\n```\n", ""):
        document = document_of(f"First:\n\n```python\nx = 0\n1/x\n```\n{output}", "markdown")
        (finding,) = run_listings(document).findings
        assert (finding.line, finding.column) == (4, 1)


def test_numbers_seen_printed_are_those_of_the_output():
    document = document_of(PLAIN)
    ((start, end),) = run_listings(document).spans
    assert document.text.text[start:end].split() == ["0", "0.5", "2", "0.5"]


def outcome(program, printed="x", time_limit=10.0):
    """What is found wrong with a listing that should print something."""
    document = document_of(f"```python\n{program}\n```\n\n```\n{printed}\n```\n", "markdown")
    return " ".join(finding.message for finding in run_listings(document, time_limit).findings)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("1/0", "ZeroDivisionError: division by zero (line 1 of the listing)"),
        ("x = 1\nraise ValueError('a\\nb')", "ValueError: a b (line 2 of the listing)"),
        ("print('a'", "SyntaxError"),
        ("x = '\\0'\nprint(open('/nowhere'))", "FileNotFoundError"),
        ("input()", "EOFError"), ("'x'", "the listing prints '', the text has 'x'"),
        ("a = 'x' * 10**10", "MemoryError"),
        ("while True: print('x' * 10**5)", "it prints more than 1048576 characters"),
        ("import os; os._exit(3)", "the process ended (exit status 3)"),
        ("import os; os.kill(os.getpid(), 9)", "the process ended (signal 9, SIGKILL)"),
        ("def f(): f()\nf()", "RecursionError"),
        ("import sys; sys.exit(1)", "the listing prints '', the text has 'x'"),
        ("open('big', 'wb').write(b'0' * 10**8)", "OSError"), ("[" * 5000, "the listing"),
    ],
)  # fmt: skip
def test_listing_that_misbehaves_is_told_in_words(program, message):
    assert message in outcome(program)


def test_listing_without_end_is_stopped_with_what_it_started():
    program = "import subprocess, sys\nsubprocess.Popen([sys.executable, '-c', 'while True: pass'])\nwhile True: pass"
    assert "not finished within 1 s" in outcome(program, time_limit=1.0)


def test_listing_sees_neither_our_folder_nor_our_secrets(tmp_path, monkeypatch):
    monkeypatch.setenv("SOME_TOKEN", "secret")
    monkeypatch.chdir(tmp_path)
    Path("module_of_ours.py").touch()
    program = "import os\nprint(os.environ.get('SOME_TOKEN'), os.environ['OPENBLAS_NUM_THREADS'])"
    assert outcome(program, "None 1") == ""
    assert "ModuleNotFoundError" in outcome("import module_of_ours")
    outcome("open('left', 'w').write('x')")
    assert os.listdir(tmp_path) == ["module_of_ours.py"]


def test_listing_that_lies_about_its_outcome_is_not_believed_to_have_run():
    lines = (
        "import os",
        "# the pipe is one of these, however many files the tests have open\nfor d in range(3, 256):",
        " try: os.write(d, b'nonsense\\n[]\\n{}\\n')",
        " except OSError: pass",
    )
    program = "\n".join([*lines, "os._exit(0)"])
    assert "the code wrote into the pipe to its caller" in outcome(program)


@pytest.mark.parametrize(("between", "shown"), [("x" * 296, True), ("x" * 297, False)])
def test_output_stands_within_300_characters_ends_of_lines_among_them(between, shown):
    (one,) = listings_in(document_of(f"```python\nprint(1)\n```\n\n{between}\n\n```\n1\n```\n", "markdown"))
    assert (one.printed is not None) is shown


def test_200_listings_are_run_and_60_first_lines_tried():
    many = lambda count: document_of("```python\n1\n```\n" * count, "markdown")
    assert len(listings_in(many(200))) == 200
    with pytest.raises(ValueError, match="the text has 201 listings; at most 200 are run"):
        listings_in(many(201))
    for lines in (60, 61):
        (one,) = listings_in(document_of("x = 1\n" * lines + "Output:\n\n1\n"))
        assert one.program.text.count("\n") == 60


def test_limits_of_what_listings_take_write_and_print(monkeypatch):
    given = []

    def refuse(what, limits, **_):
        given.append(limits)
        raise LookupError

    assert "prints more" not in outcome("print('x' * (2**20 - 1))")
    assert "prints more" in outcome("print('x' * 2**20)")
    monkeypatch.setattr(listings, "Session", refuse)
    with pytest.raises(LookupError):
        outcome("1")
    assert given == [Limits(seconds=10, memory=2 * 2**30, file=64 * 2**20)]


def test_listing_is_not_read_by_the_rules_that_our_own_code_asks_for():
    """Annotations are values in it: from __future__ import annotations is ours."""
    for shows in (False, True):
        program = "def f(x: 1 + 1): ...\nprint(f.__annotations__['x'] * 2)"
        assert listings.run_listing({"program": program, "shows": shows}) == {"printed": "4\n", "error": None}


def test_a_cell_shows_its_last_value_and_of_an_error_500_characters_are_told():
    for shows, printed in ((True, "3\n"), (False, "")):
        assert listings.run_listing({"program": "x = 2\nx + 1", "shows": shows}) == {"printed": printed, "error": None}
    told = listings.run_listing({"program": "def f(): raise ValueError('x' * 489)\nf()", "shows": True})["error"]
    assert told == f"ValueError: {'x' * 488} (line 2 of the listing)"


def test_names_are_shared_and_order_is_kept():
    alone = run_listings(document_of(MARKDOWN.replace("x = 3\nprint(f", "print(f"), "markdown"))
    assert [finding.claim for finding in alone.findings] == ["listing 1", "listing 2"]


def found(document):
    return [(listing.program.text.strip(), listing.printed is not None) for listing in listings_in(document)]


def test_output_far_away_or_in_another_language_belongs_to_no_listing():
    far = "```python\na\n```\n" + "word " * 100 + "\n```\nb\n```\n"
    assert found(document_of(far, "markdown")) == [("a", False)]
    assert found(document_of("```python\na\n```\n```sh\nb\n```\n", "markdown")) == [("a", False)]
    assert found(document_of("```python\na\n```\n```python\nb\n```\n", "markdown")) == [("a", False), ("b", False)]
    assert found(document_of("```\na\n```\n", "markdown")) == []
    assert run_listings(document_of("```python\nprint(7)\n```\n", "markdown")) == listings.Ran((), 1, ())
    assert run_listings(document_of("```python\n\n```\n\n```\n\n```\n", "markdown")) == listings.Ran((), 1, ((0, 0),))


def test_listing_of_plain_text_begins_where_it_can_be_python():
    assert found(document_of(PLAIN))[0][0].startswith("def double")
    assert found(document_of("prose only\n\nExpected output:\n\n5\n")) == []
    assert found(document_of("import os\nOutput:\n")) == []
    assert found(document_of("print('\\d')\nOutput:\n\\d\n")) == [("print('\\d')", True)], "though Python warns of it"


def test_text_without_listings_starts_no_process(monkeypatch):
    monkeypatch.delattr(listings, "Session")
    assert run_listings(document_of("0.5", "markdown")).count == 0


def test_answer_of_a_listing_that_is_none_is_no_outcome(monkeypatch):
    """As where a program writes into the pipe through which its outcome comes."""
    orders = []
    answer = {"printed": 7, "error": None}
    monkeypatch.setattr(listings.Session, "ask", lambda self, *order: orders.append(order) or answer)
    (finding,) = run_listings(document_of("```python\nprint(1)\n```\n", "markdown")).findings
    assert "an invalid answer" in finding.found
    assert [len(order) for order in orders] == [1, 2], "the start of the process takes nothing of its time"


@given(
    st.lists(
        st.sampled_from(
            ["import x\n", "a = 1\n", "Output:\n", "5\n", "\n", "def f(:\n", "  b\n", "(" * 300, "\0", "'\\d'\n"]
        )
    )
)
def test_no_text_crashes_the_search_for_listings(pieces):
    listings_in(document_of("".join(pieces)))
