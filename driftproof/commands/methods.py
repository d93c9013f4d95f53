"""`driftproof methods`: the catalogue, listed."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands


def add(commands: Commands) -> None:
    """Describe the command."""
    commands.add_parser(
        "methods",
        help="list the methods, and the families with a free parameter",
        description="List the methods of the catalogue: key, family, claimed order, title and source.",
        epilog="example:\n  driftproof methods\n",
    ).set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The catalogue as a table."""
    from driftproof.texts.writing.text import methods_text

    return methods_text()
