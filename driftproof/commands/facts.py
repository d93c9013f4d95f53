"""`driftproof facts`: every exact fact of a method, from the catalogue or from a file of your own."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from driftproof.arguments import Commands, digits

EXAMPLES = """\
examples:
  driftproof facts rk4
  driftproof facts rk4 --only order,stability_function,imaginary_limit
  driftproof facts gauss2 --format json
  driftproof facts tableau.toml --format tex
  driftproof facts rk4 --only order --plot region.svg      needs the extra: pip install 'driftproof[report]'

tableau.toml:
  family = "runge_kutta"            or splitting, nystrom, collocation
  A = [[0, 0], ["2/3", 0]]
  b = ["1/4", "3/4"]                c may be left out: then the row sums of A
  [roots]                           if coefficients need one, e.g. s3 = "sqrt(3)"; then write "1/4 - s3/6"
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "facts",
        help="every exact fact of a method",
        description="Derive the exact facts of a method: order, stability, symplecticity, limits, series, and why.",
        epilog=EXAMPLES,
    )
    parser.add_argument("method", help="a key that `driftproof methods` lists, or a file that ends in .toml")
    parser.add_argument("--only", type=_names, metavar="FACT,FACT", help="compute only these facts")
    parser.add_argument("--terms", type=digits, default=12, help="length of the series (default 12)")
    parser.add_argument("--format", choices=("text", "json", "tex"), default="text", help="json is canonical")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="also draw a picture, e.g. region.svg")
    parser.add_argument(
        "--picture",
        choices=("region", "order-star", "phase"),
        default="region",
        help="what to draw: stability region, order star, or dispersion and dissipation",
    )
    parser.set_defaults(answer=answer)


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(","))


def answer(options: argparse.Namespace) -> str:
    """The facts in the format asked for."""
    from driftproof.facts import facts_text, method_of
    from driftproof.tex import facts_tex
    from driftproof.text import as_json
    from symbolic.facts import FACTS, facts_of

    method = method_of(options.method)
    result = facts_of(method, options.only or tuple(FACTS), options.terms)
    if options.plot:
        from driftproof.method_figures import draw_method

        draw_method(options.picture, method, options.plot)
    forms: dict[str, Callable[[dict[str, Any]], str]] = {"json": as_json, "text": facts_text, "tex": facts_tex}
    return forms[options.format](result)
