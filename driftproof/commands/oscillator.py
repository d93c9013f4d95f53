"""`driftproof step`, `run` and `roundoff`: exact steps and runs on the oscillator, and bounds on rounding errors."""

from __future__ import annotations

from argparse import Namespace

from driftproof.commands import arguments as cli
from driftproof.support.plain_text import DIGITS_UNASKED

QUESTION = (
    cli.METHOD,
    cli.option("--h", "step size, such as 1/4 or 0.25", type=cli.nonzero_step, required=True),
    cli.option("--state", "start: position,velocity (default 1,0)", type=cli.initial_state, default="1,0"),
    cli.digits_option("significant digits (default 15)", default=DIGITS_UNASKED),
    cli.option("--rounding", "how ties are rounded", choices=("half-even", "half-away"), default="half-even"),
    cli.TEXT_OR_JSON,
)
FLOAT_FORMATS = cli.names_in("driftproof.symbolic.rounding.formats", "FORMATS")


@cli.command(*QUESTION)
def step_command(options: Namespace) -> str:
    """Take one step of q' = v, v' = -q exactly, and print fractions with certified decimals.

    examples:
      driftproof step rk4 --h 1/2 --state 1,0
      driftproof step symplectic_euler --h 0.5 --state 0,1 --format json
    """
    return cli.answer_of("step", options)


@cli.command(
    *QUESTION,
    cli.option("--t", "final time, a multiple of h", type=cli.exactly("t"), required=True),
    cli.flag("--budget", "also run in floats, and split the error into truncation and rounding"),
)
def run_command(options: Namespace) -> str:
    """Take t/h steps exactly and certify the final state, its errors, energy and phase.
    Long runs are computed by repeated squaring: ten million steps take a moment.

    examples:
      driftproof run forward_euler --h 1/4 --t 10 --digits 30
      driftproof run rk4 --h 0.01 --t 100000 --state 0,1 --format json
      driftproof run symplectic_euler --h 1/4 --t 10 --budget
    """
    return cli.answer_of("run", options)


@cli.command(
    cli.METHOD,
    cli.steps_option("step sizes, such as 1/4,1/8"),
    cli.option("--float", "the number format (default binary64)", choices=FLOAT_FORMATS, default="binary64"),
    cli.TEXT_OR_JSON,
)
def roundoff_command(options: Namespace) -> str:
    """Derive a bound on the rounding error of one step from its program: as a formula, to first order and in full,
    and in units of u at the given step sizes. It bounds the distance to the exact step of the method's definition;
    if the program rounds coefficients, also the distance to the exact step with the rounded coefficients.

    examples:
      driftproof roundoff rk4
      driftproof roundoff rk4 --h 1/4,5/2
      driftproof roundoff yoshida4 --h 1/10
      driftproof roundoff velocity_verlet --h 1/32 --float binary32
    """
    return cli.answer_of("roundoff", options)
