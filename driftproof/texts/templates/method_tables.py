"""A table of methods: one row for each, one column for each question that is asked of all of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from driftproof.texts.questions.asking import Asking
from driftproof.texts.questions.parser import parse
from driftproof.texts.questions.runs import READOUTS
from driftproof.texts.questions.syntax import Asked
from driftproof.texts.templates import quantities
from driftproof.texts.templates.problems import Refusal
from driftproof.texts.templates.quantities import Manner, Quantity

MOST_CELLS = 10_000
_COLUMN = re.compile(r"(?P<asked>.*?)(?: (?P<form>digits|places) (?P<count>[0-9]{1,6})| (?P<exact>exact))?")


def methods_table(
    ask: Callable[[str], Quantity],
    methods: Sequence[str],
    columns: Sequence[str] | Mapping[str, str],
    h: str | None,
    t: str | None,
    manner: Manner,
) -> str:
    """The table in the kind of text. A column is a readout of the run to t by steps of h, or else a fact.

    It says how its numbers are written: "state_error digits 4", "energy_change places 3", "imaginary_limit exact";
    where it says nothing, they must be short. A mapping names the columns: {"Calls": "evaluations"}. Raises Refusal,
    and what `ask` raises.
    """
    methods, named = _names(methods), _columns(columns)
    if not 0 < len(methods) * len(named) <= MOST_CELLS:
        raise Refusal(f"a table of methods has from 1 to {MOST_CELLS} cells; name methods and columns")
    run = "" if h is None and t is None else f"h={h} t={t}"
    escape = manner.kind.escape
    header = [escape(name) for name in ("Method", *named)]
    rows = [
        [escape(_title(key, ask)), *(_cell(ask, key, column, run, manner) for column in named.values())]
        for key in methods
    ]
    return manner.kind.table([header, *rows])


def _names(methods: Sequence[str]) -> list[str]:
    if isinstance(methods, str) or not all(isinstance(key, str) for key in methods):
        raise Refusal('methods are a list of keys, as in ["rk4", "forward_euler"]')
    return list(methods)


def _columns(columns: Sequence[str] | Mapping[str, str]) -> dict[str, str]:
    named = dict(columns) if isinstance(columns, Mapping) else {_heading(column): column for column in columns}
    if not all(isinstance(column, str) for column in named.values()) or isinstance(columns, str):
        raise Refusal('columns are a list, as in ["state_error digits 4", "evaluations"], or named in a mapping')
    return named


def _heading(column: object) -> str:
    """What is asked, in words."""
    match = _COLUMN.fullmatch(str(column))
    words = (match["asked"] if match else str(column)).replace("_", " ")
    return words if len(words) == 1 else words[:1].upper() + words[1:]


def _title(key: str, ask: Callable[[str], Quantity]) -> str:
    """The title of a method. Raises QuestionError, as a question about it does, where there is none of that key."""
    question = f"order {key}"
    node = parse(question)
    if not isinstance(node, Asked):
        raise Refusal(f"{key[:40]!r} is no key of a method")
    return Asking(node, question).method().title


def _cell(ask: Callable[[str], Quantity], key: str, column: str, run: str, manner: Manner) -> str:
    match = _COLUMN.fullmatch(column)
    assert match  # the lazy part takes everything else
    head, _, rest = match["asked"].partition(" ")
    if head in READOUTS and not run:
        raise Refusal(f"the column {head!r} is read out of a run; give h and t")
    found = ask(f"run {key} {run} : {match['asked']}" if head in READOUTS else f"{head} {key} {rest}".rstrip())
    if match["form"]:
        return getattr(quantities, match["form"])(found, int(match["count"]), manner)  # type: ignore[no-any-return]
    if match["exact"]:
        return quantities.exact(found, manner, in_code=False)
    return str(found)
