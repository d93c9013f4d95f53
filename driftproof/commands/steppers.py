"""`driftproof identify` and `verify`: which method a float stepper is, and whether it is the given one."""

from __future__ import annotations

from argparse import Namespace
from functools import partial
from typing import TYPE_CHECKING, Any

from driftproof.commands import arguments as cli

if TYPE_CHECKING:
    from driftproof.blackbox.report import Report

MOST_EXAMPLES = 10**6
CALLS = cli.names_in("driftproof.blackbox.stepper.calling_conventions", "SIGNATURES")
TARGET = (
    cli.option("step", "the stepper and where to import it from, such as mylib.ode:step", metavar="MODULE:STEP"),
    cli.option("--calls", "how to call the stepper, if its parameter names do not show it", choices=CALLS),
    cli.option("--array", "converts floats to the stepper's numbers, such as torch:tensor", metavar="MODULE:MAKER"),
    cli.time_limit_option("seconds for the whole run (default 120)", default=120.0),
    cli.format_option("text json markdown", "markdown can be pasted into an issue"),
    cli.flag("--all", "show every check, not only the faults"),
    cli.option("--examples", "steps to try (default 1000)", type=cli.integer_in(1, MOST_EXAMPLES, "examples")),
    cli.option("--largest-step", "try steps of sizes 0 < h <= this (default 2)", type=cli.positive_number("step size")),
    cli.option("--largest-state", "try states with |q|, |v| <= this (default 1000)", type=cli.positive_number("state")),
    cli.flag("--extremes", "also try the smallest floats, down to subnormal ones"),
    cli.flag("--step-in-binary32", "allow the stepper to round h to binary32 first"),
    cli.flag("--velocity-from-positions", "allow v = (q1 - q)/h, which adds u (|q| + |q1|)/h to the bound"),
    cli.flag("--flush-to-zero", "allow subnormal numbers to become 0"),
    cli.option("--solver-tolerance", "accuracy of implicit stages, e.g. 1e-10", type=cli.exactly("solver tolerance")),
)
SOLVER_OPTION = cli.flag("--solver", "examine a whole solver: solve(f, t_span, y0, rtol, atol) -> (t, y)")
METHOD_OPTION = partial(cli.option, "--method")
SYSTEM_OPTION = cli.option("--system", "f(t, y) that a step without a force should have built in", metavar="MODULE:F")
START_OPTION = cli.option(
    "--start", "where a step with --system may be asked: 280:400, or 7e6,0,0; 0,7500,0", metavar="STATE"
)
# Options that only apply if a stepper is compared with a method, and those that do not apply to a whole solver.
ALLOWANCES = ("step_in_binary32", "velocity_from_positions", "flush_to_zero", "solver_tolerance")
WITH_A_METHOD = ("examples", "extremes", "largest_step", "largest_state", *ALLOWANCES)
WITHOUT_A_SYSTEM = ("examples", "extremes", *(name for name in ALLOWANCES if name != "solver_tolerance"))
WITH_A_STEPPER = ("calls", "array", *WITH_A_METHOD)


@cli.command(*TARGET, SOLVER_OPTION, METHOD_OPTION("compare the stepper with this method, as `driftproof verify` does"))
def identify_command(options: Namespace) -> str:
    """Examine a stepper as a black box and say which method it is, of which order, and what else it does.

    examples:
      driftproof identify mylib.integrators:step
      driftproof identify mylib.integrators:rk_step --calls field
      driftproof identify mylib.integrators:step --array numpy:float32 --format markdown
      driftproof identify mylib.ode:solve --solver
      driftproof identify tableau.toml                 which method of the catalogue the exact table is

    what a stepper may look like:
      step(q, v, h) -> (q1, v1)            with a system built in; also step(state, h), and with m, k, t
      step(force, q, v, h) -> (q1, v1)     q'' = force(q)
      step(state, t, h, force)             a dict or an object, changed in place or returned
      step(f, t, y, h) -> y1               y' = f(t, y); also without t; or (y1, error), (y1, y1_hat), (y1, dense)
      step(f, jac, t, y, h) -> y1          a Rosenbrock method; step(f_explicit, f_implicit, t, y, h): an IMEX one
    An object with a state, a method that advances it, and a force that it calls or is given, becomes a stepper by
      from driftproof import stepper_of
      step = stepper_of(lambda force: Body(acceleration=force), position="x", velocity="v", advance="update")
      step = stepper_of(Body, position="x", velocity="v", push="apply_force", advance="update")
    (field_stepper_of for y' = f(t, y)). A stepper that remembers earlier steps is read from whole runs. Wrap anything
    else in a short function of one of these forms. The stepper runs in an isolated process, so it may crash or hang.

    With --method the stepper is compared with that method: `driftproof verify --help` says what is checked.

    exit status: 0: a method is named, exactly or nearly; 1: none; 2: wrong input; 3: undecided.
    Faults change nothing of that: a test of a solver is assert_verified_solver(solve, "dormand_prince54").
    """
    return _examined(options)


@cli.command(
    *TARGET,
    SOLVER_OPTION,
    SYSTEM_OPTION,
    START_OPTION,
    METHOD_OPTION("a key of `driftproof methods`, a .toml file, boris, or abm2 to abm6 (PECE)", required=True),
)
def verify_command(options: Namespace) -> str:
    """Compare a stepper with a method: its coefficients, its order, its rounding errors with a derived bound.
    The bound holds for the definition's sums and products in any order, fused or not. A built-in system is q'' = -q,
    one read from short steps (then undecided), or the one given with --system. Implicit stages of a step(f, t, y, h)
    are read up to the residual that their solver leaves, whose size the report states.

    examples:
      driftproof verify mylib.integrators:step --method velocity_verlet
      driftproof verify mylib.integrators:rk_step --method tableau.toml --examples 5000
      driftproof verify mylib.implicit:step --method backward_euler --solver-tolerance 1e-10
      driftproof verify mylib.circuits:step --method trapezoid --system mylib.circuits:rlc --solver-tolerance 1e-12
      driftproof verify mylib.ode:solve --solver --method dormand_prince54

    A solver agrees if it advances that method and has no fault, of its clock or its tolerances, say.
    exit status: 0 if it agrees, 1 if it does not, 2 if the input is wrong, 3 if the verdict is undecided: the report
    then says what was not tested, and what would decide it.
    `driftproof identify --help` says what a stepper may look like.
    """
    return _examined(options)


def _examined(options: Namespace) -> str:
    """The report of `identify`, or of `verify` if a method is given. Raises Refuted, Undecided or ValueError."""
    if options.solver:
        from driftproof.blackbox.solvers.identify_solver import identify_solver

        cli.refuse(options, (*WITH_A_STEPPER, *["system", "start"] * hasattr(options, "system")), "with --solver")
        report = identify_solver(options.step, options.method, time_limit=options.time_limit)
        return _written(report, report.passed if options.method else report.answered, options)
    from driftproof.blackbox.identify import identify
    from driftproof.blackbox.judging.agreement import EXAMPLES
    from driftproof.blackbox.judging.specification import Allowance, Domain
    from driftproof.blackbox.verify import verify

    how = {name: getattr(options, name) for name in ("calls", "array", "time_limit")}
    if options.method is None:
        cli.refuse(options, WITH_A_METHOD, "without --method")
        report = identify(options.step, **how)
        return _written(report, report.answered, options)
    if getattr(options, "system", None):
        cli.refuse(options, WITHOUT_A_SYSTEM, "with --system")
    limits: dict[str, Any] = {"smallest_step": 0.0, "smallest_state": 0.0} if options.extremes else {}
    limits |= {x: y for x in ("largest_step", "largest_state", "start") if (y := getattr(options, x, None))}
    domain = Domain(**limits)
    allowance = Allowance(**{name: getattr(options, name) for name in ALLOWANCES})
    examples = options.examples or EXAMPLES
    how |= {"examples": examples, "domain": domain, "allowance": allowance, "system": getattr(options, "system", None)}
    report = verify(options.step, options.method, **how)
    return _written(report, report.passed, options)


def _written(report: Report, good: bool | None, options: Namespace) -> str:
    """The report as text. Raises Refuted with it if `good` is False, Undecided if `good` is None."""
    words = report.written(options.format, options.all)
    if not good:
        raise cli.Undecided(words) if good is None else cli.Refuted(words)
    return words
