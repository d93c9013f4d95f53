"""`driftproof diff`: what changed between two files of values."""

from __future__ import annotations

import argparse
from pathlib import Path

from driftproof.commands.arguments import Commands, Refuted

FORMATS = ("text", "json", "github")

EXAMPLES = """\
examples:
  driftproof diff old.json new.json
  driftproof diff old.json new.json --format github      annotations, for a continuous-integration run

old.json and new.json are what `driftproof values` printed then, and what it prints now.
The exit status is 0 where no value changed, 1 where one did, 2 where a file cannot be read. A number changed in value
if its exact forms differ, or its decimals cannot be roundings of one number; only in digits if more or fewer are shown.
Outputs of `driftproof facts`, `step` and `run --format json` are compared as well.
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "diff",
        help="what changed between two files of values: value, digits or wording",
        description="Compare two files of values: what changed in value, what only in digits or in wording, what is"
        " new and what is gone.",
        epilog=EXAMPLES,
    )
    parser.add_argument("old", type=Path, help="what `driftproof values` printed before")
    parser.add_argument("new", type=Path, help="what it prints now")
    parser.add_argument("--format", choices=FORMATS, default="text", help="text, json, or annotations for github")
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The changes in the format asked for. Raises Refuted if a value changed."""
    from driftproof.texts.values.changes import VALUE, changes, read_document
    from driftproof.texts.values.changes_report import FORMATS as REPORTS

    found = changes(read_document(options.old), read_document(options.new))
    report = REPORTS[options.format](found, options.old, options.new)
    if any(change.kind == VALUE for change in found):
        raise Refuted(report)
    return report
