"""`driftproof run`: a whole run, certified, and the error budget of its float twin."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands, add_question, progress, rational


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "run",
        help="a whole run, certified to any number of digits",
        description=(
            "Take t/h steps exactly and certify the final state, its errors, energy and phase.\n"
            "Long runs are answered by repeated squaring: ten million steps take a moment."
        ),
        epilog=(
            "examples:\n"
            "  driftproof run forward_euler --h 1/4 --t 10 --digits 30\n"
            "  driftproof run rk4 --h 0.01 --t 100000 --state 0,1 --format json\n"
            "  driftproof run symplectic_euler --h 1/4 --t 10 --budget\n"
        ),
    )
    add_question(parser)
    parser.add_argument("--t", type=rational("t"), required=True, help="final time, a multiple of h")
    parser.add_argument(
        "--budget", action="store_true", help="also run in floats: its error, split in truncation and rounding"
    )
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The certified run, and with --budget the error of the binary64 run beside it."""
    from driftproof.support.plain_text import as_json
    from driftproof.texts.writing.answers import run_answer
    from driftproof.texts.writing.text import answer_text

    question = (options.method, options.h, options.t, options.state, options.digits)
    result = run_answer(*question, options.rounding)
    if not options.budget:
        return as_json(result) if options.format == "json" else answer_text(result)
    from driftproof.reports.rounding import budget_answer, budget_text

    budget = budget_answer(*question, options.rounding, progress)
    if options.format == "json":
        return as_json({**result, "budget": budget})
    return f"{answer_text(result)}\n\n{budget_text(budget)}"
