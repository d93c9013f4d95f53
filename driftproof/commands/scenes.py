"""`driftproof scenes`: the lesson's presets, listed."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands


def add(commands: Commands) -> None:
    """Describe the command."""
    commands.add_parser(
        "scenes",
        help="list the lesson's scenes",
        description="List the lesson's presets: the method shown, h, t and the number of steps.",
        epilog="example:\n  driftproof scenes\n",
    ).set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The presets as a table."""
    from driftproof.numeric.scenes import PRESETS
    from driftproof.texts.writing.text import scenes_text

    return scenes_text(list(PRESETS.values()))
