"""`driftproof verify`: whether a float stepper is the method that its name says, to roundoff."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands, Refuted, counted, positive_number, rational
from driftproof.commands.identify import add_target

MOST_EXAMPLES = 10**6

EXAMPLES = """\
examples:
  driftproof verify mylib.integrators:step --method velocity_verlet
  driftproof verify mylib.integrators:rk_step --method tableau.toml --examples 5000
  driftproof verify mylib.implicit:step --method backward_euler --solver-tolerance 1e-10

exit status: 0 if it agrees, 1 if it does not, 2 if the question makes no sense.
`driftproof identify --help` says what a stepper may look like.
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "verify",
        help="whether a float stepper is the method its name says, to roundoff",
        description=(
            "Hold a stepper to a method: its coefficients, its rounding errors against a derived bound, its order.\n"
            "The bound holds for the definition's sums and products in any order, fused or not."
        ),
        epilog=EXAMPLES,
    )
    add_target(parser)
    parser.add_argument("--method", required=True, help="a key that `driftproof methods` lists, or a .toml file")
    parser.add_argument(
        "--examples", type=counted("examples", MOST_EXAMPLES), default=1000, help="steps to try (default 1000)"
    )
    parser.add_argument("--largest-step", type=positive_number("h"), default=2.0, help="0 < h <= this (default 2)")
    parser.add_argument(
        "--largest-state", type=positive_number("state"), default=1000.0, help="|q|, |v| <= this (default 1000)"
    )
    parser.add_argument("--extremes", action="store_true", help="try the smallest floats, too, down to subnormal ones")
    parser.add_argument("--step-in-binary32", action="store_true", help="allow that h is rounded to binary32 first")
    parser.add_argument(
        "--velocity-from-positions", action="store_true", help="allow for v formed as (q1 - q)/h: u (|q| + |q1|)/h"
    )
    parser.add_argument("--flush-to-zero", action="store_true", help="allow that subnormal numbers become 0")
    parser.add_argument(
        "--solver-tolerance", type=rational("solver tolerance"), help="how well implicit stages are solved, e.g. 1e-10"
    )
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The report in the format asked for. Raises Refuted with it where the stepper does not agree."""
    from driftproof.blackbox.judging.agreement import Domain
    from driftproof.blackbox.judging.tolerance import Allowance
    from driftproof.blackbox.verify import verify

    if options.solver_tolerance is not None and options.solver_tolerance < 0:
        raise ValueError(f"solver tolerance {options.solver_tolerance} is below zero")
    smallest = {"smallest_step": 0.0, "smallest_state": 0.0} if options.extremes else {}
    report = verify(
        options.step,
        options.method,
        door=options.door,
        array=options.array,
        examples=options.examples,
        domain=Domain(options.largest_step, options.largest_state, **smallest),
        allowance=Allowance(
            options.step_in_binary32,
            options.velocity_from_positions,
            options.flush_to_zero,
            options.solver_tolerance,
        ),
        time_limit=options.time_limit,
    )
    if not report.passed:
        raise Refuted(report.written(options.format))
    return report.written(options.format)
