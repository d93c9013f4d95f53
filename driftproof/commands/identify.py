"""`driftproof identify`: which method a float stepper really is."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands, positive_number

EXAMPLES = """\
examples:
  driftproof identify mylib.integrators:step
  driftproof identify mylib.integrators:rk_step --door field
  driftproof identify mylib.integrators:step --array numpy:float32 --format markdown

what a stepper may look like:
  step(q, v, h) -> (q1, v1)            its system is built in; also step(state, h), and with m, k, t
  step(force, q, v, h) -> (q1, v1)     q'' = force(q)
  step(f, t, y, h) -> y1               y' = f(t, y); also without t
An object with a state, a method that advances it and a force that it calls, or that is given to it, is made one by
  from driftproof import stepper_of
  step = stepper_of(lambda force: Body(acceleration=force), position="x", velocity="v", advance="update")
  step = stepper_of(Body, position="x", velocity="v", push="apply_force", advance="update")
(field_stepper_of for y' = f(t, y)). Wrap anything else in a function of two lines.
It runs in a child process: a hang or a crash is a finding.
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "identify",
        help="which method a float stepper really is",
        description="Read a stepper from outside and say which method it is, of which order, and what it does besides.",
        epilog=EXAMPLES,
    )
    add_target(parser)
    parser.set_defaults(answer=answer)


def add_target(parser: argparse.ArgumentParser) -> None:
    """What `identify` and `verify` share: the stepper, its door, its numbers, the time limit, the format."""
    parser.add_argument("step", metavar="MODULE:STEP", help="where the stepper is imported from, e.g. mylib.ode:step")
    parser.add_argument("--door", choices=("map", "force", "field"), help="if the names of its parameters do not tell")
    parser.add_argument("--array", metavar="MODULE:MAKER", help="what makes its numbers of floats, e.g. torch:tensor")
    parser.add_argument(
        "--time-limit", type=positive_number("time limit"), default=60.0, help="seconds for each question (default 60)"
    )
    parser.add_argument(
        "--format", choices=("text", "json", "markdown"), default="text", help="markdown is ready for an issue"
    )


def answer(options: argparse.Namespace) -> str:
    """The report in the format asked for."""
    from driftproof.blackbox.identify import identify

    report = identify(options.step, door=options.door, array=options.array, time_limit=options.time_limit)
    return report.written(options.format)
