"""`driftproof work-precision`: error against evaluations and against run time."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from driftproof.commands.arguments import Commands, add_format, add_methods, add_output, positive_number, several

if TYPE_CHECKING:
    from driftproof.reports.work_precision.study import Measured, Steps, Study

# The lesson's three, and one of each kind beside them.
DEFAULT = (
    "forward_euler",
    "symplectic_euler",
    "rk4",
    "velocity_verlet",
    "dormand_prince54",
    "blanes_moan6",
    "gauss2",
)

EXAMPLES = """\
examples:
  driftproof work-precision --methods rk4,velocity_verlet --time-limit 0.01
  driftproof work-precision kaps --methods rk4,radau_iia2 --time-limit 0.01 -o measured/

Without any argument: seven methods on the harmonic oscillator, in about ten seconds.

Each method runs at numbers of steps that double, until rounding is all that is left of its error. Errors are formed
exactly, against digits that are certified; evaluations of f are counted. Times are of one trajectory, compiled (extra
`fast`) and in plain Python, and of one state of an ensemble; they are measured in turns, in random order.

A method is dominated when each of its points is beaten by a point of another that has no more error for no more cost.

-o writes into the folder
  errors.json                errors, evaluations, measured orders: the same in every run
  times.json                 all that was measured in seconds, with machine and versions
  work_precision.csv         both, one row a point
  work_precision_state.svg   the figures: state, energy, phase (needs the extra: pip install 'driftproof[report]')
  points.json                what an interrupted study goes on from
--peers runs scipy, diffrax, heyoka or torchdiffeq beside ours (extra `peers`), at tolerances from 1e-3 to 1e-13.
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "work-precision",
        help="error against evaluations and against run time",
        description="What error methods reach on a problem, at how many evaluations of f, in what time.",
        epilog=EXAMPLES,
    )
    parser.add_argument("problem", nargs="?", default="harmonic_oscillator", help="`driftproof stability` lists them")
    add_methods(parser, f"keys or .toml files (default {','.join(DEFAULT)})")
    add_output(parser, "a folder for files and figures; an interrupted study goes on from it", "FOLDER")
    parser.add_argument(
        "--peers", type=several(str), action="extend", default=[], metavar="P,P", help="scipy, diffrax, heyoka, ..."
    )
    parser.add_argument(
        "--time-limit",
        type=positive_number("time limit"),
        default=0.1,
        metavar="S",
        help="seconds that a point may be timed for; one that is run for its error alone may take ten times as long;"
        " what would take longer is marked as such (default 0.1)",
    )
    add_format(parser)
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The tables, and where files were written."""
    from driftproof.numeric.problems.catalogue import problem_named
    from driftproof.reports.work_precision.peers import peers_named
    from driftproof.reports.work_precision.report import errors_json, text, times_json
    from driftproof.reports.work_precision.study import Study, measure
    from driftproof.support.files import demand_folder
    from driftproof.support.plain_text import as_json
    from driftproof.texts.writing.facts import method_of

    methods = [method_of(name) for name in options.methods or DEFAULT]
    study = Study(problem_named(options.problem), methods, peers_named(options.peers), options.time_limit)
    if options.output:
        demand_folder(options.output)
    with _progress() as steps:
        measured = measure(study, options.output, _say, steps)
    written = _write(study, measured, options.output) if options.output else []
    if options.format == "json":
        return as_json({"errors": errors_json(study, measured), "times": times_json(study, measured)})
    return "\n".join([text(study, measured), *written])


def _write(study: Study, measured: Measured, folder: Path) -> list[str]:
    """A line for each file; the figures are left out, with the reason, where nothing can be drawn."""
    from driftproof.numeric.work_precision.exact import floors
    from driftproof.reports.work_precision.report import write
    from driftproof.support.extras import how_to_install, installed

    lines = [f"wrote {path}" for path in write(study, measured, folder)]
    if not installed("matplotlib"):
        return [*lines, f"no figures: matplotlib is not installed; {how_to_install('report')}"]
    from driftproof.reports.work_precision.figure import draw

    return [*lines, *(f"wrote {draw(study, measured, quantity, folder)}" for quantity in floors(study.problem))]


def _say(line: str) -> None:
    print(f"driftproof work-precision: {line}", file=sys.stderr)


@contextmanager
def _progress() -> Iterator[Steps | None]:
    """A bar on a terminal, of which curves and samples are steps."""
    if not sys.stderr.isatty():
        yield None
        return
    from tqdm import tqdm

    from driftproof.reports.work_precision.study import Steps

    with tqdm(total=0, unit="point", leave=False) as bar:

        def expect(more: int) -> None:
            bar.total += more
            bar.refresh()

        yield Steps(expect, lambda: bar.update(1))
