"""`driftproof stability` and `work-precision`: which steps a method can take on a problem, and what accuracy costs."""

from __future__ import annotations

from argparse import Namespace

from driftproof.commands import arguments as cli


@cli.command(
    cli.option("problem", "a problem, or a .toml file of your own; without it, the problems are listed", nargs="?"),
    cli.methods_option(
        "keys or .toml files (default"
        " forward_euler, rk4, symplectic_euler, backward_euler, implicit_midpoint, radau_iia2)"
    ),
    cli.parameters_option(cli.OTHER_PARAMETERS),
    cli.steps_option(
        "step sizes that divide t, such as 1/4,1/8, or pi/50 of 2*pi (default: those of 10, 100 and 1000 steps)"
    ),
    cli.TEXT_OR_JSON,
)
def stability_command(options: Namespace) -> str:
    """Show which step sizes methods can take on a problem, where their runs end, and what theory leads one to expect.

    examples:
      driftproof stability                                        lists the problems
      driftproof stability stiff_oscillator
      driftproof stability dahlquist_1e3 --h 1/500,1/256 --methods forward_euler,rk4,backward_euler,bdf2,rodas4
      driftproof stability kepler_eccentric --methods rk4,velocity_verlet,yoshida4 --format json

    On a linear problem y' = Ay, or y' = Ay + b with a point of rest, the verdicts are proved, for the exact value of
    the double h that is run; with b(t), which may jump, they are of the difference of two solutions. One of your own
    has at most 20 components, and no solution of y' = Ay grows. The largest step size is also found by bisection with
    float steps. On any other problem the verdicts are observations. "No small h" is said where powers grow however
    short the steps are; from larger h on, which are seen, they may be bounded again. The first values of a multistep
    method are steps of another one, which is named.

    your own problem, in mine.toml, whose true solution is enclosed to 20 digits:
      title = "A pendulum of 1 m"
      rates = ["y1", "-g * sin(y0)"]        in t, y0, y1, ..., pi; sin, cos, tan, exp, log, sqrt, tanh, abs; 0.1 = 1/10;
                                            with kinks and jumps: max, min, sign, heaviside, floor, mod(t, 12)
      start = ["1/2", "0"]                  at t = 0; of numbers such as "pi/4", and of an end "2*pi", runs take the
                                            nearest double, as is said, and steps are t/N
      end = "10"
      energy = "y1^2/2 - g * cos(y0)"       may be left out, as may the title; if f changes it, errors are differences
                                            from that of the solution
      parameters.g = "9.81"                 a number, or an expression such as "2*pi*f" in pi and earlier parameters;
                                            another one with --parameters g=1.62; start and end may have them, too
    or by names: rates.x = "v", rates.v = "-g * sin(x)", start.x = "1/2", start.v = 0; a single unknown is also called y
    instead of rates: function = "mylib.models:pendulum", your own f(t, y), with the parameters as keyword arguments
    """
    if options.problem is None:
        cli.refuse(options, ("methods", "h", "parameters"), "without a problem")
    return cli.answer_of("stability", options)


@cli.command(
    cli.option("problem", "a problem, or a .toml file of your own", nargs="?", default="harmonic_oscillator"),
    cli.methods_option(
        "keys or .toml files (default"
        " forward_euler, symplectic_euler, rk4, velocity_verlet, dormand_prince54, blanes_moan6, gauss2;"
        " implicit ones where the problem is stiff)"
    ),
    cli.parameters_option(cli.OTHER_PARAMETERS),
    cli.error_option(
        "the accuracy you want, or several: tell first which method reaches it at the end, with which h, at what cost"
    ),
    cli.output_option("a folder for files and figures, from which an interrupted study is resumed", metavar="FOLDER"),
    cli.list_option("--peers", "also scipy, diffrax, heyoka", type=cli.several(str), metavar="P,P"),
    cli.time_limit_option(
        "seconds for timing one point (default 0.1); a longer run is not timed, and if it needs more than 10⁸"
        " evaluations for each of these seconds, its error is not measured; no limit on the whole: compiling a method"
        " takes seconds",
        default=0.1,
        metavar="S",
    ),
    cli.TEXT_OR_JSON,
)
def work_precision_command(options: Namespace) -> str:
    """Measure the errors that methods reach on a problem, against evaluations of f and against run time.

    examples:
      driftproof work-precision --methods rk4,velocity_verlet --time-limit 0.01
      driftproof work-precision kaps --methods rk4,radau_iia2,bdf2 --time-limit 0.01 -o measured/
      driftproof work-precision kepler --error 1e-5,1e-8 --time-limit 0.01

    Without any argument: seven methods on the harmonic oscillator, in about twenty seconds.

    Each method runs with doubling numbers of steps, until only rounding is left of its error. Errors are computed
    exactly, from certified digits of the solution; evaluations of f are counted. Explicit pairs, Gauss methods and
    Radau IIA also run with step-size control, at tolerances from 1e-3 to 1e-13. Times are those of one trajectory,
    compiled (extra `fast`) and in plain Python, and of one state of an ensemble; methods take turns, in random order.

    What counts in the tables is the error at the end; below each stands who needs the fewest evaluations by the largest
    on the way, and how often it was looked at: at the reference's times or, on a problem of your own, after each step
    of ours and of scipy (of more than 65536 steps after each k-th). A run counts if all finer ones that were made
    are as good, but for rounding. A method is dominated if each of its points has a no worse and no dearer one.

    -o writes into the folder
      errors.json                errors, evaluations, measured orders: the same in every run
      times.json                 all times in seconds, with the machine and versions
      work_precision.csv         both, in one row for each point
      work_precision_state.svg   the figures: state, energy, phase
      points.json                the points from which an interrupted study is resumed
    --peers also runs scipy, diffrax or heyoka (extra `peers`), at tolerances from 1e-3 to 1e-13.
    """
    return cli.answer_of("work_precision", options)
