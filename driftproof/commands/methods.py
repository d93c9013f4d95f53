"""`driftproof methods`, `facts` and `derive`: the catalogue, the exact facts of a method, and derivations of some."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from driftproof.commands import arguments as cli

# Terms of a series: this many take a second for most methods, and minutes for those with irrational coefficients.
MOST_TERMS = 1000
_PICTURES = ("region", "order-star", "phase")


@cli.command(cli.format_option("text json", "json has an entry for each key"))
def methods_command(options: Namespace) -> str:
    """List the methods of the catalogue: key, family, claimed order, title, source. KEY_embedded: a pair's other row.

    examples:
      driftproof methods
      driftproof methods --format json
    """
    from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
    from driftproof.methods.families import FAMILIES
    from driftproof.support.plain_text import as_json, table

    names = {"RungeKutta": "Runge-Kutta", "Collocation": "collocation", "Splitting": "splitting", "Nystrom": "Nyström"}
    names |= {"Multistep": "multistep", "Rosenbrock": "Rosenbrock", "Additive": "IMEX"}
    rows = [["method", "family", "order", "title", "source"]]
    for key, method in (*METHODS.items(), *FURTHER_METHODS.items()):
        rows.append([key, names[type(method).__name__], str(method.claimed_order), method.title, method.source])
    for key, family in FAMILIES.items():
        rows.append([key, f"Runge-Kutta in {family.parameter}", str(family.claimed_order), family.title, family.source])
    if options.format == "json":
        return as_json({key: dict(zip(rows[0][1:], row, strict=True)) for key, *row in rows[1:]})
    return table(rows, right=(2,))


@cli.command(
    cli.option("method", "a key that `driftproof methods` lists, or a .toml file"),
    cli.option("--only", "compute and print only these facts", type=cli.several(str), metavar="FACT,FACT"),
    cli.option("--at", "for a family: the value of its parameter, such as 1/4", metavar="VALUE"),
    cli.option("--system", "facts on z' = Az instead, for the matrix A, such as '0 1; -1 -1/10'", metavar="ROWS"),
    cli.option(
        "--order-tolerance", "the order with residuals up to SIZE", type=cli.exactly("order tolerance"), metavar="SIZE"
    ),
    cli.option("--terms", "terms of the series (default 12)", type=cli.integer_in(1, MOST_TERMS, "terms"), default=12),
    cli.flag("--all", "in text, also show the facts that are rarely needed"),
    cli.format_option("text json tex"),
    cli.option("--plot", "also draw a figure into this .svg file; see --picture", type=Path, metavar="FILE"),
    cli.option("--picture", "what --plot draws (default region); phase: dispersion and dissipation", choices=_PICTURES),
)
def facts_command(options: Namespace) -> str:
    """Derive the exact facts of a method: order, stability, symplecticity, limits on h, series, each with its reason.

    examples:
      driftproof facts rk4                                     Runge-Kutta; gauss2 is one by collocation
      driftproof facts velocity_verlet --all                   a splitting; nystrom4 is a Runge-Kutta-Nyström method
      driftproof facts bdf3                                    a multistep method: root condition, A(alpha), barriers
      driftproof facts rodas4                                  a Rosenbrock method; ark324 is an additive one (IMEX)
      driftproof facts sdirk_order_2                           a family, as a function of its parameter
      driftproof facts sdirk_order_2 --at '1 - sqrt(2)/2'      one member of it
      driftproof facts rk4 --only order,stability_function,imaginary_limit --format json
      driftproof facts rk4 --system '0 1; -1 -1/10'            on z' = Az: R(hA), its determinant, limits on h
      driftproof facts tsitouras54 --only order,order_fails --order-tolerance 1e-12
      driftproof facts tableau.toml --format tex
      driftproof facts rk4 --only order --plot region.svg

    A family of your own is a Runge-Kutta tableau with a line parameter = "theta" and entries such as "1 - theta".
    'mine.toml at 1/2' names a member of it for every command, as 'sdirk_order_2 at 1/4' does of ours.

    exit status: 1 if the order, or zero-stability, is shown, and the order is not the claimed one, nor that of embedded
    weights, or a multistep method is not zero-stable, which the first lines then say, with the one entry that may be
    wrong; 2 if the file cannot be read. A claim holds if digits explain what is missed, and one of a splitting if it
    holds on q'' = F(q). Of [roots] one that is no radical is { minpoly = [-3, 0, 1], interval = [1, 2] }, the root
    there of x² - 3.

    tableau.toml:
      family = "runge_kutta"            or splitting, nystrom, collocation, multistep, rosenbrock, additive
      A = [[0, 0], ["2/3", 0]]
      b = ["1/4", "3/4"]                c may be left out; it is then the row sums of A
      claimed_order = 2                 may be left out
      [roots]                           if coefficients need one, e.g. s3 = "sqrt(3)"; then write "1/4 - s3/6"
    """
    from driftproof.reports.fact_sheet import MethodFacts, facts

    about = {name: getattr(options, name) for name in ("only", "at", "system", "order_tolerance", "terms")}
    sheet = facts(options.method, **about)
    if not options.plot:
        cli.refuse(options, ("picture",), "without --plot")
    else:
        if not isinstance(sheet, MethodFacts):
            takes = "--plot takes one method of one step, without --system; --at chooses a member of a family"
            raise ValueError(f"{takes}; `driftproof facts` without --plot has the facts of all")
        from driftproof.reports.method_figures import draw_method

        draw_method(options.picture or _PICTURES[0], sheet.method, options.plot)
    written: str = sheet.written(options.format, options.all)
    written += f"\n\nwrote {options.plot}" if options.plot and options.format == "text" else ""
    if sheet.unreached:
        raise cli.Refuted(written)
    return written


@cli.command(
    cli.option("method", "a key that `driftproof methods` lists, or a .toml file"),
    cli.option("--only", "derive only these facts", type=cli.several(str), default=(), metavar="NAME,NAME"),
    cli.format_option("text tex json", "tex is for pasting into a document, json for programs"),
)
def derive_command(options: Namespace) -> str:
    """Derive the behaviour of a method with rational coefficients on q' = v, v' = -q, line by line, in the symbol h:
    one-step matrix, determinant, energy multiplier, invariant, roots, phase and stability limit.

    examples:
      driftproof derive symplectic_euler
      driftproof derive rk4 --only energy_multiplier,stability_limit --format tex
      driftproof derive tableau.toml --format json
    """
    from driftproof.symbolic.derivation.derive import derive

    return derive(options.method, only=options.only).written(options.format)
