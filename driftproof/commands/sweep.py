"""`driftproof sweep`: a scene at every point of a grid, on the processors of this machine or of a cluster."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from driftproof.commands.arguments import (
    Commands,
    add_format,
    add_methods,
    add_output,
    add_sizes,
    counted,
    rational,
    several,
    state,
)

EXAMPLES = """\
examples:
  driftproof sweep default --h 1/4,1/8,1/16 --methods rk4,velocity_verlet
  driftproof sweep default --h 1/8,1/16 --t 10,20 --state 1,0 --state 0,1 --format json
  driftproof sweep default --methods rk4 --h 1/4,1/8 -o answers.jsonl      run it again to go on where it stopped

The grid has a point for each combination, --h varying fastest; what is not given is as in the scene. A run that
overflows, or an h that does not divide t, is answered by its message. Nothing in the result depends on --workers, or on
--cluster tcp://HOST:8786, the scheduler of a dask cluster (extra: pip install 'driftproof[cluster]').
"""
MOST_WORKERS = 1024


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "sweep",
        help="run a scene at every point of a grid of steps, times, starts and methods",
        description="Run a scene in floats at every point of a grid, in parallel, with answers that survive a crash.",
        epilog=EXAMPLES,
    )
    parser.add_argument("scene", help="a preset that `driftproof scenes` lists, or a file that ends in .toml")
    add_methods(parser, "keys that `driftproof methods` lists")
    parser.add_argument("--state", type=state, action="append", help="start as position,velocity; repeatable")
    parser.add_argument("--t", type=several(rational("t")), action="extend", metavar="T,T", help="final times")
    add_sizes(parser, "step sizes, such as 1/4,1/8")
    add_output(parser, "keep answers here, as JSON lines, as they come; an interrupted sweep goes on from them")
    where = parser.add_mutually_exclusive_group()
    workers = counted("processes", MOST_WORKERS)
    where.add_argument("--workers", type=workers, metavar="N", help="processes (default: one for each processor)")
    where.add_argument("--cluster", metavar="ADDRESS", help="the scheduler of a dask cluster")
    add_format(parser)
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The readouts of every point, as a table or as JSON."""
    from driftproof.numeric.scenes import scene_named
    from driftproof.reports.sweeps import answers, sweep_json, sweep_text
    from driftproof.support.plain_text import as_json

    scene = scene_named(options.scene)
    axes = {"selected": options.methods, "start": options.state, "t": options.t, "h": options.h}
    grid = {name: values for name, values in axes.items() if values}
    with _executor(options) as executor:
        found = answers(scene, grid, executor, options.output)
    return as_json(sweep_json(scene, found)) if options.format == "json" else sweep_text(scene, found)


@contextmanager
def _executor(options: argparse.Namespace) -> Iterator[Executor | None]:
    if options.cluster:
        from driftproof.reports.cluster import cluster_executor

        with cluster_executor(options.cluster) as executor:
            yield executor
    elif options.workers:
        from driftproof.numeric.sweep import processes

        with processes(options.workers) as executor:
            yield executor
    else:
        yield None
