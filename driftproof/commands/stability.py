"""`driftproof stability`: which steps a method can take on a problem, as proved and as seen."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence

from driftproof.commands.arguments import Commands, add_format, add_methods, add_sizes

# One of each behaviour, and the lesson's three among them.
DEFAULT = ("forward_euler", "rk4", "symplectic_euler", "backward_euler", "implicit_midpoint", "radau_iia2")

EXAMPLES = """\
examples:
  driftproof stability                                        lists the problems
  driftproof stability stiff_oscillator
  driftproof stability dahlquist_1e3 --h 1/500,1/256 --methods forward_euler,rk4,backward_euler
  driftproof stability kepler_eccentric --methods rk4,velocity_verlet,yoshida4 --format json

On a linear problem y' = Ay the verdicts are proved, at exactly the double h that is run: it is read as a fraction. The
largest step is also found by bisection on the float step itself. On any other problem, what is said is what was seen.
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "stability",
        help="which steps a method can take on a problem: proved, and seen",
        description="Which steps methods can take on a stiff or extreme problem, where runs end, and what is expected.",
        epilog=EXAMPLES,
    )
    parser.add_argument("problem", nargs="?", help="a problem; without one they are listed")
    add_methods(parser, f"keys or .toml files (default {','.join(DEFAULT)})")
    add_sizes(parser, "step sizes that divide t, such as 1/4,1/8 (default: 10, 100 and 1000 steps)")
    add_format(parser)
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The tables for one problem, or the list of problems."""
    from driftproof.numeric.problems.catalogue import PROBLEMS, problem_named
    from driftproof.reports.stability import problems_json, problems_text, stability_answer, stability_text
    from driftproof.support.plain_text import as_json

    if options.problem is None:
        listed = problems_json(PROBLEMS.values())
        return as_json(listed) if options.format == "json" else problems_text(listed)
    result = stability_answer(problem_named(options.problem), options.methods or DEFAULT, options.h, _walk)
    return as_json(result) if options.format == "json" else stability_text(result)


def _walk(names: Sequence[str]) -> Iterable[str]:
    """The names, with a progress bar on a terminal."""
    if not sys.stderr.isatty():
        return names
    from tqdm import tqdm

    bar: Iterable[str] = tqdm(names, unit="method", leave=False)
    return bar
