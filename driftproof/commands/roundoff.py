"""`driftproof roundoff`: the rounding bound of one step, derived by running it."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands, add_format, add_method, add_sizes


def add(commands: Commands) -> None:
    """Describe the command."""
    from driftproof.symbolic.rounding.formats import FORMATS

    parser = commands.add_parser(
        "roundoff",
        help="the rounding bound of one step, derived by running it",
        description=(
            "Derive the rounding bound of one step from its own program: as a formula, to first order and in full,\n"
            "and in units of u at the step sizes asked for. It bounds the distance to the definition's exact step;\n"
            "where the program rounds coefficients, also that to the step with the coefficients that it holds."
        ),
        epilog=(
            "examples:\n"
            "  driftproof roundoff rk4\n"
            "  driftproof roundoff rk4 --h 1/4,5/2\n"
            "  driftproof roundoff yoshida4 --h 1/10\n"
            "  driftproof roundoff velocity_verlet --h 1/32 --float binary32\n"
        ),
    )
    add_method(parser)
    add_sizes(parser, "step sizes, such as 1/4,1/8")
    parser.add_argument("--float", choices=tuple(FORMATS), default="binary64", help="the number format")
    add_format(parser)
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The bound as formulas, and its values at each h."""
    from driftproof.reports.rounding import roundoff_answer, roundoff_text
    from driftproof.support.plain_text import as_json
    from driftproof.symbolic.rounding.formats import FORMATS

    result = roundoff_answer(options.method, options.h, FORMATS[options.float])
    return as_json(result) if options.format == "json" else roundoff_text(result)
