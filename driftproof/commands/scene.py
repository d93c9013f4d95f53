"""`driftproof scene`: run a scene in floats and show what it asks for."""

from __future__ import annotations

import argparse
from pathlib import Path

from driftproof.commands.arguments import Commands, add_format, digits, progress

EXAMPLES = """\
examples:
  driftproof scene default
  driftproof scene stability_boundary --format json
  driftproof scene default --figures pictures/
  driftproof scene mine.toml

mine.toml:
  selected = "rk4"                  the method whose readouts are shown
  h = "1/8"                         0.125 is read exactly, too
  t = 10
  start = [1, 0]
  readouts = ["state_error", "evaluations"]
  certified = ["phase_error"]       to any number of --digits, by the exact side
  methods = ["rk4", "velocity_verlet"]
  panels = ["table"]                table, position, phase_plane; for a report also work_precision, stability
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "scene",
        help="run a scene in floats and show what it asks for",
        description="Run a preset, or a scene of your own from a TOML file, in floats.",
        epilog=EXAMPLES,
    )
    parser.add_argument("name", help="a preset that `driftproof scenes` lists, or a file that ends in .toml")
    parser.add_argument("--digits", type=digits, default=15, help="digits of certified readouts (default 15)")
    parser.add_argument("--figures", type=Path, metavar="FOLDER", help="also draw the scene's figures, as SVG")
    add_format(parser)
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The scene's readouts and table, and where its figures were written."""
    from driftproof.numeric.scenes import scene_named
    from driftproof.reports.page.trajectory import write_figures
    from driftproof.reports.scene_view import scene_json, scene_text, show_scene
    from driftproof.support.files import demand_folder
    from driftproof.support.plain_text import as_json

    scene = scene_named(options.name)
    if options.figures:
        demand_folder(options.figures)
    shown = show_scene(scene, options.digits, progress)
    drawn = write_figures(scene, options.figures) if options.figures else []
    if options.format == "json":
        return as_json(scene_json(scene, shown))
    wrote = "\n".join(f"wrote {path}" for path in drawn)
    return "\n\n".join(filter(None, [scene_text(scene, shown), wrote]))
