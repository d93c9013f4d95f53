"""`driftproof step`: one step, exactly."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands, add_question


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "step",
        help="one step, exactly",
        description="Take one step of q' = v, v' = -q exactly, and print fractions with certified decimals.",
        epilog=(
            "examples:\n"
            "  driftproof step rk4 --h 1/2 --state 1,0\n"
            "  driftproof step symplectic_euler --h 0.5 --state 0,1 --format json\n"
        ),
    )
    add_question(parser)
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The state after the step and its energy."""
    from driftproof.support.plain_text import as_json
    from driftproof.texts.writing.answers import step_answer
    from driftproof.texts.writing.text import answer_text

    result = step_answer(options.method, options.h, options.state, options.digits, options.rounding)
    return as_json(result) if options.format == "json" else answer_text(result)
