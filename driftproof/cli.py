"""The command line: parse, ask, print. One line and a non-zero exit for anything that cannot be answered."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn

from driftproof import __version__
from methods.rationals import parse_rational

MOST_DIGITS = 10_000
# A float run longer than this shows a progress bar.
LONG_RUN = 10**6

BAD_INPUT = 2
NO_ANSWER = 3


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 0 if answered, 2 for bad input, 3 if the question has no answer in the arithmetic used."""
    options = _parser().parse_args(arguments)
    try:
        print(options.answer(options))
    except BrokenPipeError:
        sys.stderr.close()  # the reader has gone; a second complaint at exit would be noise
    except (ValueError, OSError) as error:
        return _complain(options.command, error, BAD_INPUT)
    except ArithmeticError as error:
        return _complain(options.command, error, NO_ANSWER)
    except KeyboardInterrupt:
        return _complain(options.command, "interrupted", 130)
    return 0


def _complain(command: str, error: object, status: int) -> int:
    print(f"driftproof {command}: {' '.join(str(error).split())}", file=sys.stderr)
    return status


class _Parser(argparse.ArgumentParser):
    """An argument parser that complains in one line, and takes -1/2 and -1,0 for values rather than options."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        kwargs["formatter_class"] = argparse.RawDescriptionHelpFormatter
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = re.compile(r"-[\d.]")

    def error(self, message: str) -> NoReturn:
        """Print one line that names the problem and where to read more, and exit with status 2."""
        self.exit(BAD_INPUT, f"{self.prog}: {' '.join(message.split())} (`{self.prog} --help` shows how)\n")


def _rational(what: str) -> Callable[[str], Fraction]:
    def parse(text: str) -> Fraction:
        try:
            return parse_rational(text, what)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return parse


def _nonzero_step(text: str) -> Fraction:
    h = _rational("h")(text)
    if h == 0:
        raise argparse.ArgumentTypeError("a step of size 0 goes nowhere; give a nonzero h")
    return h


def _state(text: str) -> tuple[Fraction, Fraction]:
    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text!r} is not a state; write position,velocity like 1,0")
    return _rational("q")(parts[0]), _rational("v")(parts[1])


def _digits(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:9]) <= MOST_DIGITS and len(text) < 9):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a number of digits from 1 to {MOST_DIGITS}")
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="driftproof",
        description="Exact facts and certified numbers about one-step integrators, and float runs held to them.",
        epilog=_MAIN_EXAMPLES,
    )
    parser.add_argument("--version", action="version", version=f"driftproof {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=_Parser)
    _add_methods(commands)
    _add_step(commands)
    _add_run(commands)
    _add_scenes(commands)
    _add_scene(commands)
    _add_values(commands)
    return parser


_MAIN_EXAMPLES = """\
examples:
  driftproof step rk4 --h 1/2 --state 1,0          337/384 and -23/48, with decimals
  driftproof run forward_euler --h 1/4 --t 10      certified state, errors, energy and phase
  driftproof scene default                         the lesson's readouts and its table
  driftproof values --only 'rk4.*' --format md     proved values, ready for a text

Numbers are read exactly: 0.1 is 1/10, and 1/4 is a quarter. `driftproof COMMAND --help` teaches each command.
"""


def _add_methods(commands: argparse._SubParsersAction[_Parser]) -> None:
    methods = commands.add_parser(
        "methods",
        help="list the methods",
        description="List the methods of the catalogue: key, family, claimed order, title and source.",
        epilog="example:\n  driftproof methods\n",
    )
    methods.set_defaults(answer=_answer_methods)


def _add_step(commands: argparse._SubParsersAction[_Parser]) -> None:
    step = commands.add_parser(
        "step",
        help="one step, exactly",
        description="Take one step of q' = v, v' = -q exactly, and print fractions with certified decimals.",
        epilog=(
            "examples:\n"
            "  driftproof step rk4 --h 1/2 --state 1,0\n"
            "  driftproof step symplectic_euler --h 0.5 --state 0,1 --format json\n"
        ),
    )
    _add_question(step)
    step.set_defaults(answer=_answer_step)


def _add_run(commands: argparse._SubParsersAction[_Parser]) -> None:
    run = commands.add_parser(
        "run",
        help="a whole run, certified to any number of digits",
        description=(
            "Take t/h steps exactly and certify the final state, its errors, energy and phase.\n"
            "Long runs are answered by repeated squaring: ten million steps take a moment."
        ),
        epilog=(
            "examples:\n"
            "  driftproof run forward_euler --h 1/4 --t 10 --digits 30\n"
            "  driftproof run rk4 --h 0.01 --t 100000 --state 0,1 --format json\n"
        ),
    )
    _add_question(run)
    run.add_argument("--t", type=_rational("t"), required=True, help="final time, a multiple of h")
    run.set_defaults(answer=_answer_run)


def _add_question(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("method", help="a key that `driftproof methods` lists, e.g. rk4")
    parser.add_argument("--h", type=_nonzero_step, required=True, help="step size, e.g. 1/4 or 0.25")
    parser.add_argument("--state", type=_state, default="1,0", help="start as position,velocity (default 1,0)")
    parser.add_argument("--digits", type=_digits, default=15, help="significant digits (default 15)")
    parser.add_argument(
        "--rounding", choices=("half-even", "half-away"), default="half-even", help="what a tie becomes"
    )
    parser.add_argument("--format", choices=("text", "json"), default="text")


def _add_scenes(commands: argparse._SubParsersAction[_Parser]) -> None:
    scenes = commands.add_parser(
        "scenes",
        help="list the lesson's scenes",
        description="List the lesson's presets: the method shown, h, t and the number of steps.",
        epilog="example:\n  driftproof scenes\n",
    )
    scenes.set_defaults(answer=_answer_scenes)


def _add_scene(commands: argparse._SubParsersAction[_Parser]) -> None:
    scene = commands.add_parser(
        "scene",
        help="run a scene in floats and show what it asks for",
        description="Run a preset, or a scene of your own from a TOML file, in floats.",
        epilog=_SCENE_EXAMPLES,
    )
    scene.add_argument("name", help="a preset that `driftproof scenes` lists, or a file that ends in .toml")
    scene.add_argument("--digits", type=_digits, default=15, help="digits of certified readouts (default 15)")
    scene.add_argument("--figures", type=Path, metavar="FOLDER", help="also draw the scene's figures, as SVG")
    scene.add_argument("--format", choices=("text", "json"), default="text")
    scene.set_defaults(answer=_answer_scene)


_SCENE_EXAMPLES = """\
examples:
  driftproof scene default
  driftproof scene stability_boundary --format json
  driftproof scene default --figures pictures/      needs the extra: pip install 'driftproof[report]'
  driftproof scene mine.toml

mine.toml:
  selected = "rk4"                  the method whose readouts are shown
  h = "1/8"                         0.125 is read exactly, too
  t = 10
  start = [1, 0]
  readouts = ["state_error", "evaluations"]
  certified = ["phase_error"]       to any number of --digits, by the exact side
  methods = ["rk4", "velocity_verlet"]
  panels = ["table"]                table, position, phase_plane
"""


def _add_values(commands: argparse._SubParsersAction[_Parser]) -> None:
    from driftproof.values import FORMATS

    values = commands.add_parser(
        "values",
        help="the numbers of the lesson, proved",
        description="Print every number that the lesson prints, by id, as the last green run of the proofs wrote it.",
        epilog=(
            "examples:\n"
            "  driftproof values\n"
            "  driftproof values --only 'rk4.*' --format md\n"
            "  driftproof values --only '*.state_error' --format csv\n"
        ),
    )
    values.add_argument("--only", default="*", metavar="PATTERN", help="ids that match this shell pattern")
    values.add_argument("--format", choices=tuple(FORMATS), default="json")
    values.set_defaults(answer=_answer_values)


def _answer_methods(options: argparse.Namespace) -> str:
    from driftproof.text import methods_text

    return methods_text()


def _answer_step(options: argparse.Namespace) -> str:
    from driftproof.answers import step_answer
    from driftproof.text import answer_text, as_json

    answer = step_answer(options.method, options.h, options.state, options.digits, options.rounding)
    return as_json(answer) if options.format == "json" else answer_text(answer)


def _answer_run(options: argparse.Namespace) -> str:
    from driftproof.answers import run_answer
    from driftproof.text import answer_text, as_json

    answer = run_answer(options.method, options.h, options.t, options.state, options.digits, options.rounding)
    return as_json(answer) if options.format == "json" else answer_text(answer)


def _answer_scenes(options: argparse.Namespace) -> str:
    from driftproof.text import scenes_text
    from numeric.scenes import PRESETS

    return scenes_text(list(PRESETS.values()))


def _answer_scene(options: argparse.Namespace) -> str:
    from driftproof.scene_view import draw_scene, scene_json, scene_text, show_scene
    from driftproof.text import as_json
    from numeric.scenes import scene_named

    scene = scene_named(options.name)
    shown = show_scene(scene, options.digits, _progress)
    drawn = draw_scene(scene, options.figures) if options.figures else []
    if options.format == "json":
        return as_json(scene_json(scene, shown))
    return "\n".join([scene_text(scene, shown), *(f"\nwrote {path}" for path in drawn)])


def _answer_values(options: argparse.Namespace) -> str:
    from driftproof.values import published_values, render_values

    return render_values(published_values(options.only), options.format)


def _progress(steps: int) -> Iterable[int]:
    if steps < LONG_RUN or not sys.stderr.isatty():
        return range(steps)
    from tqdm import trange

    bar: Iterable[int] = trange(steps, unit="step", unit_scale=True, leave=False)
    return bar
