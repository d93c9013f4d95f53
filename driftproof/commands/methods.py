"""`driftproof methods`, `facts` and `derive`: the catalogue, every exact fact of a method, and how some come about."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from driftproof.commands import arguments as cli

if TYPE_CHECKING:
    from driftproof.methods.catalogue import FactsOnly
    from driftproof.methods.families import Family
    from driftproof.methods.number_field import Exact
    from driftproof.methods.schemes import Method

# For most methods a second; those with irrational coefficients take minutes.
MOST_TERMS = 1000


@cli.command()
def methods_command(options: Namespace) -> str:
    """List the methods of the catalogue: key, family, claimed order, title and source.

    example:
      driftproof methods
    """
    from driftproof.methods.catalogue import FACTS_ONLY, METHODS
    from driftproof.methods.families import FAMILIES
    from driftproof.support.plain_text import table

    names = {"RungeKutta": "Runge-Kutta", "Collocation": "collocation", "Splitting": "splitting", "Nystrom": "Nyström"}
    names |= {"Multistep": "multistep", "Rosenbrock": "Rosenbrock", "Additive": "IMEX"}
    rows = [["method", "family", "order", "title", "source"]]
    for key, method in (*METHODS.items(), *FACTS_ONLY.items()):
        rows.append([key, names[type(method).__name__], str(method.claimed_order), method.title, method.source])
    for key, family in FAMILIES.items():
        rows.append([key, f"Runge-Kutta in {family.parameter}", str(family.claimed_order), family.title, family.source])
    return table(rows, right=(2,))


@cli.read_by
def _number(text: str) -> Exact:
    from driftproof.methods.expressions import parse_number

    return parse_number(text, "value")


@cli.read_by
def _system(text: str) -> Any:
    from driftproof.methods.expressions import parse_system

    return parse_system(text)


@cli.command(
    cli.option("method", "a key that `driftproof methods` lists, or a file that ends in .toml"),
    cli.option("--only", "compute only these facts", type=cli.several(str), metavar="FACT,FACT"),
    cli.option("--at", "the parameter of a family, e.g. 1/4: one method", type=_number, metavar="VALUE"),
    cli.option("--system", "facts on z' = Az, A given as '0 1; -1 -1/10'", type=_system, metavar="ROWS"),
    cli.option(
        "--order-tolerance", "add the order up to such residuals", type=cli.exactly("order tolerance"), metavar="SIZE"
    ),
    cli.option("--terms", "length of the series (default 12)", type=cli.integer_in(1, MOST_TERMS, "terms"), default=12),
    cli.flag("--all", "text: every fact, not only those that most ask for"),
    cli.format_option("text json tex"),
    cli.option("--plot", "also draw a picture, e.g. region.svg", type=Path, metavar="FILE"),
    cli.option(
        "--picture",
        "what to draw: stability region, order star, or dispersion and dissipation",
        choices=("region", "order-star", "phase"),
        default="region",
    ),
)
def facts_command(options: Namespace) -> str:
    """Derive the exact facts of a method: order, stability, symplecticity, limits, series, and why.

    examples:
      driftproof facts rk4
      driftproof facts rk4 --all
      driftproof facts rk4 --only order,stability_function,imaginary_limit
      driftproof facts rk4 --system '0 1; -1 -1/10'            on z' = Az: R(hA), its determinant, limits of h
      driftproof facts sdirk_order_2                           a family, as a function of its parameter
      driftproof facts sdirk_order_2 --at '1 - sqrt(2)/2'      one member of it
      driftproof facts tsitouras54 --only order,order_fails --order-tolerance 1e-12
      driftproof facts rk4 --only region_boundary --format json
      driftproof facts bdf3                                    a multistep method: root condition, A(alpha), barriers
      driftproof facts tableau.toml --format tex
      driftproof facts rk4 --only order --plot region.svg      needs the extra: pip install 'driftproof[report]'

    A family of your own is a Runge-Kutta tableau with a line parameter = "theta" and entries such as "1 - theta".

    tableau.toml:
      family = "runge_kutta"            or splitting, nystrom, collocation, multistep, rosenbrock, additive
      A = [[0, 0], ["2/3", 0]]
      b = ["1/4", "3/4"]                c may be left out: then the row sums of A
      [roots]                           if coefficients need one, e.g. s3 = "sqrt(3)"; then write "1/4 - s3/6"
    """
    from driftproof.methods.catalogue import FactsOnly
    from driftproof.methods.families import Family
    from driftproof.methods.tableau_file import subject_of
    from driftproof.support.plain_text import as_json
    from driftproof.texts.writing.fact_groups import grouped_facts_text
    from driftproof.texts.writing.facts import facts_tex, facts_text
    from driftproof.texts.writing.records import record

    subject = subject_of(options.method)
    if isinstance(subject, Family):
        result = _of_family(subject, options)
    elif isinstance(subject, FactsOnly):
        result = _of_facts_only(subject, options)
    elif options.at is None:
        result = _of_method(subject, options)
    else:
        raise ValueError(f"{subject.key} has no parameter; --at is for families such as sdirk_order_2")
    if options.format == "json":
        return as_json(record(result))
    if options.format == "tex":
        return facts_tex(result)
    return facts_text(result) if options.only or options.system else grouped_facts_text(result, options.all)


@cli.command(
    cli.option("method", "a key that `driftproof methods` lists, or a file that ends in .toml"),
    cli.option("--only", "derive only these", type=cli.several(str), default=(), metavar="NAME,NAME"),
    cli.format_option("text tex json", "text, TeX to paste, or json"),
)
def derive_command(options: Namespace) -> str:
    """Derive what a method with rational coefficients does to q' = v, v' = -q, line by line, in the symbol h:
    one-step matrix, determinant, energy multiplier, invariant, roots, phase and stability limit.

    examples:
      driftproof derive symplectic_euler
      driftproof derive rk4 --only energy_multiplier,stability_limit --format tex
      driftproof derive tableau.toml --format json
    """
    from driftproof.methods.tableau_file import method_of
    from driftproof.support.plain_text import as_json
    from driftproof.symbolic.derivation.derive import derive

    method = method_of(options.method)
    derived = derive(method).chosen(options.only)
    if options.format == "json":
        return as_json({"method": method.key, "derived": {each.name: each.data() for each in derived}})
    return "\n\n".join(each.derivation_tex if options.format == "tex" else each.text for each in derived)


def _of_family(family: Family, options: Namespace) -> dict[str, Any]:
    """The facts of the family, or of its member at --at. Raises ValueError for options that only a method has."""
    from driftproof.symbolic.family_facts import FAMILY_FACTS, FamilyFacts
    from driftproof.symbolic.linear.facts import facts_by_name

    if options.at is not None:
        return _of_method(family.member(options.at), options)
    if options.system or options.order_tolerance is not None or options.plot:
        raise ValueError(f"{family.key} is a family; choose one method with --at, a value of {family.parameter}")
    return facts_by_name(FamilyFacts(family), options.only or FAMILY_FACTS, FAMILY_FACTS)


def _of_facts_only(method: FactsOnly, options: Namespace) -> dict[str, Any]:
    """The facts of a method that has facts only. Raises ValueError for options of methods that step from one state."""
    from driftproof.symbolic.facts import facts_only

    if options.at is not None or options.system or options.plot:
        raise ValueError(f"{method.key} is {method.kind}; --at, --system and --plot are not for it")
    return facts_only(method, options.only or (), options.order_tolerance)


def _of_method(method: Method, options: Namespace) -> dict[str, Any]:
    """The facts of the method, or of the method on a system; also its picture, if one is asked for."""
    from driftproof.symbolic.facts import FACTS, ON_REQUEST, Facts, Reduction, order_within
    from driftproof.symbolic.linear.facts import facts_by_name
    from driftproof.symbolic.linear.systems import facts_on_system

    if options.system and (options.order_tolerance is not None or options.plot):
        raise ValueError("--system is about one problem, --order-tolerance and --plot about the method; ask separately")
    if options.system:
        return facts_on_system(method, options.system, options.only)
    facts = Facts(method, options.terms)
    found = facts_by_name(facts, options.only or FACTS, (*FACTS, *ON_REQUEST))
    if facts.reduction is not None and options.only and "reduction" not in options.only:
        stages, *named = facts.reduction
        table, irreducible = (tuple(name for name in names if name in found) for names in named)
        if table or irreducible:
            found["reduction"] = Reduction(stages, table, irreducible)
    if options.order_tolerance is not None:
        found["order_to_tolerance"] = order_within(method, options.order_tolerance)
    if options.plot:
        from driftproof.support.environment import require_package

        require_package("matplotlib", "report", "pictures need matplotlib")
        from driftproof.reports.method_figures import draw_method

        draw_method(options.picture, method, options.plot)
    return found
