"""The page of differences is true and complete: it is as its generator writes it, and no difference is left out."""

import re
from pathlib import Path

import pytest

from docs.pages import CONSOLE, SESSION, TABLE, markdown, printed, refreshed, rows_of
from docs.tables import TABLES, agrees, all_claims, found, peers, statements
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.facts import FACTS
from tests.looping import exactly, some

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "differences.md").read_text(encoding="utf-8")
PROSE = TABLE.sub("", SESSION.sub("", CONSOLE.sub("", PAGE)))


@pytest.mark.slow
def test_page_is_what_its_generator_writes_and_wrong_numbers_are_put_right():
    wrong = PAGE
    for shown, planted in (
        ("\n3.69e-18\n", "\n3.68e-18\n"),
        ("real limit       78\n", "real limit       60\n"),
        ("| `tsitouras54` | 5 | 0 |", "| `tsitouras54` | 5 | 5 |"),
        ("-1/8; 1/4*sqrt(2)", "1/8; 1/4*sqrt(2)"),
    ):
        assert shown in PAGE
        wrong = wrong.replace(shown, planted)
    assert refreshed(wrong, TABLES) == PAGE, "run `make docs`"


def written(name):
    """The table as it stands on the page, its header first."""
    match = re.search(rf"<!-- table: {name} -->\n\n(\| (.*) \|\n(?:\|.*\n)*)", PAGE)
    assert match
    return [match[2].split(" | "), *rows_of(match[1])]


NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?")


def numbers(text):
    """Every decimal, and every whole number from 20 on."""
    return {n for n in NUMBER.findall(text) if "." in n or "e" in n or int(n) >= 20}


def test_every_number_of_the_text_stands_in_a_block_or_a_table():
    computed = numbers("".join([*map(" ".join, CONSOLE.findall(PAGE)), *SESSION.findall(PAGE), *tables_of_page()]))
    text = re.sub(r"`[^`]*`|[a-z]+(?:-[a-z]+)*-\d{4}|equation [\d.]+|\(#.*?\)", "", PROSE)
    rounded = len({claim.name.split(",")[0] for claim in all_claims() if claim.found.order != claim.order})
    assert f"| {rounded} tables of rounded decimals |" in text
    assert numbers(text) - {str(rounded)} <= computed
    assert "59.715" in numbers(text)
    assert not numbers(text.replace("59.715", "59.716")) - {str(rounded)} <= computed


def tables_of_page():
    return [match[0] for match in TABLE.finditer(PAGE)]


def test_table_of_orders_lists_every_difference_and_no_other():
    listed = {row[0].strip("`").split(",")[0] for row in written("orders")[1:]}
    assert listed == {key for key, method in METHODS.items() if getattr(method, "decimal", False)}
    assert all(claimed != order for _, claimed, order, *_ in written("orders")[1:])
    assert len(written("orders")) - 1 == int(written("order_count")[1][2]) > 0


# A difference that is not here is a new one: it has to be explained on the page first.
DIFFERENT_IN_PRINT = {("tr_bdf2", "algebraically_stable"), ("ssprk22", "real_limit")}


def test_every_statement_in_print_is_reproduced_or_known_to_differ():
    different = {
        (key, s["fact"])
        for s in statements()
        for key in s["methods"]
        if not agrees(s["says"], found(key, s["fact"], embedded=s.get("embedded", False)))
    }
    assert different == DIFFERENT_IN_PRINT
    assert sum(len(s["methods"]) for s in statements()) > 150
    assert all(key in PAGE.partition("## What is in print")[0] for key, _ in DIFFERENT_IN_PRINT)


@pytest.mark.parametrize(
    ("says", "value", "same"),
    [
        (True, True, True), (True, False, False), ("2.785", {"decimal": "2.78529"}, True),
        ("2.786", {"decimal": "2.78529"}, False), ("-2.0", {"decimal": "2.00000"}, False), ("2", "oo", False),
        ("oo", "oo", True),
    ],
)  # fmt: skip
def test_statement_agrees_in_all_the_digits_that_are_printed(says, value, same):
    assert agrees(says, value) is same


def test_every_answer_of_a_peer_that_is_not_ours_is_explained():
    text = PROSE + "".join(f"{command}\n{shown}" for command, shown in CONSOLE.findall(PAGE))
    for peer in exactly(3, peers().values()):
        for fact, seen in some(peer["facts"].items(), 2):
            assert fact in FACTS
            for key in seen["differs"]:
                assert METHODS[key].decimal or re.search(rf"\b{key}\b", text), (key, fact)


def test_a_difference_of_a_peer_that_is_gone_is_noticed():
    """What we answer is derived here and now, what they answered is kept: the two have to differ still."""
    assert all(theirs != ours for *_, theirs, ours in written("peer_differences")[1:])
    assert len(written("peer_differences")) > 20


def test_sources_are_in_the_bibliography_and_links_have_their_headings():
    known = set(re.findall(r"@\w+\{([^,\s]+),", (ROOT / "references.bib").read_text(encoding="utf-8")))
    keys = re.findall(r"\b[a-z]+(?:-[a-z]+)*-(?:19|20)\d\d\b", PAGE)
    assert len(set(keys)) > 10
    assert set(keys) <= known
    headings = re.findall(r"^#+ (.*)$", PAGE, re.MULTILINE)
    slugs = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
    links = re.findall(r"\]\(#(.*?)\)", PAGE)
    assert len(links) > 10
    assert set(links) <= slugs


def test_tests_that_the_page_names_exist():
    tests = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py"))
    named = re.findall(r"`(test_\w+)`", PAGE)
    assert named
    assert all(f"def {name}(" in tests for name in named)


def test_command_that_fails_is_no_block():
    with pytest.raises(ValueError, match="exit code 2"):
        printed("facts no_such_method")


def test_markdown_keeps_a_bar_inside_its_cell_and_is_read_back():
    shown = markdown([["a", "b"], ["|h|", "1"], ["", "x | y"]])
    assert shown == "| a | b |\n| --- | --- |\n| \\|h\\| | 1 |\n|  | x \\| y |\n"
    assert rows_of(shown) == [["|h|", "1"], ["", "x | y"]]


def test_links_of_all_pages_lead_to_files():
    broken = []
    for path in some((ROOT / "docs").rglob("*.md"), 15):
        prose = re.sub(r"```.*?```|`[^`]*`", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        links = (link.partition("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", prose))
        broken += [f"{path.name}: {link}" for link in links if "://" not in link and not (path.parent / link).exists()]
    assert broken == []
