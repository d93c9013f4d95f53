"""`driftproof stability` and `work-precision`: which steps a method can take on a problem, and what accuracy costs."""

from __future__ import annotations

from argparse import Namespace

from driftproof.commands import arguments as cli


@cli.command(
    cli.option("problem", "a problem, or a .toml file of one; without one they are listed", nargs="?"),
    cli.methods_option(
        "keys or .toml files (default forward_euler,rk4,symplectic_euler,backward_euler,implicit_midpoint,radau_iia2)"
    ),
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
      rates = ["y1", "-g * sin(y0)"]        in t, y0, y1, ..., pi; sin, cos, exp, log, sqrt; powers; 0.1 is 1/10
      start = ["1/2", "0"]                  at t = 0
      end = "10"
      energy = "y1^2/2 - g * cos(y0)"       may be left out, as may the title
      parameters.g = "9.81"                 a number, or an expression such as "2*pi*f" in pi and parameters before it
    or by names: rates.x = "v", rates.v = "-g * sin(x)", start.x = "1/2", start.v = 0; a single unknown is also called y
    in the place of rates: function = "mylib.models:pendulum", your own f(t, y), parameters being its keywords
    """
    return cli.answer_of("stability", options)


@cli.command(
    cli.option(
        "problem", "`driftproof stability` lists them; or a .toml file", nargs="?", default="harmonic_oscillator"
    ),
    cli.methods_option(
        "keys or .toml files (default"
        " forward_euler,symplectic_euler,rk4,velocity_verlet,dormand_prince54,blanes_moan6,gauss2)"
    ),
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

    Without any argument: seven methods on the harmonic oscillator, in about twenty seconds.

    Each method runs at numbers of steps that double, until rounding is all that is left of its error. Errors are formed
    exactly, against digits that are certified; evaluations of f are counted. Explicit pairs, Gauss's methods and Radau
    IIA also run in controlled steps, at tolerances from 1e-3 to 1e-13. Times are of one trajectory, compiled
    (extra `fast`) and in plain Python, and of one state of an ensemble; they are measured in turns, in random order.

    A method is dominated when each of its points is beaten by a point of another with no more error for no more cost.

    -o writes into the folder
      errors.json                errors, evaluations, measured orders: the same in every run
      times.json                 all that was measured in seconds, with machine and versions
      work_precision.csv         both, one row a point
      work_precision_state.svg   the figures: state, energy, phase
      points.json                what an interrupted study goes on from
    --peers runs scipy, diffrax, heyoka or torchdiffeq beside ours (extra `peers`), at tolerances from 1e-3 to 1e-13.
    """
    return cli.answer_of("work_precision", options)
