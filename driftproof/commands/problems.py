"""`driftproof stability` and `work-precision`: which steps a method can take on a problem, and what accuracy costs."""

from __future__ import annotations

import sys
from argparse import Namespace
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from driftproof.commands import arguments as cli
from driftproof.support.plain_text import printable

if TYPE_CHECKING:
    from driftproof.reports.work_precision.study import Measured, Study

# One of each behaviour, and the lesson's three among them.
STABILITY_METHODS = ("forward_euler", "rk4", "symplectic_euler", "backward_euler", "implicit_midpoint", "radau_iia2")
# The lesson's three, and one of each kind beside them.
WORK_PRECISION_METHODS = (
    *("forward_euler", "symplectic_euler", "rk4"),
    *("velocity_verlet", "dormand_prince54", "blanes_moan6", "gauss2"),
)


@cli.command(
    cli.option("problem", "a problem, or a .toml file of one; without one they are listed", nargs="?"),
    cli.methods_option(f"keys or .toml files (default {','.join(STABILITY_METHODS)})"),
    cli.steps_option("step sizes that divide t, such as 1/4,1/8 (default: 10, 100 and 1000 steps)"),
    cli.TEXT_OR_JSON,
)
def stability_command(options: Namespace) -> str:
    """Which steps methods can take on a stiff or extreme problem, where runs end, and what is expected.

    examples:
      driftproof stability                                        lists the problems
      driftproof stability stiff_oscillator
      driftproof stability dahlquist_1e3 --h 1/500,1/256 --methods forward_euler,rk4,backward_euler
      driftproof stability kepler_eccentric --methods rk4,velocity_verlet,yoshida4 --format json

    On a linear problem y' = Ay the verdicts are proved, at exactly the double h that is run, read as a fraction. The
    largest step is also found by bisection on the float step itself. On any other problem, what was seen is said.

    your own problem, in mine.toml, whose true solution is enclosed to 20 digits:
      title = "A pendulum of 1 m"
      rates = ["y1", "-g * sin(y0)"]        in t, y0, y1, ...; sin, cos, exp, log, sqrt; powers; 0.1 is 1/10
      start = ["1/2", "0"]                  at t = 0
      end = "10"
      energy = "y1^2/2 - g * cos(y0)"       may be left out, as may the title
      parameters.g = "9.81"
    in the place of rates and parameters: function = "mylib.models:pendulum", your own f(t, y)
    """
    from driftproof.numeric.problems.catalogue import PROBLEMS
    from driftproof.reports.stability import problems_json, problems_text, stability_answer, stability_text
    from driftproof.reports.user_problem import problem_given

    if options.problem is None:
        return cli.as_asked(options, problems_json(PROBLEMS.values()), problems_text)
    methods = options.methods or STABILITY_METHODS
    walk = partial(cli.with_progress, unit="method")
    found = stability_answer(problem_given(options.problem), methods, options.h, walk)
    return cli.as_asked(options, found, stability_text)


@cli.command(
    cli.option(
        "problem", "`driftproof stability` lists them; or a .toml file", nargs="?", default="harmonic_oscillator"
    ),
    cli.methods_option(f"keys or .toml files (default {','.join(WORK_PRECISION_METHODS)})"),
    cli.output_option("a folder for files and figures; an interrupted study goes on from it", metavar="FOLDER"),
    cli.list_option("--peers", "scipy, diffrax, heyoka, ...", type=cli.several(str), metavar="P,P"),
    cli.time_limit_option(
        "seconds that a point may be timed for; what would take longer is marked as such;"
        " its error is seen up to 10⁸ evaluations for each of these seconds, on every machine the same (default 0.1)",
        default=0.1,
        metavar="S",
    ),
    cli.TEXT_OR_JSON,
)
def work_precision_command(options: Namespace) -> str:
    """What error methods reach on a problem, at how many evaluations of f, in what time.

    examples:
      driftproof work-precision --methods rk4,velocity_verlet --time-limit 0.01
      driftproof work-precision kaps --methods rk4,radau_iia2 --time-limit 0.01 -o measured/

    Without any argument: seven methods on the harmonic oscillator, in about ten seconds.

    Each method runs at numbers of steps that double, until rounding is all that is left of its error. Errors are formed
    exactly, against digits that are certified; evaluations of f are counted. Times are of one trajectory, compiled
    (extra `fast`) and in plain Python, and of one state of an ensemble; they are measured in turns, in random order.

    A method is dominated when each of its points is beaten by a point of another with no more error for no more cost.

    -o writes into the folder
      errors.json                errors, evaluations, measured orders: the same in every run
      times.json                 all that was measured in seconds, with machine and versions
      work_precision.csv         both, one row a point
      work_precision_state.svg   the figures: state, energy, phase (needs the extra: pip install 'driftproof[report]')
      points.json                what an interrupted study goes on from
    --peers runs scipy, diffrax, heyoka or torchdiffeq beside ours (extra `peers`), at tolerances from 1e-3 to 1e-13.
    """
    from driftproof.methods.tableau_file import method_of
    from driftproof.reports.sweeps import progress_bar
    from driftproof.reports.user_problem import problem_given
    from driftproof.reports.work_precision.peers import peers_named
    from driftproof.reports.work_precision.report import errors_json, study_text, times_json
    from driftproof.reports.work_precision.study import Study, measure
    from driftproof.support.files import require_folder, sole_writer

    methods = [method_of(name) for name in options.methods or WORK_PRECISION_METHODS]
    study = Study(problem_given(options.problem), methods, peers_named(options.peers), options.time_limit)
    with ExitStack() as stack:
        if options.output:
            require_folder(options.output)
            options.output.mkdir(parents=True, exist_ok=True)
            stack.enter_context(sole_writer(options.output))
        bar = stack.enter_context(progress_bar(0, "point"))

        def progress(more: int, done: int) -> None:
            bar.total += more
            bar.update(done)

        measured = measure(study, options.output, _say, progress)
        written = _write(study, measured, options.output) if options.output else []
    both = {"errors": errors_json(study, measured), "times": times_json(study, measured)}
    return cli.as_asked(options, both, lambda _: "\n".join([study_text(study, measured), *written]))


def _write(study: Study, measured: Measured, folder: Path) -> list[str]:
    """A line for each file; the figures are left out, with the reason, where nothing can be drawn."""
    from driftproof.numeric.work_precision.exact import floors
    from driftproof.reports.work_precision.report import write_study
    from driftproof.support.environment import how_to_install, installed

    lines = [f"wrote {path}" for path in write_study(study, measured, folder)]
    if not installed("matplotlib"):
        return [*lines, f"no figures: matplotlib is not installed; {how_to_install('report')}"]
    from driftproof.reports.work_precision.figure import draw_study

    return [*lines, *(f"wrote {draw_study(study, measured, quantity, folder)}" for quantity in floors(study.problem))]


def _say(line: str) -> None:
    print(printable(f"driftproof work-precision: {line}"), file=sys.stderr)
