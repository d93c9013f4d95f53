"""`driftproof values`: every form to the letter, patterns over ids, and never a blank for a number."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from driftproof.commands.arguments import BAD_INPUT
from driftproof.texts.values import published as values

Run = Callable[..., tuple[int, str, str]]

Answer = Callable[..., str]

DOCUMENT = {
    "rounding": "half-even",
    "values": {
        "a.h": {"exact": "1/4", "decimal": "0.25", "printed": {"L1": "0.25"}, "evidence": "PROVED"},
        "b.state_error": {
            "exact": None,
            "decimal": "2.390",
            "printed": {"L3": "2.390", "L2": "2.39", "L4": "2.39"},
            "evidence": "CERTIFIED",
        },
    },
}

RENDERED = {
    "md": "| id | exact | decimal | printed |\n|---|---|---|---|\n| `a.h` | `1/4` | 0.25 | 0.25 |\n"
    "| `b.state_error` |  | 2.390 | 2.39, 2.390 |\n",
    "csv": "id,exact,decimal,printed,evidence\na.h,1/4,0.25,0.25,PROVED\nb.state_error,,2.390,2.39 2.390,CERTIFIED\n",
}


@pytest.fixture
def published(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(values, "_document", lambda: json.loads(json.dumps(DOCUMENT)))


@pytest.mark.usefixtures("published")
@pytest.mark.parametrize("form", RENDERED)
def test_values_are_rendered(form: str, answer: Answer) -> None:
    assert answer("values", "--format", form) == RENDERED[form]


@pytest.mark.usefixtures("published")
def test_values_as_json_are_canonical_and_as_javascript_the_same(answer: Answer) -> None:
    assert json.loads(answer("values")) == DOCUMENT
    script = answer("values", "--format", "js").split("export const values = ")[1]
    assert json.JSONDecoder().raw_decode(script)[0] == DOCUMENT["values"]


@pytest.mark.usefixtures("published")
def test_only_takes_a_shell_pattern_in_every_format(answer: Answer, run: Run) -> None:
    assert set(json.loads(answer("values", "--only", "a.*"))["values"]) == {"a.h"}
    assert answer("values", "--only", "*error", "--format", "csv").endswith(
        "evidence\nb.state_error,,2.390,2.39 2.390,CERTIFIED\n"
    )
    assert run("values", "--only", "A.*")[0] == BAD_INPUT


@pytest.mark.usefixtures("published")
def test_missing_decimal_is_an_error_and_never_a_blank(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(values, "_document", lambda: {"values": {"x": {"exact": "1", "printed": {}, "evidence": "P"}}})
    for form in ("tex", *RENDERED):
        with pytest.raises(KeyError):
            run("values", "--format", form)
