"""`driftproof certify`: an enclosure of the true error of a trajectory, from a function and a file."""

from __future__ import annotations

import re
from argparse import Namespace
from fractions import Fraction
from pathlib import Path

from driftproof.commands import arguments as cli
from driftproof.support.plain_text import as_json


@cli.read_by
def _step(text: str) -> Fraction:
    """A step size: an exact number, or the double that a hexadecimal float spells."""
    from driftproof.enclosure.trajectories import float_of_text
    from driftproof.methods.numbers.rationals import parse_rational

    return Fraction(float_of_text(text)) if "0x" in text.lower() else parse_rational(text, "h")


@cli.command(
    cli.option("function", "f of y' = f(t, y): module:f, its text, or a .toml file", metavar="F"),
    cli.option("run", "the trajectory: a .csv, .txt, .dat, .npz or .npy file", type=Path),
    cli.parameters_option("other values of parameters of a file, or keywords of a function, such as beta=0.55"),
    cli.option(
        "--method", "also split the error, for this method: a key, .toml file, or SciPy's RK23, RK45, DOP853, Radau"
    ),
    cli.option("--h", "the step size, if the file has only some points of the run", type=_step),
    cli.option(
        "--invariant", "a first integral: NAME=TEXT, or a known NAME", action="append", default=[], metavar="NAME"
    ),
    cli.option("--tolerance", "exit with status 1 if any error is larger", type=cli.positive_number("tolerance")),
    cli.option("--figure", "also draw the error against time, as .svg", type=Path, metavar="FILE"),
    cli.TEXT_OR_JSON,
)
def certify_command(options: Namespace) -> str:
    """Enclose the true error of a float trajectory of y' = f(t, y), from any solver in any language.
    The true solution starts exactly at the first point of the file.

    examples:
      driftproof certify mylib.models:pendulum run.csv
      driftproof certify 'y1; -sin(y0)' run.csv --method RK45 --tolerance 1e-6
      driftproof certify pendulum.toml run.csv --figure error.svg --format json

    what f may be:
      module:f        your own Python function f(t, y), unchanged: arithmetic, math, NumPy; imported from this folder
      'y1; -sin(y0)'  rates in t, y0, ..., sin, cos, tan, exp, log, sqrt, tanh, abs, max, exact numbers; or equations:
                      "x'=v, v'=-k*sin(x), k=2"; with "x''=-sin(x)", all velocities follow the positions in the file
      file.toml       rates = ["y1", "-g * sin(y0)"], or rates.theta = "omega" and so on; [parameters] with g = "9.81";
                      or function = "module:f"; a run that has another start or end than the file is told so
    f runs in this process with your rights, as in your own tests; Ctrl-C stops it.

    what the file holds:
      .csv   (.txt, .dat) a line for each time: t and the components, separated by commas, semicolons or blanks. Names
             in the first line tell which column is t, and which is which unknown of f if f has names; without them the
             first column is t. Lines that begin with # are skipped. Write decimals of 17 digits (Fortran's 1.5D0 is
             understood), or hexadecimal floats such as 0x1.8p+0, as C and C++ print with %a, which keep every bit.
      .npz   the arrays t and y (or ts and ys), a row or a column for each time
      .npy   one array, with a row for each time: t and the components

    With --method, error = truncation + rounding, each enclosed: the method is run exactly with the steps of the run,
    which lead from point to point, or have the size --h. Points that it does not reach so are told, with their error.
    With --invariant, the drift of a first integral is enclosed and split as well: energy='y1^2/2 - cos(y0)', or
    oscillator_energy, pendulum_energy, kepler_energy, angular_momentum, henon_heiles_energy.

    exit status: 0 if the error is enclosed, and within --tolerance if that is given; 1 if it exceeds --tolerance, or if
    the run is not of --method, whose total error is shown; 2 if the input is wrong; 3 if nothing can be proved, with
    the reason, such as a pole near the trajectory, or if a run that is off may be of SciPy's Radau.
    """
    from driftproof.blackbox.stepper.opening import imported
    from driftproof.enclosure.certify import certify, within
    from driftproof.enclosure.runs.exact_runs import NotItsSteps, PerhapsItsSteps
    from driftproof.methods.formulas.field_text import field_of_text
    from driftproof.reports.certificate_figure import draw_certificate

    given = options.function
    if re.fullmatch(r"[^\W\d]\w*(\.[^\W\d]\w*)+", given) and not given.endswith(".toml"):
        raise ValueError(f"{given} is no right-hand side; for a function write {':'.join(given.rsplit('.', 1))}")
    f = given if given.endswith(".toml") else imported(given, "function") if ":" in given else field_of_text(given)
    about = {
        "parameters": options.parameters,
        "method": options.method,
        "h": options.h,
        "invariants": _invariants(options.invariant),
    }
    undecided = False
    try:
        found = certify(f, options.run, **about)
    except NotItsSteps as refusal:
        if refusal.total is None:
            raise
        found, undecided = refusal.total, isinstance(refusal, PerhapsItsSteps)
    good = options.tolerance is None or within(found, options.tolerance)
    drawn = draw_certificate(found, f"Error of {options.run.name}", options.figure) if options.figure else None
    if options.format == "json":
        within_it = {} if options.tolerance is None else {"tolerance": repr(options.tolerance), "within": good}
        written = as_json(found.record() | within_it)
    else:
        verdict = f"{'within' if good else 'BEYOND'} the tolerance {options.tolerance}" if options.tolerance else ""
        written = "\n".join(filter(None, [found.text(), verdict, f"wrote {drawn}" if drawn else ""]))
    if not good or found.unsplit:
        raise cli.Undecided(written) if good and undecided else cli.Refuted(written)
    return written


def _invariants(given: list[str]) -> dict[str, str]:
    from driftproof.enclosure.invariants import known_invariant

    pairs = [each.partition("=") for each in given]
    return {name.strip(): text if equals else known_invariant(name) for name, equals, text in pairs}
