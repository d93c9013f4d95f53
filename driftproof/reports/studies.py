"""Studies of error against work: measured, printed, and written to a folder."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path

from driftproof.enclosure.problem_tables import GivenParameters
from driftproof.methods.catalogue import METHODS
from driftproof.methods.given_methods import GivenMethods, methods_of
from driftproof.methods.numbers.rationals import ExactNumber, exact_number
from driftproof.numeric.reference_errors import floors
from driftproof.numeric.stability import STIFF_DECAY, fastest_decay
from driftproof.reports.progress import kept_in, progress_bar
from driftproof.reports.stability import steps_for_decay
from driftproof.reports.user_problem import GivenProblem, problem_given
from driftproof.reports.work_precision.peers import peers_named
from driftproof.reports.work_precision.report import study_text
from driftproof.reports.work_precision.study import Study, measure
from driftproof.reports.work_precision.study_files import errors_json, times_json, write_study
from driftproof.support.files import require_folder, sole_writer
from driftproof.support.plain_text import printable
from driftproof.support.results import Answered

# The lesson's three, and one method of each further kind.
WORK_PRECISION_METHODS = (
    *("forward_euler", "symplectic_euler", "rk4"),
    *("velocity_verlet", "dormand_prince54", "blanes_moan6", "gauss2"),
)


# Where the problem is stiff: an explicit pair beside implicit methods of one stage, of diagonal and of full tableaux,
# multistep methods, and one that takes a Jacobian.
_FOR_STIFF = (
    *("dormand_prince54", "backward_euler", "tr_bdf2", "gauss2", "radau_iia2", "radau_iia3"),
    *("bdf2", "bdf4", "rodas4"),
)


def work_precision(
    problem: GivenProblem = "harmonic_oscillator",
    methods: GivenMethods = (),
    *,
    parameters: GivenParameters = (),
    error: ExactNumber | Sequence[ExactNumber] = (),
    peers: Sequence[str] = (),
    time_limit: ExactNumber = 0.1,
    output: str | Path | None = None,
) -> Answered:
    """The errors that methods reach on a problem, with how many evaluations of f, in what time; `found` has the points.

    A point may be timed for `time_limit` seconds; runs for errors may take 10⁸ evaluations for each of these seconds.
    `parameters` replace some of the problem's own. Without methods a stiff problem gets implicit ones. `error` is the
    accuracy that you want, or several: which point reaches it with the fewest evaluations is told first. `output` is a
    folder for files and figures, from which an interrupted study goes on. Raises ValueError.

    >>> from driftproof import work_precision
    >>> study = work_precision("dahlquist_1", ["forward_euler"], time_limit=1e-4)
    >>> study["errors"]["curves"][0]["points"][0]["evaluations"]
    8
    """
    about = problem_given(problem, parameters)
    decay, at = fastest_decay(about)
    usual = _FOR_STIFF if decay * about.t >= STIFF_DECAY else WORK_PRECISION_METHODS
    asked = methods_of(methods or usual)
    study = Study(about, asked, peers_named(peers), float(Fraction(time_limit)), errors_wanted(error))
    folder, written = None if output is None else Path(output), list[str]()
    with ExitStack() as stack:
        if folder:
            require_folder(folder)
            folder.mkdir(parents=True, exist_ok=True)
            stack.enter_context(sole_writer(folder))
        bar = stack.enter_context(progress_bar(0, "point"))

        def progress(more: int, done: int) -> None:
            bar.total += more
            bar.update(done)

        say = lambda line: print(printable(f"driftproof work-precision: {line}"), file=sys.stderr)
        with kept_in(folder):
            measured = measure(study, folder, say, progress)
        if folder:
            from driftproof.reports.work_precision.figure import draw_study

            figures = [draw_study(study, measured, quantity, folder) for quantity in floors(study.problem)]
            written = [f"wrote {path}" for path in (*write_study(study, measured, folder), *figures)]
    both = {"errors": errors_json(study, measured), "times": times_json(study, measured)}
    stiff = (
        f"This is stiff: an eigenvalue of df/dy is {-decay:.3g} at t = {at:g}, where errors of rk4 grow in a run of"
        f" fewer than {steps_for_decay(METHODS['rk4'], about.t, decay)} steps; those of implicit methods do not"
        if usual is _FOR_STIFF
        else ""
    )
    return Answered(both, lambda _: "\n".join([study_text(study, measured, stiff), *written]), measured)


def errors_wanted(error: ExactNumber | Sequence[ExactNumber]) -> list[float]:
    """The errors that are wanted, from one, from several, or from a text like "1e-5,1e-8". Raises ValueError."""
    errors = error.split(",") if isinstance(error, str) else error if isinstance(error, Sequence) else [error]
    wanted = [x if isinstance(x, float) else float(exact_number(x, "error")) for x in errors]
    if not all(x > 0 for x in wanted):
        raise ValueError(f"error = {error}; must be positive")
    return wanted
