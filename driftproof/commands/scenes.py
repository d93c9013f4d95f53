"""`driftproof scene`, `sweep` and `report`: the float runs of a scene, a grid of them, or a page about them."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from driftproof.commands import arguments as cli

MOST_WORKERS = 1024


@cli.command(
    cli.option("name", "a preset, or a .toml file of your own; without it, the presets are listed", nargs="?"),
    cli.methods_option("methods instead of the scene's: the first is shown, all are compared"),
    cli.option("--figures", "also draw the scene's figures into this folder, as SVG", type=Path, metavar="FOLDER"),
    cli.TEXT_OR_JSON,
)
def scene_command(options: Namespace) -> str:
    """Run a preset, or a scene of your own from a TOML file, in floats.

    examples:
      driftproof scene                                lists the presets
      driftproof scene default
      driftproof scene default --methods rk4,implicit_midpoint
      driftproof scene stability_boundary --format json
      driftproof scene default --figures pictures/
      driftproof scene mine.toml

    Instead of start, a scene may have problem = "kepler" or another problem that `driftproof stability`
    lists, or a .toml file of your own (`driftproof stability --help` shows one); its only panel is then the table.

    mine.toml:
      selected = "rk4"                  the method whose readouts are shown
      h = "1/8"                         or 0.125, which is read exactly as well
      t = 10
      start = [1, 0]
      readouts = ["state_error", "evaluations"]      also largest_error and largest_energy_change, after all steps
      methods = ["rk4", "velocity_verlet"]
      panels = ["table"]                table, position, phase_plane; for a report also work_precision, stability
    """
    if options.name is None:
        cli.refuse(options, ("methods", "figures"), "without a scene")
    return cli.answer_of("scene", options)


@cli.command(
    cli.option("scene", "a preset that `driftproof scene` lists, a problem, or your own .toml file"),
    cli.methods_option("keys that `driftproof methods` lists"),
    cli.parameters_option(cli.OTHER_PARAMETERS),
    cli.option("--state", "position,velocity; may be repeated", type=cli.initial_state, action="append"),
    cli.list_option("--t", "final times", type=cli.several(cli.exactly("t")), metavar="T,T"),
    cli.steps_option("step sizes, such as 1/4,1/8, or 1/4:1/64 for 1/4, 1/8, ..., 1/64"),
    cli.output_option("write each answer here as a line of JSON; an interrupted sweep is resumed from this file"),
    cli.one_of(
        cli.option(
            "--workers",
            "number of processes (default: one for each processor)",
            type=cli.integer_in(1, MOST_WORKERS, "processes"),
            metavar="N",
        ),
        cli.option("--cluster", "address of the scheduler of a dask cluster", metavar="ADDRESS"),
    ),
    cli.TEXT_OR_JSON,
)
def sweep_command(options: Namespace) -> str:
    """Run a scene in floats at every point of a grid, in parallel, with answers that survive a crash.

    examples:
      driftproof sweep default --h 1/4,1/8,1/16 --methods rk4,velocity_verlet
      driftproof sweep default --h 1/8,1/16 --t 10,20 --state 1,0 --state 0,1 --format json
      driftproof sweep default --methods rk4 --h 1/4,1/8 -o answers.jsonl      run it again to resume where it stopped
      driftproof sweep pendulum --methods rk4,velocity_verlet --h 1/10:1/80      its errors at its end

    The grid has a point for each combination, --h varying fastest; what is not given is as in the scene. For a run that
    overflows, or an h that does not divide t, the answer is a message. The answers do not depend on --workers, nor on
    --cluster tcp://HOST:8786, the scheduler of a dask cluster (extra: pip install 'driftproof[cluster]').
    """
    return cli.answer_of("sweep", options)


@cli.command(
    cli.option("scenes", "presets, problems, .toml files, or stiff (default: all presets)", nargs="*", metavar="SCENE"),
    cli.output_option("the HTML file to write", required=True),
    cli.methods_option("for problems: keys or .toml files (default: those of `driftproof stability`)"),
    cli.error_option("the accuracy you want on problems, or several: say which method reaches it, with which h"),
)
def report_command(options: Namespace) -> str:
    """Write presets, problems, or scenes and problems of your own from TOML files, as one page of HTML.

    examples:
      driftproof report -o report.html                  the lesson's presets
      driftproof report default -o report.html
      driftproof report mine.toml compare -o report.html
      driftproof report kepler --methods rk4,velocity_verlet --error 1e-5 -o report.html
      driftproof report stiff -o report.html            stiff problems, and which steps methods can take on each

    The page is one file without scripts or external resources, with figures, tables and the numbers behind them. It has
    the panels that the scenes name: table, position, phase_plane, work_precision, stability (`driftproof scene --help`
    shows a scene). For a problem (`driftproof stability --help` shows one) it has the errors of methods against their
    work, who needs the least of it for an error at the end and on the way, and the steps that they can take. The same
    scenes give the same bytes; a printed page shows everything.
    """
    import driftproof

    about = {name: getattr(options, name) for name in ("output", "methods", "error")}
    return str(driftproof.report(*options.scenes, **about))
