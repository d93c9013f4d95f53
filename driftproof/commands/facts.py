"""`driftproof facts`: every exact fact of a method or a family, from the catalogue or from a file of your own."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from driftproof.commands.arguments import Commands, counted, rational, several

if TYPE_CHECKING:
    from driftproof.methods.families import Family
    from driftproof.methods.number_field import Exact
    from driftproof.methods.schemes import Method

# For most methods a second; those with irrational coefficients take minutes.
MOST_TERMS = 1000

EXAMPLES = """\
examples:
  driftproof facts rk4
  driftproof facts rk4 --only order,stability_function,imaginary_limit
  driftproof facts rk4 --system '0 1; -1 -1/10'            on z' = Az: R(hA), its determinant, limits of h
  driftproof facts sdirk_order_2                           a family, as a function of its parameter
  driftproof facts sdirk_order_2 --at '1 - sqrt(2)/2'      one member of it
  driftproof facts tsitouras54 --only order,order_fails --order-tolerance 1e-12
  driftproof facts rk4 --only region_boundary --format json
  driftproof facts tableau.toml --format tex
  driftproof facts rk4 --only order --plot region.svg      needs the extra: pip install 'driftproof[report]'

A family of your own is a Runge-Kutta tableau with a line parameter = "theta" and entries such as "1 - theta".

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
        help="every exact fact of a method or of a family of methods",
        description="Derive the exact facts of a method: order, stability, symplecticity, limits, series, and why.",
        epilog=EXAMPLES,
    )
    parser.add_argument("method", help="a key that `driftproof methods` lists, or a file that ends in .toml")
    parser.add_argument("--only", type=several(str), metavar="FACT,FACT", help="compute only these facts")
    parser.add_argument("--at", type=_number, metavar="VALUE", help="the parameter of a family, e.g. 1/4: one method")
    parser.add_argument("--system", type=_system, metavar="ROWS", help="facts on z' = Az, A given as '0 1; -1 -1/10'")
    parser.add_argument(
        "--order-tolerance", type=rational("order tolerance"), metavar="SIZE", help="add the order up to such residuals"
    )
    parser.add_argument(
        "--terms", type=counted("terms", MOST_TERMS), default=12, help="length of the series (default 12)"
    )
    parser.add_argument("--format", choices=("text", "json", "tex"), default="text", help="json is canonical")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="also draw a picture, e.g. region.svg")
    parser.add_argument(
        "--picture",
        choices=("region", "order-star", "phase"),
        default="region",
        help="what to draw: stability region, order star, or dispersion and dissipation",
    )
    parser.set_defaults(answer=answer)


def _number(text: str) -> Exact:
    from driftproof.methods.expressions import parse_number

    value: Exact = _one_line(parse_number, text, "value")
    return value


def _system(text: str) -> Any:
    from driftproof.methods.systems import parse_system

    return _one_line(parse_system, text)


def _one_line(parse: Callable[..., Any], *arguments: str) -> Any:
    """What `parse` reads; its complaint as argparse takes it."""
    try:
        return parse(*arguments)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def answer(options: argparse.Namespace) -> str:
    """The facts in the format asked for."""
    from driftproof.methods.families import Family
    from driftproof.support.plain_text import as_json
    from driftproof.texts.writing.facts import facts_text, subject_of
    from driftproof.texts.writing.tex import facts_tex

    subject = subject_of(options.method)
    if isinstance(subject, Family):
        result = _of_family(subject, options)
    elif options.at is None:
        result = _of_method(subject, options)
    else:
        raise ValueError(f"{subject.key} has no parameter; --at is for families such as sdirk_order_2")
    forms: dict[str, Callable[[dict[str, Any]], str]] = {"json": as_json, "text": facts_text, "tex": facts_tex}
    return forms[options.format](result)


def _of_family(family: Family, options: argparse.Namespace) -> dict[str, Any]:
    """The facts of the family, or of its member at --at. Raises ValueError for options that only a method has."""
    from driftproof.symbolic.family_facts import FAMILY_FACTS, family_facts

    if options.at is not None:
        return _of_method(family.member(options.at), options)
    if options.system or options.order_tolerance is not None or options.plot:
        raise ValueError(f"{family.key} is a family; choose one method with --at, a value of {family.parameter}")
    return family_facts(family, options.only or tuple(FAMILY_FACTS))


def _of_method(method: Method, options: argparse.Namespace) -> dict[str, Any]:
    """The facts of the method, or of the method on a system; also its picture, if one is asked for."""
    from driftproof.symbolic.facts import FACTS, facts_of, order_within, system_facts
    from driftproof.symbolic.linear.systems import SYSTEM_FACTS

    if options.system and (options.order_tolerance is not None or options.plot):
        raise ValueError("--system is about one problem, --order-tolerance and --plot about the method; ask separately")
    if options.system:
        return system_facts(method, options.system, options.only or tuple(SYSTEM_FACTS))
    found = facts_of(method, options.only or tuple(FACTS), options.terms)
    if options.order_tolerance is not None:
        found["order_to_tolerance"] = order_within(method, options.order_tolerance)
    if options.plot:
        from driftproof.support.extras import demand_pictures

        demand_pictures()
        from driftproof.reports.method_figures import draw_method

        draw_method(options.picture, method, options.plot)
    return found
