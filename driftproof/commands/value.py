"""`driftproof value`: a number for a text, asked for in a small language."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import MOST_DIGITS, Commands, counted, digits

EXAMPLES = """\
what can be asked, with [optional parts] and any of a|b:
  ID                                                       a published value, as `driftproof values` lists them
  step METHOD h=1/2 [N=3] [from q,v] : READOUT             q v energy energy_change state_error phase_error
  run METHOD h=1/4 t=10 [from q,v] : READOUT               exact.q exact.v steps evaluations h t k1.q k1.v ...
  exact t=10 [from q,v] : q|v|energy                       the solution itself
  FACT METHOD [at VALUE] [h=1/4] [: PART]                  order, energy_multiplier, imaginary_limit, a_stable, ...
  roundoff METHOD h=1/4 [sharp] [from q,v] : READOUT       q v qq qv vq vv c, bounds in units of u
  + - * / ** ( ) abs sqrt log2 log10 cos sin               on all of these; ratio(a, b) = |a|/|b|, percent(a, b)
Of h, t and N (or steps), two make a run. A start not given is 1,0. phase_error may end in deg, rad or turns.

examples:
  driftproof value rk4.first_step.q --digits 6
  driftproof value 'run symplectic_euler h=1/4 t=10 : phase_error deg' --places 3 --style printed
  driftproof value 'energy_multiplier rk4' --format tex
  driftproof value 'one_step_matrix rk4 h=1/2 : M_qq'
  driftproof value 'ratio(run rk4 h=1/2 t=10 : state_error, run rk4 h=1/4 t=10 : state_error)' --digits 3
  driftproof value 'order sdirk_order_2 at (1/2 + sqrt(3)/6)'
  driftproof value --list      every head, readout, fact, function and id

With --digits or --places only the number is printed, ready for a text. A tie is refused unless --rounding says what it
becomes; tofixed does what JavaScript's toFixed does, away is for bounds. docs/language.md has the whole of it.
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    from driftproof.texts.questions.style import ROUNDINGS

    parser = commands.add_parser(
        "value",
        help="a number for a text, asked for in a small language",
        description="Answer one question exactly, and print the number as a text wants it: digits, rounding, style.",
        epilog=EXAMPLES,
    )
    parser.add_argument("question", nargs="?", help="the question, in quotes")
    count = parser.add_mutually_exclusive_group()
    count.add_argument("--digits", type=digits, metavar="N", help="significant digits")
    count.add_argument("--places", type=counted("places", MOST_DIGITS, 0), metavar="N", help="digits after the point")
    parser.add_argument("--rounding", choices=ROUNDINGS, help="the policy (default half-even, ties refused)")
    parser.add_argument("--style", choices=("plain", "printed"), default="plain", help="-6.7e-5 or −6.7×10⁻⁵")
    parser.add_argument("--format", choices=("text", "json", "tex", "mathml", "md"), default="text")
    parser.add_argument("--list", action="store_true", help="list what can be asked")
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The answer in the format and the style asked for. Raises QuestionError."""
    from dataclasses import replace

    from driftproof.texts.questions import ask, limits
    from driftproof.texts.questions.rendered import Wish, rendered
    from driftproof.texts.questions.style import PLAIN, PRINTED
    from driftproof.texts.questions.vocabulary import vocabulary

    if options.list:
        return vocabulary()
    if options.question is None:
        raise ValueError("no question is asked; write one in quotes, or --list to see what can be asked")
    style = replace(PRINTED if options.style == "printed" else PLAIN, rounding=options.rounding)
    with limits.time_limit(options.question, limits.SECONDS):
        return rendered(ask.value(options.question), Wish(options.digits, options.places, style), options.format)
