"""`driftproof report`: scenes as one page of HTML."""

from __future__ import annotations

import argparse
from pathlib import Path

from driftproof.commands.arguments import Commands, add_output, digits, progress

EXAMPLES = """\
examples:
  driftproof report -o report.html                  the lesson's presets
  driftproof report default -o report.html
  driftproof report mine.toml compare -o report.html

The page is one file that loads nothing, with figures, tables and the numbers behind them; it runs no script. It has the
panels that the scenes name: table, position, phase_plane, work_precision, stability (`driftproof scene --help` shows
a scene). The same scenes make the same bytes, but for measured --times.
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "report",
        help="write scenes as a page of HTML",
        description="Write presets, or scenes of your own from TOML files, as one page of HTML.",
        epilog=EXAMPLES,
    )
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", help="a preset, or a file that ends in .toml (default: all presets)"
    )
    add_output(parser, "the page to write", required=True)
    parser.add_argument("--digits", type=digits, default=15, help="digits of certified readouts (default 15)")
    parser.add_argument(
        "--times",
        action="store_true",
        help="also measure seconds where a scene names work_precision; never twice alike",
    )
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """Where the page was written."""
    from driftproof.numeric.scenes import PRESETS, scene_named
    from driftproof.reports.page.document import document
    from driftproof.support.files import demand_file, whole

    demand_file(options.output)
    scenes = [scene_named(name) for name in options.scenes or PRESETS]
    page = document(scenes, options.digits, times=options.times, counter=progress)
    with whole(options.output) as draft:
        Path(draft).write_text(page, encoding="utf-8", newline="\n")
    return f"wrote {options.output}"
