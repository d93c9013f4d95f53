"""`driftproof values`: the numbers of the lesson, proved."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands


def add(commands: Commands) -> None:
    """Describe the command."""
    from driftproof.texts.values.published import FORMATS

    parser = commands.add_parser(
        "values",
        help="the numbers of the lesson, proved",
        description="Print every number that the lesson prints, by id, as the last green run of the proofs wrote it.",
        epilog=(
            "examples:\n"
            "  driftproof values\n"
            "  driftproof values --only 'rk4.*' --format md\n"
            "  driftproof values --only '*.state_error' --format csv\n"
            "  driftproof values --format js       a module for web pages: save it as driftproof.mjs\n"
            "  driftproof values --format tex      definitions for \\driftproof{id}: save it as values.tex\n"
        ),
    )
    parser.add_argument("--only", default="*", metavar="PATTERN", help="ids that match this shell pattern")
    parser.add_argument("--format", choices=tuple(FORMATS), default="json", help="json is canonical")
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The published values in the format asked for."""
    from driftproof.texts.values.published import published_values, render_values

    return render_values(published_values(options.only), options.format)
